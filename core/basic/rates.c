#include "rates.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "surface_basic.h"
#include "mem.h"
#include "select.h"

const double rates_target[RATES_TARGETS] = {0.01, 0.001, 0.0001};

struct rates {
    size_t n, ngenuine, nimpostor;
    uint32_t nsubject;
    struct rates_score *score;  /* falling */
    double *genuine, *impostor; /* the same scores, apart */
    size_t listed;              /* of impostor; the others, if any, are lower */
    uint32_t *probes;           /* [nsubject] of a tail; NULL: all are listed */
};

double rates_least(size_t n)
{
    return n > 0 ? 3 / (double)n : (double)INFINITY;
}

bool rates_supported(double rate, size_t n)
{
    return rate >= rates_least(n);
}

size_t rates_needed(double rate)
{
    return (size_t)ceil(3 / rate - 1e-6); /* 3 / 0.0001 is not quite 30000 */
}

static int by_score(const void *a, const void *b)
{
    const struct rates_score *x = a, *y = b;

    if (x->score != y->score)
        return x->score > y->score ? -1 : 1;
    if (x->template != y->template)
        return x->template <y->template ? -1 : 1;
    return (x->probe > y->probe) - (x->probe < y->probe);
}

enum status rates_new(const struct rates_score *s, size_t n, uint32_t nsubject,
                      struct rates **out)
{
    struct rates *r = mem_array(1, sizeof *r);

    *out = NULL;
    if (r == NULL)
        return ST_ENOMEM;
    *r = (struct rates){.n = n, .nsubject = nsubject};
    r->score = mem_array(n + 1, sizeof *r->score);
    r->genuine = mem_array(n + 1, sizeof *r->genuine);
    r->impostor = mem_array(n + 1, sizeof *r->impostor);
    if (r->score == NULL || r->genuine == NULL || r->impostor == NULL) {
        rates_free(r);
        return ST_ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        if (isnan(s[i].score) || s[i].score == (double)INFINITY ||
            s[i].template >= nsubject || s[i].probe >= nsubject) {
            rates_free(r);
            return ST_EINVAL;
        }
        r->score[i] = s[i];
    }
    qsort(r->score, n, sizeof *r->score, by_score);
    for (size_t i = 0; i < n; i++) {
        if (r->score[i].template == r->score[i].probe)
            r->genuine[r->ngenuine++] = r->score[i].score;
        else
            r->impostor[r->nimpostor++] = r->score[i].score;
    }
    r->listed = r->nimpostor;
    *out = r;
    return ST_OK;
}

/* The weight of all comparisons of a tail, if each subject counts as often as it was drawn. */
static double tail_weight(const struct rates *r, const uint32_t *drawn)
{
    double probes = 0, sum = 0;

    for (uint32_t i = 0; i < r->nsubject; i++)
        probes += (double)drawn[i] * r->probes[i];
    for (uint32_t i = 0; i < r->nsubject; i++)
        sum += drawn[i] * (probes - (double)drawn[i] * r->probes[i]);
    return sum;
}

enum status rates_new_tail(const struct rates_score *s, size_t n, const uint32_t *probes,
                           uint32_t nsubject, struct rates **out)
{
    enum status st = rates_new(s, n, nsubject, out);
    uint32_t *once = mem_array(nsubject + (size_t)1, sizeof *once);

    if (st == ST_OK &&
        ((*out)->probes = mem_array(nsubject + (size_t)1, sizeof *probes)) != NULL &&
        once != NULL) {
        memcpy((*out)->probes, probes, nsubject * sizeof *probes);
        for (uint32_t i = 0; i < nsubject; i++)
            once[i] = 1;
        (*out)->nimpostor = (size_t)tail_weight(*out, once);
    } else if (st == ST_OK) {
        st = ST_ENOMEM;
        rates_free(*out);
        *out = NULL;
    }
    mem_free(once);
    return st;
}

void rates_free(struct rates *r)
{
    if (r == NULL)
        return;
    mem_free(r->score);
    mem_free(r->genuine);
    mem_free(r->impostor);
    mem_free(r->probes);
    mem_free(r);
}

size_t rates_ngenuine(const struct rates *r)
{
    return r->ngenuine;
}

size_t rates_nimpostor(const struct rates *r)
{
    return r->nimpostor;
}

enum status rates_people(const struct rates *r, uint32_t *out)
{
    bool *seen = mem_array(r->nsubject + (size_t)1, sizeof *seen);

    if (seen == NULL)
        return ST_ENOMEM;
    memset(seen, 0, r->nsubject * sizeof *seen);
    *out = 0;
    for (size_t i = 0; i < r->n; i++)
        if (r->score[i].template == r->score[i].probe && !seen[r->score[i].probe]) {
            seen[r->score[i].probe] = true;
            ++*out;
        }
    mem_free(seen);
    return ST_OK;
}

/* How many of v[0..n-1], falling, are at or above the threshold; -INFINITY never is. */
static size_t accepted(const double *v, size_t n, double threshold)
{
    size_t low = 0, high = n;

    while (low < high) {
        const size_t mid = low + (high - low) / 2;

        if (v[mid] >= threshold && v[mid] > -(double)INFINITY)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

double rates_fmr(const struct rates *r, double score)
{
    return (double)accepted(r->impostor, r->listed, score) / (double)r->nimpostor;
}

double rates_fnmr(const struct rates *r, double score)
{
    return (double)(r->ngenuine - accepted(r->genuine, r->ngenuine, score)) /
           (double)r->ngenuine;
}

double rates_at(const struct rates *r, double fmr)
{
    double best = (double)INFINITY;

    for (size_t i = 0; i < r->n && r->score[i].score > -(double)INFINITY; i++) {
        if (!(rates_fmr(r, r->score[i].score) <= fmr))
            break;
        best = r->score[i].score;
    }
    return best;
}

/* ---- figures */

/* The weights of the comparisons accepted so far, and of all. */
struct rates_sums {
    double genuine, impostor, all_genuine, all_impostor;
};

static double weight(const struct rates_score *s, const uint32_t *drawn)
{
    if (drawn == NULL)
        return 1;
    return s->template == s->probe ? (double)drawn[s->template]
                                   : (double)drawn[s->template] * (double)drawn[s->probe];
}

/* The rate at which both cross between the last threshold and this one. */
static double crossing(double fmr0, double fnmr0, double fmr1, double fnmr1)
{
    const double before = fnmr0 - fmr0, after = fmr1 - fnmr1;
    const double t = before / (before + after);

    return fmr0 + t * (fmr1 - fmr0);
}

/* Computes the figures in one pass over the scores, each group of ties at once.
 *   drawn  [nsubject] how often each subject counts; NULL: once
 *   at     the FMR of out->at */
static void rates_figures_of(const struct rates *r, const uint32_t *drawn,
                             double threshold, double at, struct rates_figures *out)
{
    struct rates_sums s = {0};
    double fmr0 = 0, fnmr0 = 1;

    *out = (struct rates_figures){NAN, {NAN, NAN, NAN}, {NAN, NAN, NAN}, NAN, NAN, NAN};
    for (size_t i = 0; i < r->n; i++) {
        const double w = weight(&r->score[i], drawn);

        if (r->score[i].template == r->score[i].probe)
            s.all_genuine += w;
        else
            s.all_impostor += w;
    }
    out->fmr = s.all_impostor > 0 ? 0 : (double)NAN;
    out->fnmr = s.all_genuine > 0 ? 1 : (double)NAN;
    out->at = s.all_impostor > 0 ? (double)INFINITY : (double)NAN;
    for (int k = 0; k < RATES_TARGETS && s.all_impostor > 0; k++) {
        out->tar_score[k] = (double)INFINITY;
        out->tar[k] = s.all_genuine > 0 ? 0 : (double)NAN;
    }
    for (size_t i = 0; i < r->n && r->score[i].score > -(double)INFINITY;) {
        const double score = r->score[i].score;
        const struct rates_sums last = s;
        double fmr, fnmr;

        for (; i < r->n && r->score[i].score == score; i++) {
            const double w = weight(&r->score[i], drawn);

            if (r->score[i].template == r->score[i].probe)
                s.genuine += w;
            else
                s.impostor += w;
        }
        if (s.genuine + s.impostor <= last.genuine + last.impostor)
            continue; /* none of their subjects was drawn */
        fmr = s.impostor / s.all_impostor;
        fnmr = (s.all_genuine - s.genuine) / s.all_genuine;
        if (score >= threshold) {
            out->fmr = fmr;
            out->fnmr = fnmr;
        }
        for (int k = 0; k < RATES_TARGETS; k++)
            if (fmr <= rates_target[k]) {
                out->tar[k] = 1 - fnmr;
                out->tar_score[k] = score;
            }
        if (fmr <= at)
            out->at = score;
        if (isnan(out->eer) && fmr >= fnmr)
            out->eer = crossing(fmr0, fnmr0, fmr, fnmr);
        fmr0 = fmr;
        fnmr0 = fnmr;
    }
    if (isnan(out->eer) && s.all_genuine > 0 && s.all_impostor > 0)
        out->eer = fnmr0; /* more than that never matches: they do not meet */
}

void rates_figures(const struct rates *r, double threshold, struct rates_figures *out)
{
    rates_figures_of(r, NULL, threshold, (double)NAN, out);
}

/* ---- bootstrap */

uint64_t rates_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);

    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

uint32_t rates_below(uint64_t *state, uint32_t n)
{
    const uint64_t fair = UINT64_MAX - UINT64_MAX % n; /* a multiple of n */
    uint64_t x;

    do
        x = rates_random(state);
    while (x >= fair);
    return (uint32_t)(x % n);
}

/* The 2.5 and 97.5 per cent points of v[0..n-1], those that are numbers. */
static void interval(double *v, size_t n, double *low, double *high)
{
    size_t m = 0;

    for (size_t i = 0; i < n; i++)
        if (!isnan(v[i]))
            v[m++] = v[i];
    *low = *high = NAN;
    if (m == 0)
        return;
    select_sort(v, m);
    *low = v[(size_t)(0.025 * (double)(m - 1) + 0.5)];
    *high = v[(size_t)(0.975 * (double)(m - 1) + 0.5)];
}

static void draw_subjects(const struct rates *r, uint64_t *seed, uint32_t *drawn)
{
    memset(drawn, 0, r->nsubject * sizeof *drawn);
    for (uint32_t k = 0; k < r->nsubject; k++)
        drawn[rates_below(seed, r->nsubject)]++;
}

/* The figures as an array of doubles, which they are. */
#define FIGURES (sizeof(struct rates_figures) / sizeof(double))

enum status rates_bootstrap(const struct rates *r, double threshold, double at,
                            unsigned replicates, uint64_t seed, struct rates_figures *low,
                            struct rates_figures *high)
{
    uint32_t *drawn = mem_array(r->nsubject + (size_t)1, sizeof *drawn);
    double *all = mem_array(((size_t)replicates + 1) * FIGURES, sizeof *all);
    double bound[2][FIGURES];
    enum status st = ST_OK;

    if (drawn == NULL || all == NULL)
        st = ST_ENOMEM;
    else if (replicates == 0)
        st = ST_EINVAL;
    for (unsigned i = 0; i < replicates && st == ST_OK; i++) {
        struct rates_figures f;
        double value[FIGURES];

        draw_subjects(r, &seed, drawn);
        rates_figures_of(r, drawn, threshold, at, &f);
        memcpy(value, &f, sizeof value);
        for (size_t k = 0; k < FIGURES; k++)
            all[k * replicates + i] = value[k];
    }
    for (size_t k = 0; k < FIGURES && st == ST_OK; k++)
        interval(&all[k * replicates], replicates, &bound[0][k], &bound[1][k]);
    if (st == ST_OK) {
        memcpy(low, bound[0], sizeof *low);
        memcpy(high, bound[1], sizeof *high);
    }
    mem_free(drawn);
    mem_free(all);
    return st;
}

/* The FNMR at each of m rising FMRs, if each subject counts as often as it was drawn. */
static void drawn_det(const struct rates *r, const uint32_t *drawn, const double *fmr,
                      size_t m, double *fnmr)
{
    struct rates_sums all = {0}, s = {0};
    double missed = 1;
    size_t k = 0;

    for (size_t i = 0; i < r->n; i++) {
        const double w = weight(&r->score[i], drawn);
        const bool genuine = r->score[i].template == r->score[i].probe;

        *(genuine ? &all.all_genuine : &all.all_impostor) += w;
    }
    for (size_t i = 0; i < r->n && r->score[i].score > -(double)INFINITY;) {
        const double score = r->score[i].score;

        for (; i < r->n && r->score[i].score == score; i++) {
            const bool genuine = r->score[i].template == r->score[i].probe;

            *(genuine ? &s.genuine : &s.impostor) += weight(&r->score[i], drawn);
        }
        for (; k < m && fmr[k] < s.impostor / all.all_impostor; k++)
            fnmr[k] = missed;
        missed = (all.all_genuine - s.genuine) / all.all_genuine;
    }
    for (; k < m; k++)
        fnmr[k] = missed;
    for (k = 0; k < m && !(all.all_genuine > 0 && all.all_impostor > 0); k++)
        fnmr[k] = NAN;
}

/* What drawn_det() or drawn_rates() computes from a draw: m values at m places. */
typedef void drawn_row(const struct rates *r, const uint32_t *drawn, const double *at,
                       size_t m, double *out);

/* The 95 % interval of each of the m values of a row. */
static enum status bootstrap_row(const struct rates *r, drawn_row *row, const double *at,
                                 size_t m, unsigned replicates, uint64_t seed,
                                 double *low, double *high)
{
    uint32_t *drawn = mem_array(r->nsubject + (size_t)1, sizeof *drawn);
    double *all = mem_array(m * replicates + 1, sizeof *all);
    double *one = mem_array(m + 1, sizeof *one);
    const enum status st =
        drawn != NULL && all != NULL && one != NULL ? ST_OK : ST_ENOMEM;

    for (unsigned i = 0; i < replicates && st == ST_OK; i++) {
        draw_subjects(r, &seed, drawn);
        row(r, drawn, at, m, one);
        for (size_t k = 0; k < m; k++)
            all[k * replicates + i] = one[k];
    }
    for (size_t k = 0; k < m && st == ST_OK; k++)
        interval(&all[k * replicates], replicates, &low[k], &high[k]);
    mem_free(drawn);
    mem_free(all);
    mem_free(one);
    return st;
}

enum status rates_bootstrap_det(const struct rates *r, const double *fmr, size_t m,
                                unsigned replicates, uint64_t seed, double *low,
                                double *high)
{
    return replicates == 0
               ? ST_EINVAL
               : bootstrap_row(r, drawn_det, fmr, m, replicates, seed, low, high);
}

/* ---- a calibration */

#define LEAST_SUPPORT 5.0   /* comparisons that a measured knot rests on */
#define HIGHER        0.001 /* by which a score is above the highest one */

static const double quantile[] = {0.95,  0.8,   0.5,   0.2,    0.1,    0.05, 0.02, 0.01,
                                  0.005, 0.002, 0.001, 0.0005, 0.0002, 1e-4, 5e-5, 2e-5,
                                  1e-5,  5e-6,  2e-6,  1e-6,   5e-7,   2e-7, 1e-7, 5e-8};

#define QUANTILES (sizeof quantile / sizeof *quantile)

/* A knot, unless score or rate would not be beyond the last one's. */
static void add_knot(double score, double rate, struct surface_calibration *c)
{
    const struct surface_knot *last = &c->knot[c->n - 1];

    if (rate > 0 && score > last->score && rate < last->rate)
        c->knot[c->n++] = (struct surface_knot){score, rate};
}

enum status rates_calibrate(const struct rates *r, double fmr,
                            struct surface_calibration *c)
{
    const double n = (double)rates_nimpostor(r);
    bool placed = false;

    memset(c, 0, sizeof *c);
    if (!rates_supported(fmr, rates_nimpostor(r)))
        return ST_ETOOFEW;
    c->threshold = rates_at(r, fmr);
    if (!isfinite(c->threshold) || !(rates_fmr(r, c->threshold) > 0))
        return ST_ETOOFEW;
    c->knot[c->n++] = (struct surface_knot){rates_at(r, 1) - 1, 1};
    for (size_t i = 0; i < QUANTILES; i++) {
        const double score = rates_at(r, quantile[i]);

        if (!placed && score >= c->threshold) {
            add_knot(c->threshold, rates_fmr(r, c->threshold), c);
            placed = true;
        }
        if (quantile[i] * n >= LEAST_SUPPORT && isfinite(score))
            add_knot(score, rates_fmr(r, score), c);
    }
    if (!placed)
        add_knot(c->threshold, rates_fmr(r, c->threshold), c);
    return surface_calibration_valid(c) ? ST_OK : ST_ETOOFEW;
}

/* The FMR at each of m rising scores, if each subject counts as often as it was drawn.  NAN: no comparison. */
static void drawn_rates(const struct rates *r, const uint32_t *drawn, const double *score,
                        size_t m, double *rate)
{
    double sum = 0;
    size_t k = m; /* score[k] and those behind it are done */

    for (size_t i = 0; i < r->n; i++) {
        const struct rates_score *s = &r->score[i];

        for (; k > 0 && s->score < score[k - 1]; k--)
            rate[k - 1] = sum;
        if (s->template != s->probe)
            sum += weight(s, drawn);
    }
    for (; k > 0; k--)
        rate[k - 1] = sum;
    if (r->probes != NULL)
        sum = tail_weight(r, drawn);
    for (k = 0; k < m; k++)
        rate[k] /= sum;
}

enum status rates_extend(const struct rates *r, size_t pairs, uint64_t seed,
                         struct surface_calibration *c)
{
    double score[QUANTILES], rate[QUANTILES], low[QUANTILES];
    double last = c->threshold;
    size_t m = 0;
    enum status st;

    if (r->listed == 0)
        return ST_OK;
    if (r->probes != NULL)
        last = fmax(last, r->impostor[r->listed - 1] - HIGHER);
    while (c->knot[c->n - 1].score > last)
        c->n--;
    for (size_t i = 0; i < QUANTILES; i++) {
        const double at = rates_at(r, quantile[i]);

        if (isfinite(at) && at > last)
            score[m++] = last = at;
    }
    if ((st = bootstrap_row(r, drawn_rates, score, m, RATES_REPLICATES, seed, low,
                            rate)) != ST_OK)
        return st;
    while (m > 0 && c->knot[c->n - 1].score > c->threshold &&
           c->knot[c->n - 1].rate <= rate[0])
        c->n--; /* more people have it more often */
    for (size_t k = 0; k < m; k++)
        if (rate[k] > rates_least(pairs))
            add_knot(score[k], rate[k], c);
    /* No comparison scores higher than the highest: there the rule of 3 holds. */
    add_knot(r->impostor[0] + HIGHER, rates_least(pairs), c);
    return ST_OK;
}

uint32_t rates_subjects(double fmr)
{
    const double pairs = (double)rates_needed(fmr);
    const double least = ceil((1 + sqrt(1 + 8 * pairs)) / 2 - 1e-9); /* n (n - 1) / 2 */

    return least < UINT32_MAX ? (uint32_t)least : UINT32_MAX;
}
