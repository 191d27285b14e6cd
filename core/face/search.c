#include "search.h"

#include <math.h>
#include <string.h>

#include "grid.h"
#include "lsq.h"
#include "ratio.h"
#include "series.h"

#define D SEARCH_MODES

/* Of a coefficient's deviation given a complete face: coarser units lose, finer ones win nothing. */
#define SEARCH_STEP 0.4

/* Added to the factored form, which is only semidefinite: below what integers see. */
#define SEARCH_RIDGE 1e-9

typedef double matrix[D][D];

/* ---- dense matrices: symmetric ones are whole, of a factor L row j has column j of L from its diagonal on */

static void load(const struct encoding *e, double add, matrix h)
{
    const float *a = e->a;

    memset(h, 0, sizeof(matrix));
    for (uint32_t i = 0; i < e->n && i < D; i++)
        for (uint32_t k = 0; k <= i; k++)
            h[i][k] = h[k][i] = (double)*a++;
    for (uint32_t i = 0; i < D; i++)
        h[i][i] += add;
}

static bool factor(matrix h)
{
    return lsq_factor(h[0], D, D, D);
}

static double ln_det(matrix l)
{
    return 2 * ratio_half_ln_det(l[0], D, D);
}

/* x = L^-1 w. */
static void solve(matrix l, matrix w, matrix x)
{
    for (uint32_t j = 0; j < D; j++) {
        double by[D];

        for (uint32_t k = 0; k < j; k++)
            by[k] = -l[k][j];
        memcpy(x[j], w[j], sizeof x[j]);
        lsq_add_rows(x[0], D, j, by, D, x[j]);
        for (uint32_t i = 0; i < D; i++)
            x[j][i] /= l[j][j];
    }
}

/* q += sign x' x: its upper triangle. */
static void add_gram(matrix x, double sign, matrix q)
{
    for (uint32_t i = 0; i < D; i++) {
        double by[D];

        for (uint32_t k = 0; k < D; k++)
            by[k] = sign * x[k][i];
        lsq_add_rows(&x[0][i], D, D, by, D - i, &q[i][i]);
    }
}

static void make_whole(matrix q)
{
    for (uint32_t i = 0; i < D; i++)
        for (uint32_t j = 0; j < i; j++)
            q[i][j] = q[j][i];
}

/* out = L^-T L^-1; x is work. */
static void invert(matrix l, matrix x, matrix out)
{
    memset(out, 0, sizeof(matrix));
    for (uint32_t i = 0; i < D; i++)
        out[i][i] = 1;
    solve(l, out, x);
    memset(out, 0, sizeof(matrix));
    add_gram(x, 1, out);
    make_whole(out);
}

/* ---- the model */

/* What the template of a class has of the mean face. */
static bool is_there(int class, uint32_t cell)
{
    const double x = grid_x(cell), y = grid_y(cell);

    switch (class) {
    case 3:
        return y <= 32; /* no forehead */
    case 4:
        return y >= -40; /* no chin */
    case 5:
        return x >= -22; /* one side */
    case 6:
        return x <= 22; /* the other side */
    case 7:
        return y <= 8 || y >= 44; /* no eyes */
    default:
        return true;
    }
}

static enum status search_prepare_class(const struct encode_basis *e, int class,
                                        struct scratch *s, struct encoding *out)
{
    static const double residual_mm[SEARCH_CLASSES] = {0.45, 0.7, 1.05, 0.7,
                                                       0.7,  0.7, 0.7,  0.7};
    float z[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = is_there(class, i) ? e->m->mean[i] : (float)NAN;
    return encode_heights(e, z, residual_mm[class], s, out);
}

enum status search_prepare(const struct encode_basis *e, struct scratch *s,
                           struct search_basis *out)
{
    struct encoding one;
    enum status st = ST_OK;

    memset(out, 0, sizeof *out);
    out->n = e->m->identity.n < D ? e->m->identity.n : D;
    for (int c = 0; st == ST_OK && c < SEARCH_CLASSES; c++) {
        matrix *work;

        if ((st = search_prepare_class(e, c, s, &one)) != ST_OK)
            break;
        load(&one, 1, out->precision[c]);
        if ((work = scratch_need(s, sizeof *work)) == NULL)
            return ST_ENOMEM;
        memcpy(*work, out->precision[c], sizeof *work);
        st = factor(*work) ? ST_OK : ST_EINVAL;
        out->ln_det[c] = st == ST_OK ? ln_det(*work) : 0;
    }
    for (uint32_t i = 0; i < D; i++) { /* of the complete face of middling noise */
        const double all = out->precision[1][i][i];

        out->step[i] = SEARCH_STEP * sqrt(fmax(all - 1, 1e-6)) / all;
    }
    return st;
}

/* ---- descriptors */

/* The class whose posterior tells least from the template's (Kullback and Leibler): covariance is the
 * latter's. */
static int nearest_class(const struct search_basis *b, matrix covariance)
{
    double least = INFINITY;
    int best = 0;

    for (int c = 0; c < SEARCH_CLASSES; c++) {
        double sum = -b->ln_det[c];

        for (uint32_t i = 0; i < D; i++)
            for (uint32_t j = 0; j < D; j++)
                sum += b->precision[c][i][j] * covariance[i][j];
        if (sum < least) {
            least = sum;
            best = c;
        }
    }
    return best;
}

enum status search_describe(const struct search_basis *b, const struct encoding *e,
                            struct scratch *s, unsigned char out[SURFACE_DESCRIPTOR])
{
    struct {
        matrix h, x, covariance;
    } *w = scratch_need(s, sizeof *w);
    double mean[D] = {0};

    memset(out, SURFACE_UNDESCRIBED, SURFACE_DESCRIPTOR);
    if (w == NULL)
        return ST_ENOMEM;
    if (e->n == 0)
        return ST_EINVAL;
    load(e, 1, w->h);
    if (!factor(w->h))
        return ST_EINVAL;
    for (uint32_t i = 0; i < b->n; i++)
        mean[i] = (double)e->b[i];
    lsq_forward(w->h[0], D, D, D, mean);
    lsq_backward(w->h[0], D, D, mean);
    invert(w->h, w->x, w->covariance);
    for (uint32_t i = 0; i < b->n; i++)
        if (!isfinite(mean[i] /= b->step[i]))
            return ST_EINVAL;
    memset(out, 0, SURFACE_DESCRIPTOR);
    for (uint32_t i = 0; i < b->n; i++)
        out[1 + i] = (unsigned char)(int8_t)lrint(fmin(fmax(mean[i], -127), 127));
    out[0] = (unsigned char)nearest_class(b, w->covariance);
    return ST_OK;
}

/* ---- probes */

struct probe_work {
    matrix a, inverse; /* of the probe: A, (A + cI)^-1 */
    matrix h, x, q;
    double b[D], mean[D]; /* b, (A + cI)^-1 b */
    double rest;          /* the terms of the score that no class changes */
    double constant[SEARCH_CLASSES];
};

/* What the evidence of M in h and v adds: v becomes L^-1 v, x L^-1 w. */
static bool eliminate(struct probe_work *w, matrix from, double v[D], double *constant)
{
    if (!factor(w->h))
        return false;
    lsq_forward(w->h[0], D, D, D, v);
    *constant = -ln_det(w->h) / 2;
    for (uint32_t i = 0; i < D; i++)
        *constant += v[i] * v[i] / 2;
    solve(w->h, from, w->x);
    return true;
}

/* g += sign x' v. */
static void add_slope(matrix x, double sign, const double v[D], double g[D])
{
    for (uint32_t k = 0; k < D; k++)
        for (uint32_t i = 0; i < D; i++)
            g[i] += sign * v[k] * x[k][i];
}

/* The quadratic form of the score of a template of the class: q, g and the constant. */
static bool form(struct probe_work *w, const matrix precision, double rho, double g[D],
                 double *constant)
{
    const double c = 1 / (1 - rho * rho), k = rho * c;
    double v[D], one, two;
    matrix *from = (matrix *)(uintptr_t)precision; /* which solve() only reads */

    memset(w->q, 0, sizeof w->q);
    memset(g, 0, D * sizeof *g);
    for (uint32_t i = 0; i < D; i++)
        for (uint32_t j = 0; j < D; j++)
            w->h[i][j] = precision[i][j] + w->a[i][j];
    memcpy(v, w->b, sizeof v);
    if (!eliminate(w, *from, v, &one))
        return false;
    add_gram(w->x, -1, w->q);
    add_slope(w->x, 1, v, g);

    for (uint32_t i = 0; i < D; i++) {
        for (uint32_t j = 0; j < D; j++)
            w->h[i][j] = precision[i][j] - k * k * w->inverse[i][j];
        w->h[i][i] += c - 1;
        v[i] = k * w->mean[i];
    }
    if (!eliminate(w, *from, v, &two))
        return false;
    add_gram(w->x, 1, w->q);
    add_slope(w->x, -1, v, g);
    *constant = one - two - w->rest;
    return true;
}

/* A row in integers, of a factor's column from j on and its offset z. */
static void put_row(const double l[D], uint32_t j, double z, struct search_row *out)
{
    double most = 1e-9, scale;
    int shift = 0;

    for (uint32_t i = j; i < D; i++)
        most = fmax(most, fabs(l[i]));
    while (shift < 20 && most * SEARCH_UNIT * (2 << shift) < INT16_MAX &&
           fabs(z) * SEARCH_UNIT * (2 << shift) < 5e8)
        shift++;
    scale = SEARCH_UNIT * (double)(1 << shift);
    memset(out, 0, sizeof *out);
    for (uint32_t i = j; i < D; i++)
        out->factor[i] = (int16_t)lrint(fmin(fmax(l[i] * scale, -INT16_MAX), INT16_MAX));
    out->offset = (int32_t)lrint(fmin(fmax(z * scale, -5e8), 5e8)) -
                  (shift > 0 ? 1 << (shift - 1) : 0); /* so that >> rounds */
    out->shift = shift;
}

/* The form as rows, and its greatest value. */
static bool put_rows(const struct search_basis *b, struct probe_work *w,
                     const double g[D], double constant, struct search_rows *out,
                     double *best)
{
    double z[D];

    for (uint32_t i = 0; i < D; i++) {
        const uint32_t from = D - 1 - i; /* the mode that tells most comes last */

        for (uint32_t j = i; j < D; j++) {
            const uint32_t to = D - 1 - j;

            w->h[i][j] = w->q[to < from ? to : from][to < from ? from : to] *
                         b->step[from] * b->step[to];
        }
        w->h[i][i] += SEARCH_RIDGE;
        z[i] = g[from] * b->step[from];
    }
    if (!factor(w->h))
        return false;
    lsq_forward(w->h[0], D, D, D, z);
    *best = constant;
    for (uint32_t i = 0; i < D; i++) {
        *best += z[i] * z[i] / 2;
        put_row(w->h[i], i, z[i], &out->row[i]);
    }
    return true;
}

/* What depends on the probe alone. */
static bool search_load(const struct search_basis *b, const struct encoding *p,
                        double rho, struct probe_work *w)
{
    const double c = 1 / (1 - rho * rho);
    double ln;

    memset(w->b, 0, sizeof w->b);
    for (uint32_t i = 0; i < b->n; i++)
        w->b[i] = (double)p->b[i];
    load(p, c, w->h);
    if (!factor(w->h))
        return false;
    ln = ln_det(w->h);
    memcpy(w->mean, w->b, sizeof w->mean);
    lsq_forward(w->h[0], D, D, D, w->mean);
    w->rest = -ln / 2 + 0.5 * D * series_ln(c);
    for (uint32_t i = 0; i < D; i++)
        w->rest += w->mean[i] * w->mean[i] / 2;
    lsq_backward(w->h[0], D, D, w->mean);
    invert(w->h, w->x, w->inverse);
    load(p, 0, w->a);
    return true;
}

enum status search_probe(const struct search_basis *b, const struct encoding *p,
                         double rho, unsigned classes, struct scratch *s,
                         struct search_probe *out)
{
    const double unit = 2.0 * SEARCH_UNIT * SEARCH_UNIT;
    struct probe_work *w = scratch_need(s, sizeof *w);
    double g[D], best[SEARCH_CLASSES], constant;

    if (w == NULL)
        return ST_ENOMEM;
    if (p->n == 0 || !search_load(b, p, rho, w))
        return ST_EINVAL;
    out->best = -RATIO_MOST;
    for (int c = 0; c < SEARCH_CLASSES; c++) {
        if ((classes >> c & 1) == 0)
            continue;
        if (!form(w, b->precision[c], rho, g, &constant) ||
            !put_rows(b, w, g, constant, &out->class[c], &best[c]) ||
            !(fabs(best[c]) < RATIO_MOST))
            return ST_EINVAL;
        out->best = fmax(out->best, best[c]);
    }
    for (int c = 0; c < SEARCH_CLASSES; c++)
        if ((classes >> c & 1) != 0)
            out->class[c].base = (int32_t)lrint(fmin((out->best - best[c]) * unit, 1e9));
    return ST_OK;
}

double search_score(const struct search_probe *p, int32_t cost)
{
    return p->best - cost / (2.0 * SEARCH_UNIT * SEARCH_UNIT);
}
