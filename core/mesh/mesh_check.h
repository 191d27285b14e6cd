/* mesh_check.h -- is a mesh the Delaunay triangulation of its points? */
#ifndef CORE_MESH_CHECK_H
#define CORE_MESH_CHECK_H
#include <stdbool.h>
#include "status.h"

struct mesh; /* mesh.h */

/* mesh_check(m): all of mesh_link()'s conditions on a mesh with twins, and the empty
 * circle across every inner edge (so: the Delaunay triangulation).  For tests and for
 * surfacectl check-database.  If tree is true, parent[] must be a spanning tree of mesh edges (its
 * minimality: mst_check()).  O(nv).
 * Returns ST_OK or ST_ECORRUPT. */
enum status mesh_check(const struct mesh *m, bool tree);

#endif
