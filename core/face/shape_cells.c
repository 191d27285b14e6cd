#include "shape_cells.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "solve.h"
#include "frame.h"
#include "grid.h"
#include "series.h"
#include "shape_cover.h"
#include "shape_detail.h"
#include "shape_work.h"

/* mm: the most that a cell adds to the residual. */
#define SHAPE_RESIDUAL_MM 5.0

/* Mean square below which a relief is rounding: the surface is a quadric. */
#define SHAPE_FLAT_MM2 1e-6

/* mm: the place round an eye, beside the nose; the share of it that must be skin before it is
 * compared with an eye.  Of 1,400 scans of faces, up to 45 % of some cut out, one in
 * 700 has less. */
#define SHAPE_EYE_LEFT   4
#define SHAPE_EYE_RIGHT  54
#define SHAPE_EYE_BOTTOM 10
#define SHAPE_EYE_TOP    54
#define SHAPE_EYE_LEAST  0.15

/* The mean square of what the best quadric leaves of z over n cells. */
static double relief(const float *z, const uint32_t *cell, uint32_t n)
{
    struct solve_normal sum;
    double x[6], zz = 0;

    memset(&sum, 0, sizeof sum);
    for (uint32_t i = 0; i < n; i++) {
        const double u = grid_x(cell[i]) / 64, v = grid_y(cell[i]) / 82;
        const double j[6] = {1, u, v, u * u, u * v, v * v}, h = (double)z[cell[i]];

        solve_add(&sum, j, h, 1);
        zz += h * h;
    }
    if (n < 6 || !solve_equations(&sum, 0, x))
        return 0;
    for (int k = 0; k < 6; k++)
        zz += sum.g[k] * x[k];
    return zz > 0 ? zz / n : 0;
}

/* How a surface of heights z and one of heights h are alike over n cells: the correlation of
 * what their best quadrics leave. */
static double correlation(const float *z, const float *h, const uint32_t *cell,
                          uint32_t n)
{
    struct solve_normal a, b;
    double x[6], y[6], zz = 0, zh = 0, hh = 0;

    memset(&a, 0, sizeof a);
    memset(&b, 0, sizeof b);
    for (uint32_t i = 0; i < n; i++) {
        const double u = grid_x(cell[i]) / 64, v = grid_y(cell[i]) / 82;
        const double j[6] = {1, u, v, u * u, u * v, v * v};
        const double p = (double)z[cell[i]], q = (double)h[cell[i]];

        solve_add(&a, j, p, 1);
        for (int k = 0; k < 6; k++)
            b.g[k] += j[k] * q;
        zz += p * p;
        zh += p * q;
        hh += q * q;
    }
    memcpy(b.h, a.h, sizeof b.h); /* of the same cells */
    if (!solve_equations(&a, 0, x) || !solve_equations(&b, 0, y))
        return -1;
    for (int k = 0; k < 6; k++) {
        zz += a.g[k] * x[k];
        zh += a.g[k] * y[k];
        hh += b.g[k] * y[k];
    }
    return zz > SHAPE_FLAT_MM2 * n && hh > 0 ? zh / sqrt(zz * hh) : 0;
}

/* The likeness round an eye, to the right or to the left of the nose (side -1). */
static double eye(const struct shape_work *w, const float *z, const uint8_t *cell,
                  double side)
{
    uint32_t list[GRID_N], n = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double x = side * grid_x(i), y = grid_y(i);

        if (isnan(w->mean[i]) || x < SHAPE_EYE_LEFT || x > SHAPE_EYE_RIGHT ||
            y < SHAPE_EYE_BOTTOM || y > SHAPE_EYE_TOP)
            continue;
        all++;
        if (cell[i] == SHAPE_SKIN)
            list[n++] = i;
    }
    return n < SHAPE_EYE_LEAST * all ? (double)NAN : correlation(z, w->mean, list, n);
}

/* The lesser of both; of one that is not seen nothing is known, if the other looks like an eye. */
static double eyes(const struct shape_work *w, const float *z, const uint8_t *cell)
{
    const double left = eye(w, z, cell, -1), right = eye(w, z, cell, 1);

    if (isnan(left) || isnan(right))
        return fmax(left, right) > 0 ? SHAPE_EYE_UNKNOWN : -1; /* of NAN and x: x */
    return fmin(left, right);
}

/* The likeness of the forehead to the fitted one. */
static double forehead(const struct shape_work *w, const float *z,
                       const struct shape_fit *f)
{
    uint32_t list[GRID_N], n = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(w->mean[i]) || grid_region_of(i) != SURFACE_FOREHEAD)
            continue;
        all++;
        if (f->cell[i] == SHAPE_SKIN)
            list[n++] = i;
    }
    return n < SHAPE_EYE_LEAST * all ? -1 : correlation(z, f->height, list, n);
}

static double detail(const struct shape_work *w, const float *z, const uint8_t *cell)
{
    float over[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        over[i] = cell[i] == SHAPE_SKIN || cell[i] == SHAPE_APART ? z[i] - w->mean[i]
                                                                  : (float)NAN;
    return shape_detail(w->fine, w->over_rest, over);
}

/* What is not explained of the face that no cover hides, mm^2: the gap, up to SHAPE_REST_MM, as
 * the mean of each cell and those around it, so that noise counts little; squared, in terms of
 * the cell's rest, and averaged. */
static double unexplained(const struct shape_work *w, const float *gap,
                          const uint8_t *cell)
{
    enum { WIDE = GRID_NX + 2 }; /* with a rim of no cells */
    const float most = (float)SHAPE_REST_MM;
    float in[(GRID_NY + 2) * WIDE] = {0.0f}, seen[(GRID_NY + 2) * WIDE] = {0.0f};
    float all = 0.0f;
    uint32_t n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t at = (i / GRID_NX + 1) * WIDE + i % GRID_NX + 1;

        if (cell[i] != SHAPE_SKIN && cell[i] != SHAPE_APART)
            continue;
        in[at] = gap[i] > most ? most : gap[i] < -most ? -most : gap[i];
        seen[at] = 1.0f;
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t at = i / GRID_NX * WIDE + i % GRID_NX;
        float sum = 0.0f, count = 0.0f;

        if (cell[i] != SHAPE_SKIN && cell[i] != SHAPE_APART)
            continue;
        for (uint32_t k = 0; k < 9; k++) {
            sum += in[at + k / 3 * WIDE + k % 3];
            count += seen[at + k / 3 * WIDE + k % 3];
        }
        sum *= w->over_rest[i] / count;
        all += sum * sum;
        n++;
    }
    return n > 0 ? (double)all / n : 0.0;
}

/* Skin, or what is not explained; how many cells are near the face, and behind it. */
static void classify(const struct shape_work *w, const float *gap, uint8_t *cell,
                     uint32_t *near, uint32_t *behind)
{
    *near = *behind = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float far = fabsf(gap[i]);

        cell[i] = SHAPE_EMPTY;
        if (isnan(far))
            continue;
        *near += far < (float)SHAPE_NEAR_MM;
        *behind += gap[i] < (float)-SHAPE_STRONG_MM;
        cell[i] = far < (float)SHAPE_STRONG_MM * w->scale[i] ? SHAPE_SKIN : SHAPE_APART;
    }
}

/* What covers the face is no noise of what is left of it. */
static double residual(const float *gap, const uint8_t *cell)
{
    double sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const float left = fminf(fabsf(gap[i]), (float)SHAPE_RESIDUAL_MM);

        if (isnan(gap[i]) || cell[i] == SHAPE_COVER)
            continue;
        sum += (double)left * (double)left;
        n++;
    }
    return n > 0 ? sqrt(sum / n) : 0;
}

void shape_cells_rate(const struct shape_work *w, const float over[GRID_N],
                      struct shape_fit *fit)
{
    float gap[GRID_N], *const z = fit->z;
    uint32_t skin[GRID_N], near, behind;
    double a = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        gap[i] = over[i] * w->normal[i][2];
        z[i] = fit->height[i] + over[i];
    }
    classify(w, gap, fit->cell, &near, &behind);
    shape_cover_mark(w, gap, z, fit->height, fit->cell);
    fit->residual_mm = residual(gap, fit->cell);
    fit->skin = fit->cover = fit->apart = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        fit->cover += fit->cell[i] == SHAPE_COVER;
        fit->apart += fit->cell[i] == SHAPE_APART;
        if (fit->cell[i] == SHAPE_SKIN)
            skin[fit->skin++] = i;
    }
    for (uint32_t k = 0; k < w->modes->n; k++)
        a += fit->a[k] * fit->a[k];
    fit->support = (near - 2.0 * behind - 4 * a) / w->cells;
    fit->eyes = eyes(w, z, fit->cell);
    fit->forehead = forehead(w, z, fit);
    fit->detail = detail(w, z, fit->cell);
    fit->likeness =
        0.5 * series_ln((relief(fit->height, skin, fit->skin) + SHAPE_RELIEF_MM2) /
                        (unexplained(w, gap, fit->cell) + SHAPE_REST_MM2));
}
