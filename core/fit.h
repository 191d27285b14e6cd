/* fit.h -- what of a gap is motion and change, and what is left.
 * The signed gap per cell is explained as a small rigid motion of the probe, plus the
 * model's modes of change within one person (model.h), plus a rest:
 *     gap = B a - J x + rest,
 * where (a, x) minimise  sum rho(rest / deviation of the cell) + |a|^2 + tie |x|^2  over the covered
 * cells, rho Huber's loss at FIT_HUBER, by reweighted least squares.  Removing a learned change
 * before faces are compared: Al-Osaimi, Bennamoun and Mian, "An Expression Deformation
 * Approach to Non-rigid 3D Face Recognition", IJCV 81(3), 2009.
 * Float products summed in a fixed order: the same digits everywhere. */
#ifndef CORE_FIT_H
#define CORE_FIT_H
#include <stdbool.h>
#include "cells.h"
#include "mem.h"
#include "model.h"
#include "status.h"

struct fit {
    double a[MODEL_MODES];
    double x[6];         /* the motion of the probe that the gap asks for, in the frame:
                             a turn (radians) about the lever's point, then a shift (mm) */
    double deviation[6]; /* of x: from the curvature at the minimum; INFINITY: unknown */
    float rest[GRID_N];  /* mm; 0 where not covered */
    uint32_t cells;      /* covered */
};

/* Modes ready to be fitted: borrowed, with the sum of their products over all their cells,
 * each cell weighted by 1 / variance: what a face that is covered everywhere needs. */
struct fit_basis {
    const struct model_basis *b;
    float gram[MODEL_MODES][MODEL_MODES]; /* upper triangle, in tiles */
};

/* fit_prepare(b, out): once for many fits, and again when *b has changed.
 * Cost  O(GRID_N n^2), n the number of modes. */
void fit_prepare(const struct model_basis *b, struct fit_basis *out);

/* fit_solve(p, c, tie, passes, s, out): tie is the strength of the prior on x, in 1 / mm^2
 * at POSE_LEVER_MM; small: free.  passes: reweightings, 0 or more.
 * With fewer than FIT_MIN_CELLS covered cells nothing is explained: a and x are 0.
 * Cost  O(cells n + n^3 + changed n^2), changed the number of p's cells that are not fully
 * covered or, pass after pass, fit badly.  Returns ST_OK, ST_ENOMEM. */
enum status fit_solve(const struct fit_basis *p, const struct cells *c, double tie,
                      int passes, struct scratch *s, struct fit *out);

#endif
