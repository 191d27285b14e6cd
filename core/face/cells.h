/* cells.h -- the signed gap between two aligned surfaces, averaged over the cells of the
 * template's canonical frame (grid.h).
 * The gap is measured at right angles to the template (the distance along the scanner's z
 * times the cosine of the slope), so that it does not depend on the template's pose. */
#ifndef CORE_CELLS_H
#define CORE_CELLS_H
#include "pose.h"
#include "grid.h"
#include "status.h"

/* mm^2 of a cell's 16 that both surfaces must cover before the cell counts at all.
 * Chosen empirically: the weight beyond it rises from 0 (cells_cover()). */
#define CELLS_COVERED 1.0f

struct align_field; /* align_field.h */
struct align_point; /* align_field.h */

struct cells {
    float area[GRID_N];      /* mm^2 in the frame's plane that both surfaces cover */
    float gap[GRID_N];       /* mean gap, probe minus template, mm; 0 without area */
    float z[GRID_N];         /* mean height of the template there, mm */
    float normal[GRID_N][3]; /* its mean normal, in the frame */
};

/* cells_cover(c, i): Returns the weight of cell i, 0..1: 0 up to CELLS_COVERED, 1 from half of the
 * cell covered, linear between: a rim that moves a little changes little. */
static inline float cells_cover(const struct cells *c, uint32_t i)
{
    const float full = (float)(GRID_MM * GRID_MM / 2);
    const float share = (c->area[i] - CELLS_COVERED) / (full - CELLS_COVERED);

    return share < 0.0f ? 0.0f : share < 1.0f ? share : 1.0f;
}

/* cells_sample(field, pts, n, pose, frame, out): Averages the gaps at points of the probe, moved by pose
 * over the template's field, each weighted by the area it stands for.  Ignores places more than 75 degrees
 * off the frame's z (CELLS_STEEP), and triangles of the template that span a hole.
 *   frame  template -> its canonical frame
 * Cost: O(n). */
void cells_sample(struct align_field *field, struct align_point *pts, uint32_t n,
                  const struct pose *pose, const struct pose *frame, struct cells *out);

#endif
