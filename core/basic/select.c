/* select.c -- radix selection and sorting by bits, in place.  Hoare's selection has a quadratic case
 * for each simple choice of the pivot, and whoever sends a scan chooses its values. */
#include "select.h"

#include <stdint.h>
#include <string.h>

/* Values that are sorted by insertion. */
#define FEW 16

/* The bits of x as a number in the order of the doubles. */
static uint64_t key(double x)
{
    uint64_t bits;

    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 != 0 ? ~bits : bits | UINT64_C(1) << 63;
}

/* Divides v[0..n-1] by the highest bit in which the keys differ: those without it come first.  Returns
 * how many they are; n if all are the same. */
static size_t divide(double *v, size_t n)
{
    const uint64_t first = key(v[0]);
    uint64_t differ = 0, bit;
    size_t below = 0;

    for (size_t i = 1; i < n; i++)
        differ |= key(v[i]) ^ first;
    if (differ == 0)
        return n;
    bit = UINT64_C(1) << (63 - __builtin_clzll(differ));
    for (size_t i = 0; i < n; i++) {
        const double x = v[i];

        v[i] = v[below];
        v[below] = x;
        below += (key(x) & bit) == 0;
    }
    return below;
}

/* In either part all keys agree in the bit that divides them and those above it, so each bit has one
 * round at most. */
double select_kth(double *v, size_t n, size_t k)
{
    for (;;) {
        const size_t below = divide(v, n);

        if (below == n)
            return v[0];
        if (k < below) {
            n = below;
        } else {
            v += below;
            n -= below;
            k -= below;
        }
    }
}

void select_sort(double *v, size_t n)
{
    while (n > FEW) {
        const size_t below = divide(v, n);

        if (below == n)
            return;
        select_sort(v, below); /* 64 deep at most */
        v += below;
        n -= below;
    }
    for (size_t i = 1; i < n; i++) {
        const double x = v[i];
        size_t k = i;

        for (; k > 0 && v[k - 1] > x; k--)
            v[k] = v[k - 1];
        v[k] = x;
    }
}
