/* face.h -- a face from a scan's points.  surface_face.h has the comparison of two faces.
 * A "model" is knowledge of faces in general (model.h), never a face. */
#ifndef CORE_FACE_H
#define CORE_FACE_H
#include <stddef.h>
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

/* face_build(pts, n, w, out, bad): Builds a face from a scanner's points (mm, any order): lattice,
 * surface, quality gate, canonical frame.
 * The gate is a coarse one: the quality (quality.h), and ST_ENOTFACE if no face explains the
 * surface at all.  core/find/gate.h judges whether the points are a face.
 *   out  all zero, or a former face, whose memory is reused; on failure it is empty but
 *        may still hold memory: face_free().  The caller sets out->step_mm, which counts as noise
 *   bad  the index of the offending point for ST_ENOTFINITE and ST_ERANGE; may be NULL
 * Returns ST_OK; ST_ETOOFEW (< SURFACE_MIN_POINTS usable); ST_ENOTFINITE; ST_ERANGE;
 * ST_EDEGENERATE; ST_EUNITS (extent outside 60-500 mm); ST_ENOTFACE; ST_EQUALITY;
 * ST_ENOMEM; ST_ELIMIT. */
enum status face_build(const struct dvec3 *pts, size_t n, struct surface_work *w,
                       struct surface_face *out, size_t *bad);

/* face_lay(pts, n, pose, w, out, bad): Builds a face like face_build(), but with pose (points, mm ->
 * canonical frame) as its canonical frame, and without an encoding: half the cost.
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

/* face_adopt(f, w): Completes a decoded face: checks and links its mesh (mesh_link()), and derives the rest.
 * If the frame belongs to another model's mean face, finds it again.
 *   f  f->surface.mesh has the input of mesh_link(), unchecked; f->frame is the stored frame
 *      (mean_id 0: none)
 * Returns ST_OK; ST_ECORRUPT: f->surface.mesh.nv is 0; ST_ENOMEM. */
enum status face_adopt(struct surface_face *f, struct surface_work *w);

/* face_rebuild(f, w): Rebuilds f, which another engine built, from its points.  Flattened spikes stay
 * flat.  The points do not change by a bit, so a second call changes nothing, nor does a first one on a
 * face of this engine.  Cost: about that of face_build().
 * Returns as face_build(), except for the statuses about single points; f is empty on failure. */
enum status face_rebuild(struct surface_face *f, struct surface_work *w);

/* face_align(tmpl, probe, w, out): Finds the pose of the probe over the template, the start of the
 * search for the minimal disparity.  The score does not depend on it.  Returns ST_OK, ST_ENOMEM. */
enum status face_align(const struct surface_face *tmpl, const struct surface_face *probe,
                       struct surface_work *w, struct align_result *out);

#endif
