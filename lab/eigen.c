#include "eigen.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define EPSILON 2.220446049250313e-16
#define SWEEPS  60 /* of QL for an eigenvalue; two or three are usual */

void eigen_add(double *restrict y, double by, const double *restrict x, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        y[i] += by * x[i];
}

double eigen_dot(const double *x, const double *y, uint32_t n)
{
    double s = 0;

    for (uint32_t i = 0; i < n; i++)
        s += x[i] * y[i];
    return s;
}

/* The reflection I - beta v v' that takes x to a multiple (returned) of the first axis; x becomes
 * v.  beta 0: x is one already. */
static double reflect(double *x, uint32_t n, double *beta)
{
    const double below = eigen_dot(x + 1, x + 1, n - 1), first = x[0];
    const double length = sqrt(first * first + below);
    const double to = first > 0 ? -length : length;

    *beta = 0;
    if (below <= 0)
        return first;
    x[0] = first - to;
    *beta = 2 / (x[0] * x[0] + below);
    return to;
}

/* m -= v q' + q v', m the square at the lower right of a, from row and column k on. */
static void subtract_both(double *a, uint32_t n, uint32_t k, const double *v,
                          const double *q)
{
    for (uint32_t i = k; i < n; i++) {
        double *row = a + (size_t)i * n + k;

        eigen_add(row, -v[i - k], q, n - k);
        eigen_add(row, -q[i - k], v, n - k);
    }
}

/* a = Q T Q', T tridiagonal: its diagonal into d, what is beside into e[0..n-2], and the rows of
 * a become those of Q.  room: [n][n] and 2 n. */
static void tridiagonal(double *a, uint32_t n, double *d, double *e, double *room)
{
    double *const q = room + (size_t)n * n, *const beta = q + n;

    for (uint32_t k = 0; k < n; k++) {
        double *v = a + (size_t)k * n + k + 1; /* by symmetry also the column */
        const uint32_t m = n - k - 1;

        d[k] = a[(size_t)k * n + k];
        if (m == 0)
            break;
        e[k] = reflect(v, m, &beta[k]);
        if (!(beta[k] > 0))
            continue;
        memset(q, 0, m * sizeof *q);
        for (uint32_t i = 0; i < m; i++)
            eigen_add(q, beta[k] * v[i], a + (size_t)(k + 1 + i) * n + k + 1, m);
        eigen_add(q, -beta[k] / 2 * eigen_dot(q, v, m), v, m);
        subtract_both(a, n, k + 1, v, q);
    }
    memset(room, 0, (size_t)n * n * sizeof *room);
    for (uint32_t i = 0; i < n; i++)
        room[(size_t)i * n + i] = 1;
    for (uint32_t k = n - 1; k-- > 0;) { /* Q = H0 H1 ..., the last one first */
        const double *v = a + (size_t)k * n + k + 1;
        const uint32_t m = n - k - 1;

        memset(q, 0, m * sizeof *q);
        for (uint32_t i = 0; i < m; i++)
            eigen_add(q, beta[k] * v[i], room + (size_t)(k + 1 + i) * n + k + 1, m);
        for (uint32_t i = 0; i < m; i++)
            eigen_add(room + (size_t)(k + 1 + i) * n + k + 1, -v[i], q, m);
    }
    memcpy(a, room, (size_t)n * n * sizeof *a);
}

static void eigen_rotate(double *restrict x, double *restrict y, uint32_t n, double c,
                         double s)
{
    for (uint32_t i = 0; i < n; i++) {
        const double t = y[i];

        y[i] = s * x[i] + c * t;
        x[i] = c * x[i] - s * t;
    }
}

/* One implicit QL step on the unreduced block l..m, with Wilkinson's shift. */
static void ql_step(double *d, double *e, uint32_t l, uint32_t m, double *row, uint32_t n)
{
    double g = (d[l + 1] - d[l]) / (2 * e[l]), s = 1, c = 1, p = 0;
    const double root = sqrt(g * g + 1);

    g = d[m] - d[l] + e[l] / (g + (g < 0 ? -root : root));
    for (uint32_t i = m; i-- > l;) {
        const double f = s * e[i], b = c * e[i];
        double r = sqrt(f * f + g * g);

        e[i + 1] = r;
        if (!(r > 0)) { /* the block falls apart here */
            d[i + 1] -= p;
            e[m] = 0;
            return;
        }
        s = f / r;
        c = g / r;
        g = d[i + 1] - p;
        r = (d[i] - g) * s + 2 * c * b;
        p = s * r;
        d[i + 1] = g + p;
        g = c * r - b;
        eigen_rotate(row + (size_t)i * n, row + ((size_t)i + 1) * n, n, c, s);
    }
    d[l] -= p;
    e[l] = g;
    e[m] = 0;
}

/* Diagonalise: the rotations act on pairs of rows.  e[n - 1] is room.  What is small against the
 * whole matrix counts as 0: against its neighbours alone, what rounding leaves of eigenvalues
 * that are 0 would never be. */
static bool ql(double *d, double *e, uint32_t n, double *row)
{
    double most = 0;

    e[n - 1] = 0;
    for (uint32_t i = 0; i < n; i++)
        most = fmax(most, fabs(d[i]) + fabs(e[i]));
    for (uint32_t l = 0; l < n; l++)
        for (int sweep = 0;; sweep++) {
            uint32_t m = l;

            while (m + 1 < n && fabs(e[m]) > EPSILON * most)
                m++;
            if (m == l)
                break;
            if (sweep == SWEEPS)
                return false;
            ql_step(d, e, l, m, row, n);
        }
    return true;
}

static void swap(double *x, double *y, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        const double t = x[i];

        x[i] = y[i];
        y[i] = t;
    }
}

void eigen_transpose(double *a, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < i; k++)
            swap(&a[(size_t)i * n + k], &a[(size_t)k * n + i], 1);
}

/* The values falling, with their rows, each row with its sign. */
static void arrange(double *d, double *row, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++) {
        double *const at = row + (size_t)k * n;
        uint32_t best = k, largest = 0;

        for (uint32_t i = k + 1; i < n; i++)
            best = d[i] > d[best] ? i : best;
        if (best != k) {
            swap(&d[k], &d[best], 1);
            swap(at, row + (size_t)best * n, n);
        }
        for (uint32_t i = 1; i < n; i++)
            largest = fabs(at[i]) > fabs(at[largest]) ? i : largest;
        if (at[largest] < 0)
            for (uint32_t i = 0; i < n; i++)
                at[i] = -at[i];
    }
}

enum status eigen_symmetric(double *a, uint32_t n, double *value)
{
    const size_t all = (size_t)n * n;
    double largest = 0, *room;
    bool done;

    for (size_t i = 0; i < all; i++) {
        if (!isfinite(a[i]))
            return ST_EINVAL;
        largest = fmax(largest, fabs(a[i]));
    }
    if (n == 0)
        return ST_OK;
    if ((room = calloc(all + 3 * (size_t)n, sizeof *room)) == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < all && largest > 0; i++)
        a[i] /= largest; /* squares neither overflow nor vanish */
    tridiagonal(a, n, value, room, room + n);
    eigen_transpose(a, n); /* columns of Q as rows */
    done = ql(value, room, n, a);
    free(room);
    arrange(value, a, n);
    for (uint32_t i = 0; i < n; i++)
        value[i] *= largest;
    return done ? ST_OK : ST_EINTERNAL;
}
