#include "report_json.h"

#include <math.h>

#include "ctl_corpus.h"
#include "ctl.h"
#include "report.h"

/* What the rate is below, where it cannot be stated. */
static void rate(struct json *o, const char *key, double value, double low, double high,
                 size_t n)
{
    const bool supported = rates_supported(value, n);

    json_object(o, key);
    json_rate(o, "value", supported ? value : (double)NAN);
    json_flag(o, "supported", supported);
    if (!supported && n > 0)
        json_rate(o, "below", fmin(1, report_bound(value, n)));
    json_rate(o, "low", low);
    json_rate(o, "high", supported ? high : fmax(high, fmin(1, report_bound(value, n))));
    json_number(o, "comparisons", (double)n);
    json_close(o);
}

static void count(struct json *o, const struct report_count *c)
{
    json_number(o, "comparisons", (double)c->n);
    json_number(o, "match", (double)c->match);
    json_number(o, "no_match", (double)c->no_match);
    json_number(o, "inconclusive", (double)c->inconclusive);
}

static void targets(const struct report *r, const struct report_group *g, struct json *o)
{
    json_array(o, "tar");
    for (int k = 0; k < RATES_TARGETS; k++) {
        const bool known = rates_supported(rates_target[k], r->non_mated.n);
        const bool supported = known && rates_supported(1 - g->f.tar[k], g->mated.n);
        const double above = 1 - fmin(1, report_bound(1 - g->f.tar[k], g->mated.n));

        json_object(o, NULL);
        json_rate(o, "fmr", rates_target[k]);
        json_flag(o, "supported", supported);
        if (!known)
            json_number(o, "non_mated_needed", (double)rates_needed(rates_target[k]));
        if (known && !supported && g->mated.n > 0)
            json_rate(o, "above", above);
        json_rate(o, "value", supported ? g->f.tar[k] : (double)NAN);
        if (known) {
            json_rate(o, "low", supported ? g->low.tar[k] : fmin(g->low.tar[k], above));
            json_rate(o, "high", g->high.tar[k]);
            json_number(o, "threshold_mm", g->f.tar_mm[k]);
        }
        json_close(o);
    }
    json_close(o);
}

static void group(const struct report *r, const struct report_group *g, struct json *o)
{
    const size_t fewer = g->mated.n < r->non_mated.n ? g->mated.n : r->non_mated.n;

    json_object(o, NULL);
    json_text(o, "probes", g->name);
    json_number(o, "number", g->probe);
    json_number(o, "failures_to_acquire", g->refused);
    count(o, &g->mated);
    rate(o, "eer", g->f.eer, g->low.eer, g->high.eer, fewer);
    targets(r, g, o);
    rate(o, "fnmr", g->no_match.value, g->no_match.low, g->no_match.high, g->no_match.n);
    rate(o, "fnmr_with_inconclusive", g->unmatched.value, g->unmatched.low,
         g->unmatched.high, g->unmatched.n);
    json_number(o, "ranked", g->ranked);
    json_number(o, "own_template_nearest", g->first);
    if (g->posed > 0) {
        json_object(o, "rotation_error_deg");
        json_number(o, "number", (double)g->posed);
        json_number(o, "median", g->median_deg);
        json_number(o, "most", g->most_deg);
        json_number(o, "largest", g->worst_deg);
        json_number(o, "beyond_3", (double)g->beyond);
        json_close(o);
    }
    json_close(o);
}

static void refused(const struct report *r, struct json *o)
{
    const struct corpus *c = r->t->corpus;

    json_array(o, "refused");
    for (uint32_t i = 0; i < c->nscan; i++)
        if (r->t->refused[i] != NULL) {
            json_object(o, NULL);
            json_text(o, "file", c->scan[i].file);
            json_text(o, "subject", c->subject[c->scan[i].subject].id);
            json_flag(o, "enroll", c->scan[i].enrolled);
            json_text(o, "reason", r->t->refused[i]);
            json_close(o);
        }
    ctl_corpus_left(o, c);
}

void report_json_out(struct json *o, const struct report *r)
{
    const struct ctl_trials *t = r->t;

    json_text(o, "scans", r->source);
    json_text(o, "made", r->made);
    json_text(o, "engine", r->engine);
    json_text(o, "calibration", r->calibration);
    json_number(o, "threshold_mm", r->threshold_mm);
    json_number(o, "subjects", t->corpus->nsubject);
    json_number(o, "populations", t->corpus->npopulation);
    json_number(o, "failures_to_enrol", r->unenrolled);
    refused(r, o);
    json_object(o, "non_mated");
    count(o, &r->non_mated);
    rate(o, "fmr", r->match.value, r->match.low, r->match.high, r->match.n);
    json_number(o, "of_each_probe",
                t->non_mated == UINT32_MAX ? (double)NAN : t->non_mated);
    json_number(o, "seed", (double)t->seed);
    json_close(o);
    json_object(o, "relative");
    count(o, &r->relative);
    json_close(o);
    json_array(o, "mated");
    for (uint32_t i = 0; i < r->ngroup; i++)
        group(r, &r->group[i], o);
    json_close(o);
    json_object(o, "bootstrap");
    json_number(o, "replicates", r->replicates);
    json_number(o, "seed", (double)r->seed);
    json_close(o);
    json_object(o, "speed");
    json_number(o, "threads", t->nthread);
    json_number(o, "enroll_s", t->build_s);
    json_number(o, "compare_s", t->compare_s);
    json_number(o, "comparisons_a_second", (double)(t->n - r->undone) / t->compare_s);
    json_number(o, "align_ms", r->align_ms);
    json_number(o, "measure_ms", r->measure_ms);
    json_close(o);
    if (r->plots[0] != '\0')
        json_text(o, "no_pictures", r->plots);
}

enum status report_json(FILE *to, const void *r, struct errinfo *e)
{
    struct json *j = json_new();

    report_json_out(j, r);
    return ctl_print(to, json_pretty(j))
               ? ST_OK
               : errinfo_set(e, ST_ENOMEM, "report.json: out of memory");
}
