/* Normal equations: sums against a plain loop, factors against Cholesky's by definition and
 * against elimination; the same digits whatever the processor's vectors. */
#include "brute.h"
#include "dense.h"
#include "narrow.h"
#include "lsq.h"
#include "unit.h"

#define WIDTH  NORMAL_WIDTH
#define STRIDE (WIDTH + 8)

static struct draw rng;
static struct lsq_rows rows;

/* ---- sums */

static void fill(uint32_t width, uint32_t n)
{
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t k = 0; k < width; k++) {
            rows.row[j][k] = (float)draw_uniform(&rng, -0.5, 0.5);
            rows.times[j][k] = rows.row[j][k] * (float)(0.1 + j);
        }
    rows.n = n;
}

/* Each sum as a plain loop gives it, to the last digit: what is asked for, what may be written
 * besides, and nothing else. */
static void check_sums(uint32_t from, uint32_t to, uint32_t n)
{
    static float sum[WIDTH * STRIDE], before[WIDTH * STRIDE], narrow[WIDTH * STRIDE];

    for (size_t i = 0; i < WIDTH * STRIDE; i++)
        sum[i] = before[i] = narrow[i] = (float)draw_uniform(&rng, 0, 1);
    lsq_add(&rows, from, to, sum, STRIDE);
    assert_int_equal(rows.n, 0);
    rows.n = n;
    narrow_add(&rows, from, to, narrow, STRIDE);
    assert_memory_equal(sum, narrow, sizeof sum);
    for (uint32_t k = 0; k < WIDTH; k++)
        for (uint32_t l = 0; l < STRIDE; l++) {
            const bool asked = l >= from && l < to && k <= l;
            const bool may = l >= from && l < to && k / NORMAL_LANES <= l / NORMAL_LANES;
            float want = before[k * STRIDE + l];

            if (!may)
                assert_true(sum[k * STRIDE + l] == want);
            if (!asked)
                continue;
            for (uint32_t j = 0; j < n; j++)
                want += rows.times[j][k] * rows.row[j][l];
            assert_true(sum[k * STRIDE + l] == want);
        }
}

TEST(test_add)
{
    for (uint32_t width = NORMAL_LANES; width <= WIDTH; width += NORMAL_LANES) {
        const uint32_t n =
            width == WIDTH ? NORMAL_ROWS : (uint32_t)brute_int(&rng, 0, NORMAL_ROWS);

        fill(width, n);
        check_sums(0, width, n);
        fill(width, n);
        check_sums((uint32_t)brute_int(&rng, 0, (int32_t)(width / NORMAL_LANES)) *
                       NORMAL_LANES,
                   width, n);
    }
}

/* ---- products with a vector */

TEST(test_products)
{
    enum { ROWS = 37 };
    static float row[ROWS * STRIDE], by[STRIDE], got[STRIDE], narrow[STRIDE];

    for (uint32_t i = 0; i < ROWS * STRIDE; i++)
        row[i] = (float)draw_uniform(&rng, -0.5, 0.5);
    for (uint32_t width = NORMAL_LANES; width <= WIDTH; width += NORMAL_LANES) {
        for (uint32_t k = 0; k < STRIDE; k++) {
            by[k] = (float)draw_uniform(&rng, -0.5, 0.5);
            got[k] = narrow[k] = 7;
        }
        lsq_times(row, STRIDE, ROWS, by, width, got);
        narrow_times(row, STRIDE, ROWS, by, width, narrow);
        assert_memory_equal(got, narrow, sizeof got);
        for (uint32_t k = 0; k < STRIDE; k++) {
            float want = k < width ? 0 : 7;

            for (uint32_t i = 0; k < width && i < ROWS; i++)
                want += by[i] * row[i * STRIDE + k];
            assert_true(got[k] == want);
        }
        lsq_dot(row, STRIDE, ROWS, by, width, got);
        narrow_dot(row, STRIDE, ROWS, by, width, narrow);
        assert_memory_equal(got, narrow, sizeof got);
        for (uint32_t i = 0; i < ROWS; i++) {
            double want = 0;

            for (uint32_t k = 0; k < width; k++)
                want += (double)row[i * STRIDE + k] * (double)by[k];
            assert_true(fabs((double)got[i] - want) < 1e-5);
        }
    }
}

/* Row after row, to the last digit. */
TEST(test_add_rows)
{
    enum { MOST_ROWS = 20 };
    static double row[MOST_ROWS * STRIDE], by[MOST_ROWS], want[STRIDE], got[STRIDE],
        narrow[STRIDE];

    for (uint32_t round = 0; round < 40; round++) {
        const uint32_t n = round % MOST_ROWS, width = 90 + 3 * round;

        for (size_t i = 0; i < sizeof row / sizeof *row; i++)
            row[i] = draw_uniform(&rng, -1, 1);
        for (uint32_t k = 0; k < n; k++)
            by[k] = draw_uniform(&rng, -1, 1);
        for (uint32_t i = 0; i < STRIDE; i++) {
            got[i] = narrow[i] = want[i] = draw_uniform(&rng, -1, 1);
            for (uint32_t k = 0; k < n && i < width; k++)
                want[i] += by[k] * row[k * STRIDE + i];
        }
        lsq_add_rows(row, STRIDE, n, by, width, got);
        narrow_add_rows(row, STRIDE, n, by, width, narrow);
        assert_memory_equal(got, want, sizeof got);
        assert_memory_equal(narrow, want, sizeof narrow);
    }
}

/* ---- factors */

#define MOST 107 /* no multiple of a panel's columns */

static double m[MOST][MOST]; /* symmetric, positive definite */
static double h[MOST * STRIDE];

/* A matrix of n columns, h its lower triangle by columns, with rubbish elsewhere. */
static void draw(uint32_t n)
{
    static double g[MOST][MOST];

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++)
            g[i][k] = draw_uniform(&rng, -0.5, 0.5);
    for (uint32_t i = 0; i < MOST * STRIDE; i++)
        h[i] = 1e300;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k <= i; k++) {
            double sum = i == k ? 0.1 : 0;

            for (uint32_t j = 0; j < n; j++)
                sum += g[i][j] * g[k][j];
            m[i][k] = m[k][i] = sum;
            h[k * STRIDE + i] = sum;
        }
}

static void close_to(double got, double want)
{
    if (!(fabs(got - want) <= 1e-11 * (1 + fabs(want))))
        fail_msg("%.17g, wanted %.17g", got, want);
}

/* Cholesky's factor, by definition. */
static void plain_factor(uint32_t n, double l[MOST][MOST])
{
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = k; i < n; i++) {
            double sum = m[i][k];

            for (uint32_t j = 0; j < k; j++)
                sum -= l[i][j] * l[k][j];
            l[i][k] = i == k ? sqrt(sum) : sum / l[k][k];
        }
}

TEST(test_factor)
{
    static double l[MOST][MOST], narrow[MOST * STRIDE];

    for (uint32_t n = 1; n <= MOST; n += n < 20 ? 1 : 29) {
        draw(n);
        memcpy(narrow, h, sizeof h);
        assert_true(lsq_factor(h, STRIDE, n, n));
        assert_true(narrow_factor(narrow, STRIDE, n, n));
        plain_factor(n, l);
        for (uint32_t k = 0; k < n; k++)
            for (uint32_t i = 0; i < STRIDE; i++)
                if (i < k || i >= n)
                    assert_true(h[k * STRIDE + i] == 1e300); /* nobody's */
                else
                    close_to(h[k * STRIDE + i], l[i][k]);
        assert_memory_equal(h, narrow, sizeof h);
    }
}

/* What is left once the first `to` unknowns are eliminated: of the matrix, and of v. */
static void eliminated(uint32_t to, uint32_t n, const double *v, double s[MOST][MOST],
                       double *left)
{
    static double a[MOST * MOST], b[MOST * (MOST + 1)];
    const uint32_t columns = n - to + 1;

    for (uint32_t i = 0; i < to; i++) {
        for (uint32_t k = 0; k < to; k++)
            a[i * to + k] = m[i][k];
        for (uint32_t k = to; k < n; k++)
            b[i * columns + k - to] = m[i][k];
        b[i * columns + n - to] = v[i];
    }
    (void)dense_solve(a, to, b, columns);
    for (uint32_t i = to; i < n; i++) {
        left[i] = v[i];
        for (uint32_t j = 0; j < to; j++)
            left[i] -= m[i][j] * b[j * columns + n - to];
        for (uint32_t k = to; k < n; k++) {
            s[i][k] = m[i][k];
            for (uint32_t j = 0; j < to; j++)
                s[i][k] -= m[i][j] * b[j * columns + k - to];
        }
    }
}

/* A part of the columns leaves the Schur complement. */
TEST(test_partial)
{
    static double s[MOST][MOST];
    double v[MOST], left[MOST], x[MOST];

    for (uint32_t n = 1; n <= 60; n += n < 12 ? 1 : 7)
        for (uint32_t to = 0; to <= n; to += n < 12 ? 1 : 5) {
            draw(n);
            for (uint32_t i = 0; i < n; i++)
                x[i] = v[i] = draw_uniform(&rng, -0.5, 0.5);
            assert_true(lsq_factor(h, STRIDE, to, n));
            eliminated(to, n, v, s, left);
            for (uint32_t k = to; k < n; k++)
                for (uint32_t i = k; i < n; i++)
                    close_to(h[k * STRIDE + i], s[i][k]);
            lsq_forward(h, STRIDE, to, n, x);
            for (uint32_t i = to; i < n; i++)
                close_to(x[i], left[i]);
        }
}

TEST(test_solve)
{
    static double a[MOST * MOST];
    double v[MOST], x[MOST], y[MOST];

    for (uint32_t n = 1; n <= MOST; n += n < 20 ? 1 : 29) {
        double square = 0, want, unused;

        draw(n);
        for (uint32_t i = 0; i < n; i++)
            x[i] = y[i] = v[i] = draw_uniform(&rng, -0.5, 0.5);
        assert_true(lsq_factor(h, STRIDE, n, n));
        lsq_forward(h, STRIDE, n, n, x);
        for (uint32_t i = 0; i < n; i++)
            square += x[i] * x[i];
        lsq_backward(h, STRIDE, n, x);
        for (int twice = 0; twice < 2; twice++) {
            for (uint32_t i = 0; i < n; i++)
                for (uint32_t k = 0; k < n; k++)
                    a[i * n + k] = m[i][k];
            if (twice == 0)
                (void)dense_solve(a, n, y, 1);
        }
        want = dense_square(a, n, v, &unused);
        close_to(square, want);
        for (uint32_t i = 0; i < n; i++)
            if (!(fabs(x[i] - y[i]) < 1e-9))
                fail_msg("%u of %u: %.17g, wanted %.17g", i, n, x[i], y[i]);
    }
}

/* What is not positive definite is told at the column where it shows, wherever that is. */
TEST(test_indefinite)
{
    static const double bad[] = {-1e9, 0, 1e-10, (double)NAN, -(double)INFINITY};

    for (uint32_t n = 1; n < 14; n++)
        for (uint32_t at = 0; at < n; at++)
            for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
                draw(n);
                for (uint32_t i = 0; i < n; i++) /* only what others explain is added */
                    h[(i < at ? i : at) * STRIDE + (i < at ? at : i)] =
                        i == at ? bad[k] : 0;
                assert_false(lsq_factor(h, STRIDE, n, n));
                draw(n);
                for (uint32_t i = 0; i < n; i++)
                    h[(i < at ? i : at) * STRIDE + (i < at ? at : i)] =
                        i == at ? bad[k] : 0;
                assert_true(lsq_factor(h, STRIDE, at, n)); /* not looked at yet */
            }
}

BEFORE_ALL(set_up)
{
    rng.x = brute_seed("normal");
}
