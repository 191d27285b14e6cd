/* measure.h -- the exact disparity of two surfaces at a given pose: the papers' measure.
 * The probe is moved and prepared as a surface (paper 1, 3.1 and 3.3), each surface is
 * located in the other (3.3) and interpolated there (3.4), both triangulations are merged
 * into the general triangulation, and the volume between the surfaces is summed over it
 * (3.5). */
#ifndef CORE_MEASURE_H
#define CORE_MEASURE_H
#include <stdint.h>
#include "disparity.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "status.h"
#include "surface.h"

/* One worker's reusable memory, and the results of the last call.  An empty one is all zero;
 * after the first few calls nothing is allocated any more. */
struct measure_work {
    struct scratch scratch,
        points;            /* memory of the builders; free for other use between calls */
    struct scratch arrays; /* holds the arrays below */
    struct surface moved;  /* the probe at the pose */
    struct location *tmpl_in_moved, *moved_in_tmpl;
    double *tmpl_gap, *moved_gap; /* at their vertices: moved minus template
                                     (disparity.h), lattice units */
    struct mesh general; /* the general triangulation; template vertices come first */
    uint32_t *b_vertex;  /* [moved nv] merge_build()'s */
    struct disparity_vertex *vertex; /* [general.nv] */
};

void measure_work_free(
    struct measure_work *w); /* resets w to the empty state; NULL is allowed */

/* measure_work_wipe(w, keep): Overwrites the remains of faces, and keeps at most `keep` bytes in each
 * scratch (scratch_wipe()). */
void measure_work_wipe(struct measure_work *w, size_t keep);

/* measure_at(tmpl, probe, transform, u, w, out): Measures the disparity of tmpl (surface a) and the probe
 * (surface b) moved by transform (mm, row-major 4 x 4, a rigid motion or a reflection).
 *   u    the weight; NULL: 1 everywhere
 *   out  all zero if the surfaces have nothing in common; w->general.nv is then 0, as on failure
 * Cost: O(n log n), about three times a triangulation.  Returns ST_OK, ST_ENOMEM. */
enum status measure_at(const struct surface *tmpl, const struct surface *probe,
                       const double transform[16], const struct disparity_weight *u,
                       struct measure_work *w, struct disparity *out);

#endif
