#include "simplify.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "delaunay.h"
#include "disparity.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"
#include "star.h"

#define NONE UINT32_MAX

/* Simplification in progress. */
struct state {
    const struct mesh *m; /* the original */
    const struct simplify_limit *limit;
    struct mesh now;     /* the points that are left; numbers as in m */
    uint32_t left;       /* how many */
    double *gap;         /* [nv] now minus m */
    double *was;         /* [nv] the same before the last point was taken out */
    double *share;       /* [nv] a third of the counted area round the point, twice */
    double *volume;      /* [nt] of the original's triangles; twice */
    uint8_t *counts;     /* [nt] whether they do */
    uint32_t *first;     /* [nt] of the points that lie in a triangle of now, */
    uint32_t *next;      /* [nv] and the one after; NONE */
    double *key;         /* [nv] what taking the point out would cost */
    uint32_t *heap, *at; /* [nv] by key, then number; and where a point is in it */
    uint32_t size;
    double total, area; /* of volume; of the area that counts, twice */
};

/* ---- a heap of points, the least key on top */

static bool before(const struct state *s, uint32_t a, uint32_t b)
{
    return s->key[a] != s->key[b] ? s->key[a] < s->key[b] : a < b;
}

static void simplify_put(struct state *s, uint32_t place, uint32_t v)
{
    s->heap[place] = v;
    s->at[v] = place;
}

static void sift_up(struct state *s, uint32_t place)
{
    const uint32_t v = s->heap[place];

    for (; place > 0 && before(s, v, s->heap[(place - 1) / 2]); place = (place - 1) / 2)
        simplify_put(s, place, s->heap[(place - 1) / 2]);
    simplify_put(s, place, v);
}

static void sift_down(struct state *s, uint32_t place)
{
    const uint32_t v = s->heap[place];

    for (;;) {
        uint32_t child = 2 * place + 1;

        if (child + 1 < s->size && before(s, s->heap[child + 1], s->heap[child]))
            child++;
        if (child >= s->size || !before(s, s->heap[child], v))
            break;
        simplify_put(s, place, s->heap[child]);
        place = child;
    }
    simplify_put(s, place, v);
}

static void heap_drop_top(struct state *s)
{
    const uint32_t last = s->heap[--s->size];

    if (s->size > 0) {
        simplify_put(s, 0, last);
        sift_down(s, 0);
    }
}

/* ---- gaps */

/* One triangle of a star. */
struct piece {
    struct ivec2 a, b, c;
    double za, zb, zc, area;
};

static void pieces(const struct mesh *m, const struct star *star, struct piece *out)
{
    for (uint32_t t = 0; t < star->ntri; t++) {
        const uint32_t a = star->ring[star->corner[t][0]];
        const uint32_t b = star->ring[star->corner[t][1]];
        const uint32_t c = star->ring[star->corner[t][2]];

        out[t] = (struct piece){m->xy[a],
                                m->xy[b],
                                m->xy[c],
                                m->z[a],
                                m->z[b],
                                m->z[c],
                                (double)orient2d(m->xy[a], m->xy[b], m->xy[c])};
    }
}

/* Which piece a point of the star lies in, and the height there.  From the piece where the
 * last point was: points of one triangle lie near each other. */
static double height_in(const struct piece *p, uint32_t n, struct ivec2 q, uint32_t *at)
{
    for (uint32_t k = 0, t = *at; k < n; k++, t = t + 1 < n ? t + 1 : 0) {
        const int64_t wa = orient2d(p[t].b, p[t].c, q), wb = orient2d(p[t].c, p[t].a, q);
        const int64_t wc = orient2d(p[t].a, p[t].b, q);

        if (wa < 0 || wb < 0 || wc < 0)
            continue;
        *at = t;
        return p[t].za +
               ((double)wb * (p[t].zb - p[t].za) + (double)wc * (p[t].zc - p[t].za)) /
                   p[t].area;
    }
    return (double)NAN; /* (No point of the star is outside its pieces.) */
}

/* What it costs to take v out; INFINITY: it stays. */
static double cost_of(const struct state *s, uint32_t v)
{
    const bool by_volume = isfinite(s->limit->disparity);
    struct piece piece[STAR_MAX];
    struct star star;
    double worst = 0, volume = 0;
    uint32_t at = 0;

    if (!star_find(&s->now, v, &star))
        return INFINITY;
    pieces(s->m, &star, piece);
    for (uint32_t i = 0; i <= star.n; i++) {
        uint32_t p = i < star.n ? s->first[star.edge[i] / 3] : v;

        for (; p != NONE; p = i < star.n ? s->next[p] : NONE) {
            const double gap =
                fabs(height_in(piece, star.ntri, s->m->xy[p], &at) - s->m->z[p]);

            worst = gap > worst ? gap : worst;
            volume += s->share[p] * (gap - fabs(s->gap[p]));
            if (worst > s->limit->error)
                return INFINITY;
        }
    }
    return by_volume ? volume : worst;
}

/* Bring the volumes round p up to date. */
static void update_volume(struct state *s, uint32_t p)
{
    const struct mesh *m = s->m;
    uint32_t h = m->out[p];

    do {
        const uint32_t t = h / 3;

        if (s->counts[t]) {
            const uint32_t *v = &m->org[3 * t];
            const double was = s->volume[t];

            s->volume[t] =
                disparity_prism((double)orient2d(m->xy[v[0]], m->xy[v[1]], m->xy[v[2]]),
                                s->gap[v[0]], s->gap[v[1]], s->gap[v[2]]);
            s->total += s->volume[t] - was;
        }
        h = mesh_turn(m, h);
    } while (h != m->out[p]);
}

/* Take v out. */
static void simplify_take(struct state *s, const struct star *star)
{
    const bool by_volume = isfinite(s->limit->disparity);
    struct piece piece[STAR_MAX];
    uint32_t list = star->v, at = 0;

    pieces(s->m, star, piece);
    s->next[list] = NONE;
    for (uint32_t i = 0; i < star->n; i++) { /* all points of the star in one list */
        const uint32_t t = star->edge[i] / 3;

        for (uint32_t p = s->first[t], next; p != NONE; p = next) {
            next = s->next[p];
            s->next[p] = list;
            list = p;
        }
        s->first[t] = NONE;
    }
    for (uint32_t p = list, next; p != NONE; p = next) {
        uint32_t t;

        next = s->next[p];
        s->was[p] = s->gap[p];
        s->gap[p] = height_in(piece, star->ntri, s->m->xy[p], &at) - s->m->z[p];
        t = star->edge[at] / 3; /* that star_remove() uses for the piece */
        s->next[p] = s->first[t];
        s->first[t] = p;
        if (by_volume)
            update_volume(s, p);
    }
    star_remove(&s->now, star);
    s->left--;
}

/* Put the point that was taken out last back, but for the triangles. */
static void put_back(struct state *s, const struct star *star)
{
    for (uint32_t i = 0; i < star->ntri; i++)
        for (uint32_t p = s->first[star->edge[i] / 3]; p != NONE; p = s->next[p])
            s->gap[p] = s->was[p];
    s->now.out[star->v] = star->edge[0];
    s->left++;
}

/* ---- all of it */

/* s->now is a copy of m. */
static void simplify_begin(const uint8_t *bridge, struct state *s)
{
    const struct mesh *m = s->m;

    memset(s->gap, 0, m->nv * sizeof *s->gap);
    memset(s->share, 0, m->nv * sizeof *s->share);
    memset(s->volume, 0, m->nt * sizeof *s->volume);
    memset(s->first, 0xff, m->nt * sizeof *s->first);
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        double twice;

        s->counts[t] = !mesh_is_ghost(m, t) && (bridge == NULL || !bridge[t]);
        if (!s->counts[t])
            continue;
        twice = (double)orient2d(m->xy[v[0]], m->xy[v[1]], m->xy[v[2]]);
        s->area += twice;
        for (int i = 0; i < 3; i++)
            s->share[v[i]] += twice / 3;
    }
    s->left = m->nv;
    for (uint32_t v = 0; v < m->nv; v++)
        s->key[v] = cost_of(s, v);
    for (uint32_t v = 0; v < m->nv; v++)
        simplify_put(s, s->size++, v);
    for (uint32_t place = s->size / 2; place-- > 0;)
        sift_down(s, place);
}

static void simplify_run(struct state *s)
{
    const bool by_volume = isfinite(s->limit->disparity);
    const double room = s->limit->disparity * s->area;
    struct star star;

    while (s->left > s->limit->least && s->size > 0) {
        const uint32_t v = s->heap[0];

        if (!(s->key[v] < (double)INFINITY) || !star_find(&s->now, v, &star))
            break;
        heap_drop_top(s);
        simplify_take(s, &star);
        if (by_volume && s->total > room) {
            put_back(s, &star);
            break;
        }
        for (uint32_t i = 0; i < star.n; i++) {
            const uint32_t w = star.ring[i];

            s->key[w] = cost_of(s, w);
            sift_up(s, s->at[w]);
            sift_down(s, s->at[w]);
        }
    }
}

/* The points that are left, and what became of the others. */
static enum status simplify_finish(const struct state *s, struct scratch *scratch,
                                   struct mesh *out, double *gap,
                                   struct simplify_result *r)
{
    const struct mesh *m = s->m;
    struct ivec3 *pts = mem_array(s->left, sizeof *pts);
    double volume = 0;
    enum status st;
    uint32_t n = 0;

    if (pts == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v++) {
        if (s->now.out[v] != STAR_NONE)
            pts[n++] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
        r->error = fmax(r->error, fabs(s->gap[v]));
    }
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];

        if (s->counts[t])
            volume +=
                disparity_prism((double)orient2d(m->xy[v[0]], m->xy[v[1]], m->xy[v[2]]),
                                s->gap[v[0]], s->gap[v[1]], s->gap[v[2]]);
    }
    r->kept = n;
    r->disparity = s->area > 0 ? volume / s->area : 0;
    if (gap != NULL)
        memcpy(gap, s->gap, m->nv * sizeof *gap);
    st = delaunay_build(pts, n, scratch, out);
    mem_free(pts);
    return st;
}

static size_t simplify_layout(struct state *s, unsigned char *block)
{
    const size_t nv = s->m->nv, nt = s->m->nt;
    size_t at = 0;

    s->gap = mem_take(block, &at, nv, sizeof *s->gap);
    s->was = mem_take(block, &at, nv, sizeof *s->was);
    s->share = mem_take(block, &at, nv, sizeof *s->share);
    s->volume = mem_take(block, &at, nt, sizeof *s->volume);
    s->key = mem_take(block, &at, nv, sizeof *s->key);
    s->first = mem_take(block, &at, nt, sizeof *s->first);
    s->next = mem_take(block, &at, nv, sizeof *s->next);
    s->heap = mem_take(block, &at, nv, sizeof *s->heap);
    s->at = mem_take(block, &at, nv, sizeof *s->at);
    s->counts = mem_take(block, &at, nt, sizeof *s->counts);
    return at;
}

enum status simplify_mesh(const struct mesh *m, const uint8_t *bridge,
                          const struct simplify_limit *limit, struct scratch *s,
                          struct mesh *out, double *gap, struct simplify_result *r)
{
    struct state state = {.m = m, .limit = limit};
    unsigned char *block = mem_array(simplify_layout(&state, NULL), 1);
    enum status st = ST_ENOMEM;

    *r = (struct simplify_result){0};
    if (block != NULL)
        st = mesh_copy(&state.now, m, 0);
    if (st == ST_OK) {
        (void)simplify_layout(&state, block);
        simplify_begin(bridge, &state);
        simplify_run(&state);
        st = simplify_finish(&state, s, out, gap, r);
    }
    if (st != ST_OK)
        out->nv = out->nt = 0;
    mesh_free(&state.now);
    mem_free(block);
    return st;
}
