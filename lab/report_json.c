/* The report of an evaluation as JSON. */
#include "lab.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "model.h"
#include "model_digest.h"
#include "report.h"

/* What the rate is below, where it cannot be stated. */
static void rate_of(struct json *o, const char *key, double value, double low,
                    double high, size_t n)
{
    const bool supported = rates_supported(value, n);

    json_object(o, key);
    json_rate(o, "value", supported ? value : (double)NAN);
    json_rate(o, "observed", value);
    json_flag(o, "supported", supported);
    if (!supported && n > 0)
        json_rate(o, "below", fmin(1, report_bound(value, n)));
    json_rate(o, "low", low);
    json_rate(o, "high", supported ? high : fmax(high, fmin(1, report_bound(value, n))));
    json_number(o, "of", (double)n);
    json_close(o);
}

static void report_json_rate(struct json *o, const char *key, const struct report_rate *x)
{
    rate_of(o, key, x->value, x->low, x->high, x->n);
}

static void report_json_count(struct json *o, const struct report_count *c)
{
    json_number(o, "planned", (double)c->planned);
    json_number(o, "comparisons", (double)c->n);
    json_number(o, "match", (double)c->match);
    json_number(o, "no_match", (double)c->no_match);
    json_number(o, "inconclusive", (double)c->inconclusive);
}

static void targets(const struct report_curve *g, size_t non_mated, struct json *o)
{
    json_array(o, "tar");
    for (int k = 0; k < RATES_TARGETS; k++) {
        const bool known = rates_supported(rates_target[k], non_mated);
        const bool supported = known && rates_supported(1 - g->f.tar[k], g->n);
        const double above = 1 - fmin(1, report_bound(1 - g->f.tar[k], g->n));

        json_object(o, NULL);
        json_rate(o, "fmr", rates_target[k]);
        json_flag(o, "supported", supported);
        if (!known)
            json_number(o, "non_mated_needed", (double)rates_needed(rates_target[k]));
        if (known && !supported && g->n > 0)
            json_rate(o, "above", above);
        json_rate(o, "value", supported ? g->f.tar[k] : (double)NAN);
        json_rate(o, "observed", g->f.tar[k]);
        if (known) {
            json_rate(o, "low", supported ? g->low.tar[k] : fmin(g->low.tar[k], above));
            json_rate(o, "high", g->high.tar[k]);
            json_score(o, "threshold", g->f.tar_score[k]);
        }
        json_close(o);
    }
    json_close(o);
}

/* As members of the open object. */
static void curve(const struct report_curve *g, size_t non_mated, struct json *o)
{
    json_number(o, "mated", (double)g->n);
    rate_of(o, "eer", g->f.eer, g->low.eer, g->high.eer,
            g->n < non_mated ? g->n : non_mated);
    targets(g, non_mated, o);
}

static void group(const struct report *r, const struct report_group *g, struct json *o)
{
    json_object(o, NULL);
    json_text(o, "probes", g->name);
    json_number(o, "number", (double)g->fta.n);
    json_number(o, "failures_to_acquire", round(g->fta.value * (double)g->fta.n));
    report_json_rate(o, "fta", &g->fta);
    report_json_count(o, &g->mated);
    json_object(o, "scored");
    curve(&g->curve[REPORT_SCORED], r->non_mated.n, o);
    json_close(o);
    json_object(o, "with_refusals");
    curve(&g->curve[REPORT_ALL], r->non_mated.n, o);
    json_close(o);
    report_json_rate(o, "fnmr", &g->fnmr);
    report_json_rate(o, "fnmr_with_inconclusive", &g->unmatched);
    report_json_rate(o, "frr", &g->frr);
    json_number(o, "ranked", g->ranked);
    json_number(o, "own_template_nearest", g->first);
    json_close(o);
}

static void refused_as(const struct report *r, const struct trials_scan *scan,
                       const char *as, struct json *o)
{
    const struct corpus *c = r->t->corpus;

    for (uint32_t i = 0; i < c->nscan; i++)
        if (scan[i].st != ST_OK) {
            json_object(o, NULL);
            json_text(o, "file", c->scan[i].file);
            json_text(o, "subject", c->subject[c->scan[i].subject].id);
            json_text(o, "kind", c->kind[c->scan[i].kind]);
            json_text(o, "as", as);
            json_text(o, "code", status_refusal(scan[i].st));
            json_text(o, "reason", scan[i].why);
            json_close(o);
        }
}

static void made_by(const struct report *r, struct json *o)
{
    char digest[17];

    (void)snprintf(digest, sizeof digest, "%016" PRIx64, model_digest(r->model));
    json_text(o, "made", r->made);
    json_text(o, "engine", r->engine);
    json_object(o, "model");
    json_text(o, "name", r->model->name);
    json_text(o, "digest", digest);
    json_close(o);
    /* A model does not record whose scans it was learned from. */
    json_text(o, "learned_from_these_people", "unknown");
    json_text(o, "calibration", r->calibration);
    json_score(o, "threshold", r->t->threshold);
}

void report_json_out(struct json *o, const struct report *r)
{
    const struct trials *t = r->t;
    const size_t done = r->group[0].mated.n + r->non_mated.n + r->relative.n;

    json_text(o, "scans", r->source);
    made_by(r, o);
    json_number(o, "subjects", t->corpus->nsubject);
    json_number(o, "populations", t->corpus->npopulation);
    json_text(o, "enroll_kind", r->enroll_kind);
    json_number(o, "subjects_without_that_kind", r->untemplated);
    json_number(o, "templates", (double)r->fte.n);
    json_number(o, "failures_to_enroll", round(r->fte.value * (double)r->fte.n));
    report_json_rate(o, "fte", &r->fte);
    json_array(o, "refused");
    refused_as(r, t->template, "template", o);
    refused_as(r, t->probe, "probe", o);
    corpus_left_json(t->corpus, o);
    json_object(o, "non_mated");
    report_json_count(o, &r->non_mated);
    report_json_rate(o, "fmr", &r->fmr);
    report_json_rate(o, "far", &r->far);
    json_number(o, "of_each_probe",
                t->non_mated == TRIALS_ALL ? (double)NAN : t->non_mated);
    json_number(o, "seed", (double)TRIALS_SEED);
    json_close(o);
    json_object(o, "search");
    json_number(o, "people", r->search.people);
    json_score(o, "threshold", r->search.threshold);
    report_json_rate(o, "fpir", &r->search.fpir);
    report_json_rate(o, "fnir", &r->search.fnir);
    json_close(o);
    json_object(o, "relative");
    report_json_count(o, &r->relative);
    json_close(o);
    json_array(o, "mated");
    for (uint32_t i = 0; i < r->ngroup; i++)
        group(r, &r->group[i], o);
    json_close(o);
    json_array(o, "methods");
    for (size_t i = 0; i < r->nmethod; i++) {
        const struct report_method *m = &r->method[i];

        json_object(o, NULL);
        json_text(o, "method", m->name);
        json_number(o, "mated_with_a_score", (double)m->mated);
        json_number(o, "non_mated", (double)m->non_mated);
        curve(&m->curve, m->non_mated, o);
        json_close(o);
    }
    json_close(o);
    json_object(o, "bootstrap");
    json_number(o, "replicates", RATES_REPLICATES);
    json_number(o, "seed", (double)REPORT_SEED);
    json_close(o);
    json_object(o, "speed");
    json_number(o, "threads", t->nthread);
    json_number(o, "enroll_s", t->build_s);
    json_number(o, "compare_s", t->compare_s);
    json_number(o, "comparisons_a_second", (double)done / t->compare_s);
    json_number(o, "score_ms", r->score_ms);
    json_close(o);
}

enum status report_json(FILE *to, const void *r, struct errinfo *e)
{
    struct json *j = json_new();
    char *text;
    bool ok;

    report_json_out(j, r);
    text = json_pretty(j);
    ok = text != NULL && fprintf(to, "%s\n", text) >= 0;

    free(text);
    return ok ? ST_OK : errinfo_set(e, ST_ENOMEM, "report.json: out of memory");
}
