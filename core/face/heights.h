/* heights.h -- a surface as a height for each cell of the canonical frame (grid.h), for the
 * Gaussian model of faces (encode.h) and its fit (shape.h): averaged over a
 * cell, white noise and the density of the points hardly matter. */
#ifndef CORE_HEIGHTS_H
#define CORE_HEIGHTS_H
#include <stdint.h>
#include "pose.h"
#include "grid.h"
#include "mem.h"
#include "status.h"

struct surface; /* surface.h */

/* Samples of a surface in the frame of a pose: each stands for an area seen along the frame's z. */
struct heights {
    const float *x, *y, *z, *area; /* [n], mm and mm^2 */
    uint32_t n;
};

/* heights_take(f, pose, s, out): Samples the surface f moved by pose (mm, f -> canonical frame): a small
 * triangle's middle, and in a larger one as many points that each stands for HEIGHTS_AREA_MM2 at
 * most.  Ignores triangles that span a hole, that fill a hole of more than
 * HEIGHTS_HOLE mean distances of points in radius, that are seen at more than 78 degrees or from
 * behind, or that are more than HEIGHTS_AROUND_MM beside the grid.
 *   out  in s until its next use
 * Cost: O(nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status heights_take(const struct surface *f, const struct pose *pose,
                         struct scratch *s, struct heights *out);

/* heights_at(h, pose, out): Computes the mean height of each cell, mm, of the samples moved by pose, a
 * small motion, weighted by their area; NAN if less than HEIGHTS_COVERED of the cell is
 * covered.  In floats, in the samples' order.  Cost: O(n). */
void heights_at(const struct heights *h, const struct pose *pose, float out[GRID_N]);

/* heights_of(f, pose, s, out): Computes the heights of f at pose.  Returns ST_OK, ST_ENOMEM. */
enum status heights_of(const struct surface *f, const struct pose *pose,
                       struct scratch *s, float out[GRID_N]);

#endif
