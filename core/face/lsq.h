/* lsq.h -- normal equations of many rows: weighted sums of products, and their Cholesky
 * factor.  Used where a linear model is fitted to the cells of a face (fit.h, encode.h).
 * Products are floats, summed in a fixed order; the factor is in doubles, by + - * / and sqrt
 * alone: the same digits everywhere. */
#ifndef CORE_LSQ_H
#define CORE_LSQ_H
#include <stdbool.h>
#include <stdint.h>

#define NORMAL_LANES 8   /* widths are multiples of it */
#define NORMAL_WIDTH 216 /* columns at most */
#define NORMAL_ROWS  32  /* that wait to be added: they stay in the first-level cache */

/* Rows to be added: the rows, and the rows times their weights. */
struct lsq_rows {
    float row[NORMAL_ROWS][NORMAL_WIDTH], times[NORMAL_ROWS][NORMAL_WIDTH];
    uint32_t n;
};

/* lsq_add(r, from, to, sum, stride): sum[k][l] += the rows' products, weighted, for the
 * columns l of from..to-1 (multiples of NORMAL_LANES) and all k up to l: the upper triangle,
 * and up to NORMAL_LANES - 1 below the diagonal.  r is empty then.  O(rows to (to - from)). */
void lsq_add(struct lsq_rows *r, uint32_t from, uint32_t to, float *sum, uint32_t stride);

/* lsq_times(row, stride, n, by, width, out): out[k], k below width, is the sum over n rows of
 * by[i] row[i stride + k], in the rows' order.  O(n width). */
void lsq_times(const float *row, uint32_t stride, uint32_t n, const float *by,
               uint32_t width, float *out);

/* lsq_dot(row, stride, n, by, width, out): out[i] is the product of the i-th of n rows with by,
 * in NORMAL_LANES sums.  O(n width). */
void lsq_dot(const float *row, uint32_t stride, uint32_t n, const float *by,
             uint32_t width, float *out);

/* lsq_factor(h, stride, from, to, n): Cholesky's factor of the symmetric n x n matrix whose
 * lower triangle stands in h by columns (h[column * stride + row]), in place, for the columns
 * from..to-1; those before are factored already.  The columns from `to` on are then the Schur
 * complement of those before.  False: not positive definite.  O(n^2 (to - from)). */
bool lsq_factor(double *h, uint32_t stride, uint32_t from, uint32_t to, uint32_t n);

/* lsq_forward(h, stride, to, n, v): v becomes L^-1 v for the first `to` unknowns, and for
 * the others what eliminating those leaves of them.
 * lsq_backward(h, stride, n, v): v becomes L^-T v. */
void lsq_forward(const double *h, uint32_t stride, uint32_t to, uint32_t n, double *v);
void lsq_backward(const double *h, uint32_t stride, uint32_t n, double *v);

#endif
