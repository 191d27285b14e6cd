/* locate.h -- where a point lies in a triangulation, by walking straight towards it.
 * Paper 1 sections 3.2 (one point) and 3.3 (a whole mesh, along its spanning tree).
 * Exact: every turn of the walk is decided by orient2d on the lattice. */
#ifndef CORE_LOCATE_H
#define CORE_LOCATE_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

struct mesh; /* mesh.h */

enum locate_where {
    LOCATE_INSIDE, /* strictly inside the triangle of half-edge he */
    LOCATE_EDGE,   /* strictly inside the edge he, whose triangle is not a ghost */
    LOCATE_VERTEX, /* on the vertex org[he]; he's triangle is not a ghost */
    LOCATE_OUTSIDE /* outside the hull; he is the hull edge nearest to the point, on the
                      side of its real triangle */
};

struct location {
    uint32_t he;
    uint32_t where; /* enum locate_where */
};

/* Called for each triangle the walk enters, in order, the first included: consecutive
 * triangles share an edge or, where the walk passes through a vertex, that vertex. */
struct locate_trace {
    void (*enter)(void *arg, uint32_t triangle);
    void *arg;
};

/* locate_point(m, he, from, q, trace): walk straight from `from` to q.
 * he     a half-edge of a real triangle that contains `from`, border included
 * trace  may be NULL
 * Degenerate cases: q on a vertex, on an edge, outside; the walk passing through a vertex
 * or running along edges; `from` on a vertex or edge.
 * Cost  one orient2d or two per triangle crossed: O(sqrt nv) on average from far away. */
struct location locate_point(const struct mesh *m, uint32_t he, struct ivec2 from,
                             struct ivec2 q, const struct locate_trace *trace);

/* locate_mesh(in, pts, loc): locate every vertex of pts in `in`, each walk starting where
 * the vertex's parent in pts' spanning tree was found.  loc[0..pts->nv-1] is filled.
 * Cost  O(in->nv + pts->nv) for meshes of comparable density. */
void locate_mesh(const struct mesh *in, const struct mesh *pts, struct location *loc);

#endif
