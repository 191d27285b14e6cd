/* minimal.h -- the minimal disparity: the papers' measure at its own minimum over shifts and
 * rotations.  Paper 1 section 2, and 4, where it is searched for over the whole measure.
 * The score decides at the pose that explains the probe best as the same person (align.h);
 * the volume between the surfaces is least at another, near it.
 * Here the search goes over an estimate of the measure: the integral of |gap| over either
 * surface, from the gaps at its vertices (minimal_places.h), minimised by Newton steps
 * (minimal_solve.h); first over few vertices of the probe, at last over all of both surfaces.
 * The measure itself is taken once, at the estimate's minimum. */
#ifndef CORE_MINIMAL_H
#define CORE_MINIMAL_H
#include "disparity.h"
#include "status.h"
#include "surface.h"

struct measure_work; /* measure.h */

/* How far the pose may be from the alignment: the angle of the turn between them, and the
 * shift of the middle of the probe; and how much of the alignment's common area is kept. */
#define MINIMAL_TURN_DEG 10
#define MINIMAL_SHIFT_MM 20
#define MINIMAL_AREA     0.95

struct minimal {
    double transform[16];       /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    struct disparity disparity; /* the exact measure there; plain_mm is the minimum */
};

/* minimal_find(tmpl, probe, transform, w, out): the least disparity of tmpl and probe
 * within the limits above of the alignment `transform` (rigid).
 * Not more than the measure at the alignment, which is measured too where the estimate does
 * not make that certain, or the limit of the area is near.  Surfaces with nothing in common
 * at the alignment: the measure there, all zero.
 * Cost  O(nv): about a third more than measure_at(); at most six times that.  How near to the
 * least known value it comes: docs/decision.md.
 * Returns ST_OK, ST_ENOMEM. */
enum status minimal_find(const struct surface *tmpl, const struct surface *probe,
                         const double transform[16], struct measure_work *w,
                         struct minimal *out);

#endif
