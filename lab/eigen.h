/* eigen.h -- all eigenvalues and eigenvectors of a dense symmetric matrix.
 * Householder's reduction to a tridiagonal matrix, then the QL algorithm with implicit shifts
 * (tred2 and tql2: Martin, Reinsch and Wilkinson, Numerische Mathematik 11, 1968; Dubrulle,
 * Martin and Wilkinson, Numerische Mathematik 12, 1968).  By + - * / and sqrt in a fixed order:
 * the same digits with every compiler. */
#ifndef LAB_EIGEN_H
#define LAB_EIGEN_H
#include <stdint.h>
#include "status.h"

/* eigen_symmetric(a, n, value): Finds the eigenvalues of a, falling.  Row k of a becomes the eigenvector of
 * value[k], of length 1, with its largest entry by size positive.
 *   a  [n][n], symmetric
 * An eigenvalue's error is about n 1e-16 of the largest one.  Cost: about 5 n^3 products.
 * Returns ST_OK; ST_EINVAL: an entry is not finite; ST_EINTERNAL: QL does not converge; ST_ENOMEM. */
enum status eigen_symmetric(double *a, uint32_t n, double *value);

/* eigen_transpose(a, n): Transposes a, [n][n]. */
void eigen_transpose(double *a, uint32_t n);

/* eigen_add(y, by, x, n): Adds by x to y. */
void eigen_add(double *restrict y, double by, const double *restrict x, uint32_t n);

/* eigen_dot(x, y, n): Returns the scalar product. */
double eigen_dot(const double *x, const double *y, uint32_t n);

#endif
