/* toy.h -- a small made-up model and surfaces, for tests of learning and measuring: fixed
 * numbers, computed with + - * / alone. */
#ifndef TESTS_TOY_H
#define TESTS_TOY_H
#include <stddef.h>
#include <stdint.h>
#include "pose.h"
#include "brute.h"
#include "cells.h"
#include "model.h"
#include "surface.h"

/* toy_model(m): Fills *m as model_parse() would: an egg with a nose and two orbits; 6 modes of
 * change, 12 of identity, and all 18 as modes of shape. */
void toy_model(struct surface_model *m);

/* toy_text(m, len): Returns m as text of *len bytes, to be released by free(). */
char *toy_text(const struct surface_model *m, size_t *len);

/* toy_height(x, y): Returns the height of the mean face, mm; defined for all x, y. */
double toy_height(double x, double y);

/* toy_cells(m, from, to, out): Sets the cells to the gap of the heights `to` over the heights `from`
 * (mm; NAN: no height), at right angles to the mean face of m. */
void toy_cells(const struct surface_model *m, const float from[GRID_N],
               const float to[GRID_N], struct cells *out);

typedef double toy_heights(const void *arg, double x, double y);

/* toy_scan(z, arg, n, pose, rng, out): Makes the surface of about n points of z, spread roughly
 * evenly over an oval of half axes 55 and 70 mm and moved by pose (NULL: not moved). */
void toy_scan(toy_heights *z, const void *arg, uint32_t n, const struct pose *pose,
              struct draw *rng, struct surface *out);

/* toy_surface(pts, n, out): Calls surface_prepare() for points in mm, without a search for spikes. */
void toy_surface(const struct dvec3 *pts, size_t n, struct surface *out);

/* toy_pose(yaw, pitch, roll, shift, p): Sets *p to the rotation (degrees) about the point 80 mm
 * behind the origin, then the shift (mm). */
void toy_pose(double yaw, double pitch, double roll, struct dvec3 shift, struct pose *p);

extern const struct pose toy_still; /* the identity */

/* toy_then(a, b): Returns the motion that applies a, then b. */
struct pose toy_then(const struct pose *a, const struct pose *b);

/* toy_at(h, x, y): Returns the height between the centres of the cells of h, bilinear; NAN beside
 * them. */
double toy_at(const float h[GRID_N], double x, double y);

#endif
