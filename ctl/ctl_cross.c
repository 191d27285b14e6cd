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
    struct ctl_cross *p;
};

static enum status list_subject(void *arg, const struct store_subject *one,
                                struct errinfo *e)
{
    struct ctl *c = ((struct ctl_cross_list *)arg)->c;
    struct ctl_cross *p = ((struct ctl_cross_list *)arg)->p;
    struct store_template *t = NULL;
    void *subjects = NULL, *templates = NULL;
    size_t n = 0;
    enum status st = one->templates > 0
                         ? store_template_list(c->store, c->actor, one->id, &t, &n, e)
                         : ST_OK;

    if (st != ST_OK || n == 0)
        goto out;
    if ((subjects = command_grow(p->subject, p->nsubject, sizeof *p->subject)) != NULL)
        p->subject = subjects;
    templates = realloc(p->tmpl, (p->ntemplate + n) * sizeof *p->tmpl);
    if (templates != NULL)
        p->tmpl = templates;
    if (subjects == NULL || templates == NULL) {
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
        goto out;
    }
    p->subject[p->nsubject] =
        (struct ctl_cross_subject){.first = p->ntemplate, .n = (uint32_t)n};
    memcpy(p->subject[p->nsubject].id, one->id, sizeof one->id);
    for (size_t i = 0; i < n; i++) {
        struct ctl_cross_template *to = &p->tmpl[p->ntemplate++];

        memcpy(to->id, t[i].id, sizeof to->id);
        memcpy(to->digest, t[i].digest, sizeof to->digest);
        to->owner = p->nsubject;
    }
    p->nsubject++;
out:
    free(t);
    return st;
}

enum status ctl_cross_list(struct ctl *c, struct ctl_cross *p)
{
    return ctl_model_each(c->store, list_subject, &(struct ctl_cross_list){c, p}, &c->e);
}

/* Appends the subject and the templates of it that have a face, which are at its place or behind. */
static enum status load_subject(struct ctl *c, struct ctl_cross_subject one,
                                struct ctl_cross *p)
{
    const uint32_t first = p->ntemplate;
    enum status st = ST_OK;

    for (uint32_t i = one.first; i < one.first + one.n && st == ST_OK; i++) {
        struct store_template t;
        struct surface_face *f = NULL;

        st = store_template_load(c->store, c->actor, p->tmpl[i].id, &t, c->work, &f,
                                 &c->e);
        if (st == ST_OK) {
            p->face[p->ntemplate] = f;
            p->tmpl[p->ntemplate] = p->tmpl[i];
            p->tmpl[p->ntemplate++].owner = p->nsubject;
        } else {
            if (st == ST_EVERSION) /* of another engine, and of no use to this one */
                (void)fprintf(stderr, "surfacectl: template skipped: %s\n", c->e.msg);
            st = st == ST_ENOTFOUND || st == ST_EVERSION ? ST_OK : st;
        }
    }
    one.first = first;
    one.n = p->ntemplate - first;
    if (one.n > 0)
        p->subject[p->nsubject++] = one;
    return st;
}

enum status ctl_cross_load(struct ctl *c, uint64_t seed, struct ctl_cross *p)
{
    enum status st = ctl_cross_list(c, p);
    const uint32_t all = p->nsubject;
    uint32_t wanted = all < CTL_CROSS_MAX ? all : CTL_CROSS_MAX;

    if (st != ST_OK)
        return st;
    if ((p->face = malloc((p->ntemplate + (size_t)1) * sizeof(void *))) == NULL)
        return ctl_cross_no_memory(c);
    p->nenrolled = all;
    p->nsubject = p->ntemplate = 0;
    for (uint32_t i = 0; i < all && st == ST_OK; i++)
        if (rates_below(&seed, all - i) < wanted) { /* Knuth's algorithm S */
            wanted--;
            st = load_subject(c, p->subject[i], p);
        }
    return st;
}

void ctl_cross_free(struct ctl_cross *p)
{
    for (uint32_t i = 0; p->face != NULL && i < p->ntemplate; i++)
        surface_face_free(p->face[i]);
    free(p->face);
    free(p->tmpl);
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

static enum status do_trial(void *arg, size_t i, struct surface_work *w,
                            struct errinfo *e)
{
    const struct trials *t = arg;
    const struct trial *x = &t->trial[i];

    t->score[i].template = x->subject;
    t->score[i].probe = t->p->tmpl[x->probe].owner;
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
