/* quality.h -- the quality of a scan: noise, density, coverage; and the gate that refuses
 * what is not a face, or too poor a scan of one. */
#ifndef CORE_QUALITY_H
#define CORE_QUALITY_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

/* mm, of the longest side: what a scan in cm, inches or metres, or of a room, has not. */
#define QUALITY_EXTENT_MIN_MM 60
#define QUALITY_EXTENT_MAX_MM 500

/* Warnings.  Density (mm): beyond it the score begins to fall, and with it q->score.  The
 * others: beyond what 99 of 100 scans of a good scanner have (noise 0.51 mm); a third of the outline missing; turns beyond what align_search() is
 * made for. */
#define QUALITY_SPARSE_MM        3.0
#define QUALITY_NOISY_MM         0.6
#define QUALITY_INCOMPLETE_SHARE 0.7
#define QUALITY_TURNED_YAW_DEG   30
#define QUALITY_TURNED_OTHER_DEG 20 /* pitch, roll */

struct frame;   /* frame.h */
struct scratch; /* mem.h */
struct surface; /* surface.h */

struct quality {
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* measured area over the hull's area, 0..1 */
    double density_mm; /* typical distance between neighbours */
    double noise_mm;   /* white noise estimated from the surface itself */
};

/* quality_extent(pts, n, s): ST_EUNITS where the extent of the points (lattice units at
 * LATTICE_PER_MM) is not that of a face in millimetres: the longest side of the bounding box
 * below 60 mm, or the middle 98 % of the points along an axis above 500 mm.  n >= 1.  O(n).
 * Returns ST_OK, ST_EUNITS, ST_ENOMEM. */
enum status quality_extent(const struct ivec3 *pts, size_t n, struct scratch *s);

/* quality_rate(f, s, q): fill q, and the gate.  O(nv).
 * Returns ST_OK; ST_ENOTFACE where the surface is within 3 mm (root mean square) of a plane;
 * ST_EQUALITY where the noise is above 3 mm, a quarter of the points are spikes, or less than
 * a tenth of the outline was measured; ST_ENOMEM. */
enum status quality_rate(const struct surface *f, struct scratch *s, struct quality *q);

/* Defects of a scan that can still be used. */
enum quality_reason {
    QUALITY_SPARSE,     /* density_mm above QUALITY_SPARSE_MM */
    QUALITY_NOISY,      /* noise_mm above QUALITY_NOISY_MM */
    QUALITY_INCOMPLETE, /* coverage below QUALITY_INCOMPLETE_SHARE */
    QUALITY_TURNED, /* away from the scanner: more than 30 degrees of yaw, or 20 of pitch
                           or roll */
    QUALITY_REASONS
};

/* quality_reasons(q, frame): the defects as bits, 1 << reason each; 0: none.
 * frame  NULL where it is not known; then the last is not looked for */
unsigned quality_reasons(const struct quality *q, const struct frame *frame);

/* quality_reason_name(r): "sparse", "noisy", ...; static. */
const char *quality_reason_name(enum quality_reason r);

#endif
