/* fit.h -- split a gap into motion, change and a rest.
 * The signed gap per cell is a small rigid motion of the probe, plus the model's modes of
 * change within one person (model.h), plus a rest:
 *     gap = B a - J x + rest.
 * Reweighted least squares minimise
 *     sum rho(rest / the cell's deviation) + |a|^2 + tie |x|^2
 * over the covered cells; rho is Huber's loss at FIT_HUBER.  To remove a learned change
 * before faces are compared: Al-Osaimi, Bennamoun and Mian, "An Expression Deformation
 * Approach to Non-rigid 3D Face Recognition", IJCV 81(3), 2009.
 * Products are floats, summed in a fixed order: the same digits everywhere. */
#ifndef CORE_FIT_H
#define CORE_FIT_H
#include <stdbool.h>
#include "cells.h"
#include "mem.h"
#include "model.h"
#include "status.h"

/* Huber's limit, in standard deviations: 1.2 % of a normal distribution lies beyond. */
#define FIT_HUBER 2.5

/* A weight that a pass would change by less than this share of a full one stays: half of the
 * sums' work, and scores change by less than 0.1 %. */
#define FIT_STILL 0.05

/* With fewer covered cells nothing is explained; a third of a face has 350.  Chosen empirically. */
#define FIT_MIN_CELLS 40

struct fit {
    double a[MODEL_MODES];
    double x[6];         /* the motion of the probe that explains the gap, in the frame: a
                             rotation (radians) about (0, 0, -POSE_LEVER_MM), then a shift
                             (mm) */
    double deviation[6]; /* standard deviation of x, from the curvature at the minimum;
                             INFINITY: unknown */
    float rest[GRID_N];  /* mm; 0 where not covered */
    uint32_t cells;      /* covered */
};

/* Modes ready to be fitted: borrowed, with the normal equations of a face that is covered
 * everywhere: the sum of their products over the cells in use, weighted by 1 / variance. */
struct fit_basis {
    const struct model_basis *b;
    bool used[GRID_N]; /* cells that are fitted; all others are as not covered */
    float gram[MODEL_MODES][MODEL_MODES]; /* upper triangle, in tiles */
};

/* fit_prepare(b, out): Prepares *b for many fits; to be called again after a change of *b.
 * Cost: O(GRID_N n^2), n the number of modes. */
void fit_prepare(const struct model_basis *b, struct fit_basis *out);

/* fit_solve(p, c, tie, passes, s, out): Splits c's gap.
 * tie     strength of the prior on x, in 1 / mm^2 with rotations at POSE_LEVER_MM; a
 *         small one leaves x free
 * passes  reweightings, 0 or more; a weight that would change by less than FIT_STILL of a
 *         full one stays
 * With fewer than FIT_MIN_CELLS covered cells a and x are 0 and the rest is the gap.
 * Cost  O(cells n + n^3 + changed n^2), where changed counts the cells that are not fully
 * covered and, in each pass, those that change their weight.  Returns ST_OK, ST_ENOMEM. */
enum status fit_solve(const struct fit_basis *p, const struct cells *c, double tie,
                      int passes, struct scratch *s, struct fit *out);

#endif
