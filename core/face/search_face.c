#include <math.h>
#include <string.h>

#include "face_data.h"
#include "face_work.h"
#include "place.h"
#include "search.h"

/* Sizes of heads that differ by less are one but for rounding. */
#define SEARCH_SAME 1e-6

/* The basis of w's model, made when it is first needed. */
static enum status search_need(struct surface_work *w)
{
    enum status st;

    if (w->search != NULL)
        return ST_OK;
    if ((w->search = mem_array(1, sizeof *w->search)) == NULL)
        return ST_ENOMEM;
    if ((st = search_prepare(&w->encode, &w->normal, w->search)) == ST_OK)
        return ST_OK;
    mem_free(w->search);
    w->search = NULL;
    return st;
}

enum surface_status surface_describe(struct surface_work *work,
                                     const struct surface_face *face,
                                     unsigned char out[SURFACE_DESCRIPTOR])
{
    enum status st = search_need(work);

    if (st == ST_OK)
        st = search_describe(work->search, &face->encoding, &work->normal, out);
    return status_to(st);
}

/* A search under way. */
struct search_face {
    struct search_probe probe;
    struct encoding other;   /* of the probe at the mean face's size */
    struct search_hit hit[]; /* [most] */
};

static enum status scan(struct surface_work *work, const struct surface_index *x,
                        const struct encoding *e, const uint16_t *allowed, double floor,
                        size_t most, struct search_face *g, struct surface_hit *hit,
                        size_t *n)
{
    const enum status st = search_probe(work->search, e, work->model->kinship,
                                        search_classes(x), &work->normal, &g->probe);

    *n = 0;
    if (st != ST_OK)
        return st;
    *n = search_scan(x, &g->probe, allowed, floor, most, g->hit);
    for (size_t i = 0; i < *n; i++)
        hit[i] = (struct surface_hit){(float)search_score(&g->probe, g->hit[i].cost),
                                      g->hit[i].slot};
    return ST_OK;
}

/* The head at the mean face's size: of one person both scans are compared at one size (pair.h), and most
 * templates have that. */
static enum status encode_other(struct surface_work *work,
                                const struct surface_face *probe, struct encoding *out)
{
    struct shape_fit fit;
    const enum status st = place_at(probe, 1, work, &fit);

    return st == ST_OK ? place_encode(probe, &fit, work, out) : st;
}

/* Keeps the `most` best of both lists, a slot once.  O(n m): few probes come here. */
static void search_merge(struct surface_hit *hit, size_t *n,
                         const struct surface_hit *more, size_t m, size_t most)
{
    for (size_t k = 0; k < m; k++) {
        size_t at = 0, end;

        for (end = 0; end < *n && hit[end].slot != more[k].slot; end++)
            ;
        if (end < *n && hit[end].score >= more[k].score)
            continue;
        if (end == *n && *n < most)
            ++*n;
        else if (end == *n && hit[--end].score >= more[k].score)
            continue;
        while (at < end && hit[at].score >= more[k].score)
            at++;
        memmove(&hit[at + 1], &hit[at], (end - at) * sizeof *hit);
        hit[at] = more[k];
    }
}

enum surface_status surface_search(struct surface_work *work,
                                   const struct surface_index *x,
                                   const struct surface_face *probe,
                                   const uint16_t *allowed, double floor, size_t most,
                                   struct surface_hit *hit, size_t *n)
{
    struct search_face *g =
        mem_array(1, sizeof *g + most * (sizeof *g->hit + sizeof(struct surface_hit)));
    struct surface_hit *more = g != NULL ? (struct surface_hit *)&g->hit[most] : NULL;
    enum status st = g != NULL ? search_need(work) : ST_ENOMEM;
    size_t m;

    *n = 0;
    if (st == ST_OK)
        st = scan(work, x, &probe->encoding, allowed, floor, most, g, hit, n);
    if (st == ST_OK && fabs(place_size(&probe->frame.pose) - 1) > SEARCH_SAME &&
        (st = probe->surface.mesh.nv > 0 ? ST_OK : ST_EINVAL) == ST_OK &&
        (st = encode_other(work, probe, &g->other)) == ST_OK && g->other.n > 0) {
        st = scan(work, x, &g->other, allowed, floor, most, g, more, &m);
        search_merge(hit, n, more, m, most);
    }
    mem_free(g);
    return status_to(st);
}
