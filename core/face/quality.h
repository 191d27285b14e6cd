/* quality.h -- the quality of a scan: noise, density, coverage; and the gate that refuses
 * non-faces and poor scans. */
#ifndef CORE_QUALITY_H
#define CORE_QUALITY_H
#include <stddef.h>
#include "surface_face.h"
#include "status.h"
#include "vec.h"

struct frame;   /* frame.h */
struct mesh;    /* mesh.h */
struct scratch; /* mem.h */
struct surface; /* surface.h */

/* quality_extent(pts, n, s): Checks that the extent of n >= 1 points (lattice units at LATTICE_PER_MM)
 * is possible for a face in millimetres.  Cost: O(n).
 * Returns ST_OK; ST_EUNITS: the longest side of the bounding box is below 60 mm, or the middle 98 % of
 * the points along an axis above 500 mm; ST_ENOMEM. */
enum status quality_extent(const struct ivec3 *pts, size_t n, struct scratch *s);

/* quality_step(step_mm): Returns the part, in mm, of a step between neighbouring depths that counts.
 * Files in whole millimetres have steps of 1 mm, which the sensor's own noise hides: nothing of a step
 * counts up to 1 mm, all of it from 1.4 mm on. */
double quality_step(double step_mm);

/* quality_noise(m, stride, s, out): Measures the white noise of m along its normal, mm, at every
 * stride-th vertex: the median distance from the plane through the neighbours, on which edges and spikes
 * have no effect.  0 if no vertex has such a plane.  Returns ST_OK, ST_ENOMEM. */
enum status quality_noise(const struct mesh *m, uint32_t stride, struct scratch *s,
                          double *out);

/* quality_rate(f, step_mm, s, q): Rates f, and applies the gate.  The noise is at least half of a step
 * that counts: the greatest error of a depth.  Cost: O(nv).
 * Returns ST_OK; ST_ENOTFACE: the surface is within 3 mm (root mean square) of a plane;
 * ST_EQUALITY: the noise is above 3 mm, a quarter of the points are spikes, or less than
 * a tenth of the outline was measured; ST_ENOMEM. */
enum status quality_rate(const struct surface *f, double step_mm, struct scratch *s,
                         struct surface_quality *q);

/* quality_reasons(q, frame): Returns the defects as bits, 1 << enum surface_reason each; 0: none.
 *   frame  NULL: unknown; the bit of SURFACE_OBLIQUE is then 0 */
unsigned quality_reasons(const struct surface_quality *q, const struct frame *frame);

#endif
