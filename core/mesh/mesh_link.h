/* mesh_link.h -- a mesh from the code of its triangles, checked: for decoding. */
#ifndef CORE_MESH_LINK_H
#define CORE_MESH_LINK_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* mesh_link(m, s): Completes the triangulation that delaunay_build() wrote from a part of it, and checks
 * that the result is a triangulation of the convex hull: coordinates on the lattice, indices
 * in range, every edge shared by exactly two triangles, every real triangle
 * counter-clockwise, one ring of ghosts round a convex hull, every vertex with one full ring
 * of triangles; the tree's edges are edges of the mesh, parent[v] < v.  Any input is safe.
 * On entry there are nv, nt, xy, z, parent, and of each triangle t, in the order of mesh.h,
 *   org[3 t]      for a ghost its first corner
 *   twin[3 t]     for a real triangle its gate
 *   org[3 t + 1]  in turns the first and the second of nv - 1 pairs of half-edges that are each
 *                 other's twins: mesh_listed()
 *   org[3 t + 2]  its third corner
 * Cost: O(nv).
 * Returns ST_OK, ST_ECORRUPT, ST_ENOMEM. */
enum status mesh_link(struct mesh *m, struct scratch *s);

/* mesh_listed(m, h): Returns true if h is less than its twin, and the two follow neither from a gate nor
 * from the ring of ghosts.  nv - 1 half-edges are listed. */
bool mesh_listed(const struct mesh *m, uint32_t h);

#endif
