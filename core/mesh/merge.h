/* merge.h -- the general triangulation: the Delaunay triangulation of the union of two
 * meshes that overlap, made from their triangulations.
 * Paper 1 section 3.5 and [8] (Mestetskiy and Tsarik). */
#ifndef CORE_MERGE_H
#define CORE_MERGE_H
#include <stdint.h>
#include "status.h"

struct location; /* locate.h */
struct mesh;     /* mesh.h */
struct scratch;  /* mem.h */

/* merge_build(a, b, b_in_a, s, out, b_vertex): Makes the Delaunay triangulation of the
 * points of a and of b, triangle for triangle the one that delaunay_build() makes of the union.
 *   a         any mesh that mesh_link() accepts.  If a is not Delaunay, out may not be either; it
 *             is still a triangulation of all points with these numbers
 *   b         with b->parent
 *   b_in_a    from locate_mesh(a, b, b_in_a)
 *   out       reserved as needed.  Vertices 0..a->nv-1 are a's; z is a's or b's own height; no
 *             spanning tree.  On failure nv is 0
 *   b_vertex  receives the vertex of out at each vertex of b: a's vertex if both meshes have a point
 *             there, else a new one (in b's order)
 * Cost: O(a->nv + b->nv) for meshes that sample the plane comparably.  Beyond MERGE_WORK
 * steps and new triangles a point the union is triangulated from scratch, O(N log N).
 * The limit also ends a walk in circles, which is possible if a is not Delaunay.
 * Returns ST_OK, ST_ELIMIT, ST_ENOMEM. */
enum status merge_build(const struct mesh *a, const struct mesh *b,
                        const struct location *b_in_a, struct scratch *s,
                        struct mesh *out, uint32_t *b_vertex);

#endif
