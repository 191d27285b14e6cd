/* numbered.h -- delaunay_build() with the vertices numbered as the points are. */
#ifndef CORE_NUMBERED_H
#define CORE_NUMBERED_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* numbered_build(pts, n, s, out): triangulate pts[0..n-1]; vertex v is pts[v].
 * pts   room for 2 n points, the second half is scratch.  Points are not joined: in a row
 *       (the same y), taken by x, then by number, a point that is not right of the one before
 *       it is put next to it, 1 lattice unit farther right (in pts too).
 * out   reserved as needed; no spanning tree.
 * Cost  that of delaunay_build().  Returns as delaunay_build(). */
enum status numbered_build(struct ivec3 *pts, size_t n, struct scratch *s,
                           struct mesh *out);

#endif
