/* select.h -- order statistics: medians and other quantiles. */
#ifndef CORE_SELECT_H
#define CORE_SELECT_H
#include <stddef.h>

/* select_kth(v, n, k): Returns the k-th smallest of v[0..n-1], counted from 0, and reorders v.
 * No value is a NAN; k < n.
 * Cost: O(n) for any values in any order: at most 64 rounds over the values left. */
double select_kth(double *v, size_t n, size_t k);

/* select_sort(v, n): Sorts v, the least value first, in place: the memory of a library's sort would keep
 * values of a face.  No value is a NAN.  Cost: as select_kth(), over all values in each round. */
void select_sort(double *v, size_t n);

#endif
