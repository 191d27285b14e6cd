/* repair.h -- the Delaunay triangulation of points that have moved, from the former one.
 * If the points moved little, nearly all triangles are still right. */
#ifndef CORE_REPAIR_H
#define CORE_REPAIR_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* repair_mesh(m, s): Makes m, a triangulation with twin[] and out[] whose points have moved in xy,
 * the Delaunay triangulation of the points at their new places, the one that delaunay_numbered()
 * makes, up to the numbers of the triangles.  parent[] and z[] stay.
 * Cost: a pass over all edges, and the work on changed triangles.
 * Returns ST_OK; ST_ELIMIT: the triangulation has changed too much (REPAIR_*), or points
 * fall on one place, or all on one line: it must be rebuilt; ST_ENOMEM.  On failure m has all its
 * points, and arbitrary triangles. */
enum status repair_mesh(struct mesh *m, struct scratch *s);

#endif
