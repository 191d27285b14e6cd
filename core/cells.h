/* cells.h -- the signed gap between two aligned surfaces, averaged over the cells of the
 * template's canonical frame (grid.h).
 * The gap is taken at right angles to the template, as its distance along the scanner's z
 * times the cosine of the slope: so it does not depend on the template's own pose. */
#ifndef CORE_CELLS_H
#define CORE_CELLS_H
#include "align_pose.h"
#include "grid.h"
#include "tuning.h"

struct align_field;  /* align_field.h */
struct align_point;  /* align_field.h */
struct surface;      /* surface.h */
struct measure_work; /* measure.h */

struct cells {
    float area[GRID_N];      /* mm^2 in the frame's plane that both surfaces cover */
    float gap[GRID_N];       /* mean gap, probe minus template, mm; 0 without area */
    float z[GRID_N];         /* mean height of the template there, mm */
    float normal[GRID_N][3]; /* its mean normal, in the frame, not normalised */
};

/* cells_cover(c, i): what cell i counts, 0..1: nothing at CELLS_COVERED, all when half of
 * it is covered.  Without a jump, so that a rim that moves a little changes little. */
static inline float cells_cover(const struct cells *c, uint32_t i)
{
    const float full = (float)(GRID_MM * GRID_MM / 2);
    const float share = (c->area[i] - CELLS_COVERED) / (full - CELLS_COVERED);

    return share < 0.0f ? 0.0f : share < 1.0f ? share : 1.0f;
}

/* cells_measure(tmpl, w, frame, out): the exact integrals, at the pose of the last
 * measure_at() in w.  A triangulated surface cuts across what is curved between its points,
 * the more the sparser it is, so the gap is taken where there are points: at the template's
 * vertices, linear between them, and at the probe's vertices, linear between those.  The
 * first has only the probe's error of cutting across, the second only the template's, with
 * opposite signs; both grow with the square of the point spacing.  The mean of both is
 * weighted by the inverse of its variance: the fourth power of the other's spacing.
 * frame maps the template into its canonical frame.  Steep places, more than 75 degrees
 * off the frame's z, and triangles that bridge missing points of either surface are left
 * out.  O(nv). */
void cells_measure(const struct surface *tmpl, const struct measure_work *w,
                   const struct align_pose *frame, struct cells *out);

/* cells_sample(field, pts, n, pose, frame, out): the same from samples: the probe's points
 * moved by pose over the template's field, each counting for the area it stands for.
 * Cheap enough for every step of a search.  O(n). */
void cells_sample(const struct align_field *field, struct align_point *pts, uint32_t n,
                  const struct align_pose *pose, const struct align_pose *frame,
                  struct cells *out);

#endif
