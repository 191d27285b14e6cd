/* select.h -- order statistics: medians and other quantiles. */
#ifndef CORE_SELECT_H
#define CORE_SELECT_H
#include <stddef.h>

/* select_kth(v, n, k): the k-th smallest of v[0..n-1], counted from 0; v is put in another
 * order.  No value is a NAN; k < n.
 * Cost  O(n) for any values in any order: at most 64 rounds over the values left. */
double select_kth(double *v, size_t n, size_t k);

void select_sort(double *v, size_t n); /* the least first; no value is a NAN */

#endif
