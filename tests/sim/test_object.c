/* Things that are no faces: every kind gives a scan of a sensible size, the same seed gives the
 * same one, and solids are where their parts are. */
#include "object.h"
#include "solid.h"
#include "unit.h"

#define N 600

static struct dvec3 a[N], b[N];

TEST(test_every_kind)
{
    for (uint32_t k = 0; k < OBJECT_KINDS; k++)
        for (uint64_t seed = 0; seed < 2; seed++) {
            const size_t n = object_scan(k, seed, N, a);
            double least = 1e9, most = -1e9;

            assert_in_range(n, N / 10, N);
            assert_int_equal(n, object_scan(k, seed, N, b));
            assert_memory_equal(a, b, n * sizeof *a);
            for (size_t i = 0; i < n; i++) {
                assert_true(isfinite(a[i].z) && fabs(a[i].z) < 1000);
                least = fmin(least, fmin(a[i].x, a[i].y));
                most = fmax(most, fmax(a[i].x, a[i].y));
            }
            assert_true(most - least > 60 && most - least < 500);
            (void)object_scan(k, seed + 2, N, b);
            assert_memory_not_equal(a, b, 100 * sizeof *a);
        }
}

/* A ball with a box taken out of it: the scanner sees the ball from the front, and the bottom
 * of the hole. */
TEST(test_solid)
{
    static const struct solid_view front = {
        .turn = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .wide = 60, .points = N};
    struct draw r = {1};
    struct solid s = {0};
    size_t n, deep = 0;

    solid_add(&s, SOLID_BALL, 5, 0, 0, 50, 50, 50, 0);
    solid_add(&s, SOLID_BOX, 5, 0, 50, 10, 10, 40, 0)->carved = true;
    n = solid_scan(&s, &front, &r, a);
    assert_int_equal(n, N);
    for (size_t i = 0; i < n; i++) {
        const double x = a[i].x - 5, y = a[i].y, r2 = 2500 - x * x - y * y;

        if (fabs(x) < 9.5 && fabs(y) < 9.5) {
            assert_true(fabs(a[i].z - 10) < 0.1);
            deep++;
        } else if (fabs(x) > 10.5 || fabs(y) > 10.5) {
            assert_true(r2 > 0 && fabs(a[i].z - sqrt(r2)) < 0.1);
        }
    }
    assert_in_range(deep, N / 40, N / 10);
}
