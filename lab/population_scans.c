#include "population_scans.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "lsq.h"

#define HALF_WEIGHT 200.0 /* subjects */
#define FAR_MM      12.0f
#define LEAST_CELLS 230 /* a quarter of a face */
#define PARTNERS    8   /* scans of one subject are paired with as many before them */
#define MOST        (GRID_N / 2)

/* ---- gaps */

/* The motion x that explains most of the known gaps; false: they are too few. */
static bool solve_motion(const struct population *p, const float gap[GRID_N],
                         double x[POPULATION_MOTIONS])
{
    const uint32_t n = POPULATION_MOTIONS;
    double h[POPULATION_MOTIONS * POPULATION_MOTIONS] = {0};

    for (uint32_t k = 0; k < n; k++)
        x[k] = 0;
    for (uint32_t i = 0; i < GRID_N; i++)
        for (uint32_t k = 0; k < n && !isnan(gap[i]); k++) {
            const double m = (double)p->motion[k][i];

            x[k] += m * (double)gap[i];
            for (uint32_t l = 0; l <= k; l++)
                h[l * n + k] += m * (double)p->motion[l][i];
        }
    if (!lsq_factor(h, n, n, n))
        return false;
    lsq_forward(h, n, n, n, x);
    lsq_backward(h, n, n, x);
    return true;
}

uint32_t population_scans_gap(const struct population *p, const float z[GRID_N],
                              float gap[GRID_N])
{
    double x[POPULATION_MOTIONS];
    uint32_t known = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        gap[i] = (z[i] - p->mean[i]) * p->normal_z[i];
        if (!(fabsf(gap[i]) <= FAR_MM))
            gap[i] = (float)NAN;
        known += isnan(gap[i]) ? 0 : 1;
    }
    if (known < LEAST_CELLS || !solve_motion(p, gap, x)) {
        for (uint32_t i = 0; i < GRID_N; i++)
            gap[i] = (float)NAN;
        return 0;
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        for (uint32_t k = 0; k < POPULATION_MOTIONS; k++)
            gap[i] -= (float)(x[k] * (double)p->motion[k][i]);
    return known;
}

double population_scans_share(uint32_t nsubject)
{
    return nsubject / (nsubject + HALF_WEIGHT);
}

/* ---- sums over scans */

/* Sums of products of the gaps at two cells in use, of each with its mirror image: [SAME] on one
 * side, [ACROSS] from one side to the other. */
enum { SAME, ACROSS, SIDES };

struct population_scans_sums {
    uint32_t n;
    double *of[SIDES]; /* [n][n] */
};

/* A sample at the cells in use, and at their mirror images. */
struct sides {
    double own[MOST], mirror[MOST];
};

static enum status sums_new(uint32_t n, struct population_scans_sums *s)
{
    s->n = n;
    for (int i = 0; i < SIDES; i++)
        if ((s->of[i] = calloc((size_t)n * n, sizeof *s->of[i])) == NULL)
            return ST_ENOMEM;
    return ST_OK;
}

static void sums_free(struct population_scans_sums *s)
{
    for (int i = 0; i < SIDES; i++)
        free(s->of[i]);
}

static void sums_add(struct population_scans_sums *s, const struct sides *x, double by)
{
    for (uint32_t i = 0; i < s->n; i++) {
        const double own = by * x->own[i], mirror = by * x->mirror[i];
        double *restrict same = s->of[SAME] + (size_t)i * s->n;
        double *restrict across = s->of[ACROSS] + (size_t)i * s->n;

        for (uint32_t k = 0; k < s->n; k++) {
            same[k] += own * x->own[k] + mirror * x->mirror[k];
            across[k] += own * x->mirror[k] + mirror * x->own[k];
        }
    }
}

static double population_scans_value(float gap)
{
    return isnan(gap) ? 0 : (double)gap;
}

static double is_known(float gap)
{
    return isnan(gap) ? 0 : 1;
}

/* what() of a sample. */
static void population_scans_take(const struct population *p, const float gap[GRID_N],
                                  double (*what)(float), struct sides *x)
{
    for (uint32_t i = 0; i < p->cells.n; i++) {
        x->own[i] = what(gap[p->cells.at[i]]);
        x->mirror[i] = what(gap[grid_mirror(p->cells.at[i])]);
    }
}

/* Products of gaps, and how many there are. */
struct tally {
    struct population_scans_sums product, count;
    double whole; /* the count where all is known */
};

static enum status tally_new(uint32_t n, struct tally *t)
{
    const enum status st = sums_new(n, &t->product);

    return st == ST_OK ? sums_new(n, &t->count) : st;
}

static void tally_free(struct tally *t)
{
    sums_free(&t->product);
    sums_free(&t->count);
}

/* times: how often the sample counts.  by: what its products are multiplied by besides. */
static void tally_add(const struct population *p, const float gap[GRID_N], double times,
                      double by, struct tally *t)
{
    struct sides x = {{0}, {0}};

    population_scans_take(p, gap, population_scans_value, &x);
    sums_add(&t->product, &x, times * by);
    population_scans_take(p, gap, is_known, &x);
    sums_add(&t->count, &x, times);
    t->whole += 2 * times;
}

/* ---- all scans */

struct blend {
    struct population *p;
    struct tally change, identity, shape;
    struct population_scans_sums share; /* of W in identity's products */
};

/* The pairs of a subject's scans. */
static void add_pairs(struct blend *b, const struct population_scan *scan, size_t n)
{
    const size_t most = n > PARTNERS ? PARTNERS : n - 1;
    const double pairs = (double)(most * (2 * n - 1 - most)) / 2;
    float d[GRID_N];

    for (size_t i = 1; i < n; i++)
        for (size_t k = i > PARTNERS ? i - PARTNERS : 0; k < i; k++) {
            for (uint32_t c = 0; c < GRID_N; c++)
                d[c] = scan[i].gap[c] - scan[k].gap[c];
            tally_add(b->p, d, (double)(n - 1) / pairs, 0.5, &b->change);
        }
}

/* The mean of a subject's scans, and its share of W: of a mean over some of them at one cell and
 * some at the other, the number that both have in common, over the product of both numbers. */
static void add_mean(struct blend *b, const struct population_scan *scan, size_t n)
{
    float mean[GRID_N], count[GRID_N];
    struct sides x = {{0}, {0}}, all;

    for (uint32_t c = 0; c < GRID_N; c++) {
        double sum = 0, known = 0;

        for (size_t i = 0; i < n; i++) {
            sum += population_scans_value(scan[i].gap[c]);
            known += is_known(scan[i].gap[c]);
        }
        count[c] = (float)known;
        mean[c] = known > 0 ? (float)(sum / known) : (float)NAN;
    }
    tally_add(b->p, mean, 1, 1, &b->identity);
    population_scans_take(b->p, count, population_scans_value, &all);
    for (size_t i = 0; i < n; i++) {
        population_scans_take(b->p, scan[i].gap, is_known, &x);
        for (uint32_t c = 0; c < b->p->cells.n; c++) {
            x.own[c] = x.own[c] > 0 ? x.own[c] / all.own[c] : 0;
            x.mirror[c] = x.mirror[c] > 0 ? x.mirror[c] / all.mirror[c] : 0;
        }
        sums_add(&b->share, &x, 1);
    }
}

static void add_subject(struct blend *b, const struct population_scan *scan, size_t n)
{
    if (n > 1)
        add_pairs(b, scan, n);
    add_mean(b, scan, n);
    for (size_t i = 0; i < n; i++)
        tally_add(b->p, scan[i].gap, 1.0 / (double)n, 1, &b->shape);
}

/* The covariance of s between cells i and k of a side. */
static double covariance(const struct spread *s, int side, size_t at)
{
    const double even = s->block[0][at], odd = s->block[1][at];

    return (side == SAME ? even + odd : even - odd) / 2;
}

/* less: NULL, or what is to be subtracted from the products: so many times own. */
static void mix(struct spread *s, const struct tally *t, double weight,
                const struct population_scans_sums *less,
                const struct population_scans_sums *own)
{
    const double prior = t->whole * (1 - weight) / weight;

    for (size_t at = 0; at < (size_t)s->n * s->n; at++) {
        double mixed[SIDES];

        for (int side = 0; side < SIDES; side++) {
            const double count = t->count.of[side][at];
            double sum = t->product.of[side][at];

            if (less != NULL)
                sum -= less->of[side][at] * own->of[side][at];
            mixed[side] = covariance(s, side, at);
            if (prior + count > 0)
                mixed[side] = (prior * mixed[side] + sum) / (prior + count);
        }
        s->block[0][at] = mixed[SAME] + mixed[ACROSS];
        s->block[1][at] = mixed[SAME] - mixed[ACROSS];
    }
}

/* The scans' own W, or W where no pair of them shows both cells; in place of the products. */
static void own_change(struct blend *b)
{
    const size_t all = (size_t)b->p->cells.n * b->p->cells.n;

    for (int side = 0; side < SIDES; side++)
        for (size_t at = 0; at < all; at++) {
            const double count = b->change.count.of[side][at];
            double *sum = &b->change.product.of[side][at];

            *sum = count > 0 ? *sum / count : covariance(&b->p->change, side, at);
        }
}

static void mix_all(struct blend *b, double weight)
{
    struct population *const p = b->p;

    if (b->change.whole > 0)
        mix(&p->change, &b->change, weight, NULL, NULL);
    own_change(b);
    mix(&p->identity, &b->identity, weight, &b->share, &b->change.product);
    mix(&p->shape, &b->shape, weight, NULL, NULL);
    population_still(p, &p->change);
    population_still(p, &p->identity);
    population_still(p, &p->shape);
}

enum status population_scans_blend(struct population *p,
                                   const struct population_scan *scan, size_t n,
                                   double weight)
{
    struct blend b = {.p = p};
    enum status st = tally_new(p->cells.n, &b.change);

    if (st == ST_OK)
        st = tally_new(p->cells.n, &b.identity);
    if (st == ST_OK)
        st = tally_new(p->cells.n, &b.shape);
    if (st == ST_OK)
        st = sums_new(p->cells.n, &b.share);
    for (size_t i = 0, k = 0; st == ST_OK && i < n; i = k) {
        while (k < n && scan[k].subject == scan[i].subject)
            k++;
        add_subject(&b, scan + i, k - i);
    }
    if (st == ST_OK && n > 0 && weight > 0)
        mix_all(&b, weight);
    tally_free(&b.change);
    tally_free(&b.identity);
    tally_free(&b.shape);
    sums_free(&b.share);
    return st;
}
