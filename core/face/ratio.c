#include "ratio.h"

#include <math.h>
#include <string.h>

#include "lsq.h"
#include "series.h"

#define N MODEL_MODES

/* The two terms of evidence(M, b). */
struct evidence {
    double square, ln; /* b' M^-1 b / 2, -ln det M / 2; NAN: M is no such matrix */
};

struct ratio_probe {
    const struct encoding *p;
    double rho, c;        /* c = 1 / (1 - rho^2) */
    struct evidence own;  /* of p's own block, A + cI */
    double mean[N];       /* (A + cI)^-1 b */
    double inverse[N][N]; /* (A + cI)^-1, lower triangle by columns */
    double h[N][N], g[N]; /* work */
};

/* h (by columns): A, plus `add` on the diagonal. */
static void ratio_load(const struct encoding *e, double add, double h[N][N])
{
    const float *a = e->a;

    for (uint32_t i = 0; i < e->n; i++)
        for (uint32_t k = 0; k <= i; k++)
            h[k][i] = (double)*a++ + (k == i ? add : 0);
}

double ratio_half_ln_det(const double *h, uint32_t stride, uint32_t n)
{
    double product = 1, sum = 0;

    for (uint32_t i = 0; i < n; i++) {
        product *= h[(size_t)i * stride + i];
        if (product > 1e200 || product < 1e-200) {
            sum += series_ln(product);
            product = 1;
        }
    }
    return sum + series_ln(product);
}

/* Of M in h and b in g; h becomes M's factor L, and g L^-1 b. */
static struct evidence evidence(double h[N][N], uint32_t n, double *g)
{
    struct evidence out = {0, 0};

    if (!lsq_factor(h[0], N, n, n))
        return (struct evidence){(double)NAN, (double)NAN};
    lsq_forward(h[0], N, n, n, g);
    for (uint32_t i = 0; i < n; i++)
        out.square += g[i] * g[i] / 2;
    out.ln = -ratio_half_ln_det(h[0], N, n);
    return out;
}

/* Rows of the inverse that are summed together: a sum waits for its last addition. */
#define ROWS 4
_Static_assert(N % ROWS == 0, "the rows behind the last are there, and 0");

typedef double lanes __attribute__((vector_size(16)));

/* The products of column i with columns k..k+ROWS-1 of L^-1, from row i on: the sums of the even rows
 * and of the odd ones.  A column is 0 above its diagonal, and below row n. */
static inline void products(double l[N][N], uint32_t k, uint32_t i, uint32_t n,
                            lanes sum[ROWS])
{
    for (uint32_t j = i - i % 2; j < n; j += 2) {
        lanes column;

        memcpy(&column, &l[i][j], sizeof column);
        for (uint32_t q = 0; q < ROWS; q++) {
            lanes row;

            memcpy(&row, &l[k + q][j], sizeof row);
            sum[q] += row * column;
        }
    }
}

/* inverse = L^-T L^-1, from the factor in h. */
static void invert(struct ratio_probe *r, uint32_t n)
{
    double(*l)[N] = r->inverse; /* first L^-1, by columns */

    memset(r->inverse, 0, sizeof r->inverse);
    for (uint32_t k = 0; k < n; k++) {
        l[k][k] = 1;
        for (uint32_t j = k; j < n; j++) {
            const double *col = r->h[j], v = l[k][j] / col[j];

            l[k][j] = v;
            for (uint32_t i = j + 1; i < n; i++)
                l[k][i] -= v * col[i];
        }
    }
    for (uint32_t k = 0; k < n; k += ROWS)
        for (uint32_t i = k; i < n; i++) {
            lanes sum[ROWS] = {{0, 0}};

            products(l, k, i, n, sum);
            /* Column i is still wanted from row i on, row i of those before it only here. */
            for (uint32_t q = 0; q < ROWS && k + q <= i; q++)
                l[k + q][i] = sum[q][0] + sum[q][1];
        }
}

struct ratio_probe *ratio_probe(const struct encoding *p, double rho, struct scratch *s)
{
    struct ratio_probe *r = scratch_need(s, sizeof *r);

    if (r == NULL)
        return NULL;
    r->p = p;
    r->rho = rho;
    r->c = 1 / (1 - rho * rho);
    ratio_load(p, r->c, r->h);
    for (uint32_t i = 0; i < p->n; i++)
        r->g[i] = (double)p->b[i];
    r->own = evidence(r->h, p->n, r->g);
    memcpy(r->mean, r->g, sizeof r->mean);
    lsq_backward(r->h[0], N, p->n, r->mean);
    invert(r, p->n);
    return r;
}

struct terms {
    double score, expected;
};

/* same, own: what the evidence of one person, and of two, says of the other's identity. */
static struct terms ratio_compare(struct ratio_probe *r, const struct encoding *t,
                                  double same[N], double own[N])
{
    const uint32_t n = t->n;
    const double k = r->rho * r->c;
    const float *a = r->p->a;
    struct evidence one, two;

    ratio_load(t, 1, r->h);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j <= i; j++)
            r->h[j][i] += (double)*a++;
        same[i] = (double)r->p->b[i] + (double)t->b[i];
    }
    one = evidence(r->h, n, same);
    lsq_backward(r->h[0], N, n, same);

    ratio_load(t, r->c, r->h);
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = j; i < n; i++)
            r->h[j][i] -= k * k * r->inverse[j][i];
        own[j] = (double)t->b[j] + k * r->mean[j];
    }
    two = evidence(r->h, n, own);
    lsq_backward(r->h[0], N, n, own);
    two.ln += r->own.ln + 0.5 * n * series_ln(r->c);
    two.square += r->own.square;
    return (struct terms){one.square - two.square + one.ln - two.ln, one.ln - two.ln};
}

double ratio_score(struct ratio_probe *r, const struct encoding *t, double *expected)
{
    double same[N], own[N];
    struct terms out;

    *expected = 0;
    if (r->p->n == 0 || r->p->n != t->n)
        return 0;
    out = ratio_compare(r, t, same, own);
    /* A + I is positive definite by its making.  What is read from a file need not be. */
    if (!(fabs(out.score) < RATIO_MOST))
        return -RATIO_MOST;
    *expected = out.expected;
    return out.score;
}

double ratio_slopes(struct ratio_probe *r, const struct encoding *t, double tmpl[N],
                    double probe[N])
{
    const uint32_t n = t->n;
    const double k = r->rho * r->c;
    double same[N], own[N];
    struct terms out;

    memset(tmpl, 0, N * sizeof *tmpl);
    memset(probe, 0, N * sizeof *probe);
    if (r->p->n == 0 || r->p->n != n)
        return 0;
    out = ratio_compare(r, t, same, own);
    for (uint32_t i = 0; i < n; i++) {
        double other = r->mean[i]; /* of the probe's identity, if they are two */

        for (uint32_t j = 0; j < n; j++)
            other += k * (i > j ? r->inverse[j][i] : r->inverse[i][j]) * own[j];
        tmpl[i] = same[i] - own[i];
        probe[i] = same[i] - other;
    }
    return out.score;
}
