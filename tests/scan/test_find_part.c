/* The parts of a cloud: what belongs to one, which are taken, and in which order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "brute.h"
#include "find_part.h"

#define MANY 40000

static struct brute_rng rng;

static double within(double half)
{
    return half * (2 * brute_real(&rng) - 1);
}

/* n points in a box about (x, y, z). */
static size_t add(struct dvec3 *pts, size_t at, size_t n, struct dvec3 c,
                  struct dvec3 half)
{
    for (size_t i = 0; i < n; i++)
        pts[at + i] = (struct dvec3){c.x + within(half.x), c.y + within(half.y),
                                     c.z + within(half.z)};
    return at + n;
}

static void test_parts(void **state)
{
    static struct dvec3 pts[MANY];
    const struct dvec3 head = {80, 120, 90};
    struct find_grid g, parts[FIND_PARTS];
    uint32_t n, voxels = 0;
    size_t m = 0;

    (void)state;
    rng.state = brute_seed("test_find_part");
    m = add(pts, m, 8000, (struct dvec3){0, 0, 0}, head);
    m = add(pts, m, 9000, (struct dvec3){300, 0, 0}, head); /* 140 mm apart */
    m = add(pts, m, 15000, (struct dvec3){0, 0, -300},
            (struct dvec3){700, 500, 1}); /* wall */
    m = add(pts, m, 500, (struct dvec3){0, 400, 0},
            (struct dvec3){20, 20, 20}); /* small */
    m = add(pts, m, 200, (struct dvec3){500, 0, 0}, (struct dvec3){5, 100, 5}); /* few */
    assert_int_equal(find_grid_make(pts, m, 1, (struct dvec3){0, 0, 0}, &g), ST_OK);
    assert_int_equal(find_part_all(&g, parts, &n), ST_OK);
    assert_int_equal(n, 2);
    for (uint32_t k = 0; k < n; k++) {
        uint32_t points = 0;

        for (uint32_t v = 0; v < parts[k].nvoxels; v++) {
            const double x = (double)parts[k].voxel[v].at[0] + g.corner.x;

            points += parts[k].voxel[v].n;
            assert_true(k == 0 ? x > 219 && x < 381 : x > -81 && x < 81);
        }
        assert_int_equal(points, k == 0 ? 9000 : 8000);
        assert_int_equal(parts[k].first[parts[k].ncells], parts[k].nvoxels);
        voxels += parts[k].nvoxels;
        find_grid_free(&parts[k]);
    }
    assert_true(voxels < g.nvoxels);
    find_grid_free(&g);
}

/* A run of cells is the same found by looking at all. */
static void test_runs(void **state)
{
    static struct dvec3 pts[2000];
    struct find_grid g;

    (void)state;
    rng.state = brute_seed("test_find_part");
    (void)add(pts, 0, 2000, (struct dvec3){5, 6, 7}, (struct dvec3){90, 60, 130});
    assert_int_equal(find_grid_make(pts, 2000, 1, (struct dvec3){0, 0, 0}, &g), ST_OK);
    for (int look = 0; look < 2000; look++) {
        const int32_t x0 = brute_int(&rng, -2, g.nx), x1 = x0 + brute_int(&rng, 0, 5);
        const int32_t y = brute_int(&rng, -1, g.ny), z = brute_int(&rng, -1, g.nz);
        const struct find_run run = find_grid_run(&g, x0, x1, y, z);
        uint32_t there = 0;

        for (uint32_t c = 0; c < g.ncells; c++) {
            int32_t at[3];

            find_grid_place(&g, c, at);
            if (at[0] < x0 || at[0] > x1 || at[1] != y || at[2] != z)
                continue;
            assert_true(c >= run.first && c < run.end);
            there++;
        }
        assert_int_equal(there, run.end - run.first);
    }
    find_grid_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_runs),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
