#include "lsq.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* The loops that matter are compiled two or three times, for processors with wider vectors too.  A
 * lane does the same operations on the same numbers in each, and nothing is contracted: the
 * digits are the same. */
#if defined __x86_64__ && !defined NORMAL_NARROW
#define NORMAL_WIDE __attribute__((target("avx2")))
#ifdef __clang__
#define NORMAL_WIDER __attribute__((target("avx512f")))
#else
#define NORMAL_WIDER __attribute__((target("avx512f,prefer-vector-width=512")))
#endif
#endif
#define EITHER static inline __attribute__((always_inline))

#define TILE 4

typedef float lanes __attribute__((vector_size(4 * NORMAL_LANES)));
typedef float lanes2 __attribute__((vector_size(8 * NORMAL_LANES)));

/* sum[k..k+3][l..l+7] += the products of some rows, in a tile that stays in registers. */
EITHER void add_tile(const struct lsq_rows *r, uint32_t k, uint32_t l, float *sum,
                     uint32_t stride)
{
    lanes t[TILE];

    for (uint32_t i = 0; i < TILE; i++)
        memcpy(&t[i], &sum[(k + i) * stride + l], sizeof t[i]);
    for (uint32_t j = 0; j < r->n; j++) {
        const float *a = &r->times[j][k];
        lanes v;

        memcpy(&v, &r->row[j][l], sizeof v);
        for (uint32_t i = 0; i < TILE; i++)
            t[i] += a[i] * v;
    }
    for (uint32_t i = 0; i < TILE; i++)
        memcpy(&sum[(k + i) * stride + l], &t[i], sizeof t[i]);
}

/* sum[k..k+3][l..l+15] += the same products, of two tiles at once. */
EITHER void add_two_tiles(const struct lsq_rows *r, uint32_t k, uint32_t l, float *sum,
                          uint32_t stride)
{
    lanes2 t[TILE];

    for (uint32_t i = 0; i < TILE; i++)
        memcpy(&t[i], &sum[(k + i) * stride + l], sizeof t[i]);
    for (uint32_t j = 0; j < r->n; j++) {
        const float *a = &r->times[j][k];
        lanes2 v;

        memcpy(&v, &r->row[j][l], sizeof v);
        for (uint32_t i = 0; i < TILE; i++)
            t[i] += a[i] * v;
    }
    for (uint32_t i = 0; i < TILE; i++)
        memcpy(&sum[(k + i) * stride + l], &t[i], sizeof t[i]);
}

EITHER void add_all(const struct lsq_rows *r, uint32_t from, uint32_t to, float *sum,
                    uint32_t stride)
{
    for (uint32_t l = from; l < to; l += NORMAL_LANES)
        for (uint32_t k = 0; k < l + NORMAL_LANES; k += TILE)
            add_tile(r, k, l, sum, stride);
}

/* add_all() by pairs of tiles beside each other.  What only the right one of a pair has, beside
 * the diagonal, and a last column of tiles without a pair are added by themselves. */
EITHER void add_all_two(const struct lsq_rows *r, uint32_t from, uint32_t to, float *sum,
                        uint32_t stride)
{
    uint32_t l = from;

    for (; l + 2 * NORMAL_LANES <= to; l += 2 * NORMAL_LANES) {
        const uint32_t right = l + NORMAL_LANES;

        for (uint32_t k = 0; k < right; k += TILE)
            add_two_tiles(r, k, l, sum, stride);
        for (uint32_t k = right; k < right + NORMAL_LANES; k += TILE)
            add_tile(r, k, right, sum, stride);
    }
    add_all(r, l, to, sum, stride);
}

/* Columns at a time: what lies to their right is read and written once for all of them. */
#define PANEL 4

/* Columns from..to-1 of a panel, by themselves. */
static bool factor_panel(double *h, uint32_t stride, uint32_t from, uint32_t to,
                         uint32_t n)
{
    for (uint32_t k = from; k < to; k++) {
        double *col = h + k * stride, over;

        if (!(col[k] > 1e-9))
            return false;
        over = 1.0 / sqrt(col[k]);
        for (uint32_t i = k; i < n; i++)
            col[i] *= over;
        for (uint32_t j = k + 1; j < to; j++) {
            const double c = col[j];
            double *other = h + j * stride;

            for (uint32_t i = j; i < n; i++)
                other[i] -= c * col[i];
        }
    }
    return true;
}

/* Column j less what a whole panel explains of it. */
EITHER void reduce(const double *restrict panel, uint32_t stride, uint32_t j, uint32_t n,
                   double *restrict col)
{
    const double *a = panel, *b = a + stride, *c = b + stride, *d = c + stride;
    const double ja = a[j], jb = b[j], jc = c[j], jd = d[j];

    for (uint32_t i = j; i < n; i++)
        col[i] -= (ja * a[i] + jb * b[i]) + (jc * c[i] + jd * d[i]);
}

/* Column after column from `end` on less what the panel explains of it. */
EITHER void reduce_all(double *h, uint32_t stride, uint32_t panel, uint32_t n)
{
    for (uint32_t j = panel + PANEL; j < n; j++)
        reduce(h + panel * stride, stride, j, n, h + j * stride);
}

/* Columns l..l + 8 many - 1 of lsq_times(), in registers. */
EITHER void times_some(const float *row, uint32_t stride, uint32_t n, const float *by,
                       uint32_t l, uint32_t many, float *out)
{
    lanes t[TILE], v;

    memset(t, 0, sizeof t);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < many; k++) {
            memcpy(&v, row + (size_t)i * stride + l + NORMAL_LANES * k, sizeof v);
            t[k] += by[i] * v;
        }
    memcpy(out + l, t, many * sizeof v);
}

EITHER void times_all(const float *row, uint32_t stride, uint32_t n, const float *by,
                      uint32_t width, float *out)
{
    uint32_t l = 0;

    for (; l + TILE * NORMAL_LANES <= width; l += TILE * NORMAL_LANES)
        times_some(row, stride, n, by, l, TILE, out);
    if (l + 2 * NORMAL_LANES <= width) {
        times_some(row, stride, n, by, l, 2, out);
        l += 2 * NORMAL_LANES;
    }
    if (l < width)
        times_some(row, stride, n, by, l, 1, out);
}

EITHER void dot_all(const float *row, uint32_t stride, uint32_t n, const float *by,
                    uint32_t width, float *out)
{
    for (uint32_t i = 0; i < n; i++) {
        const float *r = row + (size_t)i * stride;
        lanes s, a, b;

        memset(&s, 0, sizeof s);
        for (uint32_t k = 0; k < width; k += NORMAL_LANES) {
            memcpy(&a, r + k, sizeof a);
            memcpy(&b, by + k, sizeof b);
            s += a * b;
        }
        out[i] = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
    }
}

/* Four rows at a time, so that `out` is read and written once for them. */
EITHER void add_rows_all(const double *row, uint32_t stride, uint32_t n, const double *by,
                         uint32_t width, double *restrict out)
{
    uint32_t k = 0;

    for (; k + PANEL <= n; k += PANEL) {
        const double *restrict a = row + (size_t)k * stride, *restrict b = a + stride,
                               *restrict c = b + stride, *restrict d = c + stride;

        for (uint32_t i = 0; i < width; i++)
            out[i] = out[i] + by[k] * a[i] + by[k + 1] * b[i] + by[k + 2] * c[i] +
                     by[k + 3] * d[i];
    }
    for (; k < n; k++)
        for (uint32_t i = 0; i < width; i++)
            out[i] += by[k] * row[(size_t)k * stride + i];
}

/* LSQ_EACH(name, wider, parameters, arguments): name_any() with these parameters runs name_all(), or on
 * processors with AVX-512 wider(), compiled for the processor's vectors. */
#ifdef NORMAL_WIDE
#define LSQ_EACH(name, wider, parameters, arguments)                                     \
    NORMAL_WIDE static void name##_wide parameters                                       \
    {                                                                                    \
        name##_all arguments;                                                            \
    }                                                                                    \
    NORMAL_WIDER static void name##_wider parameters                                     \
    {                                                                                    \
        wider arguments;                                                                 \
    }                                                                                    \
    static void name##_any parameters                                                    \
    {                                                                                    \
        if (__builtin_cpu_supports("avx512f"))                                           \
            name##_wider arguments;                                                      \
        else if (__builtin_cpu_supports("avx2"))                                         \
            name##_wide arguments;                                                       \
        else                                                                             \
            name##_all arguments;                                                        \
    }
#else
#define LSQ_EACH(name, wider, parameters, arguments)                                     \
    static void name##_any parameters                                                    \
    {                                                                                    \
        name##_all arguments;                                                            \
    }
#endif

LSQ_EACH(add, add_all_two,
         (const struct lsq_rows *r, uint32_t from, uint32_t to, float *sum,
          uint32_t stride),
         (r, from, to, sum, stride))
LSQ_EACH(reduce, reduce_all, (double *h, uint32_t stride, uint32_t panel, uint32_t n),
         (h, stride, panel, n))
LSQ_EACH(times, times_all,
         (const float *row, uint32_t stride, uint32_t n, const float *by, uint32_t width,
          float *out),
         (row, stride, n, by, width, out))
LSQ_EACH(dot, dot_all,
         (const float *row, uint32_t stride, uint32_t n, const float *by, uint32_t width,
          float *out),
         (row, stride, n, by, width, out))

LSQ_EACH(add_rows, add_rows_all,
         (const double *row, uint32_t stride, uint32_t n, const double *by,
          uint32_t width, double *out),
         (row, stride, n, by, width, out))

void lsq_add(struct lsq_rows *r, uint32_t from, uint32_t to, float *sum, uint32_t stride)
{
    if (r->n == 0)
        return;
    add_any(r, from, to, sum, stride);
    r->n = 0;
}

void lsq_times(const float *row, uint32_t stride, uint32_t n, const float *by,
               uint32_t width, float *out)
{
    times_any(row, stride, n, by, width, out);
}

void lsq_dot(const float *row, uint32_t stride, uint32_t n, const float *by,
             uint32_t width, float *out)
{
    dot_any(row, stride, n, by, width, out);
}

void lsq_add_rows(const double *row, uint32_t stride, uint32_t n, const double *by,
                  uint32_t width, double *out)
{
    add_rows_any(row, stride, n, by, width, out);
}

bool lsq_factor(double *h, uint32_t stride, uint32_t to, uint32_t n)
{
    for (uint32_t k = 0; k < to; k += PANEL) {
        const uint32_t end = k + PANEL <= to ? k + PANEL : to;

        if (!factor_panel(h, stride, k, end, n))
            return false;
        if (end == k + PANEL)
            reduce_any(h, stride, k, n);
        for (uint32_t p = k; p < end && end < k + PANEL; p++) /* the last columns */
            for (uint32_t j = end; j < n; j++)
                for (uint32_t i = j; i < n; i++)
                    h[j * stride + i] -= h[p * stride + j] * h[p * stride + i];
    }
    return true;
}

void lsq_forward(const double *h, uint32_t stride, uint32_t to, uint32_t n, double *v)
{
    for (uint32_t k = 0; k < to; k++) {
        const double *col = h + k * stride;

        v[k] /= col[k];
        for (uint32_t i = k + 1; i < n; i++)
            v[i] -= v[k] * col[i];
    }
}

void lsq_backward(const double *h, uint32_t stride, uint32_t n, double *v)
{
    for (uint32_t k = n; k-- > 0;) {
        const double *col = h + k * stride;
        double sum[4] = {0, 0, 0, 0}; /* one alone would wait for each addition */
        uint32_t i = k + 1;

        for (; i + 4 <= n; i += 4)
            for (uint32_t l = 0; l < 4; l++)
                sum[l] += v[i + l] * col[i + l];
        for (; i < n; i++)
            sum[0] += v[i] * col[i];
        v[k] = (v[k] - ((sum[0] + sum[1]) + (sum[2] + sum[3]))) / col[k];
    }
}
