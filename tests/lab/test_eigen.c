/* Eigenvalues and eigenvectors: of matrices where they are known, and what holds of all. */
#include "eigen.h"
#include "rates.h"
#include "unit.h"

#define MOST 80

static double a[MOST * MOST], was[MOST * MOST], value[MOST];

static double random_number(uint64_t *state)
{
    return (double)(rates_random(state) >> 11) / 4503599627370496.0 - 1;
}

/* Eigenvalues fall; a v = value v; the v are orthonormal, with their largest entries positive;
 * errors up to `within` of the largest entry. */
static void check(uint32_t n, double within)
{
    double largest = 0;

    memcpy(was, a, sizeof a);
    for (uint32_t i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(a[i]));
    assert_int_equal(eigen_symmetric(a, n, value), ST_OK);
    for (uint32_t k = 0; k < n; k++) {
        double most = 0;

        assert_true(k == 0 || value[k] <= value[k - 1]);
        for (uint32_t i = 0; i < n; i++) {
            double s = 0, both = 0;

            for (uint32_t j = 0; j < n; j++) {
                s += was[i * n + j] * a[k * n + j];
                both += a[i * n + j] * a[k * n + j];
            }
            assert_true(fabs(s - value[k] * a[k * n + i]) <= within * largest);
            assert_true(fabs(both - (i == k ? 1 : 0)) <= within);
            most = fabs(a[k * n + i]) > fabs(most) ? a[k * n + i] : most;
        }
        assert_true(most > 0);
    }
}

static void fill(uint32_t n, uint64_t *random, double by)
{
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k <= i; k++)
            a[i * n + k] = a[k * n + i] = by * random_number(random);
}

TEST(test_random)
{
    uint64_t random = 5;

    for (uint32_t n = 1; n <= 40; n++) {
        fill(n, &random, 1);
        check(n, 1e-13);
    }
    fill(20, &random, 1e200);
    check(20, 1e-13);
    fill(20, &random, 1e-200);
    check(20, 1e-13);
    fill(MOST, &random, 1);
    check(MOST, 1e-13);
}

/* Most eigenvalues are 0 but for rounding, as those of a covariance of few samples. */
TEST(test_low_rank)
{
    uint64_t random = 9;

    for (uint32_t rank = 1; rank < 6; rank++) {
        memset(a, 0, sizeof a);
        for (uint32_t k = 0; k < rank; k++) {
            double x[MOST];

            for (uint32_t i = 0; i < MOST; i++)
                x[i] = random_number(&random) * (k == 0 ? 1e5 : 1);
            for (uint32_t i = 0; i < MOST; i++)
                for (uint32_t j = 0; j < MOST; j++)
                    a[i * MOST + j] += x[i] * x[j];
        }
        check(MOST, 1e-13);
        assert_true(fabs(value[rank]) < 1e-14 * value[0] * MOST);
    }
}

TEST(test_not_finite)
{
    for (int i = 0; i < 2; i++) {
        memset(a, 0, sizeof a);
        a[5] = i == 0 ? (double)NAN : (double)INFINITY;
        assert_int_equal(eigen_symmetric(a, 3, value), ST_EINVAL);
    }
}
