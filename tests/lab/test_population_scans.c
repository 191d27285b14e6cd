/* A population adapted to scans whose gaps are made up by a known rule. */
#include "population_scans.h"
#include "rates.h"
#include "toy.h"
#include "unit.h"

#define SUBJECTS 60
#define SCANS    4

static struct surface_model toy;
static struct population p, was;
static struct population_scan scan[SUBJECTS * SCANS];

BEFORE_EACH(begin)
{
    toy_model(&toy);
    assert_int_equal(population_read(&toy, &p), ST_OK);
    assert_int_equal(population_read(&toy, &was), ST_OK);
}

AFTER_EACH(end)
{
    population_free(&p);
    population_free(&was);
}

/* Variance 1. */
static double random_number(uint64_t *state)
{
    return ((double)(rates_random(state) >> 11) / 4503599627370496.0 - 1) * sqrt(3.0);
}

/* A pattern that is symmetric, changes its sign twice and so is like no motion. */
static double pattern(uint32_t cell, double mm)
{
    const double x = grid_x(cell), y = grid_y(cell);

    return ((int)floor((fabs(x) + 200) / 12) + (int)floor((y + 200) / 12)) % 2 == 0 ? mm
                                                                                    : -mm;
}

/* Each person has a pattern of 2 mm, each scan besides one of the other places, of 1 mm. */
static void make(double hole)
{
    uint64_t random = 7;

    for (uint32_t i = 0; i < SUBJECTS * SCANS; i++) {
        static double own;
        const double change = random_number(&random);

        if (i % SCANS == 0)
            own = random_number(&random);
        scan[i].subject = i / SCANS;
        for (uint32_t c = 0; c < GRID_N; c++) {
            const bool low = grid_y(c) < 0;

            scan[i].gap[c] = (float)(low ? change * pattern(c, 1) : own * pattern(c, 2));
            if (isnan(p.mean[c]) || fabs(grid_x(c) - 20) < hole)
                scan[i].gap[c] = (float)NAN;
        }
    }
}

static bool is_used(uint32_t i, bool low)
{
    return (grid_y(p.cells.at[i]) < 0) == low;
}

/* The mean variance over the lower or the upper cells. */
static double variance(const struct spread *s, bool low)
{
    double sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < p.cells.n; i++)
        if (is_used(i, low)) {
            sum += spread_variance(s, i);
            n++;
        }
    return sum / n;
}

static bool same(const struct spread *a, const struct spread *b, double within)
{
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < a->n * a->n; i++)
            if (!(fabs(a->block[k][i] - b->block[k][i]) <= within))
                return false;
    return true;
}

/* With all of the weight the scans' own variances are found: what differs within a person is
 * change, what between people identity.  (Motion takes a little of both.) */
TEST(test_whole)
{
    make(0);
    assert_int_equal(population_scans_blend(&p, scan, SUBJECTS * SCANS, 1), ST_OK);
    assert_true(fabs(variance(&p.change, true) - 1) < 0.15);
    assert_true(variance(&p.change, false) < 0.05);
    assert_true(fabs(variance(&p.identity, false) - 4) < 0.8);
    assert_true(fabs(variance(&p.identity, true)) < 0.15); /* less what change brings */
    assert_true(fabs(variance(&p.shape, true) - 1) < 0.15);
    assert_true(fabs(variance(&p.shape, false) - 4) < 0.8);
}

/* No weight, or no scans: as before. */
TEST(test_none)
{
    make(0);
    assert_int_equal(population_scans_blend(&p, scan, SUBJECTS * SCANS, 0), ST_OK);
    assert_int_equal(population_scans_blend(&p, scan, 0, 0.5), ST_OK);
    assert_true(same(&p.change, &was.change, 0) && same(&p.identity, &was.identity, 0) &&
                same(&p.shape, &was.shape, 0));
}

/* Cells that no scan shows stay as they were, but for motion; with their mirror images the
 * scans' are known. */
TEST(test_holes)
{
    uint32_t holes = 0;

    population_still(&was, &was.change);
    make(200); /* all */
    assert_int_equal(population_scans_blend(&p, scan, SUBJECTS * SCANS, 1), ST_OK);
    assert_true(same(&p.change, &was.change, 1e-12));
    end();
    begin();
    make(15); /* on one side: what the other side shows stands for both */
    assert_int_equal(population_scans_blend(&p, scan, SUBJECTS * SCANS, 1), ST_OK);
    for (uint32_t i = 0; i < p.cells.n; i++) {
        const uint32_t at = p.cells.at[i];

        if (grid_x(at) < -5 && grid_x(at) > -35 && grid_y(at) < -8) {
            assert_true(fabs(spread_variance(&p.change, i) - 1) < 0.4);
            holes++;
        }
    }
    assert_true(holes > 20);
}

/* One scan of each: nothing is learned of change, and it is not taken for identity. */
TEST(test_single)
{
    make(0);
    for (uint32_t i = 0; i < SUBJECTS; i++)
        scan[i] = scan[i * SCANS];
    population_still(&was, &was.change);
    assert_int_equal(population_scans_blend(&p, scan, SUBJECTS, 1), ST_OK);
    assert_true(same(&p.change, &was.change, 1e-12));
    assert_true(fabs(variance(&p.identity, true) - (1 - variance(&was.change, true))) <
                0.4);
}

/* Gaps: motion is removed, what is far away is unknown, and so are scans of too little. */
TEST(test_gaps)
{
    float z[GRID_N], gap[GRID_N];

    for (uint32_t c = 0; c < GRID_N; c++) {
        z[c] = p.mean[c];
        for (uint32_t k = 0; k < POPULATION_MOTIONS && !isnan(z[c]); k++)
            z[c] += (float)(k % 2 == 0 ? 0.7 : -0.4) * p.motion[k][c] / p.normal_z[c];
    }
    z[grid_cell(1, 1)] += 50.0f;
    z[grid_cell(20, -20)] = (float)NAN;
    assert_int_equal(population_scans_gap(&p, z, gap), 2 * p.cells.n - 2);
    for (uint32_t c = 0; c < GRID_N; c++)
        if (isnan(p.mean[c]) || c == grid_cell(1, 1) || c == grid_cell(20, -20))
            assert_true(isnan(gap[c]));
        else
            assert_true(fabsf(gap[c]) < 1e-4f);
    for (uint32_t c = 0; c < GRID_N; c++)
        z[c] = grid_y(c) > 40 ? z[c] : (float)NAN;
    assert_int_equal(population_scans_gap(&p, z, gap), 0);
    for (uint32_t c = 0; c < GRID_N; c++)
        assert_true(isnan(gap[c]));
}

/* A model of half a face has no population. */
TEST(test_too_little)
{
    struct population none;
    struct surface_model *m = malloc(sizeof *m);

    assert_non_null(m);
    *m = toy;
    for (uint32_t i = 0; i < GRID_N; i++)
        if (grid_x(i) > 0)
            m->mean[i] = (float)NAN;
    assert_int_equal(population_read(m, &none), ST_EINVAL);
    assert_null(none.change.block[0]);
    population_free(&none);
    free(m);
}
