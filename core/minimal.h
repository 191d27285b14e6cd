/* minimal.h -- the minimal disparity: the papers' measure at its own minimum over shifts and
 * rotations.  Paper 1 sections 2 and 4.
 * The score decides at the pose that explains the probe best as the same person (align.h);
 * the volume between the surfaces is least at another, near it. */
#ifndef CORE_MINIMAL_H
#define CORE_MINIMAL_H
#include "disparity.h"
#include "status.h"
#include "surface.h"

struct measure_work; /* measure.h */

struct minimal {
    double transform[16];       /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    struct disparity disparity; /* the exact measure there; plain_mm is the minimum */
    double ms;                  /* by the caller's clock; 0 without one */
};

/* minimal_find(tmpl, probe, transform, w, out): the least disparity of tmpl and probe within
 * 10 degrees and 20 mm of the alignment `transform`, with at least 0.95 of the alignment's
 * common area kept.
 * Returns ST_OK, ST_ENOMEM. */
enum status minimal_find(const struct surface *tmpl, const struct surface *probe,
                         const double transform[16], struct measure_work *w,
                         struct minimal *out);

#endif
