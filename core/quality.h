/* quality.h -- what a scan is worth: spikes, noise, density, coverage, and the gate that
 * refuses what is no face or too poor a scan of one. */
#ifndef CORE_QUALITY_H
#define CORE_QUALITY_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct frame;   /* frame.h */
struct scratch; /* mem.h */
struct surface; /* surface.h */

struct quality {
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* measured area over the hull's area, 0..1 */
    double density_mm; /* typical distance between neighbours */
    double noise_mm;   /* white noise estimated from the surface itself */
};

/* quality_extent(pts, n, s): do the points extend like a face?  Lattice units at
 * LATTICE_PER_MM.  The longest side of the bounding box must reach 60 mm, and that of the
 * middle 98 % of the points along each axis must not pass 500 mm: a few stray points do
 * not matter.  O(n).  Returns ST_OK, ST_EUNITS, ST_ENOMEM.  n >= 1. */
enum status quality_extent(const struct ivec3 *pts, size_t n, struct scratch *s);

/* quality_rate(f, s, q): what a surface is worth, and the gate.  O(nv).
 * Returns ST_OK; ST_ENOTFACE no relief: within 3 mm (root mean square) of a plane, or
 * deeper than wide; ST_EQUALITY noise above 3 mm, or less than a tenth of the outline
 * measured; ST_ENOMEM. */
enum status quality_rate(const struct surface *f, struct scratch *s, struct quality *q);

/* quality_place(frame): the gate once more, when the face has been laid on the mean face:
 * ST_ENOTFACE where it lies on it nowhere (QUALITY_APART_MM, QUALITY_LOOSE_MM) or its relief
 * is not a face's (QUALITY_LIKENESS), else ST_OK.
 * A wrong refusal is worse than a wrong pass, which then matches nobody: of what has a hump
 * in its middle, as a nose, a part passes (docs/accuracy.md). */
enum status quality_place(const struct frame *frame);

/* What is wrong with a scan that may still be used: bits. */
enum quality_reason {
    QUALITY_SPARSE,     /* density_mm above QUALITY_SPARSE_MM */
    QUALITY_NOISY,      /* noise_mm above QUALITY_NOISY_MM */
    QUALITY_INCOMPLETE, /* coverage below QUALITY_INCOMPLETE_SHARE */
    QUALITY_TURNED,     /* away from the scanner: by more than 30 degrees of yaw, or 20 of
                           pitch or roll */
    QUALITY_UNUSUAL, /* farther from the mean face than QUALITY_UNUSUAL_MM, or less like
                           it than QUALITY_UNUSUAL_LIKENESS */
    QUALITY_REASONS
};

/* quality_reasons(q, frame): the bits 1 << reason, 0: all is well.  frame: NULL where it is
 * not known; then nothing is said of the last two. */
unsigned quality_reasons(const struct quality *q, const struct frame *frame);

const char *
quality_reason_name(enum quality_reason r); /* "sparse", "noisy", ...; static */

#endif
