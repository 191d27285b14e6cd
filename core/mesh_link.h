/* mesh_link.h -- a mesh from the corners of its triangles, checked: for decoding. */
#ifndef CORE_MESH_LINK_H
#define CORE_MESH_LINK_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* mesh_link(m, s): set twin[] and out[] from nv, nt, xy, org and parent, and check that the
 * result is a triangulation of the convex hull: coordinates on the lattice, indices in range,
 * every edge shared by exactly two triangles, every real triangle counter-clockwise, one
 * ring of ghosts round a convex hull, every vertex with one full ring of triangles; the
 * tree's edges are edges of the mesh, parent[v] < v.  Any input is safe.
 * The triangles must be in the order in which delaunay_build() writes them: ghosts first,
 * clockwise round the hull, with the ghost vertex as third corner.  Then out[] too is what
 * delaunay_build() sets: the half-edge of the highest number out of a vertex, of the lowest
 * out of the ghost.
 * Cost  O(nv) time.  Returns ST_OK, ST_ECORRUPT, ST_ENOMEM. */
enum status mesh_link(struct mesh *m, struct scratch *s);

#endif
