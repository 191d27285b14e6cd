#include "spread.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "eigen.h"
#include "lsq.h"

#define HALF_ROOT 0.70710678118654752 /* 1 / sqrt 2 */

enum status spread_new(uint32_t n, struct spread *out)
{
    out->n = n;
    for (int b = 0; b < 2; b++)
        out->block[b] = calloc((size_t)n * n + 1, sizeof *out->block[b]);
    if (out->block[0] != NULL && out->block[1] != NULL)
        return ST_OK;
    spread_free(out);
    return ST_ENOMEM;
}

void spread_free(struct spread *s)
{
    free(s->block[0]);
    free(s->block[1]);
    *s = (struct spread){0};
}

/* ---- samples and modes */

static double known(float gap)
{
    return isnan(gap) ? 0 : (double)gap;
}

void spread_split(const struct spread_cells *c, const float gap[GRID_N], double *part[2])
{
    for (uint32_t i = 0; i < c->n; i++) {
        const double a = known(gap[c->at[i]]), b = known(gap[grid_mirror(c->at[i])]);

        part[0][i] = (a + b) * HALF_ROOT;
        part[1][i] = (a - b) * HALF_ROOT;
    }
}

void spread_join(const struct spread_cells *c, bool odd, const double *pattern, double by,
                 float *out, uint32_t step)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        out[(size_t)i * step] = 0.0f;
    for (uint32_t i = 0; i < c->n; i++) {
        const float v = (float)(by * HALF_ROOT * pattern[i]);

        out[(size_t)c->at[i] * step] = v;
        out[(size_t)grid_mirror(c->at[i]) * step] = odd ? -v : v;
    }
}

/* ---- sums */

void spread_add_pattern(struct spread *s, bool odd, const double *x, double by)
{
    for (uint32_t i = 0; i < s->n; i++)
        eigen_add(s->block[odd] + (size_t)i * s->n, by * x[i], x, s->n);
}

void spread_add(struct spread *s, const struct spread *other, double by)
{
    for (uint32_t i = 0; i < s->n; i++)
        for (int b = 0; b < 2; b++)
            eigen_add(s->block[b] + (size_t)i * s->n, by,
                      other->block[b] + (size_t)i * s->n, s->n);
}

double spread_variance(const struct spread *s, uint32_t i)
{
    const size_t at = (size_t)i * s->n + i;

    return (s->block[0][at] + s->block[1][at]) / 2;
}

/* ---- directions that are removed */

/* x less what the k patterns before it have of it; to length 1. */
static void orthonormal(double *x, uint32_t k, uint32_t n)
{
    const double before = eigen_dot(x, x, n);
    double square;

    for (int twice = 0; twice < 2; twice++) /* the second time for rounding */
        for (uint32_t i = 1; i <= k; i++)
            eigen_add(x, -eigen_dot(x, x - (size_t)i * n, n), x - (size_t)i * n, n);
    square = eigen_dot(x, x, n);
    for (uint32_t i = 0; i < n; i++)
        x[i] = square > 1e-18 * before ? x[i] / sqrt(square) : 0;
}

/* (1 - q q') m (1 - q q').  t: [n] room. */
static void remove_one(double *m, const double *q, double *t, uint32_t n)
{
    double s;

    for (uint32_t i = 0; i < n; i++)
        t[i] = eigen_dot(m + (size_t)i * n, q, n);
    s = eigen_dot(q, t, n);
    for (uint32_t i = 0; i < n; i++) {
        double *row = m + (size_t)i * n;

        for (uint32_t k = 0; k < n; k++)
            row[k] -= t[i] * q[k] + q[i] * t[k] - s * (q[i] * q[k]);
    }
}

void spread_remove(struct spread *s, bool odd, double *x, uint32_t n)
{
    double t[GRID_N / 2];

    for (uint32_t k = 0; k < n; k++) {
        orthonormal(x + (size_t)k * s->n, k, s->n);
        remove_one(s->block[odd], x + (size_t)k * s->n, t, s->n);
    }
}

/* ---- the leading modes */

static int by_variance(const void *a, const void *b)
{
    const struct spread_mode *x = a, *y = b;

    if (x->variance > y->variance || x->variance < y->variance)
        return x->variance < y->variance ? 1 : -1;
    if (x->odd != y->odd)
        return x->odd - y->odd;
    return x->pattern < y->pattern ? -1 : 1; /* of one block: in its order */
}

enum status spread_lead(struct spread *s, uint32_t k, struct spread_mode *mode)
{
    const uint32_t n = s->n;
    double *value = calloc(n + (size_t)1, sizeof *value);
    struct spread_mode *all = calloc(2 * (size_t)n + 1, sizeof *all);
    double *own = calloc(k * (size_t)n + 1, sizeof *own);
    enum status st = value != NULL && all != NULL && own != NULL ? ST_OK : ST_ENOMEM;

    for (int b = 0; st == ST_OK && b < 2; b++) {
        st = eigen_symmetric(s->block[b], n, value);
        for (uint32_t i = 0; i < n; i++)
            all[(uint32_t)b * n + i] = (struct spread_mode){
                value[i] > 0 ? value[i] : 0, s->block[b] + (size_t)i * n, b == 1};
    }
    if (st == ST_OK && k > 2 * n)
        st = ST_EINVAL;
    if (st == ST_OK)
        qsort(all, 2 * (size_t)n, sizeof *all, by_variance);
    for (uint32_t i = 0; st == ST_OK && i < k; i++) {
        mode[i] = all[i];
        mode[i].pattern = own + (size_t)i * n;
        memcpy(mode[i].pattern, all[i].pattern, n * sizeof *own);
    }
    if (st != ST_OK)
        free(own);
    free(value);
    free(all);
    spread_free(s);
    return st;
}

/* ---- against noise */

/* m = L^-1 m. */
static void solve_rows(const double *l, double *m, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        double *row = m + (size_t)i * n;

        for (uint32_t k = 0; k < i; k++)
            eigen_add(row, -l[(size_t)i * n + k], m + (size_t)k * n, n);
        for (uint32_t k = 0; k < n; k++)
            row[k] /= l[(size_t)i * n + i];
    }
}

enum status spread_against(struct spread *s, struct spread *noise)
{
    for (int b = 0; b < 2; b++) {
        if (!lsq_factor(noise->block[b], s->n, s->n, s->n))
            return ST_EINVAL;
        eigen_transpose(noise->block[b], s->n); /* L by rows */
        solve_rows(noise->block[b], s->block[b], s->n);
        eigen_transpose(s->block[b], s->n);
        solve_rows(noise->block[b], s->block[b], s->n);
    }
    return ST_OK;
}

void spread_back(const struct spread *l, struct spread_mode *mode, uint32_t k)
{
    for (uint32_t j = 0; j < k; j++) {
        const double *m = l->block[mode[j].odd];
        double *x = mode[j].pattern;

        for (uint32_t i = l->n; i-- > 0;)
            x[i] = eigen_dot(m + (size_t)i * l->n, x, i + 1);
    }
}
