/* fill.h -- points restored in the holes of a scanned surface.
 * Paper 2 (missing points): where points are missing, the surface is the Delaunay
 * triangulation of the others, linear over each triangle.  A hole is a set of triangles that
 * bridge missing points (holes.h), connected by their edges and enclosed by measured ones.
 * Bridging triangles that are connected to the outside of the hull lie beyond the scan's
 * outline: nothing says that there was a surface, and they are not filled.
 * The new points stand on the interpolated surface as densely as the points round the hole,
 * by the local spacing at its rim: they are the corners of equilateral triangles; but there is
 * no new point nearer to a point of the scan than FILL_APART of their side. */
#ifndef CORE_FILL_H
#define CORE_FILL_H
#include <stdint.h>
#include "status.h"
#include "vec.h"

/* A restored point is this far from the scan's points at least, in sides of the triangles that
 * the restored ones form: half as far as they are from each other. */
#define FILL_APART 0.5

/* Restored points against the true surface, by the diameter of the hole, mm: root mean square,
 * and what 95 % of the points stay below.  For each size the largest that study `filled` found
 * with round holes in made-up faces, of 3,000 and of 20,000 points, and in scans, rounded up;
 * not falling with the size.  Of long holes of the same area it is about half. */
#define FILL_SIZES 8
/* clang-format off */
#define FILL_SIZE_MM { 5,   7,   10,  14,  20,  28,  40,  56 }
#define FILL_RMS_MM  { 0.3, 0.7, 1.4, 1.4, 2.2, 2.8, 3.9, 6.8 }
#define FILL_95_MM   { 0.5, 1.4, 2.9, 2.9, 4.0, 5.5, 8.3, 15.8 }
/* clang-format on */

struct scratch; /* mem.h */
struct surface; /* surface.h */

struct fill_hole {
    double area;     /* square lattice units */
    double diameter; /* diameter of a circle of that area */
    uint32_t points; /* number of points restored in it */
};

/* Restored points; empty if all zero. */
struct fill {
    struct ivec3 *pts;      /* [n] restored, hole by hole */
    struct fill_hole *hole; /* [nholes] */
    uint32_t n, nholes;
    double beyond; /* area of the triangles that bridge beyond the outline */
};

/* fill_holes(s, most, w, out): Restores the missing points of s, at most `most`.
 *   s    a result of surface_prepare(): vertices in its order
 *   out  empty, or a former one; to be released by fill_free(), also after a failure
 * A hole counts if, by its area and its rim, FILL_LEAST points or more are missing.  The
 * heights lie on s, so each is between the heights of the corners of a triangle of s.
 * New points change the spacing round them, so the surface of all points is searched again
 * until no hole is found, FILL_PASSES times at most: filling a filled surface adds
 * nothing.  The result depends on the set of points alone, not on their order.
 * Cost: O(n log n) for n points, restored ones included, if no vertex has very many
 * neighbours.
 * Returns ST_OK; ST_ELIMIT: there would be more points; ST_ENOMEM. */
enum status fill_holes(const struct surface *s, uint32_t most, struct scratch *w,
                       struct fill *out);
void fill_free(struct fill *f); /* resets f to the empty state */

/* fill_error(diameter_mm, rms_mm, most_mm): Looks up the expected distance (FILL_SIZE_MM) from the true
 * surface of the points restored in a hole of this diameter: its root mean square, and the limit that
 * 95 % of them stay below.  NAN above the largest hole that was studied. */
void fill_error(double diameter_mm, double *rms_mm, double *most_mm);

#endif
