/* mesh_link.h -- from the corners of triangles to a mesh that is proven: for decoding. */
#ifndef CORE_MESH_LINK_H
#define CORE_MESH_LINK_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* mesh_link(m, s): make twin[] and out[] from nv, nt, xy, org and parent, and prove that
 * the result is a triangulation of the convex hull: coordinates on the lattice, indices in
 * range, every edge shared by exactly two triangles, every real triangle counter-clockwise,
 * one ring of ghosts round a convex hull, every vertex with one full ring of triangles; the
 * tree's edges among the mesh's, parent[v] < v.  Hostile input is safe.  For decoding.
 * The triangles must be in the order in which delaunay_build() writes them: ghosts first,
 * clockwise round the hull, the ghost vertex at their third corner.  Then out[] too is as
 * delaunay_build() makes it: the last half-edge in number out of a vertex, the first out
 * of the ghost.
 * Cost  O(nv) time.  Returns ST_OK, ST_ECORRUPT, ST_ENOMEM. */
enum status mesh_link(struct mesh *m, struct scratch *s);

#endif
