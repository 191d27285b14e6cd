#include "mirror.h"

#include <stddef.h>

#include "cloudpoints.h"

/* So many normals must be known, or pixels, and so great a share of the normals must agree:
 * those of a mesh, or of a scanner, nearly all do.  By hand. */
#define MIRROR_LEAST 100
#define MIRROR_SHARE 0.9

/* How well rows and columns must explain where the points lie in the view.  By hand. */
#define MIRROR_IMAGE 0.7

/* What is known: 1 a mirror image, -1 none, 0 nothing. */
static int by_normals(const struct cloudpoints *c)
{
    size_t away = 0, known = 0;

    for (size_t i = 0; c->normal != NULL && i < c->n; i++) {
        const double z = c->normal[i].z;

        known += z != 0;
        away += z < 0;
    }
    if (known < MIRROR_LEAST)
        return 0;
    if ((double)away >= MIRROR_SHARE * (double)known)
        return 1;
    return (double)away <= (1 - MIRROR_SHARE) * (double)known ? -1 : 0;
}

/* Column, row, and x and y in the view. */
static void place_of(const struct cloudpoints *c, size_t i, double v[4])
{
    const uint32_t place = c->index != NULL ? c->index[i] : (uint32_t)i;

    v[0] = place % c->width;
    v[1] = place / c->width;
    v[2] = c->at[i].x;
    v[3] = c->at[i].y;
}

/* The linear map from (column, row) to (x, y) that fits best keeps the sense of rotation in a
 * mirror image alone, rows being counted downwards.  How well it fits: the product of the
 * squares of both canonical correlations (Hotelling 1936), 1 where the points are an image. */
static int by_order(const struct cloudpoints *c)
{
    double v[4], mean[4] = {0}, m[4][4] = {{0}}, cross;

    if (c->width == 0 || c->n < MIRROR_LEAST)
        return 0;
    for (size_t i = 0; i < c->n; i++) {
        place_of(c, i, v);
        for (int k = 0; k < 4; k++)
            mean[k] += v[k];
    }
    for (size_t i = 0; i < c->n; i++) {
        place_of(c, i, v);
        for (int k = 0; k < 4; k++)
            for (int l = 0; l < 4; l++)
                m[k][l] +=
                    (v[k] - mean[k] / (double)c->n) * (v[l] - mean[l] / (double)c->n);
    }
    cross = m[0][2] * m[1][3] - m[0][3] * m[1][2];
    if (!(cross * cross > MIRROR_IMAGE * (m[0][0] * m[1][1] - m[0][1] * m[0][1]) *
                              (m[2][2] * m[3][3] - m[2][3] * m[2][3])))
        return 0;
    return cross > 0 ? 1 : -1;
}

bool mirror_told(const struct cloudpoints *c)
{
    return by_normals(c) + by_order(c) > 0;
}
