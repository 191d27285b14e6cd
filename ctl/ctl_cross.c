#include "ctl_cross.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "ctl_model.h"
#include "pool.h"

static enum status ctl_cross_no_memory(struct ctl *c)
{
    return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
}

/* ---- loading */

struct ctl_cross_list {
    struct ctl *c;
    struct ctl_cross_subject *subject;
    uint32_t n;
};

/* Those that have a template. */
static enum status list_subject(void *arg, const struct store_subject *one,
                                struct errinfo *e)
{
    struct ctl_cross_list *l = arg;
    void *larger;

    (void)e;
    if (one->templates == 0)
        return ST_OK;
    if ((larger = command_grow(l->subject, l->n, sizeof *l->subject)) == NULL)
        return ctl_cross_no_memory(l->c);
    l->subject = larger;
    memcpy(l->subject[l->n++].id, one->id, sizeof one->id);
    return ST_OK;
}

/* Keep n of list[0..m-1], in their order (Knuth's algorithm S). */
static void draw_subjects(struct ctl_cross_subject *list, uint32_t m, uint32_t n,
                          uint64_t seed)
{
    uint32_t taken = 0;

    for (uint32_t i = 0; i < m && taken < n; i++)
        if (rates_below(&seed, m - i) < n - taken)
            list[taken++] = list[i];
}

static enum status load_subject(struct ctl *c, struct ctl_cross_subject *one,
                                struct ctl_cross *p)
{
    struct store_template *list = NULL, t;
    size_t n = 0;
    void *faces;
    enum status st = store_template_list(c->store, one->id, &list, &n, &c->e);

    one->first = p->ntemplate;
    one->n = 0;
    if (st == ST_ENOTFOUND)
        return ST_OK; /* deleted since it was listed */
    if (st != ST_OK)
        return st;
    if ((faces = realloc(p->face, (p->ntemplate + n + 1) * sizeof *p->face)) != NULL)
        p->face = faces;
    else
        st = ctl_cross_no_memory(c);
    for (size_t i = 0; i < n && st == ST_OK; i++) {
        struct surface_face *f = NULL;

        st = store_template_load(c->store, list[i].id, &t, c->work, &f, &c->e);
        if (st == ST_OK) {
            p->face[p->ntemplate++] = f;
            one->n++;
        } else {
            if (st == ST_EVERSION) /* of another engine, and of no use to this one */
                (void)fprintf(stderr, "surfacectl: template skipped: %s\n", c->e.msg);
            st = st == ST_ENOTFOUND || st == ST_EVERSION ? ST_OK : st;
        }
    }
    free(list);
    return st;
}

enum status ctl_cross_load(struct ctl *c, uint64_t seed, struct ctl_cross *p)
{
    struct ctl_cross_list list = {.c = c};
    enum status st = ctl_model_each(c->store, list_subject, &list, &c->e);
    uint32_t all = list.n;

    p->subject = list.subject;
    p->nenrolled = all;
    if (st == ST_OK && all > CTL_CROSS_MAX) {
        draw_subjects(p->subject, all, CTL_CROSS_MAX, seed);
        all = CTL_CROSS_MAX;
    }
    for (uint32_t i = 0; i < all && st == ST_OK; i++) {
        p->subject[p->nsubject] = p->subject[i];
        if ((st = load_subject(c, &p->subject[p->nsubject], p)) == ST_OK &&
            p->subject[p->nsubject].n > 0)
            p->nsubject++;
    }
    return st;
}

void ctl_cross_free(struct ctl_cross *p)
{
    for (uint32_t i = 0; i < p->ntemplate; i++)
        surface_face_free(p->face[i]);
    free(p->face);
    free(p->subject);
    free(p->score);
    memset(p, 0, sizeof *p);
}

/* ---- comparing */

/* A probe against the templates of a subject, but template skip. */
static enum status ctl_cross_compare(const struct ctl_cross *p, uint32_t subject,
                                     uint32_t skip, const struct surface_face *probe,
                                     struct surface_work *w, double *score,
                                     struct errinfo *e)
{
    const struct ctl_cross_subject *one = &p->subject[subject];
    const uint32_t n = one->n - (skip - one->first < one->n);

    *score = -(double)INFINITY;
    for (uint32_t t = one->first; t < one->first + one->n; t++) {
        struct surface_comparison r = {0};
        enum status st;

        if (t == skip)
            continue;
        if ((st = status_from(surface_compare(w, p->face[t], probe, &r))) != ST_OK)
            return errinfo_set(e, st, "comparing: %s", status_message(st));
        surface_best_of(w, n, &r);
        *score = fmax(*score, r.score);
    }
    return ST_OK;
}

/* A template as the probe. */
struct trial {
    uint32_t subject, probe;
};

struct trials {
    const struct ctl_cross *p;
    const struct trial *trial;
    struct rates_score *score; /* [trials] */
};

static uint32_t owner(const struct ctl_cross *p, uint32_t template)
{
    uint32_t low = 0, high = p->nsubject;

    while (high - low > 1) {
        const uint32_t mid = low + (high - low) / 2;

        if (p->subject[mid].first <= template)
            low = mid;
        else
            high = mid;
    }
    return low;
}

static enum status do_trial(void *arg, size_t i, struct surface_work *w,
                            struct errinfo *e)
{
    const struct trials *t = arg;
    const struct trial *x = &t->trial[i];

    t->score[i].template = x->subject;
    t->score[i].probe = owner(t->p, x->probe);
    return ctl_cross_compare(t->p, x->subject, x->probe, t->p->face[x->probe], w,
                             &t->score[i].score, e);
}

static enum status do_trials(struct ctl *c, struct ctl_cross *p, const char *what,
                             const struct trial *trial, size_t n)
{
    struct trials t = {.p = p, .trial = trial};
    void *larger = realloc(p->score, (p->nscore + n + 1) * sizeof *p->score);
    enum status st = ST_OK;

    if (larger == NULL)
        return ctl_cross_no_memory(c);
    p->score = larger;
    t.score = p->score + p->nscore;
    if (n > 0)
        st = pool_run(what, c->threads, c->model, n, do_trial, &t, &c->e);
    if (st == ST_OK)
        p->nscore += n;
    return st;
}

/* How many probes a subject meets: all others' templates, or an equal share of limit. */
static uint32_t wanted(const struct ctl_cross *p, uint32_t subject, double limit)
{
    const uint32_t n = p->subject[subject].n, others = p->ntemplate - n;
    const double share = limit / p->nsubject / n;

    return share >= others ? others : share > 1 ? (uint32_t)share : others > 0;
}

enum status ctl_cross_non_mated(struct ctl *c, struct ctl_cross *p, double limit,
                                uint64_t seed)
{
    struct trial *trial;
    double all = 0;
    size_t n = 0;
    enum status st;

    for (uint32_t i = 0; i < p->nsubject; i++)
        all += (double)p->subject[i].n * (p->ntemplate - p->subject[i].n);
    if (all <= limit)
        limit = (double)INFINITY;
    for (uint32_t i = 0; i < p->nsubject; i++)
        n += wanted(p, i, limit);
    if ((trial = malloc((n + 1) * sizeof *trial)) == NULL)
        return ctl_cross_no_memory(c);
    n = 0;
    for (uint32_t i = 0; i < p->nsubject; i++) {
        const struct ctl_cross_subject *one = &p->subject[i];
        uint32_t left = p->ntemplate - one->n, want = wanted(p, i, limit);

        for (uint32_t t = 0; t < p->ntemplate && want > 0; t++) {
            if (t >= one->first && t < one->first + one->n)
                continue;
            if (rates_below(&seed, left--) < want) {
                trial[n++] = (struct trial){i, t};
                want--;
            }
        }
    }
    st = do_trials(c, p, "non-mated", trial, n);
    free(trial);
    return st;
}

enum status ctl_cross_mated(struct ctl *c, struct ctl_cross *p)
{
    struct trial *trial = malloc((p->ntemplate + (size_t)1) * sizeof *trial);
    size_t n = 0;
    enum status st;

    if (trial == NULL)
        return ctl_cross_no_memory(c);
    for (uint32_t i = 0; i < p->nsubject; i++)
        for (uint32_t k = 0; k < p->subject[i].n && p->subject[i].n > 1; k++)
            trial[n++] = (struct trial){i, p->subject[i].first + k};
    st = do_trials(c, p, "mated", trial, n);
    free(trial);
    return st;
}
