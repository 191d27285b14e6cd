/* minimal_solve.h -- the small motion that makes a weighted sum of |gap| least, where every
 * gap changes linearly with the motion. */
#ifndef CORE_MINIMAL_SOLVE_H
#define CORE_MINIMAL_SOLVE_H
#include <stdint.h>

/* Newton steps between two looks at the surfaces (2: 95.7 % of the non-mated pairs,
 * 3: 96.7, 4: 96.3), and how far one goes back. */
#define MINIMAL_NEWTON 3
#define MINIMAL_BACK   0.35

#define MINIMAL_LANES 4
typedef float minimal_lanes __attribute__((vector_size(4 * MINIMAL_LANES)));

/* Places of the surfaces.  The gap at place i after the motion x is
 *     gap[i] + by[0][i] x[0] + ... + by[4][i] x[4] + x[5]:
 * a turn by the vector x[0..2] (radians), then a shift (mm). */
struct minimal_places {
    float *gap, *by[5];
    float *weight; /* 0 or more */
    uint32_t n;    /* the arrays go on to a multiple of MINIMAL_LANES, with weight 0 */
};

/* minimal_mean(p): the weighted mean of |gap|, mm; 0 without weight. */
double minimal_mean(const struct minimal_places *p);

/* minimal_solve(p, mean, limit, x): Newton steps from no motion on the sum of weight |gap|,
 * |gap| rounded off below a small part of mean.  A step is at most limit (mm) long, where turns
 * count as arcs at POSE_LEVER_MM; after a step that made the sum larger the next one goes back.
 * mean  minimal_mean(p); more than 0
 * Returns the length of x, mm. */
double minimal_solve(const struct minimal_places *p, double mean, double limit,
                     double x[6]);

#endif
