/* insert.h -- inserting points into a Delaunay triangulation: a walk to the triangle that
 * holds the point, and the triangles whose circles hold it replaced by a star about it
 * (Bowyer, "Computing Dirichlet tessellations", and Watson, "Computing the n-dimensional
 * Delaunay tessellation", The Computer Journal 24(2), 1981).  Ghosts are triangles too: a
 * point outside the hull is in the circle of the ghosts that it sees. */
#ifndef CORE_INSERT_H
#define CORE_INSERT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

struct mesh; /* mesh.h */

/* All of it is set by insert_start(), but m, ghost and limit. */
struct insert {
    struct mesh *m;
    uint32_t ghost; /* its number, whatever m->nv is: that of all points there will be */
    uint64_t limit; /* of work */
    uint64_t work;  /* triangles visited so far */
    uint32_t *edge, *inside, *stack;
};

/* insert_start(in, block): begin, with the arrays in block, which begins on a cache line;
 * returns the bytes needed for in->ghost points.  With block NULL that is all. */
size_t insert_start(struct insert *in, unsigned char *block);

/* insert_find(in, he, q, on_edge): where q lies, by a visibility walk from *he.  *he becomes
 * a half-edge of the triangle that contains q (a ghost triangle when q is outside the hull),
 * the edge itself if *on_edge.  The walk can go round in circles where the mesh is not
 * Delaunay: false when the work has reached its limit. */
bool insert_find(struct insert *in, uint32_t *he, struct ivec2 q, bool *on_edge);

/* insert_point(in, he, on_edge, v): insert vertex v, at m->xy[v], where insert_find() found
 * it; it must not lie on another vertex.  m->nt grows by 2; m->nv is the caller's business.
 * A Delaunay triangulation stays one, any other stays a triangulation.  O(new triangles). */
void insert_point(struct insert *in, uint32_t he, bool on_edge, uint32_t v);

#endif
