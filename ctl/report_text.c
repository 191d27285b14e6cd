#include "report_text.h"

#include <math.h>
#include <string.h>

#include "report.h"

struct number {
    char s[24];
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

/* An error rate with its interval; without enough comparisons, what it is below. */
static struct report_text_cell error_cell(double rate, double low, double high, size_t n)
{
    struct report_text_cell c;

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

struct report_text_cell report_text_rate(const struct report_rate *x)
{
    return error_cell(x->value, x->low, x->high, x->n);
}

static size_t least_of(const struct report *r, const struct report_group *g)
{
    return g->mated.n < r->non_mated.n ? g->mated.n : r->non_mated.n;
}

/* Both errors are in an EER: the fewer comparisons say how small it may be. */
static struct report_text_cell eer_cell(const struct report *r,
                                        const struct report_group *g)
{
    const size_t n = least_of(r, g);
    struct report_text_cell c;

    if (isnan(g->f.eer) || rates_supported(g->f.eer, n) || report_bound(g->f.eer, n) >= 1)
        return error_cell(g->f.eer, g->low.eer, g->high.eer, n);
    (void)snprintf(c.s, sizeof c.s, "below %s %%", percent(report_bound(g->f.eer, n)).s);
    return c;
}

static struct report_text_cell tar_cell(const struct report *r,
                                        const struct report_group *g, int k)
{
    const size_t n = g->mated.n;
    const double tar = g->f.tar[k];
    struct report_text_cell c;

    if (isnan(tar))
        (void)snprintf(c.s, sizeof c.s, "no comparisons");
    else if (!rates_supported(rates_target[k], r->non_mated.n))
        (void)snprintf(c.s, sizeof c.s, "not supported by %zu comparisons",
                       r->non_mated.n);
    else if (!rates_supported(1 - tar, n) && report_bound(1 - tar, n) >= 1)
        (void)snprintf(c.s, sizeof c.s, "not supported by %zu comparisons", n);
    else if (!rates_supported(1 - tar, n))
        (void)snprintf(c.s, sizeof c.s, "above %s %% (%.0f of %zu)",
                       percent(1 - report_bound(1 - tar, n)).s, tar * (double)n, n);
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

static void text_head(const struct report *r, FILE *to)
{
    const struct ctl_trials *t = r->t;
    const struct corpus *c = t->corpus;
    const struct report_group *all = &r->group[0];

    (void)fprintf(to, "# Evaluation of face comparison\n\n| | |\n|---|---|\n| scans | ");
    name(to, r->source);
    (void)fprintf(to, " |\n| made | %s by %s, calibration %s |\n", r->made, r->engine,
                  r->calibration);
    (void)fprintf(to,
                  "| subjects | %u in %u population%s; %u scans, %u of them probes |\n",
                  c->nsubject, c->npopulation, c->npopulation == 1 ? "" : "s", c->nscan,
                  all->probe);
    (void)fprintf(to, "| failures to enrol | %u of %u |\n", r->unenrolled, c->nsubject);
    (void)fprintf(to, "| failures to acquire | %u of %u |\n", all->refused, all->probe);
    (void)fprintf(to, "| comparisons | %zu mated, %zu non-mated, %zu of close relatives",
                  all->mated.n, r->non_mated.n, r->relative.n);
    if (r->undone > 0)
        (void)fprintf(to, "; %zu impossible, a scan was refused", r->undone);
    (void)fprintf(to, " |\n| non-mated pairs | ");
    if (t->non_mated == UINT32_MAX)
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
        "included; median of one %.1f ms to align and %.1f ms to measure |\n",
        (double)(t->n - r->undone) / t->compare_s, t->nthread, t->nthread == 1 ? "" : "s",
        r->align_ms, r->measure_ms);
}

static void text_rates(const struct report *r, FILE *to)
{
    const struct report_group *all = &r->group[0];

    (void)fprintf(to, "\n## Rates\n\nOf each kind of probe, against all non-mated "
                      "comparisons.\n\n| probes | mated | EER |");
    for (int k = 0; k < RATES_TARGETS; k++)
        (void)fprintf(to, " TAR at FMR %g %% |", 100 * rates_target[k]);
    (void)fprintf(to, " own template nearest |\n|---|---|---|---|---|---|---|\n");
    for (uint32_t i = 0; i < r->ngroup; i++) {
        const struct report_group *g = &r->group[i];

        (void)fprintf(to, "| ");
        name(to, g->name);
        (void)fprintf(to, " | %zu | %s |", g->mated.n, eer_cell(r, g).s);
        for (int k = 0; k < RATES_TARGETS; k++)
            (void)fprintf(to, " %s |", tar_cell(r, g, k).s);
        (void)fprintf(to, " %u of %u |\n", g->first, g->ranked);
    }
    (void)fprintf(to, "\n");
    for (int k = 0; k < RATES_TARGETS; k++)
        if (!rates_supported(rates_target[k], r->non_mated.n))
            (void)fprintf(
                to,
                "- FMR %g %%: not supported by %zu non-mated comparisons; it takes %zu\n",
                100 * rates_target[k], r->non_mated.n, rates_needed(rates_target[k]));
        else if (all->f.tar_mm[k] < 0)
            (void)fprintf(to, "- FMR %g %%: no threshold keeps it\n",
                          100 * rates_target[k]);
        else
            (void)fprintf(to, "- FMR %g %%: threshold %.3f mm [%.3f–%.3f]\n",
                          100 * rates_target[k], all->f.tar_mm[k],
                          fmax(0, all->low.tar_mm[k]), fmax(0, all->high.tar_mm[k]));
}

static void text_count(FILE *to, const struct report_count *c)
{
    (void)fprintf(to, " | %zu | %zu | %zu | %zu |", c->n, c->match, c->no_match,
                  c->inconclusive);
}

static void text_decision(const struct report *r, FILE *to)
{
    const struct report_group *all = &r->group[0];
    const double fta = (double)all->refused / (double)all->probe;

    (void)fprintf(to,
                  "\n## The program's own decision, at %.4g mm\n\n"
                  "| comparisons | number | match | non-match | inconclusive | rate |\n"
                  "|---|---|---|---|---|---|\n",
                  r->threshold_mm);
    (void)fprintf(to, "| non-mated");
    text_count(to, &r->non_mated);
    (void)fprintf(to, " FMR %s |\n| close relatives", report_text_rate(&r->match).s);
    text_count(to, &r->relative);
    if (r->relative.n > 0)
        (void)fprintf(to, " matches: %zu of %zu |\n", r->relative.match, r->relative.n);
    else
        (void)fprintf(to, " none |\n");
    for (uint32_t i = 0; i < r->ngroup; i++) {
        const struct report_group *g = &r->group[i];

        (void)fprintf(to, "| mated, ");
        name(to, g->name);
        text_count(to, &g->mated);
        (void)fprintf(to, " FNMR %s", report_text_rate(&g->no_match).s);
        if (g->mated.inconclusive > 0)
            (void)fprintf(to, "; with the inconclusive ones %s",
                          report_text_rate(&g->unmatched).s);
        (void)fprintf(to, " |\n");
    }
    if (all->refused > 0 && all->mated.n > 0)
        (void)fprintf(to,
                      "\nWith the %u probes counted that were refused as scans: false "
                      "reject rate %s %%.\n",
                      all->refused, percent(fta + (1 - fta) * all->unmatched.value).s);
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

static void text_refused(const struct report *r, FILE *to)
{
    const struct corpus *c = r->t->corpus;

    if (r->unenrolled + r->group[0].refused == 0)
        return;
    (void)fprintf(to, "\n## Scans that were refused\n\n| scan | to be | why |\n"
                      "|---|---|---|\n");
    for (uint32_t i = 0; i < c->nscan; i++) {
        if (r->t->refused[i] == NULL)
            continue;
        (void)fprintf(to, "| ");
        name(to, c->scan[i].file);
        (void)fprintf(to, " | %s | ", c->scan[i].enrolled ? "enrolled" : "a probe");
        name(to, r->t->refused[i]);
        (void)fprintf(to, " |\n");
    }
}

static const char reading[] =
    "\n## How to read this\n\n"
    "Terms are those of ISO/IEC 19795-1 and 2382-37; this is an evaluation of stored scans,\n"
    "without presentation attacks. A mated comparison is of two scans of one person, a\n"
    "non-mated one of two people. FMR: the share of non-mated comparisons that match. FNMR:\n"
    "the share of mated ones that do not. TAR: 1 - FNMR, at the largest score that keeps the\n"
    "FMR. EER: where FMR and FNMR are equal. A comparison with too little surface in common\n"
    "matches at no threshold. The program's own decision counts the inconclusive ones apart,\n"
    "those too that hide a part, with a score not far above the threshold. Refused scans take\n"
    "part in no rate. Close relatives count as neither. \"Own template nearest\" counts against\n"
    "the other templates that the probe was compared with.\n\n"
    "Intervals are over subjects, because one person's scans err together. No rate is given\n"
    "that is smaller than 3 / N for N comparisons, nor a threshold for one: with no error\n"
    "seen in N independent comparisons the rate is below 3 / N with 95 % confidence, and\n"
    "less cannot be said (\"rule of 3\"); with one error it is below 4.74 / N, with two below\n"
    "6.30 / N. For an FMR of 0.01 % that takes 30,000 non-mated\n"
    "comparisons. Comparisons of the same few people are not independent: then even this is\n"
    "flattering.\n\n"
    "The figures hold for people, scanners and times between scans like these. Thresholds\n"
    "chosen on these scans look better on them than they are.\n\n"
    "scores.csv has every comparison, rates.csv FMR and FNMR by threshold; report.html is this\n"
    "report with its pictures in one file.\n";

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
    if (r->plots[0] == '\0')
        (void)fprintf(to, "\n![DET curve](det.svg)\n\n![Scores](scores.svg)\n");
    else
        (void)fprintf(to, "\nThere are no pictures: %s.\n", r->plots);
    return ST_OK;
}
