/* quality.h -- the quality of a scan: noise, density, coverage; and the gate that refuses
 * what is not a face, or too poor a scan of one. */
#ifndef CORE_QUALITY_H
#define CORE_QUALITY_H
#include <stddef.h>
#include <stdint.h>
#include "surface_face.h"
#include "status.h"
#include "vec.h"

/* The share of the outline below which a third of it is missing.  Where the other defects begin
 * (SURFACE_NOISY_MM, ...): density where the score begins to fall, and with it q->score; noise
 * beyond what 99 of 100 scans of a good scanner have (0.51 mm); turns beyond what align_search() is
 * made for. */
#define QUALITY_INCOMPLETE_SHARE 0.7

struct frame;   /* frame.h */
struct scratch; /* mem.h */
struct surface; /* surface.h */

/* quality_extent(pts, n, s): ST_EUNITS where the extent of the points (lattice units at
 * LATTICE_PER_MM) is not that of a face in millimetres: the longest side of the bounding box
 * below 60 mm, or the middle 98 % of the points along an axis above 500 mm.  n >= 1.  O(n).
 * Returns ST_OK, ST_EUNITS, ST_ENOMEM. */
enum status quality_extent(const struct ivec3 *pts, size_t n, struct scratch *s);

/* quality_step(step_mm): Returns the part, in mm, of a step between neighbouring depths that counts.
 * Files in whole millimetres have steps of 1 mm, which the sensor's own noise hides: nothing of a step
 * counts up to 1 mm, all of it from 1.4 mm on. */
double quality_step(double step_mm);

/* quality_rate(f, step_mm, s, q): fill q, and the gate.  The noise is half of a step that counts at
 * least: the greatest error of a depth.  O(nv).
 * Returns ST_OK; ST_ENOTFACE where the surface is within 3 mm (root mean square) of a plane;
 * ST_EQUALITY where the noise is above 3 mm, a quarter of the points are spikes, or less than
 * a tenth of the outline was measured; ST_ENOMEM. */
enum status quality_rate(const struct surface *f, double step_mm, struct scratch *s,
                         struct surface_quality *q);

/* quality_reasons(q, frame): the defects as bits, 1 << enum surface_reason each; 0: none.
 * frame  NULL where it is not known; then SURFACE_OBLIQUE is not looked for */
unsigned quality_reasons(const struct surface_quality *q, const struct frame *frame);

#endif
