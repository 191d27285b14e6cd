/* simplify.h -- few points that keep the surface.
 * Paper 1 section 5 and [10] (how far a simplified surface is from the one that it was made
 * from): points are taken out one by one, each time the one that changes the surface least;
 * what they leave is triangulated anew (star.h), so that it is always the Delaunay
 * triangulation of the points that are left.  Greedy: the least number there is would take
 * a search among all subsets.
 * The gap is taken at the points of the original.  That is the papers' measure: the points
 * that are left are points of the original, so the general triangulation of both is the
 * original's own, and over its triangles the gap is linear between its corners.  (Within a triangle
 * the simplified surface may bend, and the gap between them be larger in one place.)
 * The points of the hull stay, so both surfaces cover the same. */
#ifndef CORE_SIMPLIFY_H
#define CORE_SIMPLIFY_H
#include <stdint.h>
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* When to end: at the first of these that holds. */
struct simplify_limit {
    double error;     /* no gap above this, lattice units; INFINITY: any */
    double disparity; /* the mean gap not above this; INFINITY: any.  If it is finite, the
                         point goes next that adds least to the volume; else the one
                         whose largest gap is least. */
    uint32_t least;   /* keep so many points, or more */
};

struct simplify_result {
    uint32_t kept;
    double error;     /* largest |gap|, lattice units */
    double disparity; /* volume between both over the area, lattice units */
};

/* simplify_mesh(m, bridge, limit, s, out, gap, r): out = the Delaunay triangulation of the
 * points of m that are kept, with their heights, in delaunay_build()'s order, no tree.
 * m       a Delaunay triangulation (delaunay_build()); needs no tree; not changed
 * bridge  [m->nt] the triangles that do not count in the disparity (holes_mark()); NULL: all
 *         that are real count
 * gap     [m->nv] height of out minus height of m at each point of m, lattice units; 0 at
 *         the points that were kept; NULL: not wanted
 * Points that are equally good go in the order of their numbers: deterministic.
 * Cost    about 7 n evaluations, each by the number of points that lie in a star: measured
 *         3 us a point of 3,000 down to a tenth of them, 11 us of 300,000.  Memory: about
 *         190 bytes a point besides out.
 * Returns ST_OK, ST_ELIMIT, ST_ENOMEM (out->nv is 0 then). */
enum status simplify_mesh(const struct mesh *m, const uint8_t *bridge,
                          const struct simplify_limit *limit, struct scratch *s,
                          struct mesh *out, double *gap, struct simplify_result *r);

#endif
