/* predicates.h -- exact signs for points of the lattice.
 * With |coordinate| <= LATTICE_MAX = 2^24 a difference has at most 25 bits plus sign, so
 * orient2d (< 2^52) is exact in 64-bit integers and incircle (< 2^104) in 128.  No
 * floating-point filter comes first: on a 64-bit machine the exact determinant is a dozen
 * multiplications without a branch, about the cost of the filter. */
#ifndef CORE_PREDICATES_H
#define CORE_PREDICATES_H
#include <stdbool.h>
#include <stdint.h>
#include "vec.h"

__extension__ typedef __int128 predicates_i128;

/* orient2d(a, b, c): Returns twice the signed area of triangle abc in square lattice units:
 * > 0 counter-clockwise (c to the left of a->b), 0 on one line, < 0 clockwise. */
static inline int64_t orient2d(struct ivec2 a, struct ivec2 b, struct ivec2 c)
{
    return (int64_t)(b.x - a.x) * (c.y - a.y) - (int64_t)(b.y - a.y) * (c.x - a.x);
}

/* lex_less(a, b): Returns true if a is before b by x, then y. */
static inline bool lex_less(struct ivec2 a, struct ivec2 b)
{
    return a.x != b.x ? a.x < b.x : a.y < b.y;
}

/* incircle_det(a, b, c, d): Returns the determinant whose sign tells the place of d relative to the
 * circle through the counter-clockwise triangle abc: > 0 inside, 0 on it, < 0 outside. */
static inline predicates_i128 incircle_det(struct ivec2 a, struct ivec2 b, struct ivec2 c,
                                           struct ivec2 d)
{
    int64_t ax = a.x - d.x, ay = a.y - d.y;
    int64_t bx = b.x - d.x, by = b.y - d.y;
    int64_t cx = c.x - d.x, cy = c.y - d.y;
    int64_t bc = bx * cy - by * cx;
    int64_t ca = cx * ay - cy * ax;
    int64_t ab = ax * by - ay * bx;

    return (predicates_i128)(ax * ax + ay * ay) * bc +
           (predicates_i128)(bx * bx + by * by) * ca +
           (predicates_i128)(cx * cx + cy * cy) * ab;
}

/* incircle_tie(a, b, c, d): Returns incircle() if the determinant is 0. */
bool incircle_tie(struct ivec2 a, struct ivec2 b, struct ivec2 c, struct ivec2 d);

/* incircle(a, b, c, d): Returns true if d lies inside the circle through the counter-clockwise
 * triangle abc.  Cocircular points are decided by symbolic perturbation: the lift x^2 + y^2
 * of each point is lowered by an infinitesimal: of the first point by x, then y, by far the
 * most, and so on.  So cocircular points have one triangulation in any order: the fan from
 * the lexicographically first.
 * False if d is a, b or c.  Precondition: abc counter-clockwise. */
static inline bool incircle(struct ivec2 a, struct ivec2 b, struct ivec2 c,
                            struct ivec2 d)
{
    predicates_i128 det = incircle_det(a, b, c, d);

    if (__builtin_expect(det != 0, 1))
        return det > 0;
    return incircle_tie(a, b, c, d);
}

#endif
