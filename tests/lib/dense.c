#include "dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void exchange(double *a, double *b, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const double t = a[i];

        a[i] = b[i];
        b[i] = t;
    }
}

static void subtract(double *from, const double *row, double by, size_t n)
{
    for (size_t i = 0; i < n; i++)
        from[i] -= by * row[i];
}

double dense_solve(double *m, size_t n, double *b, size_t columns)
{
    double ln_det = 0;

    for (size_t k = 0; k < n; k++) {
        size_t best = k;

        for (size_t i = k + 1; i < n; i++)
            best = fabs(m[i * n + k]) > fabs(m[best * n + k]) ? i : best;
        exchange(m + k * n, m + best * n, n);
        exchange(b + k * columns, b + best * columns, columns);
        ln_det += log(fabs(m[k * n + k]));
        for (size_t i = k + 1; i < n; i++) {
            const double by = m[i * n + k] / m[k * n + k];

            subtract(m + i * n + k, m + k * n + k, by, n - k);
            subtract(b + i * columns, b + k * columns, by, columns);
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t i = k + 1; i < n; i++)
            subtract(b + k * columns, b + i * columns, m[k * n + i], columns);
        for (size_t c = 0; c < columns; c++)
            b[k * columns + c] /= m[k * n + k];
    }
    return ln_det;
}

double dense_square(double *m, size_t n, const double *v, double *ln_det)
{
    double *x = malloc(n * sizeof *x), sum = 0;

    if (x == NULL)
        abort();
    memcpy(x, v, n * sizeof *x);
    *ln_det = dense_solve(m, n, x, 1);
    for (size_t i = 0; i < n; i++)
        sum += v[i] * x[i];
    free(x);
    return sum;
}
