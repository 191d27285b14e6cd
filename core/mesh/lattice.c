#include "lattice.h"

#include <math.h>
#include <stdbool.h>

/* Why x cannot be put on the lattice; ST_OK: it can. */
static enum status fault(double mm, double scale)
{
    if (!isfinite(mm))
        return ST_ENOTFINITE;
    return fabs(mm * scale) <= (double)LATTICE_MAX ? ST_OK : ST_ERANGE;
}

/* The fault of the first bad point. */
static enum status first_bad(const struct dvec3 *pts, size_t n, double scale, size_t *bad)
{
    enum status st = ST_OK;
    size_t i;

    for (i = 0; i < n && st == ST_OK; i++) {
        st = fault(pts[i].x, scale);
        if (st == ST_OK)
            st = fault(pts[i].y, scale);
        if (st == ST_OK)
            st = fault(pts[i].z, scale);
    }
    if (st != ST_OK && bad != NULL)
        *bad = i - 1;
    return st;
}

enum status lattice_from_mm(const struct dvec3 *pts, size_t n, double scale,
                            struct ivec3 *out, size_t *bad)
{
    const double limit = LATTICE_MAX;
    bool good = true;

    /* Without a branch; what is put out for a bad coordinate does not matter. */
    for (size_t i = 0; i < n; i++) {
        const double x = pts[i].x * scale, y = pts[i].y * scale, z = pts[i].z * scale;

        good &= (fabs(x) <= limit) & (fabs(y) <= limit) & (fabs(z) <= limit);
        /* ties to even: the default rounding mode */
        out[i] = (struct ivec3){(int32_t)lrint(x), (int32_t)lrint(y), (int32_t)lrint(z)};
    }
    return good ? ST_OK : first_bad(pts, n, scale, bad);
}
