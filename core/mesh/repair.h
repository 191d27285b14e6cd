/* repair.h -- the Delaunay triangulation of points that have moved, from what it was before.
 * Where the points moved little, nearly all triangles are still right. */
#ifndef CORE_REPAIR_H
#define CORE_REPAIR_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* repair_mesh(m, s): m is a triangulation with twin[] and out[], the points of which have
 * moved in xy; make it the Delaunay triangulation of the points at their new places, the one
 * that delaunay_numbered() makes up to the numbers of the triangles.  parent[] and z[] stay.
 * Cost    a pass over all edges, and the work where the triangulation has changed.
 * Returns ST_OK; ST_ELIMIT: the triangulation has changed too much (REPAIR_*), or points
 * fall on one place, or all on one line: build it anew; ST_ENOMEM.  On failure m has all its
 * points, and arbitrary triangles. */
enum status repair_mesh(struct mesh *m, struct scratch *s);

#endif
