/* arm.h -- in-circle tests that have points in common: seen from one of them, the others are
 * arms, and what two arms have to do with each other is computed once for several tests.
 * In 64 bits, for arms as short as between neighbours in a scan; predicates.h does the rest. */
#ifndef CORE_ARM_H
#define CORE_ARM_H
#include <stdint.h>
#include "vec.h"

struct arm {
    int64_t x, y, lift; /* lift: the square of its length */
};

/* arm_to(o, p): Returns the arm from o to p. */
static inline struct arm arm_to(struct ivec2 o, struct ivec2 p)
{
    const int64_t x = p.x - o.x, y = p.y - o.y;

    return (struct arm){x, y, x * x + y * y};
}

/* arm_cross(a, b): Returns twice the signed area of the triangle that two arms span. */
static inline int64_t arm_cross(const struct arm *a, const struct arm *b)
{
    return a->x * b->y - a->y * b->x;
}

/* Squared length from which on an arm is too long: below it (lattice units: 32 mm of a face)
 * each product is below 2^60, and 64 bits hold the sum. */
#define ARM_LONG (INT64_C(1) << 30)

/* arm_incircle(a, b, c, ab, bc, ca): Tests whether the circle through the origin and the
 * ends of a and b, in this order counter-clockwise, holds the end of c.  By the symmetry of
 * the test that is whether the circle through the ends of b, a and c, in this order
 * counter-clockwise, holds the origin.
 *   ab, bc, ca  arm_cross(a, b), and so on
 * Returns less than 0: it does; more than 0: it does not; 0: an arm is too long, or the point is on
 * the circle: incircle() decides. */
static inline int64_t arm_incircle(const struct arm *a, const struct arm *b,
                                   const struct arm *c, int64_t ab, int64_t bc,
                                   int64_t ca)
{
    const uint64_t det = (uint64_t)a->lift * (uint64_t)bc +
                         (uint64_t)b->lift * (uint64_t)ca +
                         (uint64_t)c->lift * (uint64_t)ab; /* wraps for long ones */

    if (__builtin_expect((a->lift | b->lift | c->lift) >= ARM_LONG, 0))
        return 0;
    return (int64_t)det;
}

#endif
