#include "mesh_link.h"

#include <string.h>

#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"

/* Why the conditions below suffice.  Let every half-edge of a real triangle have its
 * opposite and be strictly counter-clockwise (pair_edges) and
 * the ghosts be one ring round a convex polygon that turns once (check_ghosts).  Summed
 * as chains the real triangles have that polygon as their boundary, all other edges
 * cancel; so a point off the edges is covered as often as the polygon winds round it:
 * once inside and never outside.  The triangles therefore tile the hull: no two overlap,
 * no two vertices share a place, no edge is there twice.  No part of the surface can be
 * closed without a ghost (its area would be 0), and the ghosts hang together: the surface
 * is connected. Its rings of triangles round vertices, nv + 1 or more (each vertex has
 * one), satisfy Euler: rings - 3 nt / 2 + nt = 2 - 2 genus; with nt = 2 nv - 2 that is
 * rings = nv + 1 - 2 genus.  So the genus is 0 and each vertex has exactly one full ring.
 */

/* ---- ranges: loops without branches, which collect the sign bits of what must not be
 * negative */

static bool indices_below(const uint32_t *v, uint32_t n, uint32_t limit)
{
    uint32_t bad = 0;

    for (uint32_t i = 0; i < n; i++)
        bad |= v[i] | (limit - 1 - v[i]);
    return bad >> 31 == 0;
}

static inline uint32_t off_lattice(int32_t v)
{
    return ((uint32_t)v + (uint32_t)LATTICE_MAX) | ((uint32_t)LATTICE_MAX - (uint32_t)v);
}

static bool check_points(const struct mesh *m)
{
    uint32_t bad = 0;

    for (uint32_t v = 0; v < m->nv; v++)
        bad |= off_lattice(m->xy[v].x) | off_lattice(m->xy[v].y);
    for (uint32_t v = 0; v < m->nv; v++)
        bad |= off_lattice(m->z[v]);
    return bad >> 31 == 0;
}

/* parent[0] is 0 and parent[v] < v for the others: a tree. */
static bool check_order(const struct mesh *m)
{
    uint32_t bad = m->parent[0];

    for (uint32_t v = 1; v < m->nv; v++)
        bad |= (m->parent[v] | (v - 1 - m->parent[v])) & UINT32_C(0x80000000);
    return bad == 0;
}

/* ---- ghosts */

static bool upward(struct ivec2 a, struct ivec2 b)
{
    return b.y > a.y || (b.y == a.y && b.x > a.x);
}

/* The ghosts, first in the mesh, go round the hull clockwise: each begins where the one
 * before ends, the ghost is its third corner.  Links their sides to each other.
 * Returns how many there are, 0 when they are no ring round a convex polygon. */
static uint32_t check_ghosts(struct mesh *m)
{
    const uint32_t *org = m->org, nv = m->nv;
    uint32_t n = 0, turns = 0;

    while (n < m->nt && org[3 * n + 2] == nv)
        n++;
    if (n < 3 || n == m->nt)
        return 0;
    for (uint32_t i = 0; i < n; i++)
        if (org[3 * i] >= nv || org[3 * i + 1] >= nv)
            return 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t next = i + 1 < n ? i + 1 : 0;
        const struct ivec2 a = m->xy[org[3 * i]], b = m->xy[org[3 * i + 1]];
        const struct ivec2 c = m->xy[org[3 * next + 1]];
        const int64_t turn = orient2d(a, b, c);

        if (org[3 * next] != org[3 * i + 1] || turn > 0)
            return 0;
        /* Straight on is allowed, straight back is not. */
        if (turn == 0 &&
            (int64_t)(b.x - a.x) * (c.x - b.x) + (int64_t)(b.y - a.y) * (c.y - b.y) <= 0)
            return 0;
        turns += upward(a, b) && !upward(b, c);
        m->twin[3 * i + 1] = 3 * next + 2;
        m->twin[3 * next + 2] = 3 * i + 1;
    }
    return turns == 1 ? n : 0;
}

/* ---- edges
 *
 * A half-edge waits in a hash table for its opposite.  Triangles that share an edge are
 * mostly near each other in the mesh, so few wait at a time and a table smaller than the mesh
 * suffices.  Where another edge has the place, the half-edge goes to a list; after each round
 * the list, with all that still wait, is tried again with another hash.  Each round leaves
 * only a small part to the next, and the number of rounds is limited: the cost is linear on
 * any input.  The loop has no branch on whether the opposite is there: it would be
 * mispredicted half of the time. */

#define ROUNDS 64

struct table {
    uint64_t *edge; /* origin << 32 | destination of what waits; 0: the place is free */
    uint32_t *half; /* its number */
    uint32_t mask;  /* places less 1, a power of 2 */
    uint64_t salt;
    uint32_t *twin;
    uint32_t *list; /* of those left for another round */
    uint32_t left;
};

/* Half of an edge's hash; the product of both is the same from either side. */
static inline uint64_t mix(const struct table *t, uint32_t v)
{
    return v * UINT64_C(0xd1342543de82ef95) + t->salt;
}

/* Pair the half-edge h from a to b, or put it into the table, or leave it for another
 * round. */
static inline void pair_half(struct table *t, uint32_t h, uint32_t a, uint32_t b,
                             uint64_t ma, uint64_t mb)
{
    const uint32_t place = (uint32_t)(ma * mb >> 40) & t->mask;
    const uint64_t self = (uint64_t)a << 32 | b, opposite = (uint64_t)b << 32 | a;
    const uint64_t was = t->edge[place], miss = 0 - (uint64_t)(was != opposite);
    const uint32_t half = t->half[place];
    const uint32_t other = half ^ ((half ^ h) & (uint32_t)miss);

    if (__builtin_expect((was & miss) != 0, 0)) {
        t->list[t->left++] = h;
        return;
    }
    t->edge[place] = self & miss;
    t->half[place] = h;
    t->twin[h] = other;
    t->twin[other] = h;
}

/* Move what waits in the table to the list.  Most places are free: four are looked at
 * together. */
static void collect(struct table *t)
{
    for (uint32_t i = 0; i <= t->mask; i += 4) {
        if ((t->edge[i] | t->edge[i + 1] | t->edge[i + 2] | t->edge[i + 3]) == 0)
            continue;
        for (uint32_t k = i; k < i + 4; k++) {
            t->list[t->left] = t->half[k];
            t->left += t->edge[k] != 0;
            t->edge[k] = 0;
        }
    }
}

/* Pair what is left, round by round. */
static enum status pair_rest(const uint32_t *org, struct table *t)
{
    for (int round = 0; round < ROUNDS; round++) {
        uint32_t n;

        collect(t);
        if ((n = t->left) == 0)
            return ST_OK;
        t->salt = t->salt * UINT64_C(0x9e3779b97f4a7c15) + 1;
        t->left = 0;
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t h = t->list[i];

            const uint32_t a = org[h], b = org[mesh_next(h)];

            pair_half(t, h, a, b, mix(t, a), mix(t, b));
        }
    }
    return ST_ECORRUPT;
}

/* Pair the hull sides of the ghosts, first in the mesh, and the half-edges of the real
 * triangles. */
static enum status pair_edges(const struct mesh *m, uint32_t ghosts,
                              const struct table *empty)
{
    struct table t = *empty; /* a copy of its own stays in registers */
    const uint32_t *org = m->org, halves = 3 * m->nt;
    uint32_t h = 0;

    for (; h < 3 * ghosts; h += 3)
        pair_half(&t, h, org[h], org[h + 1], mix(&t, org[h]), mix(&t, org[h + 1]));
    for (; h < halves; h += 3) {
        const uint32_t a = org[h], b = org[h + 1], c = org[h + 2];
        const uint64_t ma = mix(&t, a), mb = mix(&t, b), mc = mix(&t, c);

        pair_half(&t, h, a, b, ma, mb);
        pair_half(&t, h + 1, b, c, mb, mc);
        pair_half(&t, h + 2, c, a, mc, ma);
    }
    return pair_rest(org, &t);
}

/* ---- triangles and tree
 *
 * Each real triangle counter-clockwise, each vertex in one, each edge of the tree in the
 * mesh: no edge is there twice, so it is enough to count them. */
static bool check_real(struct mesh *m, uint32_t ghosts)
{
    const uint32_t *org = m->org, *parent = m->parent, halves = 3 * m->nt;
    const struct ivec2 *xy = m->xy;
    uint32_t *out = m->out, edges = 0, unused = 0, h = 0;
    int64_t bad = 0;

    memset(out, 0xff, m->nv * sizeof *out);
    for (; h < 3 * ghosts; h += 3)
        edges += parent[org[h]] == org[h + 1];
    for (; h < halves; h += 3) {
        const uint32_t a = org[h], b = org[h + 1], c = org[h + 2];

        bad |= orient2d(xy[a], xy[b], xy[c]) - 1;
        out[a] = h;
        out[b] = h + 1;
        out[c] = h + 2;
        edges += (uint32_t)(parent[a] == b) + (parent[b] == c) + (parent[c] == a);
    }
    for (uint32_t v = 0; v < m->nv; v++)
        unused |= out[v];
    out[m->nv] = 2;
    return bad >= 0 && unused >> 31 == 0 && edges == m->nv - 1;
}

enum status mesh_link(struct mesh *m, struct scratch *s)
{
    struct table t = {.mask = 255, .salt = UINT64_C(0x9e3779b97f4a7c15)};
    size_t places, edge, half;
    uint32_t ghosts;

    if (m->nv < 3 || m->nv > MESH_MAX_POINTS || m->nt != 2 * m->nv - 2)
        return ST_ECORRUPT;
    if (!check_points(m) || !check_order(m) || (ghosts = check_ghosts(m)) == 0 ||
        !indices_below(m->org + 3 * ghosts, 3 * (m->nt - ghosts), m->nv) ||
        !check_real(m, ghosts))
        return ST_ECORRUPT;
    while (t.mask < m->nv)
        t.mask = 2 * t.mask + 1;
    places = t.mask + (size_t)1;
    edge = mem_round(places * sizeof *t.edge);
    half = mem_round(places * sizeof *t.half);
    t.twin = m->twin;
    /* One more than there are half-edges: pair_rest() writes before it counts. */
    t.edge = scratch_need(s, edge + half + (3 * (size_t)m->nt + 1) * sizeof *t.list);
    if (t.edge == NULL)
        return ST_ENOMEM;
    t.half = (uint32_t *)(void *)((unsigned char *)t.edge + edge);
    t.list = (uint32_t *)(void *)((unsigned char *)t.half + half);
    memset(t.edge, 0, edge + half);
    return pair_edges(m, ghosts, &t);
}
