/* plane.h -- the plane z = a x + b y + c through points, by least squares. */
#ifndef CORE_PLANE_H
#define CORE_PLANE_H
#include <stdbool.h>

/* The sums of the normal equations; all zero: no points. */
struct plane {
    double n, x, y, z, xx, xy, yy, xz, yz;
};

static inline void plane_add(struct plane *p, double x, double y, double z)
{
    p->n += 1;
    p->x += x;
    p->y += y;
    p->z += z;
    p->xx += x * x;
    p->xy += x * y;
    p->yy += y * y;
    p->xz += x * z;
    p->yz += y * z;
}

/* plane_solve(p, a, b, c): *c is the height at the origin, *a and *b are the slopes.  False:
 * there is no such plane, for the points are too few or on a line. */
bool plane_solve(const struct plane *p, double *a, double *b, double *c);

#endif
