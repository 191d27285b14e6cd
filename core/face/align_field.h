/* align_field.h -- the template as a height field, and the robust sum of the gaps between it
 * and points of the probe.
 * A moved point is rounded to the lattice and located by a visibility walk from its last
 * triangle.  The walk is exact, so on a Delaunay triangulation it ends; but a hostile client
 * can send two surfaces of which each step of a search crosses most of the triangles, and on other
 * triangulations the walk can go round in circles.  So the steps of all walks are limited. */
#ifndef CORE_ALIGN_FIELD_H
#define CORE_ALIGN_FIELD_H
#include <stdbool.h>
#include <stdint.h>
#include "pose.h"
#include "solve.h"
#include "vec.h"

struct surface; /* surface.h */

/* The weight u(x, y) of points on the template. */
struct align_weight {
    const float *u;    /* [GRID_N] weights of the cells of the canonical frame (grid.h) */
    struct pose frame; /* template -> canonical frame */
};

struct align_field {
    const struct surface *surface;
    /* NULL: a weight of 1 everywhere; else 0 off the grid */
    const struct align_weight *u;
    uint32_t first; /* a triangle to start from */
    int64_t left;   /* remaining steps of walks; below 0 no gap is found any more */
};

#define ALIGN_FIELD_NONE UINT32_MAX

/* align_field_make(s, u, f): Makes the field of s for one search.  Cost: O(1).
 *   s, u  borrowed by f */
void align_field_make(const struct surface *s, const struct align_weight *u,
                      struct align_field *f);

/* A point of the probe. */
struct align_point {
    struct dvec3 p;    /* mm */
    float area;        /* area of the probe's surface that the point stands for, mm^2 */
    uint32_t triangle; /* last triangle, or ALIGN_FIELD_NONE */
};

/* The corners of a triangle, counter-clockwise, seen from a point: each x, y, z, lattice
 * units. */
struct align_corners {
    float at[3][3];
};

/* align_field_find(f, p, q, out): Finds the triangle under q (mm), to which p has moved.  Walks from
 * p->triangle, which must not be ALIGN_FIELD_NONE, and sets it to the last triangle of the walk.
 * Cost: ALIGN_WALK steps, and all together at most ALIGN_WORK a triangle more.
 * Returns false if there is no gap: outside the template's hull, or over a hole. */
bool align_field_find(struct align_field *f, struct align_point *p, struct dvec3 q,
                      struct align_corners *out);

/* align_field_sum(f, pts, n, stride, pose, c, loss, sum): Sums over the points 0, stride, 2
 * stride, ... below n, moved by pose, and updates their triangles.  Rotations in the normal
 * equations are about c (template, mm).  In single precision: accurate to 0.0001 mm. */
void align_field_sum(struct align_field *f, struct align_point *pts, uint32_t n,
                     uint32_t stride, const struct pose *pose, struct dvec3 c,
                     enum solve_loss loss, struct solve_sum *sum);

#endif
