/* Selection compared with sorting, on values that are hard for selection. */
#include <float.h>
#include <unistd.h>

#include "brute.h"
#include "select.h"
#include "unit.h"

#define MOST (1 << 21) /* points of the largest mesh */

static double value[MOST], sorted[MOST], v[MOST];

/* Checks some ranks of value[0..n-1], among them the first, middle and last, and that v keeps
 * its values. */
static void check(size_t n)
{
    const size_t step = n > 40 ? n / 7 : 1;

    memcpy(sorted, value, n * sizeof *value);
    select_sort(sorted, n);
    for (size_t k = 0; k < n; k += step) {
        memcpy(v, value, n * sizeof *value);
        assert_true(select_kth(v, n, k) == sorted[k]);
        assert_true(select_kth(v, n, n - 1 - k) == sorted[n - 1 - k]); /* v reordered */
        assert_true(select_kth(v, n, n / 2) == sorted[n / 2]);
        select_sort(v, n);
        for (size_t i = 0; i < n; i++)
            assert_true(v[i] == sorted[i]);
    }
}

/* A value of a kind: close together, of all magnitudes, many equal ones, both signs. */
static double draw(int kind, struct draw *r)
{
    switch (kind) {
    case 0:
        return draw_uniform(r, 0, 1);
    case 1:
        return ldexp(draw_uniform(r, -0.5, 0.5), brute_int(r, -1100, 1020));
    case 2:
        return brute_int(r, -2, 2);
    case 3:
        return brute_int(r, -(1 << 24), 1 << 24);
    case 4:
        return draw_uniform(r, 0, 1) < 0.5 ? 0.0 : -0.0;
    default:
        return draw_uniform(r, 0, 1) < 0.5 ? (double)INFINITY : -DBL_MAX;
    }
}

TEST(test_random)
{
    struct draw r = {brute_seed("select")};

    for (int kind = 0; kind < 6; kind++)
        for (size_t n = 1; n < 3000; n += 1 + n / 3) {
            for (size_t i = 0; i < n; i++)
                value[i] = draw(kind, &r);
            check(n);
        }
}

/* Fills value[] such that the middle element of what is left is its minimum in each round:
 * selection with that pivot (Hoare's) takes quadratic time. */
static void make_killer(size_t n)
{
    uint32_t *place = malloc(n * sizeof *place);

    assert_non_null(place);
    for (size_t i = 0; i < n; i++)
        place[i] = (uint32_t)i;
    for (size_t lo = 0; lo < n; lo++) {
        const size_t middle = lo + (n - 1 - lo) / 2;
        const uint32_t p = place[middle];

        value[p] = (double)lo;
        place[middle] = place[lo];
        place[lo] = p;
    }
    free(place);
}

/* Quadratic selection would take some 10^12 steps: the alarm kills it. */
TEST(test_killer)
{
    make_killer(2000);
    check(2000);
    make_killer(MOST);
    (void)alarm(60);
    assert_true(select_kth(value, MOST, MOST / 2) == MOST / 2);
    (void)alarm(0);
}
