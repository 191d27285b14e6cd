/* shape_map.h -- the distance of the front-most points before a surface given by a height for each cell.
 * Internal to core. */
#ifndef CORE_SHAPE_MAP_H
#define CORE_SHAPE_MAP_H
#include <stddef.h>
#include <stdint.h>
#include "pose.h"
#include "grid.h"
#include "mem.h"
#include "status.h"

/* The largest number of points near the face that are used: ten in a cell.  Chosen empirically. */
#define SHAPE_POINTS 10000

/* mm: how far beside the grid and before it points are kept, and how deep behind the mean face,
 * at the pose that a fit starts from; a cell's points are those up to LAYER behind its first;
 * farther than BEHIND behind the face they are the back of the head, seen through a gap.  Chosen
 * empirically. */
#define SHAPE_AROUND_MM 30.0
#define SHAPE_DEEP_MM   60.0
#define SHAPE_LAYER_MM  4.0
#define SHAPE_BEHIND_MM 40.0

/* Points near the face, in the canonical frame of some pose. */
struct shape_points {
    float *x, *y, *z; /* [n], mm; padded to whole lanes */
    float *over;      /* [n] buffer: distance before the surface, mm */
    uint32_t *cell;   /* [n] buffer: cell of each point; GRID_N: none */
    uint32_t n;
};

/* shape_map_points(pts, n, pose, height, s, out): Takes the points, moved by pose, that lie
 * within SHAPE_AROUND_MM of the grid, not more than that before the nose, nor more than
 * SHAPE_DEEP_MM behind the surface there or beside it; every n-th if there are more than SHAPE_POINTS.
 *   out  in s until its next use
 * Returns ST_OK, ST_ENOMEM. */
enum status shape_map_points(const struct dvec3 *pts, size_t n, const struct pose *pose,
                             const float height[GRID_N], struct scratch *s,
                             struct shape_points *out);

/* shape_map_slope(h, i, zx, zy): Computes the slope of h at the middle of cell i, from the cells beside
 * it that have a height. */
void shape_map_slope(const float h[GRID_N], uint32_t i, float *zx, float *zy);

/* shape_map_make(p, pose, height, out): Sets out[i] to the distance of the points of cell i, moved by pose,
 * before the surface (mm, negative: behind): the mean of the front-most ones, up to
 * SHAPE_LAYER_MM behind the first; NAN if there are none.  Within a cell the surface
 * is a plane, its slope taken from the cells beside.  Ignores points more than SHAPE_BEHIND_MM behind:
 * they are seen through a gap.
 *   height  mm; NAN: no surface */
void shape_map_make(struct shape_points *p, const struct pose *pose,
                    const float height[GRID_N], float out[GRID_N]);

/* shape_map_fill(height, over): Gives cells of the surface without points the mean of the cells beside
 * them, if two or more have one. */
void shape_map_fill(const float height[GRID_N], float over[GRID_N]);

#endif
