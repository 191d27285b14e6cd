/* repair.c -- vertices of overturned triangles are taken out until none is overturned, edges
 * are flipped until all circles are empty, and the vertices are inserted again.
 * Flips alone cannot do it: where a triangle is overturned, an edge that must go may be the
 * side of no convex quadrangle.  After the first step all triangles are counter-clockwise.
 * If the hull, too, turns one way and once, they cover it once (the number of triangles over
 * a point is the winding number of the hull about it), so they are a triangulation. */
#include "repair.h"

#include <stdbool.h>

#include "arm.h"
#include "insert.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"

/* repair_mesh() gives up beyond FLIPS steps and flips a point, where more than every
 * GONE-th point has to be taken out, where one of these has more neighbours, or where, on
 * average, taking one out changes more triangles: then a triangulation from scratch costs no
 * more.  Of a face turned by 10 degrees 3 points in 1,000 have to be taken out, and it needs
 * 0.2 flips a point. */
#define REPAIR_FLIPS   2
#define REPAIR_GONE    8
#define REPAIR_RING    64
#define REPAIR_CHANGED 16

struct taken {
    uint32_t v;
    uint32_t beside; /* a neighbour that it had */
};

struct repair {
    struct mesh *m;
    struct insert insert;
    /* triangles that may be overturned: those found so, then all that */
    uint32_t *doubtful;
    size_t doubts, doubts_most; /* have changed */
    uint32_t *edges;            /* that may have to be flipped */
    size_t count;
    struct taken *taken; /* vertices taken out, in this order */
    uint32_t gone, gone_most;
};

static inline void link_twins(struct mesh *m, uint32_t a, uint32_t b)
{
    m->twin[a] = b;
    m->twin[b] = a;
}

/* The triangle of h = x -> y has the third corner q; swap xy for the edge from q to w, the
 * corner across it.  h becomes x -> w and keeps q as its third corner; the former twin of h
 * becomes y -> q, with the third corner w. */
static void flip(struct mesh *m, uint32_t h)
{
    const uint32_t f = m->twin[h];
    const uint32_t hn = mesh_next(h), fn = mesh_next(f);
    const uint32_t xw = m->twin[fn], yq = m->twin[hn];

    m->out[m->org[h]] = h;
    m->out[m->org[f]] = f;
    m->org[hn] = m->org[mesh_prev(f)];
    m->org[fn] = m->org[mesh_prev(h)];
    link_twins(m, h, xw);
    link_twins(m, f, yq);
    link_twins(m, hn, fn);
}

/* Must the edge h be flipped?  Its triangles are counter-clockwise, or ghosts. */
static bool must_flip(const struct mesh *m, uint32_t h)
{
    const struct ivec2 *xy = m->xy;
    const uint32_t x = m->org[h], y = mesh_dest(m, h), q = m->org[mesh_prev(h)];
    const uint32_t w = m->org[mesh_prev(m->twin[h])];

    if (q == m->nv || w == m->nv)
        return false;
    if (x == m->nv)
        return orient2d(xy[w], xy[y], xy[q]) > 0;
    if (y == m->nv)
        return orient2d(xy[x], xy[w], xy[q]) > 0;
    return incircle(xy[x], xy[y], xy[q], xy[w]);
}

static bool overturned(const struct mesh *m, uint32_t t)
{
    const uint32_t a = m->org[3 * t], b = m->org[3 * t + 1], c = m->org[3 * t + 2];

    if (__builtin_expect((a == m->nv) | (b == m->nv) | (c == m->nv), 0))
        return false;
    return orient2d(m->xy[a], m->xy[b], m->xy[c]) <= 0;
}

/* A vertex whose removal may turn the triangle back: the one that faces its longest side. */
static uint32_t culprit(const struct mesh *m, uint32_t t)
{
    int64_t longest = -1;
    uint32_t v = 0;

    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
        const struct ivec2 a = m->xy[m->org[h]], b = m->xy[mesh_dest(m, h)];
        const int64_t dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;

        if (length > longest) {
            longest = length;
            v = m->org[mesh_prev(h)];
        }
    }
    return v;
}

/* Around a vertex: its half-edges, counter-clockwise. */
struct ring {
    uint32_t h[REPAIR_RING];
    uint32_t n;
};

/* How good is it to cut off the i-th neighbour?  3: the triangle that it makes with its own
 * neighbours is counter-clockwise, and no other neighbour lies in it; 2: it is a hull edge's
 * ghost; 1: it is counter-clockwise; 0: nothing of that. */
static int merit(const struct mesh *m, const struct ring *r, uint32_t i)
{
    const uint32_t a = mesh_dest(m, r->h[(i + r->n - 1) % r->n]);
    const uint32_t b = mesh_dest(m, r->h[i]);
    const uint32_t c = mesh_dest(m, r->h[(i + 1) % r->n]);
    const struct ivec2 *xy = m->xy;

    if (b == m->nv)
        return 0;
    if (a == m->nv || c == m->nv)
        return 2;
    if (orient2d(xy[a], xy[b], xy[c]) <= 0)
        return 0;
    for (uint32_t k = 0; k < r->n; k++) {
        const uint32_t w = mesh_dest(m, r->h[k]);

        if (w != a && w != b && w != c && w != m->nv &&
            orient2d(xy[a], xy[b], xy[w]) >= 0 && orient2d(xy[b], xy[c], xy[w]) >= 0 &&
            orient2d(xy[c], xy[a], xy[w]) >= 0)
            return 1;
    }
    return 3;
}

/* Cut off the neighbours of a vertex until three are left. */
static bool reduce(struct repair *r, struct ring *ring)
{
    struct mesh *m = r->m;

    while (ring->n > 3) {
        uint32_t best = 0, flipped;
        int most = -1;

        for (uint32_t i = 0; i < ring->n && most < 3; i++) {
            const int is = merit(m, ring, i);

            if (is > most) {
                most = is;
                best = i;
            }
        }
        flipped = ring->h[best];
        if (m->org[mesh_prev(flipped)] == m->org[mesh_prev(m->twin[flipped])])
            return false;
        flip(m, flipped); /* now leads to the neighbour before */
        r->doubtful[r->doubts++] = m->twin[mesh_next(flipped)] / 3;
        ring->h[(best + ring->n - 1) % ring->n] = flipped;
        ring->n--;
        for (uint32_t i = best; i < ring->n; i++)
            ring->h[i] = ring->h[i + 1];
    }
    return true;
}

/* The last triangle takes the place of t, which is no longer needed. */
static void repair_fill(struct repair *r, uint32_t t)
{
    struct mesh *m = r->m;
    const uint32_t last = --m->nt;

    if (t == last)
        return;
    for (uint32_t i = 0; i < 3; i++) {
        m->org[3 * t + i] = m->org[3 * last + i];
        link_twins(m, 3 * t + i, m->twin[3 * last + i]);
        m->out[m->org[3 * t + i]] = 3 * t + i;
    }
    r->doubtful[r->doubts++] = t;
}

/* Take out v: three triangles become one.  False: give up. */
static bool take_out(struct repair *r, uint32_t v)
{
    struct mesh *m = r->m;
    const uint32_t first = m->out[v];
    struct ring ring = {.n = 0};
    uint32_t h = first, edge[3], beyond[3], t[3], p[3];

    do {
        if (ring.n == REPAIR_RING)
            return false;
        ring.h[ring.n++] = h;
        h = mesh_turn(m, h);
    } while (h != first);
    if (ring.n < 3 || r->gone == r->gone_most ||
        r->doubts + ring.n + 3 > r->doubts_most || !reduce(r, &ring))
        return false;
    for (int i = 0; i < 3; i++) {
        edge[i] = mesh_next(ring.h[i]);
        beyond[i] = m->twin[edge[i]];
        t[i] = edge[i] / 3;
    }
    for (int i = 0; i < 3; i++)
        if (beyond[i] / 3 == t[0] || beyond[i] / 3 == t[1] || beyond[i] / 3 == t[2])
            return false;
    for (int i = 0; i < 3; i++)
        p[i] = m->org[edge[i]];
    r->taken[r->gone++] = (struct taken){v, p[0] != m->nv ? p[0] : p[1]};
    for (uint32_t i = 0; i < 3; i++) { /* the first of them becomes the whole */
        m->org[3 * t[0] + i] = p[i];
        m->out[p[i]] = 3 * t[0] + i;
        link_twins(m, 3 * t[0] + i, beyond[i]);
    }
    r->doubtful[r->doubts++] = t[0];
    repair_fill(r, t[1] > t[2] ? t[1] : t[2]);
    repair_fill(r, t[1] > t[2] ? t[2] : t[1]);
    return true;
}

/* Find the overturned triangles, and the edges that must be flipped, the latter as far as
 * both triangles are sound; false when they are too many.  Which edges these are cannot be
 * predicted, so there is no branch on it. */
static bool survey(struct repair *r)
{
    const struct mesh *m = r->m;
    const struct ivec2 *const xy = m->xy;
    const uint32_t *const org = m->org, *const twin = m->twin, nv = m->nv, nt = m->nt;
    size_t count = 0, doubts = 0;

    for (uint32_t t = 0; t < nt && doubts <= r->gone_most && count <= r->insert.limit;
         t++) {
        const uint32_t v[3] = {org[3 * t], org[3 * t + 1], org[3 * t + 2]};
        const bool ghost = (v[0] == nv) | (v[1] == nv) | (v[2] == nv);
        const struct arm a = arm_to(xy[v[0]], xy[v[1]]), b = arm_to(xy[v[0]], xy[v[2]]);
        const int64_t ab = arm_cross(&a, &b);

        r->doubtful[doubts] = t;
        doubts += !ghost & (ab <= 0);
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t h = 3 * t + i, other = twin[h];
            const uint32_t *const w = &org[3 * (other / 3)];
            const uint32_t d = w[0] + w[1] + w[2] - v[i] - v[(i + 1) % 3];
            const struct arm c = arm_to(xy[v[0]], xy[d]);
            const int64_t det =
                arm_incircle(&a, &b, &c, ab, arm_cross(&b, &c), arm_cross(&c, &a));
            const bool must = __builtin_expect(det == 0, 0) ? must_flip(m, h) : det < 0;

            r->edges[count] = h;
            count += must & (h < other);
        }
    }
    r->count = count;
    r->doubts = doubts;
    return doubts <= r->gone_most && count <= r->insert.limit;
}

/* Take out vertices until no triangle is overturned; the edges of the triangles that this
 * changes may have to be flipped. */
static bool turn_back(struct repair *r)
{
    const struct mesh *m = r->m;

    for (size_t i = 0; i < r->doubts; i++) {
        const uint32_t t = r->doubtful[i];

        if (t < m->nt && overturned(m, t) && !take_out(r, culprit(m, t)))
            return false;
    }
    for (size_t i = 0; i < r->doubts; i++)
        for (uint32_t h = 3 * r->doubtful[i]; h < 3 * r->doubtful[i] + 3; h++)
            r->edges[r->count++] = h;
    return true;
}

static bool upwards(struct ivec2 a, struct ivec2 b)
{
    return b.y > a.y || (b.y == a.y && b.x > a.x);
}

/* Does the hull, which turns nowhere to the left, go round once? */
static bool hull_goes_round_once(const struct mesh *m)
{
    const uint32_t first = m->out[m->nv];
    uint32_t h = first, rounds = 0;

    do { /* from the ghost to the corners of the hull, clockwise */
        const uint32_t next = mesh_turn(m, h), after = mesh_turn(m, next);
        const struct ivec2 a = m->xy[mesh_dest(m, h)], b = m->xy[mesh_dest(m, next)],
                           c = m->xy[mesh_dest(m, after)];

        if (orient2d(a, b, c) == 0 && upwards(a, b) != upwards(b, c))
            return false;
        rounds += !upwards(a, b) && upwards(b, c);
        h = next;
    } while (h != first);
    return rounds == 1;
}

/* Flip until all circles are empty. */
static bool flip_all(struct repair *r)
{
    struct mesh *m = r->m;

    while (r->count > 0) {
        const uint32_t h = r->edges[--r->count], twin = m->twin[h];

        if (h >= 3 * m->nt || !must_flip(m, h)) /* the former is elsewhere by now */
            continue;
        if (r->insert.work++ == r->insert.limit)
            return false;
        flip(m, h);
        r->edges[r->count++] = h; /* the sides of the quadrangle */
        r->edges[r->count++] = mesh_prev(h);
        r->edges[r->count++] = twin;
        r->edges[r->count++] = mesh_prev(twin);
    }
    return true;
}

/* Insert the vertices taken out again, the last first: its neighbour is there. */
static bool put_back(struct repair *r)
{
    struct mesh *m = r->m;

    while (r->gone > 0) {
        const struct taken k = r->taken[--r->gone];
        const struct ivec2 q = m->xy[k.v];
        uint32_t he = m->out[k.beside];
        bool on_edge;

        if (!insert_find(&r->insert, &he, q, &on_edge))
            return false;
        for (int i = 0; i < 3 && on_edge; i++, he = mesh_next(he)) {
            const struct ivec2 p = m->xy[m->org[he]];

            if (p.x == q.x && p.y == q.y)
                return false;
        }
        insert_point(&r->insert, he, on_edge, k.v);
    }
    return true;
}

/* r's arrays in block; returns the bytes needed.  The edges are as many as there may be flips,
 * each of which adds 3, and those of the doubtful triangles. */
static size_t repair_layout(struct repair *r, unsigned char *block)
{
    size_t at = insert_start(&r->insert, block);

    r->edges = mem_take(block, &at, 4 * r->insert.limit + 3 * r->doubts_most + 3,
                        sizeof *r->edges);
    r->doubtful = mem_take(block, &at, r->doubts_most, sizeof *r->doubtful);
    r->taken = mem_take(block, &at, r->gone_most, sizeof *r->taken);
    return at;
}

enum status repair_mesh(struct mesh *m, struct scratch *s)
{
    const uint32_t gone_most = m->nv / REPAIR_GONE + 1;
    struct repair r = {
        .m = m,
        .insert = {.m = m, .ghost = m->nv, .limit = (uint64_t)REPAIR_FLIPS * m->nv},
        .gone_most = gone_most,
        .doubts_most = REPAIR_CHANGED * gone_most,
    };
    unsigned char *block = scratch_need(s, repair_layout(&r, NULL));

    if (block == NULL)
        return ST_ENOMEM;
    (void)repair_layout(&r, block);
    if (!survey(&r) || !turn_back(&r) || !flip_all(&r) || !hull_goes_round_once(m) ||
        !put_back(&r))
        return ST_ELIMIT;
    return ST_OK;
}
