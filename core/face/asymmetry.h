/* asymmetry.h -- a surface against its mirror image.
 * Paper 1 section 4 and [9]: the disparity between a surface and its reflection in a plane is
 * the initial estimate of its asymmetry; the least disparity over all planes is the
 * final one.
 * A reflection has three unknowns, not a pose's six.  Turning the plane by an angle about
 * an axis in it turns the mirror image by twice that angle about the same axis, and
 * shifting it by s shifts the image by 2 s.  So the plane is found by the method of align.h
 * (robust sums of gaps, reweighted Gauss-Newton steps) along these three motions.
 * Heights are measured along a direction in the symmetry plane: the surface is turned
 * upright first, and again when the plane is known.  So the result does not depend on the
 * side that the surface was scanned from. */
#ifndef CORE_ASYMMETRY_H
#define CORE_ASYMMETRY_H
#include "disparity.h"
#include "status.h"
#include "surface_face.h"

struct pose;         /* pose.h */
struct surface;      /* surface.h */
struct measure_work; /* measure.h */

/* asymmetry_find(s, start, u, m, upright, out): Finds the plane with the least disparity between s
 * and its mirror image.
 * start    a rigid motion (mm) that brings the plane to x = 0 and the view to z, to within 15
 *          degrees and 10 mm: a face's canonical frame
 * u        the weight of out->weighted_mm, over the surface turned upright; NULL: 1 everywhere
 * upright  memory for s turned upright: empty, or a former surface
 * A surface and its mirror image have the same asymmetry to within 1 %.
 * conclusive: a plane was found, and enough of the surface lies over its mirror image.  If both are apart, or
 * a pose leaves the lattice, both disparities may be 0.
 * Cost  six triangulations, two general triangulations, and up to some 100 robust sums
 *       over at most 4,000 points.  Returns ST_OK, ST_ENOMEM. */
enum status asymmetry_find(const struct surface *s, const struct pose *start,
                           const struct disparity_weight *u, struct measure_work *m,
                           struct surface *upright, struct surface_asymmetry *out);

#endif
