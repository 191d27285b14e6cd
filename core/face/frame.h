/* frame.h -- the canonical frame of a face: nose tip at the origin, symmetry plane at x = 0,
 * upright.  In it a place (x, y) of the weight u, of a mode or of a region is the same place
 * on every face.  The frame is found by aligning the face to the model's mean face, which
 * is more stable than any landmark of one scan; once, at enrolment, and stored. */
#ifndef CORE_FRAME_H
#define CORE_FRAME_H
#include "align.h"
#include "align_grid.h"
#include "pose.h"
#include "grid.h"
#include "surface.h"

struct surface_model; /* model.h */

/* The mean face as a surface to align others to. */
struct frame_mean {
    struct align_grid grid; /* with rigid as weight */
    struct pose_axes axes;
    float rigid[GRID_N];  /* for registrations: where a face keeps its shape, 0..1 */
    float height[GRID_N]; /* mm; NAN off the face */
    uint32_t mean_id;     /* model_mean_id() */
};

/* frame_mean_make(m, out): once for a model.  Returns ST_OK; ST_EDEGENERATE when the model's
 * mean is no surface. */
enum status frame_mean_make(const struct surface_model *m, struct frame_mean *out);

struct frame {
    struct pose pose; /* face -> canonical; shrinks a head that is not of adults' size */
    uint32_t mean_id; /* of the mean face it was found by; 0: not found yet */
    double cost_mm;   /* mean distance from the mean face there (capped, L1) */
    double within;    /* share of the face's points over the mean face */
    double support;   /* share of what is seen that a face's shape explains (shape.h) */
    float seen;       /* cells of the face with points */
    float explained;  /* of each of them, by a face's shape, at most 1 (place.h) */
};

/* frame_find(mean, face, w, out): align the face to the mean face.  (Of a decoded template
 * pose, mean_id, seen and explained are known; the rest is 0.)  Cost: a fraction of a triangulation.
 * Returns ST_OK, ST_ENOMEM. */
enum status frame_find(const struct frame_mean *mean, const struct surface *face,
                       struct align_work *w, struct frame *out);

#endif
