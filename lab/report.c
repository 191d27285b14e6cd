#include "report.h"
#include "select.h"

#include <math.h>
#include <stdlib.h>

/* ---- counting */

static void report_count_all(struct report_count *c, const struct trial *x)
{
    c->planned++;
    if (!x->done)
        return;
    c->n++;
    c->match += x->decision == SURFACE_MATCH;
    c->no_match += x->decision == SURFACE_NO_MATCH;
    c->inconclusive += x->decision == SURFACE_INCONCLUSIVE;
}

static bool of_kind(const struct report *r, const struct report_group *g, uint32_t scan)
{
    return g->kind == CORPUS_NONE || r->t->corpus->scan[scan].kind == g->kind;
}

/* The value that a share of v[0..n-1] is at or below; v is sorted. */
static double quantile(double *v, size_t n, double share)
{
    select_sort(v, n);
    return n > 0 ? v[(size_t)ceil(share * (double)n) - (share > 0)] : (double)NAN;
}

/* What a probe was compared with. */
struct rank {
    double own, others; /* the highest score */
    uint32_t n;         /* of others, and whether of its own */
    bool tried, planned;
};

/* A new array for all scans; NULL: out of memory. */
static struct rank *rank_probes(const struct trials *t)
{
    struct rank *rank = calloc(t->corpus->nscan, sizeof *rank);

    for (size_t i = 0; i < t->n && rank != NULL; i++) {
        const struct trial *x = &t->trial[i];
        struct rank *one = &rank[x->probe];

        one->planned |= x->type == CORPUS_GENUINE;
        if (!x->done || x->type == CORPUS_RELATIVE || x->type == CORPUS_FOREIGN)
            continue;
        if (x->type == CORPUS_GENUINE) {
            one->own = one->tried ? fmax(one->own, x->score) : x->score;
            one->tried = true;
        } else {
            one->others = one->n > 0 ? fmax(one->others, x->score) : x->score;
            one->n++;
        }
    }
    return rank;
}

/* How often the own template had the highest score, of the probes that were compared with
 * their own and with others'. */
static enum status count_ranks(struct report *r, struct report_group *g)
{
    const struct trials *t = r->t;
    struct rank *rank = rank_probes(t);

    if (rank == NULL)
        return ST_ENOMEM;
    for (uint32_t i = 0; i < t->corpus->nscan; i++)
        if (rank[i].tried && rank[i].n > 0 && of_kind(r, g, i)) {
            g->ranked++;
            g->first += rank[i].own > rank[i].others;
        }
    free(rank);
    return ST_OK;
}

static enum status measure_time(struct report *r)
{
    double *v = malloc((r->t->n + 1) * sizeof *v);
    size_t n = 0;

    if (v == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].done)
            v[n++] = (double)r->t->trial[i].score_ms;
    r->score_ms = quantile(v, n, 0.5);
    free(v);
    return ST_OK;
}

/* ---- shares, each by the same bootstrap */

static const double right = 0, wrong = -(double)INFINITY, apart = (double)NAN;

/* Of s[0..n-1], right or wrong, the share that is wrong (mated) or right (non-mated). */
static enum status report_share(const struct report *r, const struct rates_score *s,
                                size_t n, bool mated, struct report_rate *out)
{
    struct rates_figures f, low, high;
    struct rates *rates;
    enum status st = rates_new(s, n, r->t->corpus->nsubject, &rates);

    if (st == ST_OK && (st = rates_bootstrap(rates, right, (double)NAN, RATES_REPLICATES,
                                             REPORT_SEED, &low, &high)) == ST_OK) {
        rates_figures(rates, right, &f);
        *out = mated ? (struct report_rate){f.fnmr, low.fnmr, high.fnmr, n}
                     : (struct report_rate){f.fmr, low.fmr, high.fmr, n};
    }
    rates_free(rates);
    return st;
}

/* What a comparison counts as: a score, right, wrong; apart: not at all. */
typedef double score_of(const struct trial *x);

static double scored(const struct trial *x)
{
    if (x->type != CORPUS_GENUINE && x->type != CORPUS_IMPOSTOR)
        return apart;
    return x->done ? x->score : apart;
}

static double scored_or_refused(const struct trial *x)
{
    return x->type == CORPUS_GENUINE && !x->done ? wrong : scored(x);
}

static double match_of(const struct trial *x, enum corpus_pair type, bool planned)
{
    if (x->type != type || (!planned && !x->done))
        return apart;
    return x->done && x->decision == SURFACE_MATCH ? right : wrong;
}

static double non_mated_match(const struct trial *x)
{
    return match_of(x, CORPUS_IMPOSTOR, false);
}

static double non_mated_match_planned(const struct trial *x)
{
    return match_of(x, CORPUS_IMPOSTOR, true);
}

static double mated_match(const struct trial *x)
{
    return match_of(x, CORPUS_GENUINE, false);
}

static double mated_match_planned(const struct trial *x)
{
    return match_of(x, CORPUS_GENUINE, true);
}

static double mated_no_match(const struct trial *x)
{
    if (x->type != CORPUS_GENUINE || !x->done)
        return apart;
    return x->decision != SURFACE_NO_MATCH ? right : wrong;
}

/* A group's mated comparisons and all non-mated ones; *n of them at *out, for free(). */
static enum status report_collect(const struct report *r, const struct report_group *g,
                                  score_of *score, struct rates_score **out, size_t *n)
{
    const struct corpus *c = r->t->corpus;
    struct rates_score *s = malloc((r->t->n + 1) * sizeof *s);

    *out = s;
    *n = 0;
    if (s == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < r->t->n; i++) {
        const struct trial *x = &r->t->trial[i];
        const double value = score(x);

        if (!isnan(value) && (x->type != CORPUS_GENUINE || of_kind(r, g, x->probe)))
            s[(*n)++] = (struct rates_score){value, c->scan[x->template].subject,
                                             c->scan[x->probe].subject};
    }
    return ST_OK;
}

static enum status decided(const struct report *r, const struct report_group *g,
                           score_of *score, bool mated, struct report_rate *out)
{
    struct rates_score *s;
    size_t n;
    enum status st = report_collect(r, g, score, &s, &n);

    if (st == ST_OK)
        st = report_share(r, s, n, mated, out);
    free(s);
    return st;
}

/* The failures of scans as templates or, of a kind, as probes. */
static enum status failures(const struct report *r, const struct report_group *g,
                            const struct trials_scan *scan, struct report_rate *out)
{
    const struct corpus *c = r->t->corpus;
    struct rates_score *s = malloc((c->nscan + (size_t)1) * sizeof *s);
    size_t n = 0;
    enum status st;

    if (s == NULL)
        return ST_ENOMEM;
    for (uint32_t i = 0; i < c->nscan; i++)
        if (scan[i].used && of_kind(r, g, i))
            s[n++] = (struct rates_score){scan[i].st == ST_OK ? right : wrong,
                                          c->scan[i].subject, c->scan[i].subject};
    st = report_share(r, s, n, true, out);
    free(s);
    return st;
}

/* ---- searches */

static double threshold_among(const struct report *r, uint32_t people)
{
    struct surface_calibration c = r->model->calibration;

    c.threshold = r->t->threshold;
    return surface_search_threshold(&c, people);
}

static enum status measure_search(struct report *r)
{
    const struct corpus *c = r->t->corpus;
    struct rank *rank = rank_probes(r->t);
    struct rates_score *with = malloc((c->nscan + (size_t)1) * sizeof *with);
    struct rates_score *without = malloc((c->nscan + (size_t)1) * sizeof *without);
    size_t nwith = 0, nwithout = 0;
    enum status st = rank && with && without ? ST_OK : ST_ENOMEM;

    for (uint32_t i = 0; i < c->nscan && st == ST_OK; i++) {
        const struct rank *x = &rank[i];
        const uint32_t subject = c->scan[i].subject;

        if (x->n > 0)
            without[nwithout++] = (struct rates_score){
                x->others >= threshold_among(r, x->n) ? wrong : right, subject, subject};
        if (x->planned)
            with[nwith++] =
                (struct rates_score){x->tried && x->own >= threshold_among(r, x->n + 1) &&
                                             (x->n == 0 || x->own > x->others)
                                         ? right
                                         : wrong,
                                     subject, subject};
        if (x->n + x->tried > r->search.people)
            r->search.people = x->n + x->tried;
    }
    r->search.threshold = threshold_among(r, r->search.people);
    if (st == ST_OK)
        st = report_share(r, without, nwithout, true, &r->search.fpir);
    if (st == ST_OK)
        st = report_share(r, with, nwith, true, &r->search.fnir);
    free(rank);
    free(with);
    free(without);
    return st;
}

/* ---- curves */

static enum status curve_of(const struct trials *t, const struct rates_score *s, size_t n,
                            struct report_curve *out)
{
    enum status st = rates_new(s, n, t->corpus->nsubject, &out->rates);

    if (st != ST_OK)
        return st;
    out->n = rates_ngenuine(out->rates);
    rates_figures(out->rates, t->threshold, &out->f);
    return rates_bootstrap(out->rates, t->threshold, (double)NAN, RATES_REPLICATES,
                           REPORT_SEED, &out->low, &out->high);
}

static enum status measure_curve(const struct report *r, const struct report_group *g,
                                 score_of *score, struct report_curve *out)
{
    struct rates_score *s;
    size_t n;
    enum status st = report_collect(r, g, score, &s, &n);

    if (st == ST_OK)
        st = curve_of(r->t, s, n, out);
    free(s);
    return st;
}

enum status report_measure_method(struct report_method *m, const struct trials *t)
{
    struct rates_score *s = malloc((t->n + 1) * sizeof *s);
    size_t n = 0;
    enum status st;

    if (s == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < t->n; i++) {
        const struct trial *x = &t->trial[i];
        const bool mated = x->type == CORPUS_GENUINE, has = !isnan(m->score[i]);

        m->scored += has;
        m->mated += mated && has;
        m->non_mated += x->type == CORPUS_IMPOSTOR && has;
        if (mated || (x->type == CORPUS_IMPOSTOR && has))
            s[n++] = (struct rates_score){has ? m->score[i] : wrong,
                                          t->corpus->scan[x->template].subject,
                                          t->corpus->scan[x->probe].subject};
    }
    st = curve_of(t, s, n, &m->curve);
    free(s);
    return st;
}

static enum status measure_group(struct report *r, struct report_group *g)
{
    enum status st;

    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].type == CORPUS_GENUINE && of_kind(r, g, r->t->trial[i].probe))
            report_count_all(&g->mated, &r->t->trial[i]);
    if ((st = count_ranks(r, g)) != ST_OK ||
        (st = failures(r, g, r->t->probe, &g->fta)) != ST_OK ||
        (st = decided(r, g, mated_no_match, true, &g->fnmr)) != ST_OK ||
        (st = decided(r, g, mated_match, true, &g->unmatched)) != ST_OK ||
        (st = decided(r, g, mated_match_planned, true, &g->frr)) != ST_OK ||
        (st = measure_curve(r, g, scored, &g->curve[REPORT_SCORED])) != ST_OK)
        return st;
    if (g->mated.n == g->mated.planned) { /* the same comparisons */
        g->curve[REPORT_ALL] = g->curve[REPORT_SCORED];
        g->curve[REPORT_ALL].rates = NULL;
        return ST_OK;
    }
    return measure_curve(r, g, scored_or_refused, &g->curve[REPORT_ALL]);
}

/* The kinds of probes that there are, behind the group of all. */
static enum status make_groups(struct report *r)
{
    const struct corpus *c = r->t->corpus;
    bool *probed = calloc(c->nkind, sizeof *probed);

    r->group = calloc(c->nkind + (size_t)1, sizeof *r->group);
    if (probed == NULL || r->group == NULL) {
        free(probed);
        return ST_ENOMEM;
    }
    for (uint32_t i = 0; i < c->nscan; i++)
        if (r->t->probe[i].used)
            probed[c->scan[i].kind] = true;
    r->group[r->ngroup++] = (struct report_group){.name = "all", .kind = CORPUS_NONE};
    for (uint32_t k = 0; k < c->nkind; k++)
        if (probed[k])
            r->group[r->ngroup++] = (struct report_group){
                .name = c->kind[k][0] != '\0' ? c->kind[k] : "-", .kind = k};
    free(probed);
    return ST_OK;
}

enum status report_measure(struct report *r, const struct trials *t)
{
    const struct corpus *c = t->corpus;
    enum status st;

    r->t = t;
    for (uint32_t i = 0; i < c->nsubject; i++)
        r->untemplated += c->nlisted == 0 && c->subject[i].enrolled == CORPUS_NONE;
    for (size_t i = 0; i < t->n; i++)
        if (t->trial[i].type == CORPUS_IMPOSTOR)
            report_count_all(&r->non_mated, &t->trial[i]);
        else if (t->trial[i].type == CORPUS_RELATIVE)
            report_count_all(&r->relative, &t->trial[i]);
    if ((st = measure_time(r)) != ST_OK || (st = make_groups(r)) != ST_OK ||
        (st = failures(r, &r->group[0], t->template, &r->fte)) != ST_OK ||
        (st = decided(r, &r->group[0], non_mated_match, false, &r->fmr)) != ST_OK ||
        (st = decided(r, &r->group[0], non_mated_match_planned, false, &r->far)) !=
            ST_OK ||
        (st = measure_search(r)) != ST_OK)
        return st;
    for (uint32_t i = 0; i < r->ngroup && st == ST_OK; i++)
        st = measure_group(r, &r->group[i]);
    return st;
}

void report_free(struct report *r)
{
    for (uint32_t i = 0; i < r->ngroup; i++)
        for (int k = 0; k < REPORT_OF; k++)
            rates_free(r->group[i].curve[k].rates);
    free(r->group);
}

double report_bound(double rate, size_t n)
{
    /* Upper limits of a Poisson mean where 0, 1, ... were counted. */
    static const double most[] = {3, 4.74, 6.30, 7.75};
    const double errors = ceil(rate * (double)n - 1e-9);

    return most[errors > 0 ? (int)fmin(errors, 3) : 0] / (double)n;
}
