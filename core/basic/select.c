/* select.c -- radix selection by bits.  Hoare's selection has a quadratic case for each
 * simple choice of the pivot, and whoever sends a scan chooses its values. */
#include "select.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The bits of x as a number in the order of the doubles. */
static uint64_t key(double x)
{
    uint64_t bits;

    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 != 0 ? ~bits : bits | UINT64_C(1) << 63;
}

/* Each round divides what is left by the highest bit in which its keys differ.  In either
 * part all keys agree in that bit and those above it, so each bit has one round at most. */
double select_kth(double *v, size_t n, size_t k)
{
    for (;;) {
        const uint64_t first = key(v[0]);
        uint64_t differ = 0, bit;
        size_t below = 0;

        for (size_t i = 1; i < n; i++)
            differ |= key(v[i]) ^ first;
        if (differ == 0)
            return v[0];
        bit = UINT64_C(1) << (63 - __builtin_clzll(differ));
        for (size_t i = 0; i < n; i++) {
            const double x = v[i];

            v[i] = v[below];
            v[below] = x;
            below += (key(x) & bit) == 0;
        }
        if (k < below) {
            n = below;
        } else {
            v += below;
            n -= below;
            k -= below;
        }
    }
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

void select_sort(double *v, size_t n)
{
    qsort(v, n, sizeof *v, by_value);
}
