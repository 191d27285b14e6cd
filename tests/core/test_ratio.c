/* The score against Gaussian densities computed by definition; its mean, its slopes, its
 * logarithm; what is no encoding never matches. */

#include "brute.h"
#include "dense.h"
#include "ratio.h"
#include "unit.h"

#define MOST MODEL_MODES

static struct draw rng;
static struct scratch scratch;
static struct encoding tmpl, probe;

/* ---- encodings */

/* A of n modes, well conditioned, its mean on the diagonal `size`; as floats have it. */
static void draw_a(uint32_t n, double size, struct encoding *e)
{
    static double g[MOST][MOST];
    float *a = e->a;

    memset(e, 0, sizeof *e);
    e->n = n;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++)
            g[i][k] = draw_normal(&rng) / sqrt(n);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k <= i; k++) {
            double sum = i == k ? 0.5 : 0;

            for (uint32_t j = 0; j < n; j++)
                sum += 0.5 * g[i][j] * g[k][j];
            *a++ = (float)(size * sum);
        }
}

static double a_at(const struct encoding *e, uint32_t i, uint32_t k)
{
    const uint32_t row = i > k ? i : k, column = i > k ? k : i;

    return (double)e->a[row * (row + 1) / 2 + column];
}

/* b of a scan of a person of identity y: A y, and noise of covariance A. */
static void draw_b(const double *y, struct encoding *e)
{
    static double l[MOST][MOST];
    double x[MOST];

    for (uint32_t i = 0; i < e->n; i++)
        for (uint32_t k = 0; k <= i; k++) {
            double sum = a_at(e, i, k);

            for (uint32_t j = 0; j < k; j++)
                sum -= l[i][j] * l[k][j];
            l[i][k] = i == k ? sqrt(sum) : sum / l[k][k];
        }
    for (uint32_t i = 0; i < e->n; i++)
        x[i] = draw_normal(&rng);
    for (uint32_t i = 0; i < e->n; i++) {
        double sum = 0;

        for (uint32_t k = 0; k < e->n; k++)
            sum += a_at(e, i, k) * y[k] + (k <= i ? l[i][k] * x[k] : 0);
        e->b[i] = (float)sum;
    }
}

/* Two scans, whose people's identities have the correlation rho; 1: one person. */
static void draw_pair(double rho)
{
    double y[2][MOST];

    for (uint32_t i = 0; i < tmpl.n; i++) {
        y[0][i] = draw_normal(&rng);
        y[1][i] = rho * y[0][i] + sqrt(1 - rho * rho) * draw_normal(&rng);
    }
    draw_b(y[0], &tmpl);
    draw_b(y[1], &probe);
}

static double score(const struct encoding *t, const struct encoding *p, double rho,
                    double *expected)
{
    struct ratio_probe *r = ratio_probe(p, rho, &scratch);

    assert_non_null(r);
    return ratio_score(r, t, expected);
}

/* ---- by definition */

/* ln of the density of both b, up to a constant: where y and y' have the correlation rho, the
 * covariance is [[A + A A, rho A A'], [rho A' A, A' + A' A']]. */
static double ln_density(double rho)
{
    static double s[2 * MOST * 2 * MOST];
    const struct encoding *const e[2] = {&tmpl, &probe};
    const uint32_t n = tmpl.n;
    double b[2 * MOST], ln_det, square;

    for (uint32_t i = 0; i < 2 * n; i++) {
        b[i] = (double)e[i / n]->b[i % n];
        for (uint32_t k = 0; k < 2 * n; k++) {
            double sum = 0;

            for (uint32_t j = 0; j < n; j++)
                sum += a_at(e[i / n], i % n, j) * a_at(e[k / n], j, k % n);
            s[2 * n * i + k] =
                i / n == k / n ? a_at(e[i / n], i % n, k % n) + sum : rho * sum;
        }
    }
    square = dense_square(s, 2 * n, b, &ln_det);
    return -(square + ln_det) / 2;
}

TEST(test_definition)
{
    static const double rho[] = {0, 0.3, 0.9};
    static const uint32_t modes[] = {1, 2, 3, 8, 31, MOST};

    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++)
        for (size_t k = 0; k < sizeof rho / sizeof *rho; k++)
            for (int mated = 0; mated < 2; mated++) {
                double want, got, expected, back, unused;

                draw_a(modes[m], 3, &tmpl);
                draw_a(modes[m], 0.7, &probe);
                draw_pair(mated ? 1 : rho[k]);
                want = ln_density(1) - ln_density(rho[k]);
                got = score(&tmpl, &probe, rho[k], &expected);
                if (!(fabs(got - want) < 1e-9 * (1 + fabs(want))))
                    fail_msg("%u modes, rho %g: %.15g, wanted %.15g", modes[m], rho[k],
                             got, want);
                assert_true(expected > 0);
                /* the other way round the same, to rounding */
                back = score(&probe, &tmpl, rho[k], &unused);
                assert_true(fabs(back - got) < 1e-10 * (1 + fabs(got)));
                assert_true(fabs(unused - expected) < 1e-10 * (1 + fabs(expected)));
            }
}

/* The determinant of many modes of much or little evidence leaves the range of doubles. */
TEST(test_range)
{
    static const double size[] = {1e-9, 1e4, 1e10};

    for (size_t k = 0; k < sizeof size / sizeof *size; k++) {
        double want, expected, got;

        memset(&tmpl, 0, sizeof tmpl);
        tmpl.n = MOST;
        for (uint32_t i = 0; i < MOST; i++)
            tmpl.a[i * (i + 1) / 2 + i] = (float)size[k];
        probe = tmpl;
        got = score(&tmpl, &probe, 0, &expected);
        /* of each mode: 2 ln(1 + a) - ln(1 + 2 a), halved */
        want = (double)tmpl.a[0];
        want = MOST * (2 * log1p(want) - log1p(2 * want)) / 2;
        assert_true(fabs(got - want) <= 1e-9 * fabs(want) + 1e-12);
        assert_true(got == expected);
    }
}

/* Over many pairs of scans of one person the mean score is what is expected. */
TEST(test_expected)
{
    enum { PAIRS = 20000 };
    double sum = 0, squares = 0, expected = 0, mean, deviation;

    draw_a(6, 5, &tmpl);
    draw_a(6, 2, &probe);
    for (int i = 0; i < PAIRS; i++) {
        double s;

        draw_pair(1);
        s = score(&tmpl, &probe, 0, &expected);
        sum += s;
        squares += s * s;
    }
    mean = sum / PAIRS;
    deviation = sqrt((squares / PAIRS - mean * mean) / PAIRS);
    print_message("expected %.4f, mean %.4f of deviation %.4f\n", expected, mean,
                  deviation);
    assert_true(fabs(mean - expected) < 4 * deviation && deviation < 0.02);
}

/* ---- slopes */

TEST(test_slopes)
{
    static const double rho[] = {0, 0.3, 0.9};

    for (size_t k = 0; k < sizeof rho / sizeof *rho; k++) {
        double slope[2][MOST], s, expected, sum;
        struct ratio_probe *r;

        draw_a(9, 3, &tmpl);
        draw_a(9, 1, &probe);
        draw_pair(0.5);
        for (uint32_t i = 0; i < 9; i++) { /* so that steps are exact */
            tmpl.b[i] = roundf(64 * tmpl.b[i]) / 64;
            probe.b[i] = roundf(64 * probe.b[i]) / 64;
        }
        s = score(&tmpl, &probe, rho[k], &expected);
        assert_non_null(r = ratio_probe(&probe, rho[k], &scratch));
        assert_true(ratio_slopes(r, &tmpl, slope[0], slope[1]) == s);
        sum = expected;
        for (uint32_t side = 0; side < 2; side++)
            for (uint32_t i = 0; i < MOST; i++) {
                float *b = side == 0 ? &tmpl.b[i] : &probe.b[i];
                double up, down, unused;

                if (i >= 9) {
                    assert_true(slope[side][i] == 0);
                    continue;
                }
                sum += slope[side][i] * (double)*b / 2;
                *b += 0.5f;
                up = score(&tmpl, &probe, rho[k], &unused);
                *b -= 1.0f;
                down = score(&tmpl, &probe, rho[k], &unused);
                *b += 0.5f;
                /* of a quadratic form the central difference is exact */
                assert_true(fabs(up - down - slope[side][i]) < 1e-9);
            }
        assert_true(fabs(sum - s) < 1e-10 * (1 + fabs(s)));
    }
}

/* ---- what says nothing, and what is no encoding */

TEST(test_nothing)
{
    static const uint32_t modes[][2] = {{0, 5}, {5, 0}, {0, 0}, {5, 6}, {6, 5}};

    for (size_t k = 0; k < sizeof modes / sizeof *modes; k++) {
        double expected = 7, slope[2][MOST];
        struct ratio_probe *r;

        draw_a(modes[k][0], 1, &tmpl);
        draw_a(modes[k][1], 1, &probe);
        memset(slope, 1, sizeof slope);
        assert_true(score(&tmpl, &probe, 0.3, &expected) == 0);
        assert_true(expected == 0);
        assert_non_null(r = ratio_probe(&probe, 0.3, &scratch));
        assert_true(ratio_slopes(r, &tmpl, slope[0], slope[1]) == 0);
        for (uint32_t i = 0; i < MOST; i++)
            assert_true(slope[0][i] == 0 && slope[1][i] == 0);
    }
}

/* A number of either that no encoding has: the score is the least, and nothing is expected. */
TEST(test_hostile)
{
    static const double bad[] = {
        (double)NAN, (double)INFINITY, -(double)INFINITY, -1e3, 1e38, -1e38};

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        for (int where = 0; where < 6; where++) {
            struct encoding *e = where % 2 == 0 ? &tmpl : &probe;
            double expected = 7, got;

            draw_a(12, 3, &tmpl);
            draw_a(12, 3, &probe);
            draw_pair(1);
            if (where < 2)
                e->a[5 * 6 / 2 + 5] = (float)bad[k]; /* on the diagonal, */
            else if (where < 4)
                e->a[7 * 8 / 2 + 3] = (float)bad[k]; /* beside it, */
            else
                e->b[4] = (float)bad[k];
            if (where < 2 && bad[k] == 1e38)
                continue; /* sure to know one coefficient */
            if (where >= 4 && bad[k] == -1e3)
                continue; /* an unusual face */
            got = score(&tmpl, &probe, 0.3, &expected);
            if (got != -RATIO_MOST || expected != 0)
                fail_msg("%g at %d: score %g, expected %g", bad[k], where, got, expected);
        }
}

/* ---- memory */

/* One probe against many: each score as by itself. */
TEST(test_many)
{
    static struct encoding t[4];
    double want[4], expected[4], again;
    struct ratio_probe *r;

    draw_a(40, 3, &probe);
    for (int i = 0; i < 4; i++) {
        draw_a(40, 1 + i, &tmpl);
        draw_pair(1);
        t[i] = tmpl;
    }
    for (int i = 0; i < 4; i++)
        want[i] = score(&t[i], &probe, 0.3, &expected[i]);
    assert_non_null(r = ratio_probe(&probe, 0.3, &scratch));
    for (int i = 8; i-- > 0;) {
        const double got = ratio_score(r, &t[i % 4], &again);

        assert_memory_equal(&got, &want[i % 4], sizeof got);
        assert_memory_equal(&again, &expected[i % 4], sizeof again);
    }
}

BEFORE_ALL(set_up)
{
    rng.x = brute_seed("ratio");
}
