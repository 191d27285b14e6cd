#include "ctl_cross.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "ctl_model.h"
#include "pool.h"
#include "store_people.h"

static enum status ctl_cross_no_memory(struct ctl *c)
{
    return errinfo_memory(&c->e);
}

/* ---- loading */

struct ctl_cross_listed { /* a template */
    int64_t key;          /* of its subject */
    uint32_t at;          /* index of tmpl */
    struct ctl_cross_subject of;
};

struct ctl_cross_list {
    struct ctl *c;
    struct ctl_cross *p;
    struct ctl_cross_listed *listed; /* [ntemplate] */
};

static enum status list_template(void *arg, const struct store_subject *of,
                                 const struct store_template *t,
                                 const unsigned char *descriptor, struct errinfo *e)
{
    struct ctl_cross_list *l = arg;
    struct ctl_cross *p = l->p;
    const uint32_t n = p->ntemplate;
    void *tmpl = command_grow(p->tmpl, n, sizeof *p->tmpl);
    void *listed = command_grow(l->listed, n, sizeof *l->listed);

    p->tmpl = tmpl != NULL ? tmpl : p->tmpl;
    l->listed = listed != NULL ? listed : l->listed;
    if (tmpl == NULL || listed == NULL)
        return errinfo_memory(e);
    l->listed[n] = (struct ctl_cross_listed){.key = of->key, .at = n};
    memcpy(l->listed[n].of.id, of->id, sizeof of->id);
    memcpy(l->listed[n].of.uid, of->uid, sizeof of->uid);
    p->tmpl[n] = (struct ctl_cross_template){.slot = SURFACE_NOWHERE};
    memcpy(p->tmpl[n].id, t->id, sizeof t->id);
    memcpy(p->tmpl[n].digest, t->digest, sizeof t->digest);
    if (descriptor != NULL)
        p->tmpl[n].slot = surface_index_add(p->index, descriptor);
    p->ntemplate++;
    return ST_OK;
}

static void list_damaged(void *arg, const char *line)
{
    struct ctl_cross_list *l = arg;

    l->p->damaged++;
    (void)fprintf(stderr, "surfacectl: %s\n", line);
}

static int by_subject(const void *a, const void *b)
{
    const struct ctl_cross_listed *x = a, *y = b;

    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return (x->at > y->at) - (x->at < y->at);
}

/* From the order of the rows to that of the subjects. */
static enum status list_sort(struct ctl_cross_list *l)
{
    struct ctl_cross *p = l->p;
    struct ctl_cross_template *tmpl =
        malloc((p->ntemplate + (size_t)1) * sizeof *p->tmpl);

    p->subject = malloc((p->ntemplate + (size_t)1) * sizeof *p->subject);
    if (tmpl == NULL || p->subject == NULL) {
        free(tmpl);
        return ctl_cross_no_memory(l->c);
    }
    if (p->ntemplate > 0)
        qsort(l->listed, p->ntemplate, sizeof *l->listed, by_subject);
    for (uint32_t i = 0; i < p->ntemplate; i++) {
        if (i == 0 || l->listed[i].key != l->listed[i - 1].key) {
            p->subject[p->nsubject] = l->listed[i].of;
            p->subject[p->nsubject++].first = i;
        }
        tmpl[i] = p->tmpl[l->listed[i].at];
        tmpl[i].owner = p->nsubject - 1;
        p->subject[p->nsubject - 1].n++;
    }
    free(p->tmpl);
    p->tmpl = tmpl;
    return ST_OK;
}

enum status ctl_cross_list(struct ctl *c, struct ctl_cross *p)
{
    struct ctl_cross_list l = {.c = c, .p = p};
    struct store_people *people = NULL;
    enum status st;

    if ((p->index = surface_index_new()) == NULL)
        return ctl_cross_no_memory(c);
    st = store_people_begin(c->store, c->actor, 0, &people, &c->e);
    if (st == ST_OK)
        st = store_people_all(people, list_template, list_damaged, &l, &c->e);
    st = store_people_end(people, st, &c->e);
    if (st == ST_OK)
        st = list_sort(&l);
    free(l.listed);
    return st;
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

    if (st == ST_OK && p->damaged > 0)
        st = errinfo_set(&c->e, ST_ECORRUPT, "%u template%s damaged", p->damaged,
                         p->damaged == 1 ? " is" : "s are");
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
    surface_index_free(p->index);
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
