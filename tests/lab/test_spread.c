/* Covariances in even and odd patterns: against the same over all cells, done plainly. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "rates.h"
#include "spread.h"

#define SIDE 7
#define BOTH (2 * SIDE)

static const struct spread_cells cells = {SIDE, {40, 41, 70, 330, 331, 600, 1000}};
static uint64_t state_of_random = 1;

static double random_number(void)
{
    return (double)(rates_random(&state_of_random) >> 11) / 4503599627370496.0 - 1;
}

/* The k-th of all cells in use. */
static uint32_t cell(uint32_t k)
{
    return k < SIDE ? cells.at[k] : grid_mirror(cells.at[k - SIDE]);
}

static void random_gap(float gap[GRID_N])
{
    for (uint32_t i = 0; i < GRID_N; i++)
        gap[i] = (float)random_number();
}

/* What s says of two cells. */
static double covariance(const struct spread *s, uint32_t j, uint32_t k)
{
    const size_t at = j % SIDE * SIDE + k % SIDE;
    const double even = s->block[0][at], odd = s->block[1][at];

    return (j < SIDE) == (k < SIDE) ? (even + odd) / 2 : (even - odd) / 2;
}

static void add_gap(struct spread *s, const float gap[GRID_N])
{
    double even[SIDE], odd[SIDE];

    spread_split(&cells, gap, (double *[]){even, odd});
    spread_add_pattern(s, false, even, 1);
    spread_add_pattern(s, true, odd, 1);
}

static void fresh(struct spread *s, uint32_t samples, double plain[BOTH][BOTH])
{
    float gap[GRID_N];

    assert_int_equal(spread_new(SIDE, s), ST_OK);
    memset(plain, 0, sizeof(double) * BOTH * BOTH);
    for (uint32_t n = 0; n < samples; n++) {
        random_gap(gap);
        add_gap(s, gap);
        for (uint32_t j = 0; j < BOTH; j++)
            for (uint32_t k = 0; k < BOTH; k++)
                plain[j][k] += ((double)gap[cell(j)] * (double)gap[cell(k)] +
                                (double)gap[grid_mirror(cell(j))] *
                                    (double)gap[grid_mirror(cell(k))]) /
                               2;
    }
}

static void check(const struct spread *s, double plain[BOTH][BOTH], double within)
{
    for (uint32_t j = 0; j < BOTH; j++)
        for (uint32_t k = 0; k < BOTH; k++)
            assert_true(fabs(covariance(s, j, k) - plain[j][k]) < within);
}

/* A sample and its mirror image, each half. */
static void test_samples(void **state)
{
    struct spread s, twice;
    double plain[BOTH][BOTH];

    (void)state;
    fresh(&s, 5, plain);
    check(&s, plain, 1e-12);
    for (uint32_t i = 0; i < SIDE; i++)
        assert_true(fabs(spread_variance(&s, i) - plain[i][i]) < 1e-12);
    assert_int_equal(spread_new(SIDE, &twice), ST_OK);
    spread_add(&twice, &s, 2);
    spread_add(&twice, &s, -1);
    check(&twice, plain, 1e-12);
    spread_free(&s);
    spread_free(&s);
    spread_free(&twice);
}

/* What is split is joined again; a cell without a gap is 0. */
static void test_split(void **state)
{
    static float joined[GRID_N][3], sum[GRID_N];
    float gap[GRID_N];
    double part[2][SIDE];

    (void)state;
    random_gap(gap);
    gap[cell(2)] = (float)NAN;
    spread_split(&cells, gap, (double *[]){part[0], part[1]});
    memset(sum, 0, sizeof sum);
    for (int odd = 0; odd < 2; odd++) {
        spread_join(&cells, odd, part[odd], 2, &joined[0][1], 3);
        for (uint32_t i = 0; i < GRID_N; i++) {
            sum[i] += joined[i][1] / 2;
            assert_true(odd ? joined[i][1] + joined[grid_mirror(i)][1] >= 0.0f &&
                                  joined[i][1] + joined[grid_mirror(i)][1] <= 0.0f
                            : joined[i][1] >= joined[grid_mirror(i)][1]);
        }
    }
    gap[cell(2)] = 0.0f;
    for (uint32_t k = 0; k < BOTH; k++) {
        assert_true(fabsf(sum[cell(k)] - gap[cell(k)]) < 1e-6f);
        sum[cell(k)] = 0.0f;
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(sum[i] >= 0.0f && sum[i] <= 0.0f);
}

static void test_field(void **state)
{
    struct spread s;
    double deviation[GRID_N], plain[BOTH][BOTH];

    (void)state;
    for (uint32_t i = 0; i < GRID_N; i++)
        deviation[i] = 1 + fabs(grid_x(i)) / 50;
    assert_int_equal(spread_new(SIDE, &s), ST_OK);
    spread_add_field(&s, &cells, deviation, 14);
    for (uint32_t j = 0; j < BOTH; j++)
        for (uint32_t k = 0; k < BOTH; k++) {
            const double x = grid_x(cell(j)) - grid_x(cell(k));
            const double y = grid_y(cell(j)) - grid_y(cell(k));

            plain[j][k] = deviation[cell(j)] * deviation[cell(k)] *
                          exp(-(x * x + y * y) / (2 * 14 * 14));
        }
    check(&s, plain, 1e-11);
    spread_free(&s);
}

/* Along a removed pattern nothing varies; the same pattern twice, and none, do no harm. */
static void test_remove(void **state)
{
    struct spread s;
    double plain[BOTH][BOTH], x[4 * SIDE], was[2 * SIDE];

    (void)state;
    for (int odd = 0; odd < 2; odd++) {
        fresh(&s, 20, plain);
        for (int i = 0; i < SIDE; i++) {
            x[i] = was[i] = random_number();
            x[SIDE + i] = -2 * x[i];
            x[2 * SIDE + i] = 0;
            x[3 * SIDE + i] = was[SIDE + i] = random_number();
        }
        spread_remove(&s, odd, x, 4);
        for (int n = 0; n < 2; n++)
            for (int i = 0; i < SIDE; i++) {
                double sum = 0;

                for (int k = 0; k < SIDE; k++)
                    sum += s.block[odd][i * SIDE + k] * was[n * SIDE + k];
                assert_true(fabs(sum) < 1e-12);
            }
        for (int i = 0; i < SIDE * SIDE; i++) /* the other block is as it was */
            assert_true(fabs(s.block[1 - odd][i]) > 0);
        spread_free(&s);
    }
}

/* All modes together are the covariance; the first ones are the largest of both blocks. */
static void test_lead(void **state)
{
    struct spread s, rebuilt;
    struct spread_mode mode[BOTH];
    double plain[BOTH][BOTH];

    (void)state;
    fresh(&s, 30, plain);
    assert_int_equal(spread_lead(&s, BOTH, mode), ST_OK);
    assert_null(s.block[0]);
    assert_int_equal(spread_new(SIDE, &rebuilt), ST_OK);
    for (uint32_t k = 0; k < BOTH; k++) {
        assert_true(k == 0 || mode[k].variance <= mode[k - 1].variance);
        spread_add_pattern(&rebuilt, mode[k].odd, mode[k].pattern, mode[k].variance);
    }
    check(&rebuilt, plain, 1e-12);
    spread_release(mode, BOTH);
    assert_int_equal(spread_lead(&rebuilt, BOTH + 1, mode), ST_EINVAL);
    fresh(&s, 1, plain);
    s.block[1][3] = (double)NAN;
    assert_int_equal(spread_lead(&s, 1, mode), ST_EINVAL);
}

/* In the coordinates of the noise the noise is the identity, and back again s is s. */
static void test_against(void **state)
{
    struct spread s, noise, copy, rebuilt;
    struct spread_mode mode[BOTH];
    double plain[BOTH][BOTH], unused[BOTH][BOTH];

    (void)state;
    fresh(&s, 30, plain);
    fresh(&noise, 40, unused);
    assert_int_equal(spread_new(SIDE, &copy), ST_OK);
    spread_add(&copy, &noise, 1);
    assert_int_equal(spread_against(&copy, &noise), ST_OK);
    for (int b = 0; b < 2; b++)
        for (uint32_t i = 0; i < SIDE * SIDE; i++)
            assert_true(fabs(copy.block[b][i] - (i % (SIDE + 1) == 0 ? 1 : 0)) < 1e-10);
    spread_free(&noise);
    fresh(&noise, 40, unused);
    assert_int_equal(spread_against(&s, &noise), ST_OK);
    assert_int_equal(spread_lead(&s, BOTH, mode), ST_OK);
    spread_back(&noise, mode, BOTH);
    assert_int_equal(spread_new(SIDE, &rebuilt), ST_OK);
    for (uint32_t k = 0; k < BOTH; k++)
        spread_add_pattern(&rebuilt, mode[k].odd, mode[k].pattern, mode[k].variance);
    check(&rebuilt, plain, 1e-10);
    spread_release(mode, BOTH);
    spread_free(&noise);
    assert_int_equal(spread_new(SIDE, &noise), ST_OK); /* 0: none */
    assert_int_equal(spread_against(&rebuilt, &noise), ST_EINVAL);
    spread_free(&noise);
    spread_free(&copy);
    spread_free(&rebuilt);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples), cmocka_unit_test(test_split),
        cmocka_unit_test(test_field),   cmocka_unit_test(test_remove),
        cmocka_unit_test(test_lead),    cmocka_unit_test(test_against),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
