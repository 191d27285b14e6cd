#include "report_text.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "model.h"
#include "model_digest.h"
#include "report.h"

struct number {
    char s[24];
};

struct cell {
    char s[120];
};

/* A share in per cent, with as many digits as are of use. */
static struct number percent(double share)
{
    const double p = 100 * share;
    struct number c;

    (void)snprintf(c.s, sizeof c.s,
                   p == 0 || p == 100 ? "%.0f"
                   : p < 1            ? "%.2g"
                   : p > 99           ? "%.2f"
                                      : "%.1f",
                   p);
    return c;
}

/* An error rate with its interval; without enough of them, what it is below. */
static struct cell error_cell(double rate, double low, double high, size_t n)
{
    struct cell c;

    if (isnan(rate) || n == 0)
        (void)snprintf(c.s, sizeof c.s, "no comparisons");
    else if (!rates_supported(rate, n) && report_bound(rate, n) >= 1)
        (void)snprintf(c.s, sizeof c.s, "not supported by %zu comparisons", n);
    else if (!rates_supported(rate, n))
        (void)snprintf(c.s, sizeof c.s, "below %s %% (%.0f of %zu)",
                       percent(report_bound(rate, n)).s, rate * (double)n, n);
    else
        (void)snprintf(c.s, sizeof c.s, "%s %% [%s–%s]", percent(rate).s, percent(low).s,
                       percent(high).s);
    return c;
}

static struct cell rate_cell(const struct report_rate *x)
{
    return error_cell(x->value, x->low, x->high, x->n);
}

/* Both errors are in an EER: the fewer comparisons say how small it may be. */
static struct cell eer_cell(const struct report *r, const struct report_curve *g)
{
    const size_t n = g->n < r->non_mated.n ? g->n : r->non_mated.n;
    struct cell c;

    if (isnan(g->f.eer) || rates_supported(g->f.eer, n) || report_bound(g->f.eer, n) >= 1)
        return error_cell(g->f.eer, g->low.eer, g->high.eer, n);
    (void)snprintf(c.s, sizeof c.s, "below %s %%", percent(report_bound(g->f.eer, n)).s);
    return c;
}

static struct cell tar_cell(const struct report *r, const struct report_curve *g, int k)
{
    const double tar = g->f.tar[k];
    struct cell c;

    if (isnan(tar))
        (void)snprintf(c.s, sizeof c.s, "no comparisons");
    else if (!rates_supported(rates_target[k], r->non_mated.n))
        (void)snprintf(c.s, sizeof c.s, "not supported by %zu comparisons",
                       r->non_mated.n);
    else if (!rates_supported(1 - tar, g->n) && report_bound(1 - tar, g->n) >= 1)
        (void)snprintf(c.s, sizeof c.s, "not supported by %zu comparisons", g->n);
    else if (!rates_supported(1 - tar, g->n))
        (void)snprintf(c.s, sizeof c.s, "above %s %% (%.0f of %zu)",
                       percent(1 - report_bound(1 - tar, g->n)).s, tar * (double)g->n,
                       g->n);
    else
        (void)snprintf(c.s, sizeof c.s, "%s %% [%s–%s]", percent(tar).s,
                       percent(g->low.tar[k]).s, percent(g->high.tar[k]).s);
    return c;
}

/* A name in a Markdown table: nothing in it may end the cell or begin something. */
static void name(FILE *to, const char *s)
{
    for (; *s != '\0'; s++)
        (void)fprintf(to, "%s%c", strchr("|\\`*_<>[]#", *s) != NULL ? "\\" : "", *s);
}

/* ---- text */

static void text_made(const struct report *r, FILE *to)
{
    (void)fprintf(to, "# Evaluation of face comparison\n\n| | |\n|---|---|\n| scans | ");
    name(to, r->source);
    (void)fprintf(to, " |\n| made | %s by %s |\n| model | ", r->made, r->engine);
    name(to, r->model->name);
    (void)fprintf(
        to,
        ", digest %016" PRIx64 " |\n"
        "| learned from these people? | not recorded in a model: if it was, the "
        "rates are too good |\n"
        "| threshold | %.4g, calibration %s |\n",
        model_digest(r->model), r->threshold, r->calibration);
}

static void text_head(const struct report *r, FILE *to)
{
    const struct ctl_trials *t = r->t;
    const struct corpus *c = t->corpus;
    const struct report_group *all = &r->group[0];

    text_made(r, to);
    (void)fprintf(to, "| subjects | %u in %u population%s; %u scans |\n", c->nsubject,
                  c->npopulation, c->npopulation == 1 ? "" : "s", c->nscan);
    if (r->enroll_kind != NULL) {
        (void)fprintf(to, "| enrolled | scans of the kind ");
        name(to, r->enroll_kind);
        (void)fprintf(to, "; %u subjects have none |\n", r->untemplated);
    }
    (void)fprintf(to, "| failures to enroll | %.0f of %zu: %s |\n",
                  r->fte.value * (double)r->fte.n, r->fte.n, rate_cell(&r->fte).s);
    (void)fprintf(to, "| failures to acquire | %.0f of %zu: %s |\n",
                  all->fta.value * (double)all->fta.n, all->fta.n,
                  rate_cell(&all->fta).s);
    (void)fprintf(to, "| comparisons | %zu mated, %zu non-mated, %zu of close relatives",
                  all->mated.n, r->non_mated.n, r->relative.n);
    if (t->n > report_done(r))
        (void)fprintf(to, "; %zu impossible, a scan was refused", t->n - report_done(r));
    (void)fprintf(to, " |\n| non-mated pairs | ");
    if (c->nlisted > 0)
        (void)fprintf(to, "as listed |\n");
    else if (t->non_mated == CTL_TRIALS_ALL)
        (void)fprintf(to, "all of the same population |\n");
    else
        (void)fprintf(to,
                      "of each probe %u of the same population, drawn with seed %llu |\n",
                      t->non_mated, (unsigned long long)t->seed);
    (void)fprintf(
        to, "| intervals | 95 %%, %u bootstrap replicates over subjects, seed %llu |\n",
        r->replicates, (unsigned long long)r->seed);
    (void)fprintf(
        to,
        "| speed | %.0f comparisons a second on %u thread%s, reading the probes "
        "included; median of one %.2f ms |\n",
        (double)report_done(r) / t->compare_s, t->nthread, t->nthread == 1 ? "" : "s",
        r->score_ms);
}

static void text_curves(const struct report *r, enum report_of of, FILE *to)
{
    (void)fprintf(to, "\n| probes | mated | EER |");
    for (int k = 0; k < RATES_TARGETS; k++)
        (void)fprintf(to, " TAR at FMR %g %% |", 100 * rates_target[k]);
    (void)fprintf(to, " own template nearest |\n|---|---|---|---|---|---|---|\n");
    for (uint32_t i = 0; i < r->ngroup; i++) {
        const struct report_group *g = &r->group[i];

        (void)fprintf(to, "| ");
        name(to, g->name);
        (void)fprintf(to, " | %zu | %s |", g->curve[of].n, eer_cell(r, &g->curve[of]).s);
        for (int k = 0; k < RATES_TARGETS; k++)
            (void)fprintf(to, " %s |", tar_cell(r, &g->curve[of], k).s);
        (void)fprintf(to, " %u of %u |\n", g->first, g->ranked);
    }
}

static void text_rates(const struct report *r, FILE *to)
{
    const struct report_group *all = &r->group[0];
    const struct report_curve *g = &all->curve[REPORT_SCORED];

    (void)fprintf(to,
                  "\n## Rates of the comparisons made\n\nOf each kind of probe, against "
                  "all non-mated comparisons.\n");
    text_curves(r, REPORT_SCORED, to);
    (void)fprintf(to, "\n");
    for (int k = 0; k < RATES_TARGETS; k++)
        if (!rates_supported(rates_target[k], r->non_mated.n))
            (void)fprintf(
                to,
                "- FMR %g %%: not supported by %zu non-mated comparisons; it takes %zu\n",
                100 * rates_target[k], r->non_mated.n, rates_needed(rates_target[k]));
        else if (!isfinite(g->f.tar_score[k]))
            (void)fprintf(to, "- FMR %g %%: no threshold keeps it\n",
                          100 * rates_target[k]);
        else
            (void)fprintf(to, "- FMR %g %%: threshold %.2f [%.2f–%.2f]\n",
                          100 * rates_target[k], g->f.tar_score[k], g->low.tar_score[k],
                          g->high.tar_score[k]);
    if (all->mated.n == all->mated.planned)
        return;
    (void)fprintf(to,
                  "\n## Rates with refusals counted as errors\n\nA mated comparison that "
                  "a refused scan made impossible is one that does not match.\n");
    text_curves(r, REPORT_ALL, to);
}

static void text_count(FILE *to, const struct report_count *c)
{
    (void)fprintf(to, " | %zu | %zu | %zu | %zu | %zu |", c->planned, c->match,
                  c->no_match, c->inconclusive, c->planned - c->n);
}

static void text_decision(const struct report *r, FILE *to)
{
    (void)fprintf(
        to,
        "\n## The program's own decision, at %.4g\n\n"
        "| comparisons | number | match | non-match | inconclusive | refused | of "
        "those made | refusals counted |\n"
        "|---|---|---|---|---|---|---|---|\n",
        r->threshold);
    (void)fprintf(to, "| non-mated");
    text_count(to, &r->non_mated);
    (void)fprintf(to, " FMR %s | FAR %s |\n", rate_cell(&r->fmr).s, rate_cell(&r->far).s);
    if (r->relative.planned > 0) {
        (void)fprintf(to, "| close relatives");
        text_count(to, &r->relative);
        (void)fprintf(to, " matches: %zu of %zu | |\n", r->relative.match, r->relative.n);
    }
    for (uint32_t i = 0; i < r->ngroup; i++) {
        const struct report_group *g = &r->group[i];

        (void)fprintf(to, "| mated, ");
        name(to, g->name);
        text_count(to, &g->mated);
        (void)fprintf(to, " FNMR %s", rate_cell(&g->fnmr).s);
        if (g->mated.inconclusive > 0)
            (void)fprintf(to, "; with the inconclusive ones %s",
                          rate_cell(&g->unmatched).s);
        (void)fprintf(to, " | FRR %s |\n", rate_cell(&g->frr).s);
    }
}

static void text_pose(const struct report *r, FILE *to)
{
    if (!r->t->corpus->posed)
        return;
    (void)fprintf(to,
                  "\n## The pose\n\nError of the rotation found against the true one, "
                  "degrees.\n\n| probes | number | median | 90 %% below | largest | "
                  "beyond 3 |\n|---|---|---|---|---|---|\n");
    for (uint32_t i = 0; i < r->ngroup; i++) {
        const struct report_group *g = &r->group[i];

        if (g->posed == 0)
            continue;
        (void)fprintf(to, "| ");
        name(to, g->name);
        (void)fprintf(to, " | %zu | %.2f | %.2f | %.2f | %zu |\n", g->posed,
                      g->median_deg, g->most_deg, g->worst_deg, g->beyond);
    }
}

static void text_refused_as(const struct report *r, const struct ctl_trials_scan *scan,
                            const char *as, FILE *to)
{
    const struct corpus *c = r->t->corpus;

    for (uint32_t i = 0; i < c->nscan; i++) {
        if (scan[i].st == ST_OK)
            continue;
        (void)fprintf(to, "| ");
        name(to, c->scan[i].file);
        (void)fprintf(to, " | %s | ", as);
        name(to, scan[i].why);
        (void)fprintf(to, " |\n");
    }
}

static void text_refused(const struct report *r, FILE *to)
{
    if (r->fte.value + r->group[0].fta.value <= 0)
        return;
    (void)fprintf(to, "\n## Scans that were refused\n\n| scan | to be | why |\n"
                      "|---|---|---|\n");
    text_refused_as(r, r->t->template, "enrolled", to);
    text_refused_as(r, r->t->probe, "a probe", to);
}

static const char reading[] =
    "\n## How to read this\n\n"
    "Terms are those of ISO/IEC 19795-1 and 2382-37; this is an evaluation of stored scans,\n"
    "without presentation attacks. A mated comparison is of two scans of one person, a\n"
    "non-mated one of two people. FMR: the share of non-mated comparisons that match. FNMR:\n"
    "the share of mated ones that do not. TAR: 1 - FNMR, at the smallest score that keeps the\n"
    "FMR. EER: where FMR and FNMR are equal. The program's own decision counts apart the\n"
    "comparisons that are inconclusive: no match, of scans that tell too little for one.\n"
    "Close relatives count as neither. \"Own template nearest\" counts against the other\n"
    "templates that the probe was compared with.\n\n"
    "A scan that is refused is a failure to enroll (FTE) or to acquire (FTA). With refusals\n"
    "counted as errors, FRR is the share of all mated comparisons that were planned and are no\n"
    "match, for whatever reason, and FAR the share of all non-mated ones that are a match: the\n"
    "generalised rates, of people who give one scan to be enrolled and one to be verified.\n\n"
    "Intervals are over subjects, because one person's scans err together. No rate is given\n"
    "that is smaller than 3 / N for N comparisons, nor a threshold for one: with no error\n"
    "seen in N independent comparisons the rate is below 3 / N with 95 % confidence, and\n"
    "less cannot be said (\"rule of 3\"); with one error it is below 4.74 / N, with two below\n"
    "6.30 / N. For an FMR of 0.01 % that takes 30,000 non-mated\n"
    "comparisons. Comparisons of the same few people are not independent: then even this is\n"
    "flattering.\n\n"
    "The figures hold for people, scanners and times between scans like these. Thresholds\n"
    "chosen on these scans look better on them than they are.\n\n"
    "scores.csv has every comparison and every refusal, rates.csv FMR and FNMR by threshold.\n";

enum status report_text(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report *r = arg;

    (void)e;
    text_head(r, to);
    text_rates(r, to);
    text_decision(r, to);
    text_pose(r, to);
    text_refused(r, to);
    (void)fputs(reading, to);
    return ST_OK;
}

void report_text_sets(FILE *to, const struct report *r, size_t n)
{
    (void)fprintf(
        to,
        "| scans | subjects | FTE | FTA | mated | non-mated | EER | TAR at 1 %% | "
        "TAR at 0.1 %% | FNMR | FMR | refusals counted: TAR at 1 %% | TAR at "
        "0.1 %% | FRR |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < n; i++) {
        const struct report_group *all = &r[i].group[0];

        (void)fprintf(to, "| ");
        name(to, r[i].source);
        (void)fprintf(to, " | %u | %s | %s | %zu | %zu | %s | %s | %s |",
                      r[i].t->corpus->nsubject, rate_cell(&r[i].fte).s,
                      rate_cell(&all->fta).s, all->mated.n, r[i].non_mated.n,
                      eer_cell(&r[i], &all->curve[REPORT_SCORED]).s,
                      tar_cell(&r[i], &all->curve[REPORT_SCORED], 0).s,
                      tar_cell(&r[i], &all->curve[REPORT_SCORED], 1).s);
        (void)fprintf(
            to, " %s | %s | %s | %s | %s |\n", rate_cell(&all->fnmr).s,
            rate_cell(&r[i].fmr).s, tar_cell(&r[i], &all->curve[REPORT_ALL], 0).s,
            tar_cell(&r[i], &all->curve[REPORT_ALL], 1).s, rate_cell(&all->frr).s);
    }
}
