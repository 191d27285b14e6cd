#include "solve.h"

#include <math.h>
#include <stddef.h>

/* cholesky(m): the lower factor of the symmetric matrix m in its lower triangle, in place;
 * false when m is not positive definite to working precision. */
static bool cholesky(double m[6][6])
{
    for (size_t i = 0; i < 6; i++) {
        for (size_t k = 0; k <= i; k++) {
            double s = m[i][k];

            for (size_t l = 0; l < k; l++)
                s -= m[i][l] * m[k][l];
            if (k < i) {
                m[i][k] = s / m[k][k];
            } else {
                if (!(s > 1e-13 * m[i][i]))
                    return false;
                m[i][i] = sqrt(s);
            }
        }
    }
    return true;
}

bool solve_equations(const struct solve_normal *a, double damping, double x[6])
{
    double m[6][6];
    double mean[2] = {0.0, 0.0};
    const double *h = a->h;

    for (size_t i = 0; i < 6; i++)
        for (size_t k = i; k < 6; k++)
            m[k][i] = *h++;
    for (size_t i = 0; i < 6; i++)
        mean[i / 3] += m[i][i] / 3.0;
    for (size_t i = 0; i < 6; i++) {
        m[i][i] += damping * (m[i][i] + mean[i / 3]);
        x[i] = 0.0;
    }
    if (!cholesky(m))
        return false;
    for (size_t i = 0; i < 6; i++) {
        double s = -a->g[i];

        for (size_t k = 0; k < i; k++)
            s -= m[i][k] * x[k];
        x[i] = s / m[i][i];
    }
    for (size_t i = 6; i-- > 0;) {
        double s = x[i];

        for (size_t k = i + 1; k < 6; k++)
            s -= m[k][i] * x[k];
        x[i] = s / m[i][i];
    }
    return true;
}
