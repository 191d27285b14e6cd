#include <math.h>

#include "surfacectl_report.h"

/* null where the number of comparisons does not support it. */
static double if_stated(double rate, size_t n)
{
    return rates_supported(rate, n) ? rate : (double)NAN;
}

/* What the rate is below, where it cannot be stated. */
static void rate(struct surfacectl_out *o, const char *key, double value, double low,
                 double high, size_t n)
{
    const bool supported = rates_supported(value, n);

    surfacectl_out_object(o, key);
    surfacectl_out_number(o, "value", if_stated(value, n));
    surfacectl_out_flag(o, "supported", supported);
    if (!supported && n > 0)
        surfacectl_out_number(o, "below", fmin(1, rates_least(n)));
    surfacectl_out_number(o, "low", low);
    surfacectl_out_number(o, "high",
                          supported ? high : fmax(high, fmin(1, rates_least(n))));
    surfacectl_out_number(o, "comparisons", (double)n);
    surfacectl_out_close(o);
}

static void count(struct surfacectl_out *o, const struct surfacectl_report_count *c)
{
    surfacectl_out_number(o, "comparisons", (double)c->n);
    surfacectl_out_number(o, "match", (double)c->match);
    surfacectl_out_number(o, "no_match", (double)c->no_match);
    surfacectl_out_number(o, "inconclusive", (double)c->inconclusive);
}

static void targets(const struct surfacectl_report *r,
                    const struct surfacectl_report_group *g, struct surfacectl_out *o)
{
    surfacectl_out_array(o, "tar");
    for (int k = 0; k < RATES_TARGETS; k++) {
        const bool known = rates_supported(rates_target[k], r->impostor.n);
        const double least = fmin(1, rates_least(g->genuine.n));
        const bool supported = known && 1 - g->f.tar[k] >= least;

        surfacectl_out_object(o, NULL);
        surfacectl_out_number(o, "fmr", rates_target[k]);
        surfacectl_out_flag(o, "supported", supported);
        if (!known)
            surfacectl_out_number(o, "impostors_needed",
                                  (double)rates_needed(rates_target[k]));
        if (known && !supported && g->genuine.n > 0)
            surfacectl_out_number(o, "above", 1 - least);
        surfacectl_out_number(o, "value", supported ? g->f.tar[k] : (double)NAN);
        if (known) {
            surfacectl_out_number(
                o, "low", supported ? g->low.tar[k] : fmin(g->low.tar[k], 1 - least));
            surfacectl_out_number(o, "high", g->high.tar[k]);
            surfacectl_out_number(o, "threshold_mm", g->f.tar_mm[k]);
        }
        surfacectl_out_close(o);
    }
    surfacectl_out_close(o);
}

static void group(const struct surfacectl_report *r,
                  const struct surfacectl_report_group *g, struct surfacectl_out *o)
{
    const size_t fewer = g->genuine.n < r->impostor.n ? g->genuine.n : r->impostor.n;

    surfacectl_out_object(o, NULL);
    surfacectl_out_text(o, "probes", g->name);
    surfacectl_out_number(o, "number", g->probe);
    surfacectl_out_number(o, "failures_to_acquire", g->refused);
    count(o, &g->genuine);
    rate(o, "eer", g->f.eer, g->low.eer, g->high.eer, fewer);
    targets(r, g, o);
    rate(o, "fnmr", g->no_match.value, g->no_match.low, g->no_match.high, g->no_match.n);
    rate(o, "fnmr_with_inconclusive", g->unmatched.value, g->unmatched.low,
         g->unmatched.high, g->unmatched.n);
    surfacectl_out_number(o, "ranked", g->ranked);
    surfacectl_out_number(o, "own_template_nearest", g->first);
    if (g->posed > 0) {
        surfacectl_out_object(o, "rotation_error_deg");
        surfacectl_out_number(o, "number", (double)g->posed);
        surfacectl_out_number(o, "median", g->median_deg);
        surfacectl_out_number(o, "most", g->most_deg);
        surfacectl_out_number(o, "largest", g->worst_deg);
        surfacectl_out_number(o, "beyond_3", (double)g->beyond);
        surfacectl_out_close(o);
    }
    surfacectl_out_close(o);
}

static void refused(const struct surfacectl_report *r, struct surfacectl_out *o)
{
    const struct corpus *c = r->t->corpus;

    surfacectl_out_array(o, "refused");
    for (uint32_t i = 0; i < c->nscan; i++)
        if (r->t->refused[i] != NULL) {
            surfacectl_out_object(o, NULL);
            surfacectl_out_text(o, "file", c->scan[i].file);
            surfacectl_out_text(o, "subject", c->subject[c->scan[i].subject].id);
            surfacectl_out_flag(o, "enroll", c->scan[i].enrolled);
            surfacectl_out_text(o, "reason", r->t->refused[i]);
            surfacectl_out_close(o);
        }
    surfacectl_out_close(o);
}

void surfacectl_report_json(const struct surfacectl_report *r, struct surfacectl_out *o)
{
    const struct surfacectl_trials *t = r->t;

    surfacectl_out_text(o, "scans", r->source);
    surfacectl_out_text(o, "made", r->made);
    surfacectl_out_text(o, "engine", r->engine);
    surfacectl_out_text(o, "calibration", r->judge);
    surfacectl_out_number(o, "threshold_mm", r->threshold_mm);
    surfacectl_out_number(o, "subjects", t->corpus->nsubject);
    surfacectl_out_number(o, "populations", t->corpus->npopulation);
    surfacectl_out_number(o, "failures_to_enroll", r->unenrolled);
    refused(r, o);
    surfacectl_out_object(o, "impostor");
    count(o, &r->impostor);
    rate(o, "fmr", r->match.value, r->match.low, r->match.high, r->match.n);
    surfacectl_out_number(o, "of_each_probe",
                          t->impostors == UINT32_MAX ? (double)NAN : t->impostors);
    surfacectl_out_number(o, "seed", (double)t->seed);
    surfacectl_out_close(o);
    surfacectl_out_object(o, "relative");
    count(o, &r->relative);
    surfacectl_out_close(o);
    surfacectl_out_array(o, "genuine");
    for (uint32_t i = 0; i < r->ngroup; i++)
        group(r, &r->group[i], o);
    surfacectl_out_close(o);
    surfacectl_out_object(o, "bootstrap");
    surfacectl_out_number(o, "replicates", r->replicates);
    surfacectl_out_number(o, "seed", (double)r->seed);
    surfacectl_out_close(o);
    surfacectl_out_object(o, "speed");
    surfacectl_out_number(o, "threads", t->nthread);
    surfacectl_out_number(o, "enroll_s", t->build_s);
    surfacectl_out_number(o, "compare_s", t->compare_s);
    surfacectl_out_number(o, "comparisons_a_second",
                          (double)(t->n - r->undone) / t->compare_s);
    surfacectl_out_number(o, "align_ms", r->align_ms);
    surfacectl_out_number(o, "measure_ms", r->measure_ms);
    surfacectl_out_close(o);
    if (r->plots[0] != '\0')
        surfacectl_out_text(o, "no_pictures", r->plots);
}
