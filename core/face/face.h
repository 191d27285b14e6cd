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
#include "surface_face.h"
#include "quality.h"
#include "status.h"
#include "surface.h"
#include "vec.h"

struct cells;         /* cells.h */
struct measure_work;  /* measure.h */
struct surface_model; /* model.h */
struct shape_work;    /* shape_work.h */

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
 * Returns ST_OK, ST_ENOMEM. */
enum status face_lay(const struct dvec3 *pts, size_t n, const struct pose *pose,
                     struct surface_work *w, struct surface_face *out, size_t *bad);

void face_free(struct surface_face *f); /* NULL and empty ones are allowed */

/* face_renew(out): Returns the former face at *out, or a new empty one; NULL: out of memory.  Sets *out
 * to NULL. */
struct surface_face *face_renew(struct surface_face **out);

/* face_finish(st, f, out): Sets *out to f, of face_renew(), if st is ST_OK; else frees f.  Returns st. */
enum surface_status face_finish(enum status st, struct surface_face *f,
                                struct surface_face **out);

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

/* face_align(tmpl, probe, w, out): the pose of the probe over the template, from which the minimal
 * disparity is found and the gaps are shown.  The score does not depend on it.  Returns ST_OK, ST_ENOMEM. */
enum status face_align(const struct surface_face *tmpl, const struct surface_face *probe,
                       struct surface_work *w, struct align_result *out);

#endif
