#include "learn.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cells.h"
#include "fit.h"
#include "mem.h"

#define EM_ROUNDS  3
#define ITERATIONS 12   /* of orthogonal iteration, in each round */
#define LEAST_REST 0.02 /* mm: the least deviation of a cell */
#define NO_MOTION  1e12 /* fit_solve()'s tie: nothing is explained as motion */

void learn_sample(const struct cells *c, float *out)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        out[i] = c->area[i] >= LEARN_COVERED ? c->gap[i] : (float)NAN;
}

/* ---- the leading part of a covariance */

/* In four partial sums, which the processor adds in parallel. */
static double dot(const double *a, const double *b)
{
    double s[4] = {0, 0, 0, 0};

    for (uint32_t i = 0; i < GRID_N; i += 4)
        for (uint32_t k = 0; k < 4; k++)
            s[k] += a[i + k] * b[i + k];
    return (s[0] + s[2]) + (s[1] + s[3]);
}

static void subtract(double *a, double s, const double *b)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        a[i] -= s * b[i];
}

static void scale(double *a, double s)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        a[i] *= s;
}

static double over(double x)
{
    return x > 0 ? 1 / x : 0;
}

/* Gram-Schmidt; a row that depends on those before it becomes 0. */
static void orthonormal(double *v, uint32_t k)
{
    for (uint32_t i = 0; i < k; i++) {
        double *a = v + (size_t)i * GRID_N, before = dot(a, a), after;

        for (uint32_t j = 0; j < i; j++)
            subtract(a, dot(a, v + (size_t)j * GRID_N), v + (size_t)j * GRID_N);
        after = dot(a, a);
        scale(a, after > 1e-18 * before ? over(sqrt(after)) : 0);
    }
}

/* Multiplies each of k rows by a covariance. */
typedef void times(const void *arg, const double *v, uint32_t k, double *out);

/* leading(apply, arg, k, v, l): l^T l becomes the leading part, of rank k, of the
 * covariance C: with V an orthonormal basis of the subspace found by orthogonal iteration,
 * l = R^-1 V C, R R^T = V C V^T (Nystrom).  v is room for k rows. */
static void leading(times *apply, const void *arg, uint32_t k, double *v, double *l)
{
    double r[MODEL_MODES];

    for (uint32_t i = 0; i < k; i++) /* a fixed start: a hash of row and column */
        for (uint32_t c = 0; c < GRID_N; c++)
            v[(size_t)i * GRID_N + c] =
                (double)((((i + 1) * 2654435761u) ^ (c * 40503u)) * 2246822519u >> 8) /
                    8388608.0 -
                1;
    for (int i = 0; i < ITERATIONS; i++) {
        apply(arg, v, k, l);
        memcpy(v, l, (size_t)k * GRID_N * sizeof *v);
        orthonormal(v, k);
    }
    apply(arg, v, k, l);
    for (uint32_t i = 0; i < k; i++) {
        double *row = l + (size_t)i * GRID_N;
        const double *own = v + (size_t)i * GRID_N;
        double square = dot(own, row);

        /* row j of l, times own, is what Cholesky's R has in row i, column j */
        for (uint32_t j = 0; j < i; j++) {
            r[j] = dot(own, l + (size_t)j * GRID_N);
            square -= r[j] * r[j];
        }
        for (uint32_t j = 0; j < i; j++)
            subtract(row, r[j], l + (size_t)j * GRID_N);
        scale(row, square > 0 ? over(sqrt(square)) : 0);
    }
}

/* ---- modes */

struct samples {
    float *x; /* [n][GRID_N] filled */
    size_t n;
    double *sum; /* GRID_N of scratch */
};

static void samples_times(const void *arg, const double *v, uint32_t k, double *out)
{
    const struct samples *s = arg;

    memset(out, 0, (size_t)k * GRID_N * sizeof *out);
    for (size_t i = 0; i < s->n; i++) {
        for (uint32_t c = 0; c < GRID_N; c++)
            s->sum[c] = (double)s->x[i * GRID_N + c];
        for (uint32_t j = 0; j < k; j++)
            subtract(out + (size_t)j * GRID_N, -dot(s->sum, v + (size_t)j * GRID_N),
                     s->sum);
    }
    for (uint32_t j = 0; j < k; j++)
        scale(out + (size_t)j * GRID_N, 1 / (double)s->n);
}

/* One sample, or its mirror image, clipped; cells that are not used are NAN. */
static void clip(const float *gap, bool mirror, float most, const bool *used, float *out)
{
    for (uint32_t c = 0; c < GRID_N; c++) {
        const float g = gap[mirror ? grid_mirror(c) : c];

        out[c] = used[c] ? fminf(fmaxf(g, -most), most) : (float)NAN;
        if (isnan(g))
            out[c] = (float)NAN;
    }
}

/* Fill in the missing cells of a sample by fitting p to the others; add the squares of the
 * others' rest to square and their number to count. */
static enum status fill(float *x, const struct fit_basis *p, struct scratch *s,
                        double *square, double *count)
{
    struct cells cells;
    struct fit fit;
    enum status st;

    memset(&cells, 0, sizeof cells);
    for (uint32_t c = 0; c < GRID_N; c++) {
        cells.normal[c][2] = 1.0f;
        if (!isnan(x[c])) {
            cells.area[c] = (float)(GRID_MM * GRID_MM);
            cells.gap[c] = x[c];
        }
    }
    if ((st = fit_solve(p, &cells, NO_MOTION, 0, s, &fit)) != ST_OK)
        return st;
    for (uint32_t c = 0; c < GRID_N; c++) {
        if (!isnan(x[c])) {
            square[c] += (double)fit.rest[c] * (double)fit.rest[c];
            count[c] += 1;
            continue;
        }
        x[c] = 0.0f;
        for (uint32_t k = 0; k < p->b->n; k++)
            x[c] += (float)fit.a[k] * p->b->mode[c][k];
    }
    return ST_OK;
}

struct modes_work {
    struct samples s;
    struct fit_basis basis;
    struct scratch fit;
    double *v, *l, square[GRID_N], count[GRID_N];
    bool used[GRID_N];
    float most; /* mm */
};

/* Fill in all samples from gap by b (with 0 while it has no modes), and update b->rest. */
static enum status fill_all(struct modes_work *w, const float *gap, size_t n,
                            struct model_basis *b)
{
    fit_prepare(b, &w->basis);
    memset(w->square, 0, sizeof w->square);
    memset(w->count, 0, sizeof w->count);
    for (size_t i = 0; i < 2 * n; i++) {
        float *x = w->s.x + i * GRID_N;
        enum status st;

        clip(gap + i / 2 * GRID_N, i % 2 == 1, w->most, w->used, x);
        if ((st = fill(x, &w->basis, &w->fit, w->square, w->count)) != ST_OK)
            return st;
    }
    for (uint32_t c = 0; c < GRID_N; c++)
        b->rest[c] = w->used[c] && w->count[c] > 0
                         ? (float)fmax(sqrt(w->square[c] / w->count[c]), LEAST_REST)
                         : 0.0f;
    return ST_OK;
}

enum status learn_modes(const float *gap, size_t n, uint32_t k, double most,
                        struct model_basis *out)
{
    const size_t rows = (size_t)k * GRID_N;
    struct modes_work *w;
    enum status st = ST_ENOMEM;

    memset(out, 0, sizeof *out);
    if (k > MODEL_MODES || n < 2 * (size_t)k || n == 0)
        return ST_EINVAL;
    if ((w = mem_array(1, sizeof *w)) == NULL)
        return ST_ENOMEM;
    memset(w, 0, sizeof *w);
    w->most = (float)most;
    w->s = (struct samples){mem_array(2 * n * GRID_N, sizeof(float)), 2 * n,
                            mem_array(GRID_N, sizeof(double))};
    w->v = mem_array(rows, sizeof *w->v);
    w->l = mem_array(rows, sizeof *w->l);
    if (w->s.x == NULL || w->s.sum == NULL || w->v == NULL || w->l == NULL)
        goto out;
    for (uint32_t c = 0; c < GRID_N; c++) {
        size_t seen = 0;

        for (size_t i = 0; i < n; i++)
            seen += (size_t)!isnan(gap[i * GRID_N + c]) +
                    (size_t)!isnan(gap[i * GRID_N + grid_mirror(c)]);
        w->used[c] = (double)seen >= LEARN_MIN_SHARE * 2 * (double)n;
        out->rest[c] = w->used[c] ? 1.0f : 0.0f;
    }
    for (int round = 0; round <= EM_ROUNDS; round++) {
        if ((st = fill_all(w, gap, n, out)) != ST_OK || round == EM_ROUNDS)
            goto out;
        leading(samples_times, &w->s, k, w->v, w->l);
        out->n = k;
        for (uint32_t c = 0; c < GRID_N; c++)
            for (uint32_t i = 0; i < k; i++)
                out->mode[c][i] = w->used[c] ? (float)w->l[(size_t)i * GRID_N + c] : 0.0f;
    }
out:
    mem_free(w->s.x);
    mem_free(w->s.sum);
    mem_free(w->v);
    mem_free(w->l);
    scratch_free(&w->fit);
    mem_free(w);
    return st;
}

/* ---- smoothing over the grid */

/* blur(in, sigma_mm, out): the sums of in over all cells, weighted by exp(-d^2 / 2 sigma^2):
 * along x, then along y. */
static void blur(const double *in, double sigma_mm, double *out)
{
    double kernel[GRID_NY], row[GRID_N];

    for (int d = 0; d < GRID_NY; d++)
        kernel[d] = exp(-0.5 * (d * GRID_MM / sigma_mm) * (d * GRID_MM / sigma_mm));
    for (int y = 0; y < GRID_NY; y++)
        for (int x = 0; x < GRID_NX; x++) {
            double s = 0;

            for (int i = 0; i < GRID_NX; i++)
                s += kernel[abs(i - x)] * in[y * GRID_NX + i];
            row[y * GRID_NX + x] = s;
        }
    for (int y = 0; y < GRID_NY; y++)
        for (int x = 0; x < GRID_NX; x++) {
            double s = 0;

            for (int j = 0; j < GRID_NY; j++)
                s += kernel[abs(j - y)] * row[j * GRID_NX + x];
            out[y * GRID_NX + x] = s;
        }
}

/* smooth(b, v, sigma_mm): v becomes its weighted mean over b's cells near by, and
 * symmetric; 0 elsewhere. */
static void smooth(const struct model_basis *b, double *v, double sigma_mm)
{
    double in[GRID_N], there[GRID_N], sum[GRID_N], count[GRID_N];

    for (uint32_t c = 0; c < GRID_N; c++) {
        there[c] = b->rest[c] > 0.0f ? 1 : 0;
        in[c] = there[c] * v[c];
    }
    blur(in, sigma_mm, sum);
    blur(there, sigma_mm, count);
    for (uint32_t c = 0; c < GRID_N; c++) {
        const uint32_t m = grid_mirror(c);

        v[c] = there[c] * (sum[c] + sum[m]) / (count[c] + count[m]);
    }
}

struct kernel {
    double amplitude[GRID_N], length_mm;
};

static void kernel_times(const void *arg, const double *v, uint32_t k, double *out)
{
    const struct kernel *q = arg;
    double in[GRID_N];

    for (uint32_t i = 0; i < k; i++) {
        double *o = out + (size_t)i * GRID_N;

        for (uint32_t c = 0; c < GRID_N; c++)
            in[c] = q->amplitude[c] * v[(size_t)i * GRID_N + c];
        blur(in, q->length_mm, o);
        for (uint32_t c = 0; c < GRID_N; c++)
            o[c] *= q->amplitude[c];
    }
}

enum status learn_smooth(struct model_basis *b, double length_mm, double share,
                         uint32_t k)
{
    struct kernel q = {.length_mm = length_mm};
    double *v, *l;

    if (k > MODEL_MODES - b->n)
        return ST_EINVAL;
    v = mem_array((size_t)k * GRID_N, sizeof *v);
    l = mem_array((size_t)k * GRID_N, sizeof *l);
    if (v == NULL || l == NULL) {
        mem_free(v);
        mem_free(l);
        return ST_ENOMEM;
    }
    for (uint32_t c = 0; c < GRID_N; c++) {
        double s = 0;

        for (uint32_t i = 0; i < b->n; i++)
            s += (double)b->mode[c][i] * (double)b->mode[c][i];
        q.amplitude[c] = share * sqrt(s);
    }
    smooth(b, q.amplitude, 2 * GRID_MM);
    leading(kernel_times, &q, k, v, l);
    for (uint32_t c = 0; c < GRID_N; c++)
        for (uint32_t i = 0; i < k; i++)
            b->mode[c][b->n + i] = (float)l[(size_t)i * GRID_N + c];
    b->n += k;
    mem_free(v);
    mem_free(l);
    return ST_OK;
}

/* ---- weights */

#define DESCENTS  400
#define RIDGE     1e-3
#define INTERCEPT 10.0 /* its feature: large, so that it converges with the weights */
#define RIGID_MM  0.6

double learn_rigid(uint32_t cell)
{
    double a = 0, whole = 0;

    for (uint32_t c = 0; c < GRID_N; c++) {
        const double x = fabs(grid_x(c)), y = grid_y(c);
        const double dx = grid_x(c) - grid_x(cell), dy = y - grid_y(cell);
        const double w = exp(-(dx * dx + dy * dy) / (2 * 8.0 * 8.0));
        double mm = 1.2; /* that expressions move the cheeks; below, other places */

        if (y <= -14)
            mm = 1.5; /* mouth and jaw */
        if (y > 12 && y < 30)
            mm = 0.4; /* orbits */
        if (y >= 30)
            mm = 0.7; /* brows and forehead */
        if (x < 17 && y > -12 && y < 30)
            mm = 0.15; /* nose */
        if (x < 9 && y >= 30)
            mm = 0.5; /* glabella */
        if (y > 56)
            mm = 0.4; /* upper forehead */
        a += w * mm;
        whole += w;
    }
    a /= whole * RIGID_MM;
    a = 1 / (1 + a * a);
    return a * sqrt(a); /* between its first and second power: docs/accuracy.md */
}

/* The regression: features are the capped rest of each cell, a missing one the mean of the
 * others, and the intercept last. */
struct regression {
    float *x; /* [n][GRID_N] */
    const uint8_t *genuine;
    size_t n, kind[2];
    double u[GRID_N + 1], ahead[GRID_N + 1], gradient[GRID_N + 1];
};

static void features(struct regression *q, const float *rest, const struct model *m)
{
    for (size_t i = 0; i < q->n; i++) {
        float *x = q->x + i * GRID_N, mean = 0.0f;
        uint32_t seen = 0;

        for (uint32_t c = 0; c < GRID_N; c++) {
            const float r = fabsf(rest[i * GRID_N + c]);

            x[c] = m->change.rest[c] > 0.0f ? fminf(r, m->cap_mm) : 0.0f;
            if (isnan(r))
                x[c] = m->change.rest[c] > 0.0f ? (float)NAN : 0.0f;
            if (m->change.rest[c] > 0.0f && !isnan(r)) {
                mean += x[c];
                seen++;
            }
        }
        mean = seen > 0 ? mean / (float)seen : 0.0f;
        for (uint32_t c = 0; c < GRID_N; c++)
            x[c] = isnan(x[c]) ? mean : x[c];
    }
}

/* The gradient at q->ahead; returns the largest curvature that the loss can have. */
static double descend(struct regression *q)
{
    double curvature = 0, x[GRID_N];

    for (uint32_t c = 0; c <= GRID_N; c++)
        q->gradient[c] = 2 * RIDGE * (c < GRID_N ? q->ahead[c] : 0);
    for (size_t i = 0; i < q->n; i++) {
        const double sign = q->genuine[i] ? 1 : -1;
        const double share = 0.5 / (double)q->kind[q->genuine[i] != 0];
        double z, pull;

        for (uint32_t c = 0; c < GRID_N; c++)
            x[c] = (double)q->x[i * GRID_N + c];
        /* the log odds of one person */
        z = sign * (INTERCEPT * q->ahead[GRID_N] - dot(x, q->ahead));
        pull = -sign * share / (1 + exp(z < 500 ? z : 500));
        subtract(q->gradient, pull, x); /* d z / d u = -x */
        q->gradient[GRID_N] += pull * INTERCEPT;
        curvature += 0.25 * share * (dot(x, x) + INTERCEPT * INTERCEPT);
    }
    return curvature + 2 * RIDGE;
}

/* Projected gradient steps with Nesterov's momentum. */
static void regress(struct regression *q)
{
    double t = 1;

    for (int i = 0; i < DESCENTS; i++) {
        const double step = 1 / descend(q);
        const double next = 0.5 * (1 + sqrt(1 + 4 * t * t)), momentum = (t - 1) / next;

        for (uint32_t c = 0; c <= GRID_N; c++) {
            const double u = q->ahead[c] - step * q->gradient[c];
            const double kept = u > 0 || c == GRID_N ? u : 0;

            q->ahead[c] = kept + momentum * (kept - q->u[c]);
            q->u[c] = kept;
        }
        t = next;
    }
}

enum status learn_weight(const float *rest, const uint8_t *genuine, size_t n,
                         const struct model *m, float *weight)
{
    struct regression *q = mem_array(1, sizeof *q);
    double sum = 0;
    uint32_t cells = 0;
    enum status st = ST_ENOMEM;

    if (q == NULL)
        return ST_ENOMEM;
    memset(q, 0, sizeof *q);
    q->genuine = genuine;
    q->n = n;
    for (size_t i = 0; i < n; i++)
        q->kind[genuine[i] != 0]++;
    if (q->kind[0] == 0 || q->kind[1] == 0) {
        st = ST_EINVAL;
        goto out;
    }
    if ((q->x = mem_array(n * GRID_N, sizeof *q->x)) == NULL)
        goto out;
    features(q, rest, m);
    regress(q);
    smooth(&m->change, q->u, GRID_MM);
    for (uint32_t c = 0; c < GRID_N; c++) {
        q->u[c] *= learn_rigid(c);
        sum += q->u[c];
        cells += q->u[c] > 0;
    }
    st = sum > 0 ? ST_OK : ST_EINVAL;
    for (uint32_t c = 0; c < GRID_N && st == ST_OK; c++)
        weight[c] = (float)(q->u[c] * cells / sum);
out:
    if (q != NULL)
        mem_free(q->x);
    mem_free(q);
    return st;
}

/* ---- a sample as cells again */

/* The mean face's slope at a cell, along step: from the neighbours that are there. */
static double slope(const float *z, uint32_t c, bool before, bool after, uint32_t step)
{
    const double here = (double)z[c];
    const double a = before ? (double)z[c - step] : (double)NAN;
    const double b = after ? (double)z[c + step] : (double)NAN;

    if (isnan(here) || (isnan(a) && isnan(b)))
        return 0;
    if (isnan(a))
        return (b - here) / GRID_MM;
    if (isnan(b))
        return (here - a) / GRID_MM;
    return (b - a) / (2 * GRID_MM);
}

void learn_cells(const float *sample, const struct model *m, struct cells *out)
{
    memset(out, 0, sizeof *out);
    for (uint32_t c = 0; c < GRID_N; c++) {
        const uint32_t x = c % GRID_NX, y = c / GRID_NX;

        out->z[c] = isnan(m->mean[c]) ? 0.0f : m->mean[c];
        out->normal[c][0] = (float)-slope(m->mean, c, x > 0, x + 1 < GRID_NX, 1);
        out->normal[c][1] = (float)-slope(m->mean, c, y > 0, y + 1 < GRID_NY, GRID_NX);
        out->normal[c][2] = 1.0f;
        if (isnan(sample[c]))
            continue;
        out->area[c] = (float)(GRID_MM * GRID_MM);
        out->gap[c] = sample[c];
    }
}
