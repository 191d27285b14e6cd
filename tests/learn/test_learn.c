/* Learning from generated samples: the modes of a family with few of them, despite missing
 * cells; the smooth covariance by definition; weights where subjects differ; the threshold
 * and its rates. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "brute.h"
#include "cells.h"
#include "fail_alloc.h"
#include "learn.h"
#include "toy.h"

#define SAMPLES 200

static struct model model;
static float sample[SAMPLES][GRID_N];
static uint64_t seed;

/* Roughly normally distributed. */
static double bell(struct brute_rng *rng)
{
    double s = -6;

    for (int i = 0; i < 12; i++)
        s += brute_real(rng);
    return s;
}

/* Samples of the toy's first n changes, each of variance 1, and white noise. */
static void family(uint32_t n, double noise, struct brute_rng *rng)
{
    for (size_t i = 0; i < SAMPLES; i++) {
        double a[6];

        for (uint32_t k = 0; k < n; k++)
            a[k] = bell(rng);
        for (uint32_t c = 0; c < GRID_N; c++) {
            double g = noise * bell(rng);

            for (uint32_t k = 0; k < n; k++)
                g += a[k] * (double)model.change.mode[c][k];
            sample[i][c] = model.change.rest[c] > 0.0f ? (float)g : (float)NAN;
        }
    }
}

/* The covariance of the gaps of cells c and d by the first n modes of b. */
static double covariance(const struct model_basis *b, uint32_t n, uint32_t c, uint32_t d)
{
    double s = 0;

    for (uint32_t k = 0; k < n; k++)
        s += (double)b->mode[c][k] * (double)b->mode[d][k];
    return s;
}

/* Removes a disc of cells at a random place of each sample, and rows at the chin in most. */
static void lose(struct brute_rng *rng)
{
    for (size_t i = 0; i < SAMPLES; i++) {
        const double x = 100 * (brute_real(rng) - 0.5), y = 120 * (brute_real(rng) - 0.5);

        for (uint32_t c = 0; c < GRID_N; c++)
            if (hypot(grid_x(c) - x, grid_y(c) - y) < 20 ||
                (i % 10 != 0 && grid_y(c) < -70))
                sample[i][c] = (float)NAN;
    }
}

/* Each of the toy's modes is symmetric or antisymmetric, so learning from mirror images too
 * does not change the covariance: it is that of the family. */
static void test_modes(void **state)
{
    static struct model_basis b;
    struct brute_rng rng = {seed};

    (void)state;
    for (int lost = 0; lost < 2; lost++) {
        double error = 0, whole = 0, rest = 0;
        uint32_t cells = 0;

        family(4, 0.05, &rng);
        if (lost)
            lose(&rng);
        assert_int_equal(learn_modes(&sample[0][0], SAMPLES, 4, LEARN_MAX_GAP, &b),
                         ST_OK);
        assert_int_equal(b.n, 4);
        for (uint32_t c = 0; c < GRID_N; c++) {
            assert_true((b.rest[c] > 0.0f) ==
                        (model.change.rest[c] > 0.0f && !(lost && grid_y(c) < -70)));
            for (uint32_t k = 0; k < MODEL_MODES; k++)
                assert_true(b.mode[c][k] == 0.0f || (k < 4 && b.rest[c] > 0.0f));
            if (b.rest[c] <= 0.0f)
                continue;
            rest += (double)b.rest[c];
            cells++;
            for (uint32_t d = 0; d < GRID_N; d += 7) {
                const double want = covariance(&model.change, 4, c, d);

                if (b.rest[d] <= 0.0f)
                    continue;
                whole += want * want;
                error +=
                    (covariance(&b, 4, c, d) - want) * (covariance(&b, 4, c, d) - want);
            }
        }
        print_message("covariance off by %.1f %%, rest %.4f mm\n",
                      100 * sqrt(error / whole), rest / cells);
        assert_true(sqrt(error / whole) < 0.2); /* 200 samples: 3 / sqrt(200) */
        assert_true(fabs(rest / cells - 0.05) < 0.01);
    }
    assert_int_equal(learn_modes(&sample[0][0], 7, 4, LEARN_MAX_GAP, &b), ST_EINVAL);
    assert_int_equal(
        learn_modes(&sample[0][0], SAMPLES, MODEL_MODES + 1, LEARN_MAX_GAP, &b),
        ST_EINVAL);
    assert_int_equal(learn_modes(&sample[0][0], 0, 0, LEARN_MAX_GAP, &b), ST_EINVAL);
}

/* An outlier counts as LEARN_MAX_GAP; and the same samples give the same bytes. */
static void test_modes_clipped(void **state)
{
    static struct model_basis a, b;
    struct brute_rng rng = {seed + 1};

    (void)state;
    family(2, 0.05, &rng);
    sample[17][600] = 1e6f;
    assert_int_equal(learn_modes(&sample[0][0], SAMPLES, 2, LEARN_MAX_GAP, &a), ST_OK);
    sample[17][600] = (float)LEARN_MAX_GAP;
    assert_int_equal(learn_modes(&sample[0][0], SAMPLES, 2, LEARN_MAX_GAP, &b), ST_OK);
    assert_memory_equal(&a, &b, sizeof a);
}

/* The kernel by definition, with the same deviation in all cells. */
static void test_smooth(void **state)
{
    static struct model_basis b;
    const double length = 40, share = 0.5, deviation = 0.8;
    double worst = 0;

    (void)state;
    memset(&b, 0, sizeof b);
    b.n = 1;
    for (uint32_t c = 0; c < GRID_N; c++) {
        b.rest[c] = model.change.rest[c];
        b.mode[c][0] = b.rest[c] > 0.0f ? (float)deviation : 0.0f;
    }
    assert_int_equal(learn_smooth(&b, length, share, MODEL_MODES), ST_EINVAL);
    assert_int_equal(learn_smooth(&b, length, share, 60), ST_OK);
    assert_int_equal(b.n, 61);
    for (uint32_t c = 0; c < GRID_N; c++)
        for (uint32_t d = 0; d < GRID_N; d += 5) {
            const double dx = grid_x(c) - grid_x(d), dy = grid_y(c) - grid_y(d);
            const double a = share * deviation;
            const double want =
                b.rest[c] > 0.0f && b.rest[d] > 0.0f
                    ? a * a * exp(-(dx * dx + dy * dy) / (2 * length * length))
                    : 0;
            const double got =
                covariance(&b, 61, c, d) - (double)b.mode[c][0] * (double)b.mode[d][0];

            worst = fmax(worst, fabs(got - want));
        }
    print_message("covariance off by %.6f mm^2 at most\n", worst);
    assert_true(worst < 1e-3);
}

/* Rests as a fit would leave them: 0.1 mm everywhere, but 0.6 mm in one region of the
 * non-mated samples. */
static void non_mated(enum grid_region where, uint8_t *mated, struct brute_rng *rng)
{
    for (size_t i = 0; i < SAMPLES; i++) {
        mated[i] = i % 2 == 0;
        for (uint32_t c = 0; c < GRID_N; c++) {
            const double size = !mated[i] && grid_region_of(c) == where ? 0.6 : 0.1;

            sample[i][c] = model.change.rest[c] > 0.0f && i % 37 != c % 37
                               ? (float)(size * bell(rng))
                               : (float)NAN;
        }
    }
}

static void test_weight(void **state)
{
    static const enum grid_region regions[] = {GRID_NOSE, GRID_FOREHEAD, GRID_EYES};
    static float u[GRID_N];
    uint8_t mated[SAMPLES];
    struct brute_rng rng = {seed + 2};

    (void)state;
    for (size_t r = 0; r < sizeof regions / sizeof *regions; r++) {
        double in = 0, out = 0, sum = 0;
        uint32_t n_in = 0, n_out = 0, n = 0;

        non_mated(regions[r], mated, &rng);
        assert_int_equal(learn_weight(&sample[0][0], mated, SAMPLES, &model, u), ST_OK);
        for (uint32_t c = 0; c < GRID_N; c++) {
            assert_true(u[c] >= 0.0f && u[c] == u[grid_mirror(c)]);
            assert_true(model.change.rest[c] > 0.0f || u[c] == 0.0f);
            n += u[c] > 0.0f;
            sum += (double)u[c];
            if (grid_region_of(c) == regions[r]) {
                in += (double)u[c];
                n_in += model.change.rest[c] > 0.0f;
            } else {
                out += (double)u[c];
                n_out += model.change.rest[c] > 0.0f;
            }
        }
        assert_true(fabs(sum / n - 1) < 1e-3);
        print_message("%s: %.2f there, %.2f elsewhere\n", grid_region_name(regions[r]),
                      in / n_in, out / n_out);
        assert_true(in / n_in > 5 * out / n_out);
    }
    memset(mated, 1, sizeof mated);
    assert_int_equal(learn_weight(&sample[0][0], mated, SAMPLES, &model, u), ST_EINVAL);
    memset(mated, 0, sizeof mated);
    assert_int_equal(learn_weight(&sample[0][0], mated, SAMPLES, &model, u), ST_EINVAL);
}

static void test_rigid(void **state)
{
    (void)state;
    for (uint32_t c = 0; c < GRID_N; c++) {
        assert_true(learn_rigid(c) > 0 && learn_rigid(c) <= 1);
        assert_true(fabs(learn_rigid(c) - learn_rigid(grid_mirror(c))) < 1e-12);
    }
    assert_true(learn_rigid(grid_cell(2, 10)) > 2 * learn_rigid(grid_cell(2, -40)));
    assert_true(learn_rigid(grid_cell(10, 62)) > learn_rigid(grid_cell(40, 0)));
}

/* Converting a comparison to a sample and back. */
static void test_samples(void **state)
{
    static struct cells c, back;
    static float x[GRID_N];

    (void)state;
    for (uint32_t i = 0; i < GRID_N; i++) {
        c.area[i] = (float)(i % 9);
        c.gap[i] = (float)i * 0.001f;
    }
    learn_sample(&c, x);
    learn_cells(x, &model, &back);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const bool covered = c.area[i] >= (float)LEARN_COVERED;

        assert_true(isnan(x[i]) == !covered);
        assert_true((cells_cover(&back, i) > 0.0f) == covered);
        assert_true(!covered || back.gap[i] == c.gap[i]);
        assert_true(back.normal[i][2] == 1.0f && !isnan(back.z[i]));
    }
    /* the normals at the sides of the nose point outwards */
    assert_true(back.normal[grid_cell(10, 10)][0] > 0.2f);
    assert_true(back.normal[grid_cell(-10, 10)][0] < -0.2f);
}

static void test_memory(void **state)
{
    static struct model_basis b;
    static float u[GRID_N];
    struct brute_rng rng = {seed + 4};
    uint8_t mated[SAMPLES];

    (void)state;
    non_mated(GRID_NOSE, mated, &rng);
    for (int what = 0; what < 3; what++) {
        enum status st = ST_ENOMEM;
        unsigned long n;

        for (n = 1; st != ST_OK; n++) {
            b = model.change;
            fail_alloc_at(n);
            st = what == 0   ? learn_modes(&sample[0][0], 8, 2, LEARN_MAX_GAP, &b)
                 : what == 1 ? learn_smooth(&b, 30, 0.5, 3)
                             : learn_weight(&sample[0][0], mated, 8, &model, u);
            fail_alloc_at(0);
            assert_true(st == ST_OK || st == ST_ENOMEM);
            if (what == 1 && st != ST_OK)
                assert_memory_equal(&b, &model.change, sizeof b);
        }
        assert_true(n > 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_modes),  cmocka_unit_test(test_modes_clipped),
        cmocka_unit_test(test_smooth), cmocka_unit_test(test_weight),
        cmocka_unit_test(test_rigid),  cmocka_unit_test(test_samples),
        cmocka_unit_test(test_memory),
    };

    seed = brute_seed("learn");
    toy_model(&model);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
