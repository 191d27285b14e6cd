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

/* lsq_add(r, from, to, sum, stride): Adds the rows' weighted products to sum[k][l], for the
 * columns l of from..to-1 (multiples of NORMAL_LANES) and all k up to l: the upper triangle,
 * and up to NORMAL_LANES - 1 below the diagonal.  Empties r.
 * Cost: O(rows to (to - from)). */
void lsq_add(struct lsq_rows *r, uint32_t from, uint32_t to, float *sum, uint32_t stride);

/* lsq_times(row, stride, n, by, width, out): Sets out[k], k below width, to the sum over n rows of
 * by[i] row[i stride + k], in the rows' order.  Cost: O(n width). */
void lsq_times(const float *row, uint32_t stride, uint32_t n, const float *by,
               uint32_t width, float *out);

/* lsq_dot(row, stride, n, by, width, out): Sets out[i] to the product of the i-th of n rows with by,
 * in NORMAL_LANES sums.  Cost: O(n width). */
void lsq_dot(const float *row, uint32_t stride, uint32_t n, const float *by,
             uint32_t width, float *out);

/* lsq_add_rows(row, stride, n, by, width, out): Adds by[k] row[k stride + i] to out[i], i below width, for each of n
 * rows in their order.  Cost: O(n width). */
void lsq_add_rows(const double *row, uint32_t stride, uint32_t n, const double *by,
                  uint32_t width, double *out);

/* lsq_factor(h, stride, to, n): Computes in place the first `to` columns of Cholesky's factor of a
 * symmetric n x n matrix, whose lower triangle stands in h by columns (h[column * stride + row]).
 * The other columns become the Schur complement of the first ones.
 * Cost: O(n^2 to).
 * Returns false if the matrix is not positive definite. */
bool lsq_factor(double *h, uint32_t stride, uint32_t to, uint32_t n);

/* lsq_forward(h, stride, to, n, v): Sets the first `to` elements of v to those of L^-1 v, and
 * eliminates these unknowns from the others. */
void lsq_forward(const double *h, uint32_t stride, uint32_t to, uint32_t n, double *v);

/* lsq_backward(h, stride, n, v): Sets v to L^-T v. */
void lsq_backward(const double *h, uint32_t stride, uint32_t n, double *v);

#endif
