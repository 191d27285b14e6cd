/* shape_solve.h -- a face's shape and its motion by least squares: the height over the mean face
 * in each cell, as a sum of modes, a small rigid motion and a rest.  Internal to shape.h.
 *     height over the mean = modes a - J x + rest
 * with a prior on a and x.  All that is fixed is prepared: the rows, divided by the deviation of
 * their rest, and the sum of their products over all cells.  A solution then takes the products
 * of those cells alone whose weight differs from the weight in a whole face, from the weight in the
 * solution before, or from 0.
 * Products are floats, summed in a fixed order; the rest is + - * / and sqrt: the same digits
 * everywhere. */
#ifndef CORE_SHAPE_SOLVE_H
#define CORE_SHAPE_SOLVE_H
#include <stdint.h>
#include "grid.h"
#include "model.h"
#include "lsq.h"

/* A row: six motions, two zeros, the modes. */
#define SHAPE_WIDTH (NORMAL_LANES + MODEL_MODES)

/* With fewer cells nothing is explained; a third of a face has 350.  Chosen empirically. */
#define SHAPE_LEAST 40

/* Immutable once prepared. */
struct shape_basis {
    uint32_t modes, cells;
    uint32_t cell[GRID_N];                /* cell of each row */
    float rest[GRID_N];                   /* deviation of each row's height, mm */
    float row[GRID_N][SHAPE_WIDTH];       /* [cells], over rest */
    float gram[SHAPE_WIDTH][SHAPE_WIDTH]; /* upper triangle: the rows' products, summed */
};

/* One solution after the other. */
struct shape_solve {
    uint32_t width;                      /* columns of sum that hold; 0: none */
    float weight[GRID_N];                /* weight of each row in sum */
    float gap[GRID_N];                   /* gap of each row, weighted, over its rest */
    float sum[SHAPE_WIDTH][SHAPE_WIDTH]; /* upper triangle */
    struct lsq_rows block;
    double h[SHAPE_WIDTH][SHAPE_WIDTH];
};

struct shape_solution {
    double a[MODEL_MODES]; /* coefficients of the modes; the others are 0 */
    double
        x[6]; /* motion of the points: a rotation (radians) about (0, 0, -POSE_LEVER_MM),
                    then a shift (mm) */
};

struct shape_prior {
    double a,
        x; /* strength of |a|^2; of |x|^2, in 1 / mm^2 with rotations at POSE_LEVER_MM */
    uint32_t modes; /* so many are fitted, or all; the others are 0 */
};

/* Prepares the modes of heights over a mean face (mm; NAN: the cell is not used) with its normals.
 * O(GRID_N modes^2). */
void shape_solve_prepare(const struct model_basis *modes, const float mean[GRID_N],
                         const float normal[GRID_N][3], struct shape_basis *out);

/* Solves for heights over[] above the mean face, with weights 0..1 (0: over[] is not looked at).
 * w->width is 0 before the first of several solutions.  With fewer than SHAPE_LEAST cells of
 * weight above 0 the solution is 0.  O(cells n + n^3 + changed n^2), where changed counts the
 * cells of other weight than in the solution before, or, if these are fewer, than 1 or 0. */
void shape_solve(const struct shape_basis *b, const float over[GRID_N],
                 const float weight[GRID_N], const struct shape_prior *prior,
                 struct shape_solve *w, struct shape_solution *out);

/* Sets the heights of used cells to the mean plus what the first n coefficients say. */
void shape_bend(const struct shape_basis *b, const float mean[GRID_N], const double *a,
                uint32_t n, float height[GRID_N]);

#endif
