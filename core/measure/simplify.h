/* simplify.h -- few points that keep the surface.
 * Paper 1 section 5 and [10] (how far a simplified surface is from the original): points are
 * removed one by one, each time the one whose removal changes the surface least, and the
 * star that is left is triangulated again (star.h): the surface is always the Delaunay
 * triangulation of its points.  The method is greedy: the smallest possible number of points
 * would need a search among all subsets.
 * The gap is measured at the points of the original.  That is the papers' measure: the points
 * left are points of the original, so the original is the general triangulation of both, and
 * over its triangles the gap is linear between the corners.  (Within a triangle the
 * simplified surface may bend, and the gap may be larger in one place.)
 * The points of the hull stay, so both surfaces cover the same area. */
#ifndef CORE_SIMPLIFY_H
#define CORE_SIMPLIFY_H
#include <stdint.h>
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* When to end: at the first limit that is reached. */
struct simplify_limit {
    double error;     /* no gap above this, lattice units; INFINITY: any */
    double disparity; /* the mean gap not above this; INFINITY: any.  If finite, the next
                         point removed is the one that adds least to the volume; else the
                         one that leaves the least largest gap */
    uint32_t least;   /* points kept at least */
};

struct simplify_result {
    uint32_t kept;
    double error;     /* largest |gap|, lattice units */
    double disparity; /* volume between both over the area, lattice units */
};

/* simplify_mesh(m, bridge, limit, s, out, gap, r): out = the Delaunay triangulation of the
 * points of m that are kept, with their heights, in delaunay_build()'s order, no tree.
 * m       a Delaunay triangulation (delaunay_build()); needs no tree; not changed
 * bridge  [m->nt] the triangles without weight in the disparity (holes_mark()); NULL: the
 *         ghosts alone
 * gap     [m->nv] height of out minus height of m at each point of m, lattice units; 0 at
 *         the points that were kept; NULL: not wanted
 * Of equally good points the lowest number is removed: deterministic.
 * Cost    about 7 n evaluations, each by the number of points that lie in a star: measured
 *         3 us a point of 3,000 down to a tenth of them, 11 us of 300,000.  Memory: about
 *         190 bytes a point besides out.
 * Returns ST_OK, ST_ELIMIT, ST_ENOMEM (out->nv is 0 then). */
enum status simplify_mesh(const struct mesh *m, const uint8_t *bridge,
                          const struct simplify_limit *limit, struct scratch *s,
                          struct mesh *out, double *gap, struct simplify_result *r);

#endif
