/* flips.h -- changing a triangulation: edges are flipped and points inserted until each
 * edge has an empty circle (C. L. Lawson, "Software for C1 Surface Interpolation", in
 * Mathematical Software III, 1977), ghosts included: the hull is repaired in the same way.
 * The parts that merge.c and repair.c have in common. */
#ifndef CORE_FLIPS_H
#define CORE_FLIPS_H
#include <stdbool.h>
#include <stdint.h>
#include "mesh.h"
#include "predicates.h"

struct flips {
    struct mesh *m;
    uint32_t ghost; /* the ghost's number, whatever m->nv is */
    uint64_t work;  /* walk steps and flips so far */
    uint64_t limit; /* of work */
};

/* flips_find(f, he, q, on_edge): where q lies, by a visibility walk from *he.  *he becomes a
 * half-edge of the triangle that contains q (a ghost triangle when q is outside the hull),
 * the edge itself if *on_edge.  The walk can go round in circles where the mesh is not
 * Delaunay: false when the work has reached its limit. */
bool flips_find(struct flips *f, uint32_t *he, struct ivec2 q, bool *on_edge);

/* flips_insert(f, he, on_edge, v): insert vertex v, at m->xy[v], where flips_find() found it;
 * it must not lie on another vertex.  m->nt grows by 2; m->nv is the caller's business.  A
 * Delaunay triangulation stays one. */
void flips_insert(struct flips *f, uint32_t he, bool on_edge, uint32_t v);

static inline void flips_link(struct mesh *m, uint32_t a, uint32_t b)
{
    m->twin[a] = b;
    m->twin[b] = a;
}

/* flips_flip(m, h): the triangle of h = x -> y has the third corner q; swap xy for the edge
 * from q to w, the corner across it.  h becomes x -> w and keeps q as its third corner; the
 * former twin of h becomes y -> q, with the third corner w. */
static inline void flips_flip(struct mesh *m, uint32_t h)
{
    const uint32_t f = m->twin[h];
    const uint32_t hn = mesh_next(h), fn = mesh_next(f);
    const uint32_t xw = m->twin[fn], yq = m->twin[hn];

    m->out[m->org[h]] = h;
    m->out[m->org[f]] = f;
    m->org[hn] = m->org[mesh_prev(f)];
    m->org[fn] = m->org[mesh_prev(h)];
    flips_link(m, h, xw);
    flips_link(m, f, yq);
    flips_link(m, hn, fn);
}

/* flips_must(m, ghost, h, q): must the edge h, whose triangle has its third corner at q (not
 * the ghost), be flipped?  Both triangles must be counter-clockwise, or ghosts. */
static inline bool flips_must(const struct mesh *m, uint32_t ghost, uint32_t h,
                              struct ivec2 q)
{
    const struct ivec2 *xy = m->xy;
    const uint32_t x = m->org[h], y = mesh_dest(m, h);
    const uint32_t w = m->org[mesh_prev(m->twin[h])];

    if (w == ghost)
        return false;
    if (x == ghost)
        return orient2d(xy[w], xy[y], q) > 0;
    if (y == ghost)
        return orient2d(xy[x], xy[w], q) > 0;
    return incircle(xy[x], xy[y], q, xy[w]);
}

#endif
