#include "chains.h"

#include <stdlib.h>

#include "mem.h"
#include "mesh.h"
#include "predicates.h"

/* A vertex with its place, to sort by it. */
struct placed {
    struct ivec2 p;
    uint32_t v;
};

static int by_place(const void *a, const void *b)
{
    const struct placed *x = a, *y = b;

    return lex_less(x->p, y->p) ? -1 : lex_less(y->p, x->p);
}

/* The half-edge h has its triangle above it: it runs to the right. */
static bool runs_right(const struct mesh *m, uint32_t h)
{
    return lex_less(m->xy[m->org[h]], m->xy[mesh_dest(m, h)]);
}

/* The number with most trailing zeros above l, up to h; l < h. */
static uint32_t between(uint32_t l, uint32_t h)
{
    const int bit = 31 - __builtin_clz(l ^ h);

    return h >> bit << bit;
}

/* rank[]: each triangle's number is greater than those of the triangles below it, from 1
 * on; ghosts below the hull have 0, those above it the last number.  wait[t]: lower edges of
 * t whose triangle has no number yet; ready[]: a stack.  Returns how many numbers there
 * are. */
static uint32_t number(const struct mesh *m, uint32_t *rank, uint8_t *wait,
                       uint32_t *ready)
{
    const uint32_t last = mesh_real(m) + 1;
    uint32_t n = 0, top = 0;

    for (uint32_t t = 0; t < m->nt; t++) {
        wait[t] = 0;
        if (mesh_is_ghost(m, t)) {
            /* The hull's edge as the ghost has it leads left below the hull. */
            uint32_t h = 3 * t;

            while (m->org[h] == m->nv || mesh_dest(m, h) == m->nv)
                h++;
            rank[t] = runs_right(m, h) ? last : 0;
            continue;
        }
        for (uint32_t h = 3 * t; h < 3 * t + 3; h++)
            wait[t] = (uint8_t)(wait[t] +
                                (runs_right(m, h) && !mesh_is_ghost(m, m->twin[h] / 3)));
        if (wait[t] == 0)
            ready[top++] = t;
    }
    while (top > 0) {
        const uint32_t t = ready[--top];

        rank[t] = ++n;
        for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
            const uint32_t up = m->twin[h] / 3;

            if (!runs_right(m, h) && !mesh_is_ghost(m, up) && --wait[up] == 0)
                ready[top++] = up;
        }
    }
    return last + 1;
}

/* The chain that keeps the edge of h, whose triangle is above it. */
static uint32_t chain_of(const struct mesh *m, const uint32_t *rank, uint32_t h)
{
    return between(rank[m->twin[h] / 3], rank[h / 3]);
}

/* Sort the edges by chain, then from left to right: they are met in that order round the
 * vertices from left to right.  order[]: the vertices. */
static void chains_fill(const struct mesh *m, const struct placed *order,
                        const uint32_t *rank, uint32_t regions, uint32_t *first,
                        uint32_t *edge)
{
    uint32_t sum = 0;

    for (uint32_t k = 0; k <= regions; k++)
        first[k] = 0;
    for (uint32_t pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < m->nv; i++) {
            const uint32_t begin = m->out[order[i].v];
            uint32_t h = begin;

            do {
                if (mesh_dest(m, h) != m->nv && runs_right(m, h)) {
                    const uint32_t k = chain_of(m, rank, h);

                    if (pass == 0)
                        first[k]++;
                    else
                        edge[first[k]++] = h;
                }
                h = mesh_turn(m, h);
            } while (h != begin);
        }
        for (uint32_t k = 0; pass == 0 && k <= regions; k++) {
            const uint32_t n = first[k];

            first[k] = sum;
            sum += n;
        }
    }
    for (uint32_t k = regions; k > 0; k--)
        first[k] = first[k - 1];
    first[0] = 0;
}

enum status chains_make(const struct mesh *m, struct scratch *s, struct chains *c)
{
    const size_t nv = m->nv, nt = m->nt;
    struct placed *order = NULL;
    uint32_t *rank = NULL, *first = NULL, *edge = NULL, *ready = NULL;
    uint8_t *wait = NULL;
    unsigned char *block = NULL;

    for (int pass = 0; pass < 2; pass++) {
        size_t at = 0;

        rank = mem_take(block, &at, nt, sizeof *rank);
        first = mem_take(block, &at, nt + 2, sizeof *first);
        edge = mem_take(block, &at, 3 * nv, sizeof *edge);
        order = mem_take(block, &at, nv, sizeof *order);
        ready = mem_take(block, &at, nt, sizeof *ready);
        wait = mem_take(block, &at, nt, sizeof *wait);
        if (pass == 0 && (block = scratch_need(s, at)) == NULL)
            return ST_ENOMEM;
    }
    for (uint32_t v = 0; v < m->nv; v++)
        order[v] = (struct placed){m->xy[v], v};
    qsort(order, nv, sizeof *order, by_place);
    c->m = m;
    c->regions = number(m, rank, wait, ready);
    chains_fill(m, order, rank, c->regions, first, edge);
    c->rank = rank;
    c->first = first;
    c->edge = edge;
    c->leftmost = order[0].v;
    c->rightmost = order[nv - 1].v;
    return ST_OK;
}

/* Of chain k the last edge that starts at q or to its left: q lies above it, below or on
 * it. */
static uint32_t edge_at(const struct chains *c, uint32_t k, struct ivec2 q)
{
    uint32_t lo = c->first[k], hi = c->first[k + 1];

    while (hi - lo > 1) {
        const uint32_t mid = lo + (hi - lo) / 2;

        if (lex_less(q, c->m->xy[c->m->org[c->edge[mid]]]))
            hi = mid;
        else
            lo = mid;
    }
    return c->edge[lo];
}

/* At the end v of the hull, beyond which q lies, or on which: one of v's two hull edges has
 * q on its outer side. */
static bool beyond(const struct mesh *m, uint32_t v, struct ivec2 q, uint32_t *he)
{
    const struct ivec2 p = m->xy[v];
    uint32_t h = m->out[v];

    while (mesh_is_ghost(m, h / 3) || !mesh_is_ghost(m, m->twin[h] / 3))
        h = mesh_turn(m, h); /* the hull edge that starts at v */
    if (p.x != q.x || p.y != q.y) {
        if (orient2d(p, m->xy[mesh_dest(m, h)], q) >= 0)
            h = m->twin[mesh_next(m->twin[mesh_next(m->twin[h])])]; /* the one before */
        *he = h;
        return false;
    }
    *he = h;
    return true;
}

bool chains_find(const struct chains *c, struct ivec2 q, uint32_t *he)
{
    const struct mesh *m = c->m;
    uint32_t low = 0, high = c->regions - 1, below = 0, above = 0;

    if (lex_less(q, m->xy[c->leftmost]))
        return beyond(m, c->leftmost, q, he);
    if (!lex_less(q, m->xy[c->rightmost]))
        return beyond(m, c->rightmost, q, he);
    while (low < high) {
        const uint32_t h = edge_at(c, between(low, high), q), over = m->twin[h];
        const int64_t side = orient2d(m->xy[m->org[h]], m->xy[mesh_dest(m, h)], q);

        if (side == 0) {
            *he = mesh_is_ghost(m, h / 3) ? over : h;
            return true;
        }
        if (side > 0) {
            low = c->rank[h / 3];
            below = h;
        } else {
            high = c->rank[over / 3];
            above = h;
        }
    }
    /* Outside, the edge that was last compared is the hull's. */
    if (low == 0) {
        *he = above;
        return false;
    }
    if (low == c->regions - 1) {
        *he = m->twin[below];
        return false;
    }
    *he = below;
    return true;
}
