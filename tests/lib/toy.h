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

/* toy_model(m): an egg with a nose and two orbits; 6 modes of change, 12 of identity, all
 * of these of shape; as model_parse() would give it. */
void toy_model(struct surface_model *m);

/* toy_text(m, len): m as text, to be released with free(). */
char *toy_text(const struct surface_model *m, size_t *len);

/* toy_height(x, y): of the mean face, mm, anywhere. */
double toy_height(double x, double y);

/* toy_cells(m, from, to, out): the gap of heights `to` over heights `from` (mm; NAN: none), at
 * right angles to m's mean face. */
void toy_cells(const struct surface_model *m, const float from[GRID_N],
               const float to[GRID_N], struct cells *out);

typedef double toy_heights(const void *arg, double x, double y);

/* toy_scan(z, arg, n, pose, rng, out): the surface of about n points of z, spread roughly
 * evenly over an oval of half axes 55 and 70 mm and moved by pose (NULL: not moved). */
void toy_scan(toy_heights *z, const void *arg, uint32_t n, const struct pose *pose,
              struct brute_rng *rng, struct surface *out);

/* toy_surface(pts, n, out): the surface of points in mm, without a search for spikes.  out: as
 * for surface_prepare(). */
void toy_surface(const struct dvec3 *pts, size_t n, struct surface *out);

/* toy_pose(yaw, pitch, roll, shift, p): the turn (degrees) about the point 80 mm behind the
 * origin, then the shift (mm). */
void toy_pose(double yaw, double pitch, double roll, struct dvec3 shift, struct pose *p);

extern const struct pose toy_still;                               /* moves nothing */
struct pose toy_then(const struct pose *a, const struct pose *b); /* first a, then b */

/* toy_at(h, x, y): between the middles of the cells with heights h, bilinear; NAN off them. */
double toy_at(const float h[GRID_N], double x, double y);

#endif
