/* cells.h -- the signed gap between two aligned surfaces, averaged over the cells of the
 * template's canonical frame (grid.h).
 * The gap is measured at right angles to the template (the distance along the scanner's z
 * times the cosine of the slope), so that it does not depend on the template's pose. */
#ifndef CORE_CELLS_H
#define CORE_CELLS_H
#include "align_pose.h"
#include "grid.h"
#include "status.h"
#include "tuning.h"

struct align_field;  /* align_field.h */
struct align_point;  /* align_field.h */
struct surface;      /* surface.h */
struct measure_work; /* measure.h */

struct cells {
    float area[GRID_N];      /* mm^2 in the frame's plane that both surfaces cover */
    float gap[GRID_N];       /* mean gap, probe minus template, mm; 0 without area */
    float z[GRID_N];         /* mean height of the template there, mm */
    float normal[GRID_N][3]; /* its mean normal, in the frame */
};

/* cells_cover(c, i): the weight of cell i, 0..1: 0 up to CELLS_COVERED, 1 from half of the
 * cell covered, linear between: a rim that moves a little changes little. */
static inline float cells_cover(const struct cells *c, uint32_t i)
{
    const float full = (float)(GRID_MM * GRID_MM / 2);
    const float share = (c->area[i] - CELLS_COVERED) / (full - CELLS_COVERED);

    return share < 0.0f ? 0.0f : share < 1.0f ? share : 1.0f;
}

/* cells_measure(tmpl, w, frame, out, overlap): the gap at the pose of the last measure_gaps()
 * in w.
 * A triangulated surface cuts across what is curved between its points: its error grows with
 * the square of the point spacing.  So the gap is measured twice: at the template's vertices
 * and linear between them, with the probe's error alone, and at the probe's vertices and
 * linear between them, with the template's error alone.  The errors have opposite signs: in
 * the mean of both they cancel, where each is weighted by the square of the spacing of the
 * vertices that it was measured at.  Within a cell a triangle counts, and covers, less where
 * the other surface's triangles are large: at the rim of a hole, and all over a sparse scan
 * (measure_work's trust).
 * frame    maps the template to its canonical frame
 * overlap  the share of the template's measured area that the probe covers, 0..1: of its
 *          triangles with a gap at each corner
 * Places more than 75 degrees off the frame's z (CELLS_STEEP), and triangles that bridge
 * missing points of either surface, are left out.  w's scratch is used.  O(nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status cells_measure(const struct surface *tmpl, struct measure_work *w,
                          const struct align_pose *frame, struct cells *out,
                          double *overlap);

/* cells_sample(field, pts, n, pose, frame, out): an estimate of the same from points of the
 * probe, moved by pose over the template's field, each weighted by the area it stands for.
 * O(n). */
void cells_sample(struct align_field *field, struct align_point *pts, uint32_t n,
                  const struct align_pose *pose, const struct align_pose *frame,
                  struct cells *out);

#endif
