/* eigen.h -- all eigenvalues and eigenvectors of a dense symmetric matrix.
 * Householder's reduction to a tridiagonal matrix, then the QL algorithm with implicit shifts
 * (tred2 and tql2: Martin, Reinsch and Wilkinson, Numerische Mathematik 11, 1968; Dubrulle,
 * Martin and Wilkinson, Numerische Mathematik 12, 1968).  By + - * / and sqrt in a fixed order:
 * the same digits with every compiler. */
#ifndef LAB_EIGEN_H
#define LAB_EIGEN_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"

/* eigen_symmetric(a, n, value): the eigenvalues of a, falling, into value[n]; row k of a becomes
 * the eigenvector of value[k], of length 1; its largest entry by size is positive.
 * a  [n][n], symmetric
 * An eigenvalue's error is about n 1e-16 of the largest one.  Cost  about 5 n^3 products.
 * Returns ST_OK; ST_EINVAL an entry is not finite; ST_EINTERNAL QL does not converge; ST_ENOMEM. */
enum status eigen_symmetric(double *a, uint32_t n, double *value);

/* eigen_cholesky(a, n): the lower triangle of a, [n][n], becomes L with L L' = a; the rest is
 * neither read nor written.  False: a is not positive definite. */
bool eigen_cholesky(double *a, uint32_t n);

/* eigen_add(y, by, x, n): y += by x.  eigen_dot(x, y, n): their product. */
void eigen_add(double *restrict y, double by, const double *restrict x, uint32_t n);
double eigen_dot(const double *x, const double *y, uint32_t n);

#endif
