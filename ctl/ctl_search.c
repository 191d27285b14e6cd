#include "ctl_search.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "pool.h"
#include "store.h"
#include "store_people.h"

#define HITS  1024 /* most hits of a search at first */
#define CHUNK 64   /* pairs that are compared by one thread */

struct searching {
    struct ctl *c;
    struct ctl_cross *p;
    struct ctl_search *out;
    double floor;
    uint32_t *tmpl; /* template of each slot */

    pthread_mutex_t lock; /* protects what follows, and the members of *out */
    bool *skipped;        /* [ntemplate] */
};

/* ---- the faces of a subject */

struct faces {
    uint32_t of;                                    /* subject; CTL_SEARCH_ALL: none */
    struct surface_face *face[STORE_TEMPLATES_MAX]; /* of its templates; NULL: skipped */
};

static void faces_free(struct faces *f)
{
    for (size_t i = 0; i < STORE_TEMPLATES_MAX; i++)
        surface_face_free(f->face[i]);
    *f = (struct faces){.of = CTL_SEARCH_ALL};
}

static struct surface_face **face_of(const struct searching *s, struct faces *f,
                                     uint32_t i)
{
    return &f->face[i - s->p->subject[f->of].first];
}

/* Those of the snapshot that were listed; without their surfaces. */
static enum status take_faces(const struct searching *s, const struct store_snapshot *is,
                              struct surface_work *w, struct faces *f, struct errinfo *e)
{
    const struct ctl_cross_subject *one = &s->p->subject[f->of];
    enum status st = ST_OK;

    for (uint32_t i = one->first; i < one->first + one->n; i++)
        for (size_t k = 0; k < is->n && (st == ST_OK || st == ST_EVERSION); k++)
            if (strcmp(is->t[k].id, s->p->tmpl[i].id) == 0)
                st = store_snapshot_face(is, k, w, face_of(s, f, i), e);
    return st == ST_EVERSION ? ST_OK : st;
}

static bool is_skipped(struct searching *s, uint32_t i)
{
    bool is;

    (void)pthread_mutex_lock(&s->lock);
    is = s->skipped[i];
    (void)pthread_mutex_unlock(&s->lock);
    return is;
}

/* Those without a face are skipped from now on, so that a damaged one is reported once. */
static void skip_missing(struct searching *s, struct faces *f, const struct errinfo *why)
{
    const struct ctl_cross_subject *one = &s->p->subject[f->of];

    (void)pthread_mutex_lock(&s->lock);
    for (uint32_t i = one->first; i < one->first + one->n; i++)
        s->skipped[i] = s->skipped[i] || *face_of(s, f, i) == NULL;
    s->p->damaged += why != NULL;
    (void)pthread_mutex_unlock(&s->lock);
    if (why != NULL)
        (void)fprintf(stderr, "surfacectl: %s\n", why->msg);
}

/* Sets f to the faces of the subject.  Each is read in a transaction of its own: a long one would keep the
 * database from forgetting what is erased meanwhile. */
static enum status need_faces(struct searching *s, uint32_t subject,
                              struct surface_work *w, struct faces *f, struct errinfo *e)
{
    struct store_people *people = NULL;
    struct store_snapshot is;
    struct store_snapshot_of what = {.uid = s->p->subject[subject].uid};
    enum status st;

    if (f->of == subject)
        return ST_OK;
    faces_free(f);
    f->of = subject;
    if ((st = store_people_begin(s->c->store, s->c->actor, 0, &people, e)) != ST_OK)
        return st;
    what.people = people;
    if ((st = store_snapshot_begin(s->c->store, &what, &is, e)) == ST_OK)
        st = take_faces(s, &is, w, f, e);
    st = store_people_end(people, store_snapshot_end(&is, st, e), e);
    store_snapshot_free(&is);
    if (st != ST_OK && st != ST_ECORRUPT && st != ST_ENOTFOUND)
        return st;
    skip_missing(s, f, st == ST_ECORRUPT ? e : NULL);
    return ST_OK;
}

/* Loads a face with its surface, which scans of heads of other sizes need. */
static enum status need_surface(const struct searching *s, uint32_t i,
                                struct surface_work *w, struct surface_face **f,
                                struct errinfo *e)
{
    struct store_template t;
    enum status st;

    if (surface_face_points(*f, NULL) > 0)
        return ST_OK;
    st = store_template_load(s->c->store, s->c->actor, s->p->tmpl[i].id, &t, w, f, e);
    return st == ST_ENOTFOUND ? ST_OK : st;
}

/* ---- templates without a descriptor: of another engine */

static enum status search_describe(void *arg, size_t i, struct surface_work *w,
                                   struct errinfo *e)
{
    struct searching *s = arg;
    struct ctl_cross_template *t = &s->p->tmpl[i];
    struct faces f = {.of = CTL_SEARCH_ALL};
    unsigned char d[SURFACE_DESCRIPTOR];
    enum status st = ST_OK;

    if (t->slot != SURFACE_NOWHERE)
        return ST_OK;
    if ((st = need_faces(s, t->owner, w, &f, e)) == ST_OK &&
        *face_of(s, &f, (uint32_t)i) != NULL) {
        const bool is =
            surface_describe(w, *face_of(s, &f, (uint32_t)i), d) == SURFACE_OK;

        (void)pthread_mutex_lock(&s->lock);
        if (is)
            t->slot = surface_index_add(s->p->index, d);
        s->skipped[i] = t->slot == SURFACE_NOWHERE;
        (void)pthread_mutex_unlock(&s->lock);
    }
    faces_free(&f);
    return st;
}

/* The template of each slot. */
static enum status map_slots(struct searching *s)
{
    const struct ctl_cross *p = s->p;
    uint32_t slots = 0;

    for (uint32_t i = 0; i < p->ntemplate; i++)
        if (p->tmpl[i].slot != SURFACE_NOWHERE && p->tmpl[i].slot >= slots)
            slots = p->tmpl[i].slot + 1;
    if ((s->tmpl = malloc((slots + (size_t)1) * sizeof *s->tmpl)) == NULL)
        return errinfo_memory(&s->c->e);
    for (uint32_t i = 0; i < p->ntemplate; i++)
        if (p->tmpl[i].slot != SURFACE_NOWHERE)
            s->tmpl[p->tmpl[i].slot] = i;
    return ST_OK;
}

/* ---- pairs that may score so much */

static enum status keep_pairs(struct searching *s, uint32_t i,
                              const struct surface_hit *hit, size_t n)
{
    struct ctl_search *out = s->out;

    for (size_t k = 0; k < n; k++) {
        const uint32_t j = s->tmpl[hit[k].slot];
        void *larger;

        if (s->p->tmpl[j].owner == s->p->tmpl[i].owner)
            continue;
        if ((larger = command_grow(out->pair, out->n, sizeof *out->pair)) == NULL)
            return ST_ENOMEM;
        out->pair = larger;
        out->pair[out->n++] = (struct ctl_search_pair){i < j ? i : j, i < j ? j : i, 0};
    }
    return ST_OK;
}

/* All hits, however many there are. */
static enum status search_hits(struct searching *s, struct surface_work *w,
                               const struct surface_face *f, struct surface_hit **hit,
                               size_t *n)
{
    enum status st = ST_OK;

    *hit = NULL;
    *n = 0;
    for (size_t most = HITS; st == ST_OK && (*hit == NULL || *n == most / 4); most *= 4) {
        struct surface_hit *larger = realloc(*hit, most * sizeof **hit);

        if (larger == NULL)
            return ST_ENOMEM;
        *hit = larger;
        st = status_from(surface_search(w, s->p->index, f, NULL,
                                        s->floor - CTL_SEARCH_MARGIN, most, *hit, n));
    }
    return st;
}

static enum status search_one(struct searching *s, uint32_t i, struct surface_work *w,
                              struct surface_face **f, struct errinfo *e)
{
    struct surface_hit *hit = NULL;
    size_t n = 0;
    enum status st = search_hits(s, w, *f, &hit, &n);

    if (st == ST_EINVAL && (st = need_surface(s, i, w, f, e)) == ST_OK && *f != NULL) {
        free(hit);
        st = search_hits(s, w, *f, &hit, &n);
    }
    (void)pthread_mutex_lock(&s->lock);
    if (st == ST_OK)
        st = keep_pairs(s, i, hit, n);
    if (st == ST_EINVAL || *f == NULL)
        s->skipped[i] = true;
    (void)pthread_mutex_unlock(&s->lock);
    free(hit);
    return st == ST_EINVAL ? ST_OK : st;
}

static enum status search_subject(void *arg, size_t i, struct surface_work *w,
                                  struct errinfo *e)
{
    struct searching *s = arg;
    const struct ctl_cross_subject *one = &s->p->subject[i];
    struct faces f = {.of = CTL_SEARCH_ALL};
    enum status st = need_faces(s, (uint32_t)i, w, &f, e);

    for (uint32_t k = one->first; st == ST_OK && k < one->first + one->n; k++) {
        struct surface_face **face = face_of(s, &f, k);

        if (!is_skipped(s, k) && (st = search_one(s, k, w, face, e)) == ST_ENOMEM)
            st = errinfo_memory(e);
    }
    faces_free(&f);
    return st;
}

static int search_by_pair(const void *p, const void *q)
{
    const struct ctl_search_pair *v = p, *w = q;

    if (v->a != w->a)
        return v->a < w->a ? -1 : 1;
    return (v->b > w->b) - (v->b < w->b);
}

/* Found from both sides, it is one. */
static void sort_pairs(struct ctl_search *out)
{
    size_t kept = 0;

    if (out->n > 0)
        qsort(out->pair, out->n, sizeof *out->pair, search_by_pair);
    for (size_t i = 0; i < out->n; i++)
        if (kept == 0 || search_by_pair(&out->pair[kept - 1], &out->pair[i]) != 0)
            out->pair[kept++] = out->pair[i];
    out->n = kept;
}

static enum status pairs_of_all(struct searching *s)
{
    struct ctl *c = s->c;
    const struct ctl_cross *p = s->p;
    bool all = true;
    enum status st = ST_OK;

    for (uint32_t i = 0; i < p->ntemplate; i++)
        all = all && p->tmpl[i].slot != SURFACE_NOWHERE;
    if (!all)
        st = pool_run("describe", c->threads, c->model, p->ntemplate, search_describe, s,
                      &c->e);
    if (st == ST_OK && (st = map_slots(s)) == ST_OK)
        st = pool_run("search", c->threads, c->model, p->nsubject, search_subject, s,
                      &c->e);
    sort_pairs(s->out);
    return st;
}

static enum status pairs_of_one(struct searching *s, const struct ctl_cross_subject *one)
{
    const uint32_t n = s->p->ntemplate, end = one->first + one->n;
    struct ctl_search *out = s->out;

    out->pair = malloc(((size_t)one->n * (n - one->n) + 1) * sizeof *out->pair);
    if (out->pair == NULL)
        return errinfo_memory(&s->c->e);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = one->first; k < end; k++)
            if (i < one->first || i >= end)
                out->pair[out->n++] =
                    (struct ctl_search_pair){i < k ? i : k, i < k ? k : i, 0};
    sort_pairs(out);
    return ST_OK;
}

/* ---- comparing */

static enum status search_compare(struct searching *s, struct ctl_search_pair *x,
                                  struct faces f[2], struct surface_work *w,
                                  struct surface_comparison *r, struct errinfo *e)
{
    struct surface_face **a = face_of(s, &f[0], x->a), **b = face_of(s, &f[1], x->b);
    enum status st = status_from(surface_compare(w, *a, *b, r));

    if (st == ST_EINVAL && (st = need_surface(s, x->a, w, a, e)) == ST_OK &&
        (st = need_surface(s, x->b, w, b, e)) == ST_OK && *a != NULL && *b != NULL)
        st = status_from(surface_compare(w, *a, *b, r));
    if (st != ST_OK && e->code != st)
        return errinfo_set(e, st, "comparing: %s", status_message(st));
    return st;
}

/* A pair without a face has the score -INFINITY. */
static enum status compare_chunk(void *arg, size_t i, struct surface_work *w,
                                 struct errinfo *e)
{
    struct searching *s = arg;
    struct faces f[2] = {{.of = CTL_SEARCH_ALL}, {.of = CTL_SEARCH_ALL}};
    uint64_t compared = 0, inconclusive = 0;
    enum status st = ST_OK;

    for (size_t k = i * CHUNK; st == ST_OK && k < (i + 1) * CHUNK && k < s->out->n; k++) {
        struct ctl_search_pair *x = &s->out->pair[k];
        struct surface_comparison r = {0};

        x->score = -(double)INFINITY;
        if (is_skipped(s, x->a) || is_skipped(s, x->b) ||
            (st = need_faces(s, s->p->tmpl[x->a].owner, w, &f[0], e)) != ST_OK ||
            (st = need_faces(s, s->p->tmpl[x->b].owner, w, &f[1], e)) != ST_OK ||
            *face_of(s, &f[0], x->a) == NULL || *face_of(s, &f[1], x->b) == NULL ||
            (st = search_compare(s, x, f, w, &r, e)) != ST_OK)
            continue;
        x->score = r.expected > 0 ? r.score : x->score;
        compared++;
        inconclusive += r.score < s->floor && r.expected < s->floor;
    }
    (void)pthread_mutex_lock(&s->lock);
    s->out->compared += compared;
    s->out->inconclusive += inconclusive;
    (void)pthread_mutex_unlock(&s->lock);
    faces_free(&f[0]);
    faces_free(&f[1]);
    return st;
}

static enum status compare_pairs(struct searching *s)
{
    struct ctl *c = s->c;
    struct ctl_search *out = s->out;
    const size_t n = out->n;
    enum status st = ST_OK;

    if (n > 0)
        st = pool_run("compare", c->threads, c->model, (n + CHUNK - 1) / CHUNK,
                      compare_chunk, s, &c->e);
    out->n = 0;
    for (size_t i = 0; st == ST_OK && i < n; i++)
        if (out->pair[i].score >= s->floor)
            out->pair[out->n++] = out->pair[i];
    return st;
}

enum status ctl_search_run(struct ctl *c, struct ctl_cross *p, uint32_t alone,
                           double floor, struct ctl_search *out)
{
    struct searching s = {.c = c, .p = p, .out = out, .floor = floor};
    enum status st = ST_OK;

    *out = (struct ctl_search){.n = 0};
    if (p->nsubject < 2)
        return ST_OK;
    if ((s.skipped = calloc(p->ntemplate, sizeof *s.skipped)) == NULL)
        return errinfo_memory(&c->e);
    (void)pthread_mutex_init(&s.lock, NULL);
    st =
        alone != CTL_SEARCH_ALL ? pairs_of_one(&s, &p->subject[alone]) : pairs_of_all(&s);
    if (st == ST_OK)
        st = compare_pairs(&s);
    for (uint32_t i = 0; i < p->ntemplate; i++)
        out->skipped += s.skipped[i];
    (void)pthread_mutex_destroy(&s.lock);
    free(s.skipped);
    free(s.tmpl);
    return st;
}

void ctl_search_free(struct ctl_search *s)
{
    free(s->pair);
    *s = (struct ctl_search){.n = 0};
}
