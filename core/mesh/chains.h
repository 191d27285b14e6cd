/* chains.h -- finds the triangle of a point in O(log^2 n) steps, whatever the
 * triangulation.  A straight walk (locate.h) is faster on scans, but an attacker who sends
 * two surfaces can make every step of the one cross all needles of the other.  Lee and
 * Preparata, "Location of a point in a planar subdivision and its applications", SIAM J.
 * Comput. 6, 1977: the triangles are put into an order in which each comes after those
 * below it; between any two numbers of that order runs a chain of edges that is monotone
 * in x, and a point's triangle is found by bisection over the chains.  An edge is kept
 * once, with the first chain that the bisection compares it in.
 * Exact: decided by orient2d on the lattice, points in the order of x, then y. */
#ifndef CORE_CHAINS_H
#define CORE_CHAINS_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

struct chains {
    const struct mesh *m;
    uint32_t regions;      /* numbers of the order: triangles, and the outside twice */
    const uint32_t *rank;  /* [nt] a triangle's number; of ghosts the outside's */
    const uint32_t *first; /* [regions + 1] index in edge of a chain's first edge */
    const uint32_t *edge;  /* half-edges with their triangle above; from left to right */
    uint32_t leftmost, rightmost; /* vertices */
};

/* chains_make(m, s, c): Makes the chains of a mesh that mesh_link() or mesh_check() accepts,
 * Delaunay or not.  They lie in s, and refer to m.
 * Cost: O(nv log nv), about half a triangulation.
 * Returns ST_OK, ST_ENOMEM. */
enum status chains_make(const struct mesh *m, struct scratch *s, struct chains *c);

/* chains_find(c, q, he): Returns true if q lies in the hull, its border included.
 *   he  receives a half-edge of a real triangle that contains q; if q lies outside, a hull edge that
 *       has q strictly on its outer side
 * Cost: O(log^2 nv). */
bool chains_find(const struct chains *c, struct ivec2 q, uint32_t *he);

#endif
