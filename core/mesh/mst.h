/* mst.h -- minimum spanning tree of the Delaunay graph in linear time.
 * Paper 1 section 3.3.  Method: Cheriton and Tarjan, "Finding Minimum Spanning Trees",
 * SIAM J. Computing 5(4), 1976: in stages, every tree takes its shortest outgoing edge;
 * then the clean-up contracts the trees and, of parallel edges, keeps the shortest, so that
 * a planar graph of k trees has fewer than 3k edges again and the stages' costs fall
 * geometrically.  (The paper's Fibonacci heap is not needed on planar graphs.)  Before the
 * first stage every triangle drops its longest side, which leaves fewer than 2 nv edges. */
#ifndef CORE_MST_H
#define CORE_MST_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* mst_build(m, s): Finds the tree of m's edges of least total length, sets m->parent, and
 * renumbers the vertices along a depth-first walk from the lexicographically first point,
 * neighbours in the order of their coordinates (mesh.h: parent[v] < v).  Half-edges and
 * triangles keep their numbers.  Edges of equal length are ordered by the end point that
 * comes first, then by the other, points by x, then y: the tree and the numbers are a
 * function of the set of points alone, whatever the numbers were before.
 * Works on any triangulation, Delaunay or not; edges are compared by squared length.
 * Cost  O(nv) time on every input; scratch: 116 bytes a point.
 * Returns ST_OK; ST_ENOMEM: m is unchanged. */
enum status mst_build(struct mesh *m, struct scratch *s);

/* mst_check(m): Checks that m->parent is the tree that mst_build() makes, by the cycle property over
 * every edge: for tests and surfacectl check.  mesh_check() checks that the tree's edges are
 * edges of the mesh.  Cost: O(nv depth).
 * Returns ST_OK, ST_ECORRUPT. */
enum status mst_check(const struct mesh *m);

#endif
