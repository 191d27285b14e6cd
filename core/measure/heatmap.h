/* heatmap.h -- the signed gap between a template and a probe at the probe's own points. */
#ifndef CORE_HEATMAP_H
#define CORE_HEATMAP_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct surface; /* surface.h */

/* heatmap_gaps(tmpl, pts, n, transform, gap_mm): Sets gap_mm[i] to the height, in mm, of pts[i] (mm),
 * moved by transform (row-major 4 x 4), above tmpl along the scanner's z; NAN if the
 * template does not cover it, or it is off the lattice.  A point's gap depends on no other
 * point.
 * Cost: O(nv + n log n), nv = tmpl->mesh.nv, for points spread like the template's, in any
 * order; for any others O((nv + n) log^2 nv).
 * Returns ST_OK; ST_ENOMEM: each gap is NAN. */
enum status heatmap_gaps(const struct surface *tmpl, const struct dvec3 *pts, size_t n,
                         const double transform[16], double *gap_mm);

#endif
