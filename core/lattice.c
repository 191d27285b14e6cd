#include "lattice.h"

#include <math.h>

static enum status to_unit(double mm, double scale, int32_t *out)
{
    double u = mm * scale;

    if (!isfinite(mm))
        return ST_ENOTFINITE;
    if (!(fabs(u) <= (double)LATTICE_MAX))
        return ST_ERANGE;
    *out = (int32_t)rint(u); /* ties to even: the default rounding mode */
    return ST_OK;
}

enum status lattice_from_mm(const struct dvec3 *pts, size_t n, double scale,
                            struct ivec3 *out, size_t *bad)
{
    for (size_t i = 0; i < n; i++) {
        enum status st = to_unit(pts[i].x, scale, &out[i].x);

        if (st == ST_OK)
            st = to_unit(pts[i].y, scale, &out[i].y);
        if (st == ST_OK)
            st = to_unit(pts[i].z, scale, &out[i].z);
        if (st != ST_OK) {
            if (bad != NULL)
                *bad = i;
            return st;
        }
    }
    return ST_OK;
}
