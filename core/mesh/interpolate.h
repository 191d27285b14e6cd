/* interpolate.h -- height of a triangulated surface at a located point.
 * Paper 1 section 3.4: barycentric interpolation. */
#ifndef CORE_INTERPOLATE_H
#define CORE_INTERPOLATE_H
#include "vec.h"

struct mesh;     /* mesh.h */
struct location; /* locate.h */

/* interpolate_height(m, loc, q): the height of m at q, in lattice units; loc is q's location
 * in m.  Exact at the vertices and on level triangles; elsewhere the weights are exact
 * integers and the error is below 1e-6 units.  Outside the hull: NAN. */
double interpolate_height(const struct mesh *m, struct location loc, struct ivec2 q);

/* interpolate_mesh(m, pts, loc, out): out[v] = the height of m at vertex v of pts, for every
 * vertex; loc from locate_mesh(m, pts, loc).  O(pts->nv). */
void interpolate_mesh(const struct mesh *m, const struct mesh *pts,
                      const struct location *loc, double *out);

#endif
