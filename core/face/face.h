/* face.h -- a face from a scan's points, and the comparison of two faces.
 * "Model" is what is known of faces in general (model.h), never a face. */
#ifndef CORE_FACE_H
#define CORE_FACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "align.h"
#include "face_data.h"
#include "grid.h"
#include "libsurface.h"
#include "quality.h"
#include "status.h"
#include "surface.h"
#include "vec.h"

struct cells;         /* cells.h */
struct measure_work;  /* measure.h */
struct surface_model; /* model.h */
struct shape_work;    /* shape_work.h */

/* More than these bytes in a block surface_work_wipe() gives back: faces of up to 10,000 points are
 * worked on without allocating again.  It takes O(bytes used since the last time). */
#define FACE_WORK_KEEP ((size_t)4 << 20)

/* The mean face of the model that w was made with, ready to align to, its shape ready to be fitted,
 * and what encodings are made by; the memory of measures. */
const struct frame_mean *face_work_mean(const struct surface_work *w);
struct shape_work *face_work_shape(struct surface_work *w);
const struct encode_basis *face_work_encode(const struct surface_work *w);
struct measure_work *face_work_measure(struct surface_work *w);

/* face_build(pts, n, w, out, bad): a face from a scanner's points (mm, any order): lattice,
 * surface, quality gate, canonical frame.
 * The gate is a coarse one: the quality's (quality.h), and ST_ENOTFACE where no face explains the
 * surface at all.  Whether the points are a face, core/find/gate.h judges.
 * out   all zero, or a former face, whose memory is used again; on failure it is empty but
 *       may still hold memory: face_free().  out->step_mm is the caller's: it counts as noise
 * bad   the index of the offending point for ST_ENOTFINITE and ST_ERANGE; may be NULL
 * Returns ST_OK; ST_ETOOFEW (< SURFACE_MIN_POINTS usable); ST_ENOTFINITE; ST_ERANGE;
 * ST_EDEGENERATE; ST_EUNITS (extent outside 60-500 mm); ST_ENOTFACE; ST_EQUALITY;
 * ST_ENOMEM; ST_ELIMIT. */
enum status face_build(const struct dvec3 *pts, size_t n, struct surface_work *w,
                       struct surface_face *out, size_t *bad);

/* face_lay(pts, n, pose, w, out, bad): as face_build(), but the canonical frame is pose (points, mm ->
 * canonical frame), and there is no encoding: half the cost.
 * face_encode(z, residual_mm, w, f): the encoding of the heights z (heights.h) becomes f's.
 * Returns ST_OK, ST_ENOMEM. */
enum status face_lay(const struct dvec3 *pts, size_t n, const struct pose *pose,
                     struct surface_work *w, struct surface_face *out, size_t *bad);
enum status face_encode(const float z[GRID_N], double residual_mm, struct surface_work *w,
                        struct surface_face *f);

void face_free(struct surface_face *f); /* NULL and empty ones are allowed */

/* face_adopt(f, w): for decoding: mesh_link(), then everything that follows from the mesh.
 * On entry f->surface.mesh has what mesh_link() reads, nothing of it checked, and f->frame is
 * the stored frame (mean_id 0: none).  The frame is found again where it belongs to another
 * model's mean face.
 * Returns ST_OK, ST_ECORRUPT (f->surface.mesh.nv is 0 then), ST_ENOMEM. */
enum status face_adopt(struct surface_face *f, struct surface_work *w);

/* face_rebuild(f, w): replace f, which another engine built, by what this engine builds from
 * the same points.  Spikes stay as they were laid flat.  The points do not change by a bit,
 * so a second call changes nothing, nor does a first one on a face of this engine.
 * Returns as face_build(), except for the statuses about single points; f is empty on
 * failure.  Costs about as much as face_build(). */
enum status face_rebuild(struct surface_face *f, struct surface_work *w);

/* Of struct surface_comparison and struct surface_disparity here the size is not used.
 *
 * face_compare(tmpl, probe, threshold, w, out): the score (ratio.h), from both encodings alone,
 * and the decision.
 * threshold  in place of that of w's calibration; NAN: that
 * The result depends only on the two faces, w's model, the calibration and the threshold.
 * Returns ST_OK (an inconclusive comparison included), ST_ENOMEM. */
enum status face_compare(const struct surface_face *tmpl,
                         const struct surface_face *probe, double threshold,
                         struct surface_work *w, struct surface_comparison *out);

/* face_compare_again(tmpl, probe, w, io): a second look where score and surfaces contradict each other:
 * where *io is a no_match of less than SURFACE_DOUBT and the minimal disparity SURFACE_DOUBT_MM at
 * most, the probe is laid on the mean face from the template's frame, and what that gives is *io if
 * its score is higher.  Next to nothing for other scores, else as face_minimal().
 * Returns ST_OK, ST_ENOMEM. */
enum status face_compare_again(const struct surface_face *tmpl,
                               const struct surface_face *probe, struct surface_work *w,
                               struct surface_comparison *io);

/* As surface_best_of(), surface_shown(), surface_compare_mirrored() and surface_weigh(). */
void face_best_of(struct surface_comparison *r, uint32_t n, const struct surface_work *w);
void face_shown(const struct surface_comparison *r, double steps, double *score,
                double *threshold);
enum status face_compare_mirrored(const struct surface_face *tmpl,
                                  const struct surface_face *probe,
                                  struct surface_work *w, struct surface_comparison *out);
enum status face_weigh(const struct surface_face *tmpl, const struct surface_face *probe,
                       struct surface_work *w, struct surface_disparity *least);

/* face_align(tmpl, probe, w, out): the pose of the probe over the template, from which the minimal
 * disparity is found and the gaps are shown.  The score does not depend on it.  Returns ST_OK, ST_ENOMEM. */
enum status face_align(const struct surface_face *tmpl, const struct surface_face *probe,
                       struct surface_work *w, struct align_result *out);

/* face_minimal(tmpl, probe, w, out): the minimal disparity (minimal.h), from the pose of
 * face_align(); the times by surface_work_clock().  Returns ST_OK, ST_ENOMEM. */
enum status face_minimal(const struct surface_face *tmpl,
                         const struct surface_face *probe, struct surface_work *w,
                         struct surface_disparity *out);

/* face_field(tmpl, probe, w, out): what face_compare() decided on.  The score is a quadratic
 * form of the heights of both scans and a constant; a cell's part is half of its height times
 * the derivative of the score by it, and of the constant the share that the place has, among
 * those that count, in telling people apart.  The cost of two encodings.  Returns ST_OK, ST_ENOMEM. */
enum status face_field(const struct surface_face *tmpl, const struct surface_face *probe,
                       struct surface_work *w, struct surface_parts *out);

/* face_asymmetry(f, w, out): f against its mirror image, from the symmetry plane of its
 * canonical frame (asymmetry.h).  Deterministic.  Returns ST_OK, ST_ENOMEM. */
enum status face_asymmetry(const struct surface_face *f, struct surface_work *w,
                           struct surface_asymmetry *out);

#endif
