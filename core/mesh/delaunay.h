/* delaunay.h -- Delaunay triangulation of a planar point set by divide and conquer.
 * Paper 1 (disparity measure) section 3.1.  Method: Guibas and Stolfi, "Primitives for the
 * Manipulation of General Subdivisions and the Computation of Voronoi Diagrams", ACM
 * Trans. Graphics 4(2), 1985, on cells cut in strips as in Dwyer, "A Faster
 * Divide-and-Conquer Algorithm for Constructing Delaunay Triangulations", Algorithmica 2,
 * 1987.  Every decision goes through predicates.h, so the result is exact, and unique also
 * for cocircular points: the same set of points gives the same mesh, in any order. */
#ifndef CORE_DELAUNAY_H
#define CORE_DELAUNAY_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* delaunay_build(pts, n, s, out): Triangulates pts[0..n-1] by (x, y).
 * pts   borrowed; lattice points in any order; points with the same (x, y) become one
 *       vertex whose height is the mean of theirs, rounded down (independent of order).
 * out   reserved as needed; vertices, org, twin and out are set, the spanning tree is not.
 * Vertex order is canonical (a function of the set of points alone).
 * Cost  O(n log n) on every input, O(n) memory; recursion depth <= 2 + log2 n.
 * Returns ST_OK; ST_ERANGE a coordinate lies off the lattice; ST_EDEGENERATE fewer than 3
 * distinct points or all on one line; ST_ELIMIT; ST_ENOMEM.  On failure out has nv == 0. */
enum status delaunay_build(const struct ivec3 *pts, size_t n, struct scratch *s,
                           struct mesh *out);

/* delaunay_numbered(pts, n, s, out): Triangulates like delaunay_build(), but vertex v is pts[v].
 * Points are not joined.  In a row (of one y), by x, then by number, a point that is not right of
 * the previous one moves next to it, 1 lattice unit farther right (in pts too).
 *   pts  buffer of 2 n points, the second half is scratch */
enum status delaunay_numbered(struct ivec3 *pts, size_t n, struct scratch *s,
                              struct mesh *out);

#endif
