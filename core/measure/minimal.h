/* minimal.h -- the minimal disparity: the papers' measure at its own minimum over shifts and
 * rotations.  Paper 1 sections 2 and 4; the paper searches over the whole measure.
 * The alignment (align.h) is the pose that explains the probe best as the same person; the
 * volume between the surfaces is least at another pose, near it.
 * This search goes over an estimate of the measure: the integral of |gap| over either
 * surface, from the gaps at its vertices (minimal_places.h), minimised by Newton steps
 * (minimal_solve.h); first over few vertices of the probe, then over all of both surfaces.
 * The measure itself is computed once, at the estimate's minimum. */
#ifndef CORE_MINIMAL_H
#define CORE_MINIMAL_H
#include "disparity.h"
#include "status.h"
#include "surface.h"

struct measure_work; /* measure.h */

/* Limits of the pose: the angle of the rotation from the alignment, the shift of the middle of the
 * probe, and the share of the alignment's common area that is kept. */
#define MINIMAL_TURN_DEG 10
#define MINIMAL_SHIFT_MM 20
#define MINIMAL_AREA     0.95

struct minimal {
    double transform[16];       /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    struct disparity disparity; /* exact measure at transform; plain_mm is the minimum */
};

/* minimal_find(tmpl, probe, transform, w, out): Finds the least disparity of tmpl and probe within
 * these limits.  The result is not more than the measure at the alignment, which is computed too if the
 * estimate does not make that certain, or the limit of the area is near.  docs/decision.md has the distance
 * from the least known value.
 *   transform  the alignment, rigid
 *   out        if the surfaces have nothing in common at the alignment: the measure there, all zero
 * Cost: O(nv): about a third more than measure_at(), at most six times as much.
 * Returns ST_OK, ST_ENOMEM. */
enum status minimal_find(const struct surface *tmpl, const struct surface *probe,
                         const double transform[16], struct measure_work *w,
                         struct minimal *out);

#endif
