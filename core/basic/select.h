/* select.h -- order statistics: medians and other quantiles. */
#ifndef CORE_SELECT_H
#define CORE_SELECT_H
#include <stddef.h>

/* select_kth(v, n, k): the k-th smallest of v[0..n-1], counted from 0; v is put in another
 * order.  No value is a NAN; k < n.
 * Cost  O(n) for any values in any order: at most 64 rounds over the values left. */
double select_kth(double *v, size_t n, size_t k);

/* select_sort(v, n): the least first.  No value is a NAN.  In place, as a library's sort that takes memory
 * would leave values of a face there.  Cost  as select_kth(), over all values in each round. */
void select_sort(double *v, size_t n);

#endif
