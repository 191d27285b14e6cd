/* The score of known gaps. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "cells.h"
#include "fail_alloc.h"
#include "learn.h"
#include "score.h"
#include "toy.h"
#include "tuning.h"

static struct model model;
static struct fit_basis changed; /* the model's change, prepared */
static struct fit_basis parts[SCORE_PARTS];
static struct scratch scratch;
static struct cells cells;
static struct fit fit;

static void no_gap(void)
{
    static float sample[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        sample[i] = model.change.rest[i] > 0.0f ? 0.0f : (float)NAN;
    learn_cells(sample, &model, &cells);
}

static struct score score(void)
{
    struct score s;

    assert_int_equal(score_of(&model, &changed, &cells, &scratch, &fit, &s), ST_OK);
    return s;
}

/* Adds +mm and -mm in blocks of three cells by three: no motion or change explains them, and
 * they are too wide for noise. */
static void chequered(double mm, int region)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        if (cells.area[i] > 0.0f && (region < 0 || (int)grid_region_of(i) == region))
            cells.gap[i] +=
                (float)((i % GRID_NX / 3 + i / GRID_NX / 3) % 2 == 0 ? mm : -mm);
}

/* The difference of the rest at cell i from the mean over the covered cells round it, with
 * Gaussian weights (sigma one cell, up to three cells away). */
static double rough(uint32_t i)
{
    const int x = (int)(i % GRID_NX), y = (int)(i / GRID_NX);
    double sum = 0, weights = 0;

    for (int v = y - 3; v <= y + 3; v++)
        for (int u = x - 3; u <= x + 3; u++) {
            const double w = exp(-0.5 * ((u - x) * (u - x) + (v - y) * (v - y)));
            const uint32_t c = (uint32_t)(v * GRID_NX + u);

            if (u < 0 || u >= GRID_NX || v < 0 || v >= GRID_NY || cells.area[c] <= 0.0f)
                continue;
            sum += w * (double)fit.rest[c];
            weights += w;
        }
    return (double)fit.rest[i] - sum / weights;
}

/* The score by definition, of a region or of the whole face (-1), from the rest in fit. */
static double defined(int region)
{
    const double cap = (double)model.cap_mm;
    double sum = 0, whole = 0, face = 0, thin;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double u = (double)model.weight[i];

        face += model.change.rest[i] > 0.0f ? u : 0;
        if (cells.area[i] <= 0.0f || model.change.rest[i] <= 0.0f ||
            (region >= 0 && (int)grid_region_of(i) != region))
            continue;
        sum += u * fmin(fabs((double)fit.rest[i]), cap);
        sum -= SCORE_ROUGH * u * fmin(fabs(rough(i)), cap);
        whole += u;
    }
    thin = region < 0 ? fmax(0, SCORE_WHOLE - whole / face) : 0;
    return sum > 0 ? sum / whole * (1 + SCORE_THIN * thin) : 0;
}

static void test_identical(void **state)
{
    double sum = 0;
    struct score s;

    (void)state;
    no_gap();
    s = score();
    assert_true(s.mm == 0 && s.change_mm == 0);
    assert_true(fabs(s.weight - 1) < 1e-12);
    for (int r = 0; r < GRID_REGIONS; r++) {
        assert_true(s.region_mm[r] == 0 && s.region_weight[r] > 0);
        sum += s.region_weight[r];
    }
    assert_true(fabs(sum - 1) < 1e-12);
}

/* The score agrees with its definition; a motion alone gives 0. */
static void test_definition(void **state)
{
    struct score s;

    (void)state;
    no_gap();
    for (uint32_t i = 0; i < GRID_N; i++)
        cells.gap[i] = cells.area[i] > 0.0f ? cells.normal[i][0] * 0.2f : 0.0f;
    s = score();
    assert_true(s.mm < 0.05 && s.change_mm > 0.01);
    for (int round = 0; round < 2; round++) {
        chequered(0.5, -1);
        s = score();
        assert_true(s.mm > 0.1);
        assert_true(fabs(s.mm - defined(-1)) < 1e-5);
        for (int r = 0; r < GRID_REGIONS; r++)
            assert_true(isnan(s.region_mm[r]) ||
                        fabs(s.region_mm[r] - defined(r)) < 1e-5);
        for (uint32_t i = 0; i < GRID_N; i++) /* then with holes */
            if (i % 29 < 4 || i % 7 == 0)
                cells.area[i] = cells.gap[i] = 0.0f;
    }
}

/* Noise from cell to cell adds little to the score; gaps of the same size over wider areas add
 * much more. */
static void test_noise(void **state)
{
    struct score narrow, wide;

    (void)state;
    no_gap();
    for (uint32_t i = 0; i < GRID_N; i++)
        if (cells.area[i] > 0.0f)
            cells.gap[i] = (i % GRID_NX + i / GRID_NX) % 2 == 0 ? 0.3f : -0.3f;
    narrow = score();
    no_gap();
    chequered(0.3, -1);
    wide = score();
    assert_true(narrow.mm < 0.15 && wide.mm > narrow.mm);
}

/* A cell adds at most the cap, however large its gap is. */
static void test_cap(void **state)
{
    struct score s;

    (void)state;
    no_gap();
    chequered(8, -1);
    s = score();
    assert_true(fabs(s.mm - defined(-1)) < 1e-5);
    assert_true(s.mm > 0.2 && s.mm <= (double)model.cap_mm);
}

/* A difference in one region raises that region's value, and the score by its weight. */
static void test_regions(void **state)
{
    (void)state;
    for (int r = 0; r < GRID_REGIONS; r++) {
        struct score s;
        double sum = 0;

        no_gap();
        chequered(0.4, r);
        s = score();
        for (int q = 0; q < GRID_REGIONS; q++)
            assert_true(q == r || s.region_mm[q] < 0.3 * s.region_mm[r]);
        for (int q = 0; q < GRID_REGIONS; q++)
            sum += s.region_mm[q] * s.region_weight[q];
        assert_true(fabs(s.mm - sum) < 0.01);
    }
}

/* A region that is not covered has NAN, and its weight is missing from the total. */
static void test_covered(void **state)
{
    struct score whole, s;

    (void)state;
    no_gap();
    chequered(0.3, -1);
    whole = score();
    for (uint32_t i = 0; i < GRID_N; i++)
        if (grid_region_of(i) == GRID_CHIN)
            cells.area[i] = cells.gap[i] = 0.0f;
    s = score();
    assert_true(isnan(s.region_mm[GRID_CHIN]) && !isnan(s.region_mm[GRID_NOSE]));
    assert_true(s.region_weight[GRID_CHIN] == whole.region_weight[GRID_CHIN]);
    assert_true(fabs(s.weight - (1 - whole.region_weight[GRID_CHIN])) < 1e-9);
    assert_true(fabs(s.mm - whole.mm) < 0.05);
    memset(cells.area, 0, sizeof cells.area);
    s = score();
    assert_true(s.mm == 0 && s.weight == 0 && s.change_mm == 0);
    for (int r = 0; r < GRID_REGIONS; r++)
        assert_true(isnan(s.region_mm[r]));
}

/* Doubling all weights does not change the score. */
static void test_scale_of_weight(void **state)
{
    static struct model saved;
    struct score a, b;

    (void)state;
    saved = model;
    no_gap();
    chequered(0.3, GRID_NOSE);
    a = score();
    for (uint32_t i = 0; i < GRID_N; i++)
        model.weight[i] *= 2.0f;
    b = score();
    assert_true(a.mm == b.mm && a.weight == b.weight);
    model = saved;
}

static double part(enum score_part p)
{
    double mm;

    assert_int_equal(score_of_part(&model, p, &parts[p], &cells, &scratch, &mm), ST_OK);
    return mm;
}

/* A part knows nothing of what happens elsewhere, not even by way of the fit: neither of an
 * expression round the mouth nor of one of the brows.  The nose belongs to all parts. */
static void test_parts(void **state)
{
    double upper, lower, middle;

    (void)state;
    no_gap();
    chequered(0.2, GRID_NOSE);
    upper = part(SCORE_UPPER);
    lower = part(SCORE_LOWER);
    middle = part(SCORE_MIDDLE);
    assert_true(upper > 0.01 && lower > 0.01 && middle > 0.01);
    chequered(0.4, GRID_MOUTH);
    chequered(0.4, GRID_CHIN);
    assert_true(part(SCORE_UPPER) == upper && part(SCORE_LOWER) > 1.1 * lower);
    assert_true(part(SCORE_MIDDLE) == middle);
    no_gap();
    chequered(0.2, GRID_NOSE);
    chequered(0.4, GRID_FOREHEAD);
    for (uint32_t i = 0; i < GRID_N; i++)
        cells.gap[i] += grid_y(i) > SCORE_MIDDLE_MM ? 3.0f : 0.0f;
    assert_true(part(SCORE_LOWER) == lower && part(SCORE_UPPER) > 1.1 * upper);
    assert_true(part(SCORE_MIDDLE) == middle);
    for (uint32_t i = 0; i < GRID_N; i++)
        cells.gap[i] += fabs(grid_x(i)) > SCORE_MIDDLE_X_MM ? 3.0f : 0.0f;
    assert_true(part(SCORE_LOWER) != lower && part(SCORE_MIDDLE) == middle);
}

/* It is the score of a face of which nothing else is covered. */
static void test_part_alone(void **state)
{
    double mm[SCORE_PARTS];
    const struct cells *const all = &cells;
    static struct cells whole;

    (void)state;
    no_gap();
    chequered(0.3, -1);
    whole = *all;
    for (int p = 0; p < SCORE_PARTS; p++)
        mm[p] = part((enum score_part)p);
    for (int p = 0; p < SCORE_PARTS; p++) {
        struct score s;

        cells = whole;
        for (uint32_t i = 0; i < GRID_N; i++)
            if (!parts[p].used[i])
                cells.area[i] = 0.0f;
        s = score();
        s.mm /= 1 + SCORE_THIN * fmax(0, SCORE_WHOLE - s.weight);
        s.mm *= p == SCORE_MIDDLE ? SCORE_MIDDLE_MORE : 1;
        assert_true(s.weight > 0.3 && s.weight < 0.95 && fabs(s.mm - mm[p]) < 1e-4);
        cells.area[0] = 0.0f;
        assert_true(fabs(part((enum score_part)p) - mm[p]) < 1e-12);
    }
}

/* Of a part that is not seen nothing is known. */
static void test_part_hidden(void **state)
{
    (void)state;
    no_gap();
    assert_true(part(SCORE_UPPER) == 0 && part(SCORE_LOWER) == 0);
    for (uint32_t i = 0; i < GRID_N; i++)
        if (grid_region_of(i) == GRID_FOREHEAD)
            cells.area[i] = 0.0f;
    assert_true(isinf(part(SCORE_UPPER)) && part(SCORE_LOWER) == 0);
    no_gap();
    for (uint32_t i = 0; i < GRID_N; i++)
        if (grid_region_of(i) == GRID_NOSE)
            cells.area[i] = 0.0f;
    assert_true(isinf(part(SCORE_UPPER)) && isinf(part(SCORE_LOWER)));
    memset(cells.area, 0, sizeof cells.area);
    assert_true(isinf(part(SCORE_UPPER)) && isinf(part(SCORE_LOWER)));
}

static void test_memory(void **state)
{
    struct scratch fresh = {0};
    struct score s;
    double mm;

    (void)state;
    no_gap();
    fail_alloc_at(1);
    assert_int_equal(score_of(&model, &changed, &cells, &fresh, &fit, &s), ST_ENOMEM);
    fail_alloc_at(0);
    assert_int_equal(score_of(&model, &changed, &cells, &fresh, &fit, &s), ST_OK);
    scratch_free(&fresh);
    fail_alloc_at(1);
    assert_int_equal(score_of_part(&model, SCORE_UPPER, &parts[0], &cells, &fresh, &mm),
                     ST_ENOMEM);
    fail_alloc_at(0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_identical),       cmocka_unit_test(test_definition),
        cmocka_unit_test(test_noise),           cmocka_unit_test(test_cap),
        cmocka_unit_test(test_regions),         cmocka_unit_test(test_covered),
        cmocka_unit_test(test_scale_of_weight), cmocka_unit_test(test_parts),
        cmocka_unit_test(test_part_alone),      cmocka_unit_test(test_part_hidden),
        cmocka_unit_test(test_memory),
    };
    int failed;

    toy_model(&model);
    fit_prepare(&model.change, &changed);
    for (int p = 0; p < SCORE_PARTS; p++)
        score_prepare_part(&model, (enum score_part)p, &parts[p]);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    scratch_free(&scratch);
    return failed;
}
