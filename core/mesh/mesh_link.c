#include "mesh_link.h"

#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"

#define NONE UINT32_MAX

/* Why the conditions below suffice.  Let every half-edge of a real triangle have its
 * opposite (unfold, pair) and be strictly counter-clockwise (unfold) and
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
 * before ends, the ghost is its third corner.  Sets their corners and links them to each
 * other.  Returns how many there are, 0 when they are no ring round a convex polygon. */
static uint32_t check_ghosts(struct mesh *m)
{
    uint32_t *const org = m->org, *const twin = m->twin, nv = m->nv;
    uint32_t n = 0, turns = 0;

    for (; n < m->nt && org[3 * n + 2] == nv; n++)
        if (org[3 * n] >= nv)
            return 0;
    if (n < 3 || n == m->nt)
        return 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t next = i + 1 < n ? i + 1 : 0, after = next + 1 < n ? next + 1 : 0;
        const struct ivec2 a = m->xy[org[3 * i]], b = m->xy[org[3 * next]];
        const struct ivec2 c = m->xy[org[3 * after]];
        const int64_t turn = orient2d(a, b, c);

        if (turn > 0)
            return 0;
        /* Straight on is allowed, straight back is not. */
        if (turn == 0 &&
            (int64_t)(b.x - a.x) * (c.x - b.x) + (int64_t)(b.y - a.y) * (c.y - b.y) <= 0)
            return 0;
        turns += upward(a, b) && !upward(b, c);
        org[3 * i + 1] = org[3 * next];
        twin[3 * i] = NONE;
        twin[3 * i + 1] = 3 * next + 2;
        twin[3 * next + 2] = 3 * i + 1;
    }
    return turns == 1 ? n : 0;
}

/* ---- real triangles
 *
 * Each lies behind a half-edge of one before it, from which it has two corners.  It must be
 * counter-clockwise, and each edge of the tree, so each vertex, must be in the mesh: no edge
 * is there twice, so it is enough to count them. */

static bool unfold(struct mesh *m, uint32_t ghosts)
{
    uint32_t *const org = m->org, *const twin = m->twin, *const out = m->out;
    const uint32_t *const parent = m->parent, nv = m->nv, halves = 3 * m->nt;
    const struct ivec2 *const xy = m->xy;
    uint32_t edges = 0;

    for (uint32_t h = 0; h < 3 * ghosts; h += 3)
        edges += parent[org[h]] == org[h + 1];
    for (uint32_t h = 3 * ghosts; h < halves; h += 3) {
        const uint32_t gate = twin[h], c = org[h + 2];
        uint32_t a, b;

        if (gate >= h || c >= nv || twin[gate] != NONE)
            return false;
        a = org[mesh_next(gate)];
        b = org[gate];
        if (orient2d(xy[a], xy[b], xy[c]) <= 0)
            return false;
        org[h] = a;
        org[h + 1] = b;
        twin[gate] = h;
        twin[h + 1] = twin[h + 2] = NONE;
        out[a] = h;
        out[b] = h + 1;
        out[c] = h + 2;
        edges += (uint32_t)(parent[a] == b) + (parent[b] == c) + (parent[c] == a);
    }
    out[nv] = 2;
    return edges == nv - 1;
}

/* ---- the other edges
 *
 * nv - 1 pairs of half-edges, which are all that is left: a pair of such that are free takes
 * two, so that none is left in the end. */

static bool mesh_link_pair(struct mesh *m, const uint32_t *list)
{
    const uint32_t *const org = m->org, halves = 3 * m->nt;
    uint32_t *const twin = m->twin;

    for (uint32_t i = 0; i < m->nt; i += 2) {
        const uint32_t h = list[i], g = list[i + 1];

        if (h >= halves || g >= halves || (twin[h] & twin[g]) != NONE ||
            org[h] != mesh_dest(m, g) || org[g] != mesh_dest(m, h))
            return false;
        twin[h] = g;
        twin[g] = h;
    }
    return true;
}

bool mesh_listed(const struct mesh *m, uint32_t h)
{
    const uint32_t g = m->twin[h];
    const bool gate = g % 3 == 0 && m->org[g + 2] != m->nv;
    const bool ghosts = h % 3 != 0 && m->org[h - h % 3 + 2] == m->nv;

    return h < g && !gate && !ghosts;
}

enum status mesh_link(struct mesh *m, struct scratch *s)
{
    uint32_t ghosts, *list;

    if (m->nv < 3 || m->nv > SURFACE_MAX_POINTS || m->nt != 2 * m->nv - 2)
        return ST_ECORRUPT;
    if ((list = scratch_need(s, m->nt * sizeof *list)) == NULL)
        return ST_ENOMEM;
    for (uint32_t t = 0; t < m->nt; t++)
        list[t] = m->org[3 * t + 1];
    return check_points(m) && check_order(m) && (ghosts = check_ghosts(m)) != 0 &&
                   unfold(m, ghosts) && mesh_link_pair(m, list)
               ? ST_OK
               : ST_ECORRUPT;
}
