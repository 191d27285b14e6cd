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

/* plane_solve(p, a, b, c): Sets *c to the height at the origin, *a and *b to the slopes.  Returns false if
 * there is no such plane: the points are too few or on a line. */
static inline bool plane_solve(const struct plane *p, double *a, double *b, double *c)
{
    const double xx = p->xx - p->x * p->x / p->n, xy = p->xy - p->x * p->y / p->n;
    const double yy = p->yy - p->y * p->y / p->n, xz = p->xz - p->x * p->z / p->n;
    const double yz = p->yz - p->y * p->z / p->n, det = xx * yy - xy * xy;

    if (!(det > 1e-9 * xx * yy))
        return false;
    *a = (xz * yy - yz * xy) / det;
    *b = (yz * xx - xz * xy) / det;
    *c = (p->z - *a * p->x - *b * p->y) / p->n;
    return true;
}

#endif
