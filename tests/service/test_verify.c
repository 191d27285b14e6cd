/* The heat map has a value for each point that was sent, in their order: null for those that
 * were dropped when they were read, or not used. */
#include "unit.h"
#include "cloudpoints.h"
#include "verify.h"

#define READ 7

/* The n values 1, 2, ... at the places of index, of READ; the wanted ones, 0 for null. */
static void check(uint32_t *index, size_t n, const double wanted[READ])
{
    struct cloudpoints c = {.index = index, .n = n, .read = READ};
    double value[READ];

    for (size_t i = 0; i < READ; i++)
        value[i] = i < n ? (double)i + 1 : 99;
    verify_spread(&c, value);
    for (size_t i = 0; i < READ; i++)
        if (wanted[i] == 0)
            assert_true(isnan(value[i]));
        else
            assert_true(value[i] == wanted[i]);
}

TEST(test_spread)
{
    uint32_t first[] = {0, 1, 2}, last[] = {4, 5, 6}, some[] = {1, 3, 6},
             all[] = {0, 1, 2, 3, 4, 5, 6};

    check(NULL, READ, (const double[]){1, 2, 3, 4, 5, 6, 7});
    check(all, READ, (const double[]){1, 2, 3, 4, 5, 6, 7});
    check(first, 3, (const double[]){1, 2, 3, 0, 0, 0, 0});
    check(last, 3, (const double[]){0, 0, 0, 0, 1, 2, 3});
    check(some, 3, (const double[]){0, 1, 0, 2, 0, 0, 3});
    check(some, 1, (const double[]){0, 1, 0, 0, 0, 0, 0});
    check(some, 0, (const double[]){0, 0, 0, 0, 0, 0, 0});
}
