/* How much of a face's fine relief a surface has, against the definition, and what changes it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "brute.h"
#include "shape_work.h"
#include "toy.h"

static struct model model;
static struct shape_work work;
static float z[GRID_N]; /* NAN: not seen */

/* All of the mean face, seen. */
static void see_all(void)
{
    memcpy(z, work.mean, sizeof z);
}

/* Of the surface z. */
static double detail(void)
{
    float over[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        over[i] = z[i] - work.mean[i];
    return shape_detail(work.fine, work.over_rest, over);
}

/* v less the mean of it over the square round cell i, of the cells that `on` says; *all: the
 * square is whole. */
static double above(const double *v, const bool *on, uint32_t i, bool *all)
{
    double sum = 0;
    int n = 0;

    for (int y = -SHAPE_FINE; y <= SHAPE_FINE; y++)
        for (int x = -SHAPE_FINE; x <= SHAPE_FINE; x++) {
            const int at[2] = {(int)(i % GRID_NX) + x, (int)(i / GRID_NX) + y};
            const int k = at[1] * GRID_NX + at[0];

            if (at[0] < 0 || at[1] < 0 || at[0] >= GRID_NX || at[1] >= GRID_NY || !on[k])
                continue;
            sum += v[k];
            n++;
        }
    *all = n == (2 * SHAPE_FINE + 1) * (2 * SHAPE_FINE + 1);
    return v[i] - sum / n;
}

/* By the definition. */
static double reference(void)
{
    static double mean[GRID_N], over[GRID_N];
    static bool face[GRID_N], seen[GRID_N];
    double sum = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        face[i] = !isnan(work.mean[i]);
        seen[i] = !isnan(z[i]);
        mean[i] = (double)work.mean[i];
        over[i] = (double)z[i] - mean[i];
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        bool whole, any;
        double m;

        if (!seen[i])
            continue;
        m = above(mean, face, i, &whole);
        if (!whole)
            continue;
        sum += (double)work.over_rest[i] * m * (m + above(over, seen, i, &any));
        all += (double)work.over_rest[i] * m * m;
    }
    return all > 0 ? sum / all : 0;
}

/* Any heights, seen anywhere. */
static void test_definition(void **state)
{
    struct brute_rng rng = {brute_seed("detail")};

    (void)state;
    for (int k = 0; k < 200; k++) {
        const double share = brute_real(&rng);

        see_all();
        for (uint32_t i = 0; i < GRID_N; i++)
            z[i] = brute_real(&rng) < share ? z[i] + (float)(6 * brute_real(&rng) - 3)
                                            : (float)NAN;
        assert_true(fabs(detail() - reference()) < 1e-4);
    }
}

/* The mean face has all of it, one twice as deep twice as much; how the surface lies does not
 * matter, nor that a half of it is not seen. */
static void test_mean(void **state)
{
    (void)state;
    for (int half = 0; half < 2; half++)
        for (int times = 0; times < 4; times++) {
            see_all();
            for (uint32_t i = 0; i < GRID_N; i++) {
                z[i] *= (float)times;
                z[i] += (float)(3 + 0.1 * grid_x(i) - 0.2 * grid_y(i));
                if (half && grid_x(i) > 0)
                    z[i] = (float)NAN;
            }
            if (half && times != 1)
                continue; /* the rim of what is seen */
            assert_true(fabs(detail() - times) < (half ? 0.1 : 1e-3));
        }
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = (float)NAN;
    assert_true(detail() == 0);
}

/* A smooth surface has little of it. */
static void test_smooth(void **state)
{
    static double mean[GRID_N];
    static bool face[GRID_N];

    (void)state;
    for (uint32_t i = 0; i < GRID_N; i++) {
        face[i] = !isnan(work.mean[i]);
        mean[i] = (double)work.mean[i];
    }
    see_all();
    for (uint32_t i = 0; i < GRID_N; i++) {
        bool all;

        if (face[i])
            z[i] -= (float)above(mean, face, i, &all);
    }
    assert_true(detail() < 0.5);
    see_all();
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = (float)(-grid_x(i) * grid_x(i) / 130 - grid_y(i) * grid_y(i) / 220);
    assert_true(fabs(detail()) < 0.2);
}

/* Noise neither adds nor takes away much. */
static void test_noise(void **state)
{
    struct brute_rng rng = {brute_seed("detail of noise")};

    (void)state;
    for (int k = 0; k < 50; k++) {
        see_all();
        for (uint32_t i = 0; i < GRID_N; i++)
            z[i] += (float)(2 * brute_real(&rng) - 1);
        assert_true(fabs(detail() - 1) < 0.15);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_definition),
        cmocka_unit_test(test_mean),
        cmocka_unit_test(test_smooth),
        cmocka_unit_test(test_noise),
    };
    int failed;

    toy_model(&model);
    shape_work_prepare(&model, &work);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    shape_work_free(&work);
    return failed;
}
