/* frame.h -- the canonical frame of a face: nose tip at the origin, symmetry plane at x = 0,
 * upright.  In it a place (x, y) of the weight u, a mode or a region is the same place
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
    struct align_grid grid; /* surface with rigid as weight */
    struct pose_axes axes;
    float rigid
        [GRID_N]; /* weight for registrations, 0..1: high on parts that keep their shape */
    float height[GRID_N]; /* mm; NAN off the face */
    uint32_t mean_id;     /* model_mean_id() */
};

/* frame_mean_make(m, out): Prepares the mean face of a model.  Returns ST_OK; ST_EDEGENERATE: the model's
 * mean is no surface. */
enum status frame_mean_make(const struct surface_model *m, struct frame_mean *out);

struct frame {
    struct pose pose; /* face -> canonical; shrinks a head that is not of adults' size */
    uint32_t
        mean_id; /* model_mean_id() of the mean face it was found by; 0: not found yet */
    double cost_mm; /* mean distance from the mean face there (capped, L1) */
    double within;  /* share of the face's points over the mean face */
    double
        support; /* share of the visible surface that a face's shape explains (shape.h) */
    float seen;  /* number of cells with points */
    float explained; /* mean share explained of each of them, at most 1 (place.h) */
};

/* frame_find(mean, face, w, out): Aligns the face to the mean face.  (The frame of a decoded template has
 * pose, mean_id, seen and explained; the rest is 0.)
 * Cost: a fraction of a triangulation.
 * Returns ST_OK, ST_ENOMEM. */
enum status frame_find(const struct frame_mean *mean, const struct surface *face,
                       struct align_work *w, struct frame *out);

#endif
