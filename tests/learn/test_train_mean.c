/* The height of a surface in each cell of its frame. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "align_pose.h"
#include "brute.h"
#include "surface.h"
#include "toy.h"
#include "train_mean.h"

static struct surface surface;

static double toy(const void *arg, double x, double y)
{
    (void)arg;
    return toy_height(x, y);
}

/* The map of the mean face is the mean face; cells without surface are empty. */
static void test_map(void **state)
{
    static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    static float z[GRID_N];
    struct align_pose pose, back;
    struct brute_rng rng = {7};

    (void)state;
    toy_pose(10, -8, 20, (struct dvec3){40, 50, 60}, &pose);
    back = align_pose_after(&pose, &still);
    toy_scan(toy, NULL, 9000, &pose, &rng, &surface);
    train_mean_map(&surface, &back, z);
    for (uint32_t c = 0; c < GRID_N; c++) {
        const double u = grid_x(c) / 55, v = grid_y(c) / 70;

        if (u * u + v * v < 0.7)
            assert_true(fabs((double)z[c] - toy_height(grid_x(c), grid_y(c))) < 1.2);
        if (u * u + v * v > 1.3)
            assert_true(isnan(z[c]));
    }
    pose.t[0] = 900;
    train_mean_map(&surface, &pose, z);
    for (uint32_t c = 0; c < GRID_N; c++)
        assert_true(isnan(z[c]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_map)};
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);

    surface_free(&surface);
    return failed;
}
