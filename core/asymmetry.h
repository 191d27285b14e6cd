/* asymmetry.h -- a surface against its mirror image.
 * Paper 1 section 4 and [9]: the surface is reflected in a plane and measured against its
 * reflection, which is the initial estimate; then the plane is corrected until the
 * disparity is least, which is the final one.
 * A reflection has three unknowns, not a pose's six.  Turning the plane by an angle about
 * an axis in it turns the mirror image by twice that angle about the same axis, and
 * shifting it by s shifts the image by 2 s: so the correction is alignment (align.h: robust
 * sums of gaps, reweighted Gauss-Newton steps) along these three motions.
 * Heights are taken at right angles to a view that lies in the symmetry plane: the surface
 * is turned there first, and once more when the plane is known, so that the figures do not
 * depend on the side that it was scanned from. */
#ifndef CORE_ASYMMETRY_H
#define CORE_ASYMMETRY_H
#include <stdbool.h>
#include <stdint.h>
#include "align.h"
#include "disparity.h"
#include "status.h"

struct align_pose;   /* align_pose.h */
struct surface;      /* surface.h */
struct measure_work; /* measure.h */

struct asymmetry {
    double normal[3];         /* of the plane, a unit vector towards the image's right, */
    double offset_mm;         /* and normal . p on it; of the surface as it was given */
    struct disparity initial; /* at the plane of the start */
    struct disparity final;   /* at the corrected plane: the asymmetry is plain_mm */
    double moved_deg, moved_mm; /* the correction: the plane's turn, and its shift in the
                                   middle of the surface */
    double turn_deg, shift_mm; /* standard deviations of both, by leaving out each twelfth
                                  of the surface in turn (jackknife) */
    uint32_t evaluations;      /* robust sums evaluated */
    enum align_stop stop;      /* ALIGN_APART: too little lies over the mirror image */
};

/* asymmetry_conclusive(a): was a plane found, and does enough of the surface lie over its
 * mirror image (ASYMMETRY_MIN_OVERLAP) for its disparity to say something? */
bool asymmetry_conclusive(const struct asymmetry *a);

/* asymmetry_find(s, start, m, upright, out): the plane in which s is most like its mirror image,
 * and how unlike.
 * s      lattice units at LATTICE_PER_MM, with its spanning tree
 * start  a rigid motion (mm) that brings the plane near x = 0 and the view along z: a face's
 *        canonical frame.  15 degrees and 10 mm off will do.
 * upright  s turned into its symmetry plane: a former surface's memory, or empty
 * The value of a surface is that of its mirror image, to what the search leaves (under 1 %).
 * With ALIGN_APART, or where a pose leads off the lattice, the measures may be all zero.
 * Cost   six triangulations, two general triangulations, and up to some 100 robust sums
 *        over at most 4,000 points.  Returns ST_OK, ST_ENOMEM. */
enum status asymmetry_find(const struct surface *s, const struct align_pose *start,
                           struct measure_work *m, struct surface *upright,
                           struct asymmetry *out);

#endif
