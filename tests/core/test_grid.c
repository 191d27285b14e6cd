/* The grid: its cells tile the frame, and mirror images and regions are consistent with it. */
#include "brute.h"
#include "grid.h"
#include "unit.h"

/* Every point of the grid lies in one cell, whose centre is within half a cell. */
TEST(test_cells)
{
    struct draw rng = {brute_seed("grid")};
    const double right = GRID_LEFT + GRID_NX * GRID_MM;
    const double top = GRID_BOTTOM + GRID_NY * GRID_MM;

    for (uint32_t c = 0; c < GRID_N; c++) {
        assert_int_equal(grid_cell(grid_x(c), grid_y(c)), c);
        assert_int_equal(grid_cell(grid_x(c) - 0.5 * GRID_MM, grid_y(c) - 0.5 * GRID_MM),
                         c); /* the lower left corner is its own */
    }
    for (int i = 0; i < 100000; i++) {
        const double x = draw_uniform(&rng, GRID_LEFT, right);
        const double y = draw_uniform(&rng, GRID_BOTTOM, top);
        const uint32_t c = grid_cell(x, y);

        assert_true(c < GRID_N);
        assert_true(fabs(grid_x(c) - x) <= GRID_MM / 2 + 1e-9);
        assert_true(fabs(grid_y(c) - y) <= GRID_MM / 2 + 1e-9);
    }
    assert_true(GRID_LEFT == -right); /* x = 0 is the symmetry plane */
    assert_int_equal(grid_cell(right, 0), GRID_NONE);
    assert_int_equal(grid_cell(GRID_LEFT - 1e-6, 0), GRID_NONE);
    assert_int_equal(grid_cell(0, top), GRID_NONE);
    assert_int_equal(grid_cell(0, GRID_BOTTOM - 1e-6), GRID_NONE);
    assert_int_equal(grid_cell((double)NAN, 0), GRID_NONE);
    assert_int_equal(grid_cell(0, (double)NAN), GRID_NONE);
    assert_int_equal(grid_cell(0, 1e300), GRID_NONE);
    assert_int_equal(grid_cell(-(double)INFINITY, 0), GRID_NONE);
}

TEST(test_mirror)
{
    for (uint32_t c = 0; c < GRID_N; c++) {
        const uint32_t m = grid_mirror(c);

        assert_true(m < GRID_N && m != c && grid_mirror(m) == c);
        assert_true(grid_x(m) == -grid_x(c) && grid_y(m) == grid_y(c));
    }
}

/* Every region has cells, is symmetric, and lies where its name says (test_libsurface.c has the names). */
TEST(test_regions)
{
    static const struct {
        double x, y;
        enum surface_region r;
    } at[] = {
        {2, 2, SURFACE_NOSE},    {32, 32, SURFACE_EYES},     {2, 40, SURFACE_EYES},
        {40, 0, SURFACE_CHEEKS}, {10, 62, SURFACE_FOREHEAD}, {58, 30, SURFACE_CHEEKS},
        {6, -66, SURFACE_CHIN},  {6, -30, SURFACE_MOUTH},
    };
    uint32_t count[SURFACE_REGIONS] = {0}, sum = 0;

    for (uint32_t c = 0; c < GRID_N; c++) {
        assert_in_range(grid_region_of(c), 0, SURFACE_REGIONS - 1);
        assert_int_equal(grid_region_of(c), grid_region_of(grid_mirror(c)));
        count[grid_region_of(c)]++;
    }
    for (int r = 0; r < SURFACE_REGIONS; r++) {
        assert_true(count[r] > 20);
        sum += count[r];
    }
    assert_int_equal(sum, GRID_N);
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        assert_int_equal(grid_region_of(grid_cell(at[i].x, at[i].y)), at[i].r);
}
