/* Things that are no faces: every kind gives a scan of a sensible size, and the same seed gives
 * the same one. */
#include "object.h"
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
