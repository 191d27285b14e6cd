#include "mesh.h"

#include <string.h>

#include "mem.h"
#include "predicates.h"

/* m's arrays in block for n points; returns the bytes needed. */
static size_t mesh_layout(struct mesh *m, size_t n, unsigned char *block)
{
    size_t at = 0;

    m->xy = mem_take(block, &at, n + 1, sizeof *m->xy);
    m->org = mem_take(block, &at, 6 * n, sizeof *m->org);
    m->twin = mem_take(block, &at, 6 * n, sizeof *m->twin);
    m->z = mem_take(block, &at, n, sizeof *m->z);
    m->out = mem_take(block, &at, n + 1, sizeof *m->out);
    m->parent = mem_take(block, &at, n, sizeof *m->parent);
    return at;
}

enum status mesh_reserve(struct mesh *m, uint32_t n)
{
    struct mesh larger = {0};

    if (n > SURFACE_MAX_POINTS)
        return ST_ELIMIT;
    if (m->block == NULL || n > m->cap) {
        if ((larger.block = mem_array(mesh_layout(&larger, n, NULL), 1)) == NULL)
            return ST_ENOMEM;
        (void)mesh_layout(&larger, n, larger.block);
        larger.cap = n;
        mem_free(m->block);
        *m = larger;
    }
    m->nv = m->nt = 0;
    return ST_OK;
}

uint32_t mesh_real(const struct mesh *m)
{
    uint32_t ghosts = 0;

    for (uint32_t h = 0; h < 3 * m->nt; h++)
        ghosts += m->org[h] == m->nv; /* each ghost has one such corner */
    return m->nt - ghosts;
}

void mesh_free(struct mesh *m)
{
    if (m == NULL)
        return;
    mem_free(m->block);
    memset(m, 0, sizeof *m);
}

enum status mesh_copy(struct mesh *dst, const struct mesh *src, uint32_t extra)
{
    const size_t n = src->nv, h = 3 * (size_t)src->nt;
    enum status st;

    if (extra > SURFACE_MAX_POINTS - src->nv)
        return ST_ELIMIT;
    if ((st = mesh_reserve(dst, src->nv + extra)) != ST_OK)
        return st;
    dst->nv = src->nv;
    dst->nt = src->nt;
    memcpy(dst->xy, src->xy, n * sizeof *src->xy);
    memcpy(dst->z, src->z, n * sizeof *src->z);
    memcpy(dst->org, src->org, h * sizeof *src->org);
    memcpy(dst->twin, src->twin, h * sizeof *src->twin);
    memcpy(dst->out, src->out, (n + 1) * sizeof *src->out);
    memcpy(dst->parent, src->parent, n * sizeof *src->parent);
    return ST_OK;
}

/* Indices, twins and corners: a closed surface of triangles, at most one ghost corner
 * each. */
static bool check_links(const struct mesh *m)
{
    const uint32_t halves = 3 * m->nt;

    for (uint32_t h = 0; h < halves; h++) {
        const uint32_t t = m->twin[h];

        if (m->org[h] > m->nv || t >= halves || m->twin[t] != h || t / 3 == h / 3)
            return false;
        if (m->org[t] != mesh_dest(m, h) || mesh_dest(m, t) != m->org[h] ||
            m->org[h] == m->org[t])
            return false;
    }
    return true;
}

/* One ring of triangles round each vertex: together the rings hold every half-edge. */
static bool check_rings(const struct mesh *m)
{
    const uint32_t halves = 3 * m->nt;
    uint32_t seen = 0;

    for (uint32_t v = 0; v <= m->nv; v++) {
        uint32_t h = m->out[v];

        if (h >= halves)
            return false;
        do {
            if (m->org[h] != v || seen++ == halves)
                return false;
            h = mesh_turn(m, h);
        } while (h != m->out[v]);
    }
    return seen == halves;
}

/* The corner facing h: the one that h does not touch. */
static uint32_t apex(const struct mesh *m, uint32_t h)
{
    return m->org[mesh_prev(h)];
}

/* Finite triangles counter-clockwise, the hull convex, no corner in a neighbour's circle. */
static bool check_shape(const struct mesh *m)
{
    const struct ivec2 *xy = m->xy;

    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t a = m->org[h], b = mesh_dest(m, h), c = apex(m, h);

        if (a == m->nv || b == m->nv)
            continue;
        if (c == m->nv) { /* b -> a -> next is the hull, clockwise: never a left turn */
            const uint32_t next = apex(m, m->twin[mesh_next(h)]);

            if (orient2d(xy[a], xy[b], xy[next]) > 0)
                return false;
        } else {
            const uint32_t d = apex(m, m->twin[h]);

            if (orient2d(xy[a], xy[b], xy[c]) <= 0)
                return false;
            if (d != m->nv && incircle(xy[a], xy[b], xy[c], xy[d]))
                return false;
        }
    }
    return true;
}

/* parent[] is a tree along edges of the mesh. */
static bool check_tree(const struct mesh *m)
{
    if (m->parent[0] != 0)
        return false;
    for (uint32_t v = 1; v < m->nv; v++) {
        const uint32_t first = m->out[v];
        uint32_t h = first;

        if (m->parent[v] >= v)
            return false;
        while (mesh_dest(m, h) != m->parent[v]) {
            if ((h = mesh_turn(m, h)) == first)
                return false;
        }
    }
    return true;
}

enum status mesh_check(const struct mesh *m, bool tree)
{
    if (m->nv < 3 || m->nv > SURFACE_MAX_POINTS || m->nt != 2 * m->nv - 2)
        return ST_ECORRUPT;
    if (!check_links(m) || !check_rings(m) || !check_shape(m))
        return ST_ECORRUPT;
    return !tree || check_tree(m) ? ST_OK : ST_ECORRUPT;
}
