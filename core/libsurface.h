/* surface.h -- libsurface: faces found in scans, stored as bytes, and compared.
 *
 *     struct surface_work *work = surface_work_new(NULL);
 *     struct surface_cloud a = {.points = p, .n = np};
 *     struct surface_cloud b = {.points = q, .n = nq};
 *     struct surface_comparison c = {0};
 *     struct surface_face *tmpl = NULL, *probe = NULL;
 *
 *     a.flags = SURFACE_ENROLMENT;
 *     if (work != NULL && surface_build(work, &a, &tmpl, NULL) == SURFACE_OK &&
 *         surface_build(work, &b, &probe, NULL) == SURFACE_OK &&
 *         surface_compare(work, tmpl, probe, &c) == SURFACE_OK)
 *         printf("%d: score %.1f\n", c.decision == SURFACE_MATCH, c.score);
 *
 * The library prints nothing, reads no file and never exits.  The same points give the
 * same digits on every machine with IEEE 754 numbers, on any number of threads.  Lengths
 * are millimetres, transforms rigid and row-major 4 x 4, unless stated otherwise.  Link
 * with -lsurface -lm (pkg-config: surface).  docs/library.md has whole programs.
 *
 * Out parameters may be NULL only where stated.
 *
 * In the source tree this is core/libsurface.h; make puts the headers that it includes, one of each
 * layer of the core, in their places and calls the result surface.h. */
#ifndef SURFACE_H
#define SURFACE_H
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "basic/surface_basic.h"
#include "face/surface_face.h"
#include "face/surface_search.h"
#include "find/surface_scan.h"

/* ---- a face from a scan */

/* Builds a face from a scan.
 *   out    *out NULL: receives a new face, to be released with surface_face_free(); else a former
 *          face, which is replaced, in its memory.  On failure a former face is released and
 *          *out is NULL
 *   found  may be NULL
 * Cost: O(n log n): for 3,000 frontal points about 2 ms and 80 bytes a point; for 20,000
 * points of a head about 10 ms.
 * Returns SURFACE_OK or any other status but SURFACE_ECORRUPT and SURFACE_EVERSION. */
SURFACE_API enum surface_status surface_build(struct surface_work *work,
                                              const struct surface_cloud *cloud,
                                              struct surface_face **out,
                                              struct surface_found *found);

/* Builds one face from the frames of one capture session, of one person, who hardly moves.
 * Keeps the face of the best frame, the base, except for its heights: each becomes a robust mean
 * of the heights of all frames there.  So the noise falls with the square root of their number;
 * with one frame the face is that of surface_build().  The frames need not be aligned.
 *   n      1..SURFACE_FRAMES_MAX
 *   cloud  [n], with the same flags and the same stop.  The face is searched for in the first frame
 *          in which one is found, and then looked for near that place.  With SURFACE_ENROLMENT
 *          each frame must show exactly one face, not mirrored, from the front; the strict gate
 *          judges the fused face.  kept receives the points of each frame's face, and the
 *          fused points in the base
 *   frame  [n]: receives the reports
 *   base   receives the number of the base, on success and with SURFACE_EPEOPLE
 *   out    as in surface_build()
 *   found  receives the base's report, with the gate's measures of the fused face; may be NULL
 * Cost: 4.5 times that of one frame for five frames of 3,000 points.
 * Returns SURFACE_OK; SURFACE_EPEOPLE: a frame does not show the person of most frames; the first
 * frame's status if no frame has a face; or the status of the fused face. */
SURFACE_API enum surface_status surface_fuse(struct surface_work *work, uint32_t n,
                                             const struct surface_cloud *cloud,
                                             struct surface_frame *frame, uint32_t *base,
                                             struct surface_face **out,
                                             struct surface_found *found);

/* Builds a face from a scan as for an enrolment and, if that is refused, as for a
 * verification, with one search.  Ignores SURFACE_ENROLMENT.
 *   refused, why  receive the enrolment's status and its report
 *   found         receives the report on the face, or on the last refusal
 * Returns as surface_build() for the verification. */
SURFACE_API enum surface_status
surface_check(struct surface_work *work, const struct surface_cloud *cloud,
              struct surface_face **out, enum surface_status *refused,
              struct surface_found *why, struct surface_found *found);

#ifdef __cplusplus
}
#endif
#endif
