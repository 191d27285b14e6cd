#include "report_json.h"

#include <math.h>

#include "ctl_corpus.h"
#include "ctl_out.h"
#include "report.h"

/* null where the number of comparisons does not support it. */
static double if_stated(double rate, size_t n)
{
    return rates_supported(rate, n) ? rate : (double)NAN;
}

/* What the rate is below, where it cannot be stated. */
static void rate(struct ctl_out *o, const char *key, double value, double low,
                 double high, size_t n)
{
    const bool supported = rates_supported(value, n);

    ctl_out_object(o, key);
    ctl_out_rate(o, "value", if_stated(value, n));
    ctl_out_flag(o, "supported", supported);
    if (!supported && n > 0)
        ctl_out_rate(o, "below", fmin(1, report_bound(value, n)));
    ctl_out_rate(o, "low", low);
    ctl_out_rate(o, "high",
                 supported ? high : fmax(high, fmin(1, report_bound(value, n))));
    ctl_out_number(o, "comparisons", (double)n);
    ctl_out_close(o);
}

static void count(struct ctl_out *o, const struct report_count *c)
{
    ctl_out_number(o, "comparisons", (double)c->n);
    ctl_out_number(o, "match", (double)c->match);
    ctl_out_number(o, "no_match", (double)c->no_match);
    ctl_out_number(o, "inconclusive", (double)c->inconclusive);
}

static void targets(const struct report *r, const struct report_group *g,
                    struct ctl_out *o)
{
    ctl_out_array(o, "tar");
    for (int k = 0; k < RATES_TARGETS; k++) {
        const bool known = rates_supported(rates_target[k], r->non_mated.n);
        const bool supported = known && rates_supported(1 - g->f.tar[k], g->mated.n);
        const double above = 1 - fmin(1, report_bound(1 - g->f.tar[k], g->mated.n));

        ctl_out_object(o, NULL);
        ctl_out_rate(o, "fmr", rates_target[k]);
        ctl_out_flag(o, "supported", supported);
        if (!known)
            ctl_out_number(o, "non_mated_needed", (double)rates_needed(rates_target[k]));
        if (known && !supported && g->mated.n > 0)
            ctl_out_rate(o, "above", above);
        ctl_out_rate(o, "value", supported ? g->f.tar[k] : (double)NAN);
        if (known) {
            ctl_out_rate(o, "low",
                         supported ? g->low.tar[k] : fmin(g->low.tar[k], above));
            ctl_out_rate(o, "high", g->high.tar[k]);
            ctl_out_number(o, "threshold_mm", g->f.tar_mm[k]);
        }
        ctl_out_close(o);
    }
    ctl_out_close(o);
}

static void group(const struct report *r, const struct report_group *g, struct ctl_out *o)
{
    const size_t fewer = g->mated.n < r->non_mated.n ? g->mated.n : r->non_mated.n;

    ctl_out_object(o, NULL);
    ctl_out_text(o, "probes", g->name);
    ctl_out_number(o, "number", g->probe);
    ctl_out_number(o, "failures_to_acquire", g->refused);
    count(o, &g->mated);
    rate(o, "eer", g->f.eer, g->low.eer, g->high.eer, fewer);
    targets(r, g, o);
    rate(o, "fnmr", g->no_match.value, g->no_match.low, g->no_match.high, g->no_match.n);
    rate(o, "fnmr_with_inconclusive", g->unmatched.value, g->unmatched.low,
         g->unmatched.high, g->unmatched.n);
    ctl_out_number(o, "ranked", g->ranked);
    ctl_out_number(o, "own_template_nearest", g->first);
    if (g->posed > 0) {
        ctl_out_object(o, "rotation_error_deg");
        ctl_out_number(o, "number", (double)g->posed);
        ctl_out_number(o, "median", g->median_deg);
        ctl_out_number(o, "most", g->most_deg);
        ctl_out_number(o, "largest", g->worst_deg);
        ctl_out_number(o, "beyond_3", (double)g->beyond);
        ctl_out_close(o);
    }
    ctl_out_close(o);
}

static void refused(const struct report *r, struct ctl_out *o)
{
    const struct corpus *c = r->t->corpus;

    ctl_out_array(o, "refused");
    for (uint32_t i = 0; i < c->nscan; i++)
        if (r->t->refused[i] != NULL) {
            ctl_out_object(o, NULL);
            ctl_out_text(o, "file", c->scan[i].file);
            ctl_out_text(o, "subject", c->subject[c->scan[i].subject].id);
            ctl_out_flag(o, "enroll", c->scan[i].enrolled);
            ctl_out_text(o, "reason", r->t->refused[i]);
            ctl_out_close(o);
        }
    ctl_corpus_left(o, c);
    ctl_out_close(o);
    ctl_corpus_skipped(o, c);
}

void report_json_out(struct ctl_out *o, const struct report *r)
{
    const struct ctl_trials *t = r->t;

    ctl_out_text(o, "scans", r->source);
    ctl_out_text(o, "made", r->made);
    ctl_out_text(o, "engine", r->engine);
    ctl_out_text(o, "calibration", r->calibration);
    ctl_out_number(o, "threshold_mm", r->threshold_mm);
    ctl_out_number(o, "subjects", t->corpus->nsubject);
    ctl_out_number(o, "populations", t->corpus->npopulation);
    ctl_out_number(o, "failures_to_enrol", r->unenrolled);
    refused(r, o);
    ctl_out_object(o, "non_mated");
    count(o, &r->non_mated);
    rate(o, "fmr", r->match.value, r->match.low, r->match.high, r->match.n);
    ctl_out_number(o, "of_each_probe",
                   t->non_mated == UINT32_MAX ? (double)NAN : t->non_mated);
    ctl_out_number(o, "seed", (double)t->seed);
    ctl_out_close(o);
    ctl_out_object(o, "relative");
    count(o, &r->relative);
    ctl_out_close(o);
    ctl_out_array(o, "mated");
    for (uint32_t i = 0; i < r->ngroup; i++)
        group(r, &r->group[i], o);
    ctl_out_close(o);
    ctl_out_object(o, "bootstrap");
    ctl_out_number(o, "replicates", r->replicates);
    ctl_out_number(o, "seed", (double)r->seed);
    ctl_out_close(o);
    ctl_out_object(o, "speed");
    ctl_out_number(o, "threads", t->nthread);
    ctl_out_number(o, "enroll_s", t->build_s);
    ctl_out_number(o, "compare_s", t->compare_s);
    ctl_out_number(o, "comparisons_a_second", (double)(t->n - r->undone) / t->compare_s);
    ctl_out_number(o, "align_ms", r->align_ms);
    ctl_out_number(o, "measure_ms", r->measure_ms);
    ctl_out_close(o);
    if (r->plots[0] != '\0')
        ctl_out_text(o, "no_pictures", r->plots);
}

enum status report_json(FILE *to, const void *r, struct errinfo *e)
{
    struct ctl_out *o = ctl_out_new(true);

    if (o == NULL)
        return errinfo_set(e, ST_ENOMEM, "report.json: out of memory");
    report_json_out(o, r);
    return ctl_out_end(o, to) ? ST_OK
                              : errinfo_set(e, ST_EIO, "report.json: cannot be written");
}
