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

/* The caller sets m, ghost and limit; insert_start() sets the other members. */
struct insert {
    struct mesh *m;
    uint32_t
        ghost; /* number of the ghost, whatever m->nv is: the final number of points */
    uint64_t limit; /* largest work */
    uint64_t work;  /* number of triangles visited so far */
    uint32_t *edge, *inside, *stack;
};

/* insert_start(in, block): Lays the arrays of in into block, which begins on a cache line.
 *   block  NULL: only the size is wanted
 * Returns the bytes needed for in->ghost points. */
size_t insert_start(struct insert *in, unsigned char *block);

/* insert_find(in, he, q, on_edge): Locates q by a visibility walk from *he.
 *   he  receives a half-edge of the triangle that contains q (a ghost triangle if q is outside the
 *       hull), the edge itself if *on_edge
 * Returns false if the work has reached its limit: on a mesh that is not Delaunay the walk can go
 * round in circles. */
bool insert_find(struct insert *in, uint32_t *he, struct ivec2 q, bool *on_edge);

/* insert_point(in, he, on_edge, v): Inserts vertex v, at m->xy[v], where insert_find() found
 * it; it must not lie on another vertex.  m->nt grows by 2; m->nv is the caller's business.
 * A Delaunay triangulation stays one, any other stays a triangulation.  Cost: O(new triangles). */
void insert_point(struct insert *in, uint32_t he, bool on_edge, uint32_t v);

#endif
