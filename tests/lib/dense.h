/* dense.h -- linear algebra by definition, in doubles: slow and short, to compare with. */
#ifndef TESTS_DENSE_H
#define TESTS_DENSE_H
#include <stddef.h>

/* dense_solve(m, n, b, columns): Solves by Gauss's elimination with pivots: b (n x columns, row by
 * row) becomes m^-1 b; m (n x n, row by row) is overwritten.  Cost: O(n^2 (n + columns)).
 * Returns ln |det m|. */
double dense_solve(double *m, size_t n, double *b, size_t columns);

/* dense_square(m, n, v, ln_det): Returns v' m^-1 v, and sets *ln_det to ln |det m|.  m is
 * overwritten. */
double dense_square(double *m, size_t n, const double *v, double *ln_det);

#endif
