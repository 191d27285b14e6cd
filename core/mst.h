/* mst.h -- minimum spanning tree of the Delaunay graph in linear time.
 * Paper 1 section 3.3.  Method: Cheriton and Tarjan, "Finding Minimum Spanning Trees",
 * SIAM J. Computing 5(4), 1976: in stages, every tree takes its shortest outgoing edge;
 * then the clean-up contracts the trees and keeps the shortest of parallel edges, so that
 * a planar graph of k trees has fewer than 3k edges again and the stages' costs fall
 * geometrically.  (The paper's Fibonacci heap is not needed on planar graphs.) */
#ifndef CORE_MST_H
#define CORE_MST_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* mst_build(m, s): find the tree of m's edges of least total length, set m->parent, and
 * renumber the vertices along a depth-first walk from the lexicographically first point
 * (mesh.h: parent[v] < v).  Edges of equal length are ordered by their end points'
 * coordinates, so the tree is a function of the set of points alone.
 * Cost  O(nv) time and scratch.  Returns ST_OK, ST_ENOMEM (m is as before). */
enum status mst_build(struct mesh *m, struct scratch *s);

/* mst_check(m, s): is m->parent a spanning tree of minimal total length?  (Cycle property
 * over every edge, O(nv * depth): for tests and surfacectl check.)
 * Returns ST_OK, ST_ECORRUPT, ST_ENOMEM. */
enum status mst_check(const struct mesh *m, struct scratch *s);

#endif
