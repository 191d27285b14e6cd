#include "plane.h"

bool plane_solve(const struct plane *p, double *a, double *b, double *c)
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
