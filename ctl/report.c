#include "report.h"

#include <math.h>
#include <stdlib.h>

#define SEED UINT64_C(1) /* of the bootstrap */

/* ---- counting */

static void count(struct report_count *c, enum face_decision d)
{
    c->n++;
    c->match += d == FACE_MATCH;
    c->no_match += d == FACE_NO_MATCH;
    c->inconclusive += d == FACE_INCONCLUSIVE;
}

static uint32_t kind_of(const struct report *r, const struct ctl_trial *x)
{
    return r->t->corpus->scan[x->probe].kind;
}

static bool within(const struct report *r, const struct report_group *g,
                   const struct ctl_trial *x)
{
    return g->kind == CORPUS_NONE || kind_of(r, x) == g->kind;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* The value that a share of v[0..n-1] is at or below; v is sorted. */
static double quantile(double *v, size_t n, double share)
{
    qsort(v, n, sizeof *v, by_value);
    return n > 0 ? v[(size_t)ceil(share * (double)n) - (share > 0)] : (double)NAN;
}

/* How often the own template had the smallest score, of the probes that were compared with
 * others too. */
static void count_ranks(struct report *r, struct report_group *g)
{
    const struct ctl_trials *t = r->t;

    for (size_t i = 0, end; i < t->n; i = end) {
        double own = (double)INFINITY, others = (double)INFINITY;
        size_t n = 0;

        for (end = i; end < t->n && t->trial[end].probe == t->trial[i].probe; end++) {
            const struct ctl_trial *x = &t->trial[end];

            if (!x->done || x->type == CORPUS_RELATIVE)
                continue;
            n += x->type == CORPUS_IMPOSTOR;
            if (!x->comparable)
                continue;
            if (x->type == CORPUS_GENUINE)
                own = x->calibrated_mm;
            else
                others = fmin(others, x->calibrated_mm);
        }
        if (within(r, g, &t->trial[i]) && t->trial[i].done && n > 0) {
            g->ranked++;
            g->first += own < others;
        }
    }
}

static enum status measure_pose(struct report *r, struct report_group *g)
{
    double *v = malloc((r->t->n + 1) * sizeof *v);

    if (v == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < r->t->n; i++) {
        const struct ctl_trial *x = &r->t->trial[i];

        if (x->done && within(r, g, x) && !isnan(x->rotation_deg)) {
            g->beyond += x->rotation_deg > 3;
            v[g->posed++] = x->rotation_deg;
        }
    }
    g->median_deg = quantile(v, g->posed, 0.5);
    g->most_deg = quantile(v, g->posed, 0.9);
    g->worst_deg = quantile(v, g->posed, 1);
    free(v);
    return ST_OK;
}

static enum status measure_time(struct report *r)
{
    double *v = malloc((2 * r->t->n + 1) * sizeof *v);
    size_t n = 0;

    if (v == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].done) {
            v[n] = r->t->trial[i].align_ms;
            v[r->t->n + n++] = r->t->trial[i].measure_ms;
        }
    r->align_ms = quantile(v, n, 0.5);
    r->measure_ms = quantile(v + r->t->n, n, 0.5);
    free(v);
    return ST_OK;
}

/* ---- rates */

/* What a comparison counts as; below 0: not at all. */
typedef double score_of(const struct ctl_trial *x);

static double trial_score(const struct ctl_trial *x)
{
    if (x->type == CORPUS_RELATIVE)
        return -1;
    return x->comparable ? x->calibrated_mm : (double)INFINITY;
}

/* The decision itself as a score: 0 is a match at threshold 0. */
static double as_score(const struct ctl_trial *x, enum corpus_pair type, bool match)
{
    return x->type != type ? -1 : match ? 0 : (double)INFINITY;
}

static double non_mated_match(const struct ctl_trial *x)
{
    return as_score(x, CORPUS_IMPOSTOR, x->decision == FACE_MATCH);
}

static double mated_match(const struct ctl_trial *x)
{
    return as_score(x, CORPUS_GENUINE, x->decision == FACE_MATCH);
}

static double mated_no_match(const struct ctl_trial *x)
{
    return as_score(x, CORPUS_GENUINE, x->decision != FACE_NO_MATCH);
}

/* The rates of a group's mated comparisons and of all non-mated ones. */
static enum status collect(const struct report *r, const struct report_group *g,
                           score_of *score, struct rates **out)
{
    const struct corpus *c = r->t->corpus;
    struct rates_score *s = malloc((r->t->n + 1) * sizeof *s);
    size_t n = 0;
    enum status st;

    *out = NULL;
    if (s == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < r->t->n; i++) {
        const struct ctl_trial *x = &r->t->trial[i];
        const double mm = x->done ? score(x) : -1;

        if (mm < 0 || (x->type == CORPUS_GENUINE && !within(r, g, x)))
            continue;
        s[n++] = (struct rates_score){mm, c->scan[x->template].subject,
                                      c->scan[x->probe].subject};
    }
    st = rates_new(s, n, c->nsubject, out);
    free(s);
    return st;
}

/* The share of wrong decisions, with its interval. */
static enum status decided(const struct report *r, const struct report_group *g,
                           score_of *score, bool mated, struct report_rate *out)
{
    struct rates_figures f, low, high;
    struct rates *rates;
    enum status st = collect(r, g, score, &rates);

    if (st == ST_OK &&
        (st = rates_bootstrap(rates, 0, RATES_REPLICATES, SEED, &low, &high)) == ST_OK) {
        rates_figures(rates, 0, &f);
        out->n = mated ? rates_ngenuine(rates) : rates_nimpostor(rates);
        out->value = mated ? f.fnmr : f.fmr;
        out->low = mated ? low.fnmr : low.fmr;
        out->high = mated ? high.fnmr : high.fmr;
    }
    rates_free(rates);
    return st;
}

static enum status measure_group(struct report *r, struct report_group *g)
{
    const struct corpus *c = r->t->corpus;
    enum status st;

    for (uint32_t i = 0; i < c->nscan; i++)
        if (!c->scan[i].enrolled &&
            (g->kind == CORPUS_NONE || c->scan[i].kind == g->kind)) {
            g->probe++;
            g->refused += r->t->refused[i] != NULL;
        }
    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].done && r->t->trial[i].type == CORPUS_GENUINE &&
            within(r, g, &r->t->trial[i]))
            count(&g->mated, r->t->trial[i].decision);
    count_ranks(r, g);
    if ((st = measure_pose(r, g)) == ST_OK &&
        (st = collect(r, g, trial_score, &g->rates)) == ST_OK &&
        (st = decided(r, g, mated_no_match, true, &g->no_match)) == ST_OK &&
        (st = decided(r, g, mated_match, true, &g->unmatched)) == ST_OK) {
        rates_figures(g->rates, r->threshold_mm, &g->f);
        st = rates_bootstrap(g->rates, r->threshold_mm, RATES_REPLICATES, SEED, &g->low,
                             &g->high);
    }
    return st;
}

enum status report_measure(struct report *r, const struct ctl_trials *t)
{
    const struct corpus *c = t->corpus;
    bool *probed = calloc(c->nkind, sizeof *probed);
    enum status st;

    r->t = t;
    r->replicates = RATES_REPLICATES;
    r->seed = SEED;
    st = probed == NULL ? ST_ENOMEM : measure_time(r);
    if (st != ST_OK ||
        (r->group = calloc(c->nkind + (size_t)1, sizeof *r->group)) == NULL) {
        free(probed);
        return ST_ENOMEM;
    }
    for (uint32_t i = 0; i < c->nsubject; i++)
        r->unenrolled += t->refused[c->subject[i].enrolled] != NULL;
    for (size_t i = 0; i < t->n; i++) {
        r->undone += !t->trial[i].done;
        probed[kind_of(r, &t->trial[i])] = true;
        if (t->trial[i].done && t->trial[i].type != CORPUS_GENUINE)
            count(t->trial[i].type == CORPUS_IMPOSTOR ? &r->non_mated : &r->relative,
                  t->trial[i].decision);
    }
    r->threshold_mm = t->threshold_mm;
    r->group[r->ngroup++] = (struct report_group){.name = "all", .kind = CORPUS_NONE};
    for (uint32_t k = 0; k < c->nkind; k++)
        if (probed[k])
            r->group[r->ngroup++] = (struct report_group){
                .name = c->kind[k][0] != '\0' ? c->kind[k] : "-", .kind = k};
    free(probed);
    st = decided(r, &r->group[0], non_mated_match, false, &r->match);
    for (uint32_t i = 0; i < r->ngroup && st == ST_OK; i++)
        st = measure_group(r, &r->group[i]);
    return st;
}

void report_free(struct report *r)
{
    for (uint32_t i = 0; i < r->ngroup; i++)
        rates_free(r->group[i].rates);
    free(r->group);
}

double report_bound(double rate, size_t n)
{
    /* Upper limits of a Poisson mean where 0, 1, ... were counted. */
    static const double most[] = {3, 4.74, 6.30, 7.75};
    const double errors = ceil(rate * (double)n - 1e-9);

    return most[errors > 0 ? (int)fmin(errors, 3) : 0] / (double)n;
}

double report_step(const struct report *r, size_t most, size_t *n)
{
    static const double factor[3] = {2, 2.5, 2}; /* 1, 2, 5, 10 */
    double largest = r->threshold_mm, step = 1e-4;

    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].done && r->t->trial[i].comparable)
            largest = fmax(largest, r->t->trial[i].calibrated_mm);
    for (int i = 0; largest / step + 1 > (double)most; i++)
        step *= factor[i % 3];
    *n = (size_t)ceil(largest / step);
    return step;
}
