/* minimal_solve.h -- the small motion that minimises a weighted sum of |gap|, if every
 * gap changes linearly with the motion. */
#ifndef CORE_MINIMAL_SOLVE_H
#define CORE_MINIMAL_SOLVE_H
#include <stdint.h>

/* The share of a step that is tried after a step that was too long. */
#define MINIMAL_BACK 0.35

#define MINIMAL_LANES 4
typedef float minimal_lanes __attribute__((vector_size(4 * MINIMAL_LANES)));

/* Sample points of the surfaces.  The gap at point i after the motion x is
 *     gap[i] + by[0][i] x[0] + ... + by[4][i] x[4] + x[5]:
 * a rotation by the vector x[0..2] (radians), then a shift (mm). */
struct minimal_places {
    float *gap, *by[5];
    float *weight; /* 0 or more */
    uint32_t
        n; /* number of points; the arrays continue to a multiple of MINIMAL_LANES, with weight 0 */
};

/* minimal_mean(p): Returns the weighted mean of |gap|, mm; 0 without weight. */
double minimal_mean(const struct minimal_places *p);

/* minimal_solve(p, mean, limit, x): Makes Newton steps from no motion on the sum of weight |gap|,
 * with |gap| rounded off below a small part of mean.  After a step that made the sum larger the
 * next one goes back.
 *   mean   minimal_mean(p); more than 0
 *   limit  longest step, mm; rotations count as arcs at POSE_LEVER_MM
 *   x      receives the motion
 * Returns the length of x, mm. */
double minimal_solve(const struct minimal_places *p, double mean, double limit,
                     double x[6]);

#endif
