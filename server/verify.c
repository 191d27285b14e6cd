#include "verify.h"

#include <math.h>
#include <string.h>

#include "app.h"
#include "attempts.h"
#include "auth.h"
#include "builder.h"
#include "capture.h"
#include "cloud.h"
#include "describe.h"
#include "errinfo.h"
#include "errmap.h"
#include "event.h"
#include "heatmap.h"
#include "logger.h"
#include "mem.h"
#include "minimal.h"
#include "metrics.h"
#include "nearest.h"
#include "params.h"
#include "render.h"
#include "replay.h"
#include "request.h"
#include "route.h"
#include "scan.h"
#include "store.h"
#include "verdict.h"
#include "worker.h"

/* One verification. */
struct verification {
    struct request *r;
    struct worker *w;
    enum params_detail detail;
    struct admission admission;
    struct nearest best;
    struct minimal least; /* not for PARAMS_DECISION */
    /* the heatmap of the probe's points, by mem_free(); NULL: not asked for */
    double *gap;
    struct face_field field; /* with it */
    /* The probe; the builder's until builder_wait(). */
    bool begun; /* with the builder */
    struct cloudpoints cloud;
    struct scan_found found;
    double parse_ms, prepare_ms;
    enum status built;
};

bool verify_admitted(struct request *r, enum admit admit, const struct errinfo *e)
{
    if (admit != ADMIT_YES)
        request_problem(r, admit == ADMIT_DISABLED ? ERRMAP_DISABLED : ERRMAP_EXPIRED,
                        "%s", e->msg);
    return admit == ADMIT_YES;
}

void verify_round(const struct request *r, const struct worker *w,
                  struct face_result *result, struct minimal *least)
{
    if (auth_exact(r))
        return;
    face_round(result, w->compare.work);
    least->disparity.plain_mm = round(least->disparity.plain_mm * 1e3) / 1e3;
}

void verify_respond(struct request *r, const struct describe_comparison *c)
{
    request_respond(r, 200, render_comparison(c));
    r->response.minimal = c->minimal == NULL && r->response.http == 200;
}

/* ---- before the comparison */

/* Refused here, the body is not even parsed. */
static enum status admitted(void *arg, const struct store_admission *a, struct errinfo *e)
{
    struct verification *v = arg;

    if (a->n == 0)
        return errinfo_set(e, ST_ENOTFOUND, "the subject has no template");
    if (!attempts_admit(v->r->app->attempts, v->r, &a->attempts))
        return errinfo_set(e, ST_EDENIED, "the subject is locked out");
    return ST_OK;
}

static void build(void *arg, struct face_work *work)
{
    struct verification *v = arg;
    const double start = logger_clock_ms();
    double parsed;

    if ((v->built = cloud_read(v->r, &v->cloud)) != ST_OK)
        return;
    parsed = logger_clock_ms();
    v->built =
        cloud_build(v->r, &v->cloud, "points", false, work, &v->w->probe, &v->found);
    v->parse_ms = parsed - start;
    v->prepare_ms = logger_clock_ms() - parsed;
}

static void reading(void *arg)
{
    struct verification *v = arg;

    v->begun = true;
    builder_begin(v->w->builder, build, v);
}

/* False: r->response says why. */
static bool admit(struct verification *v, const char *subject, const char *template_id)
{
    const struct admission_request ask = {.subject = subject,
                                          .template_id = template_id,
                                          .token = v->r->actor,
                                          .admitted = admitted,
                                          .reading = reading,
                                          .arg = v};
    struct errinfo e = {0};
    const enum status st = admission_read(&v->w->compare, &ask, &v->admission, &e);

    if (v->begun)
        builder_wait(v->w->builder);
    else if (st == ST_OK)
        build(v, v->w->compare.work);
    if (v->cloud.at != NULL) { /* parsed */
        request_stage(v->r, REQUEST_PARSE, v->parse_ms);
        request_stage(v->r, REQUEST_PREPARE, v->prepare_ms);
    }
    if (st == ST_OK)
        return v->built == ST_OK;
    if (verify_admitted(v->r, v->admission.admit, &e) &&
        (v->begun || v->r->response.http == 0)) /* else admitted() has set it */
        request_fail(v->r, &e);
    return false;
}

/* ---- the comparison */

static enum status minimal(struct verification *v, struct errinfo *e)
{
    enum status st;

    if (v->detail == PARAMS_DECISION)
        return ST_OK;
    st = nearest_minimal(&v->w->compare, &v->admission, &v->w->probe, &v->best,
                         v->detail != PARAMS_BRIEF, &v->least, e);
    request_stage(v->r, REQUEST_ALIGN, v->best.result.align_ms);
    request_stage(v->r, REQUEST_MINIMAL, v->least.ms);
    return st;
}

static enum status heatmap(struct verification *v, struct errinfo *e)
{
    struct admission_context *c = &v->w->compare;
    const size_t i = v->best.index;
    const struct face *face;
    enum status st;

    if (v->detail != PARAMS_HEATMAP)
        return ST_OK;
    if ((st = admission_hold(c, &v->admission, i, &face, e)) != ST_OK)
        return st;
    v->gap = mem_array(v->cloud.read, sizeof *v->gap);
    st = v->gap == NULL ? ST_ENOMEM
                        : heatmap_gaps(&face->surface, v->cloud.at, v->cloud.n,
                                       v->best.result.align.transform, v->gap);
    if (st == ST_OK)
        st = face_field(face, &v->w->probe, c->work, &v->field);
    admission_release(c, &v->admission, i, face);
    if (st == ST_OK)
        cloud_spread(&v->cloud, v->gap);
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "no memory for the heatmap");
}

static bool compare(struct verification *v)
{
    struct errinfo e = {0};
    enum status st =
        nearest_find(&v->w->compare, &v->admission, &v->w->probe, &v->best, &e);

    if (st == ST_OK && request_gone(v->r))
        return false;
    if (st == ST_OK)
        st = minimal(v, &e);
    if (st == ST_OK)
        st = heatmap(v, &e);
    if (st != ST_OK) {
        request_fail(v->r, &e);
        return false;
    }
    request_stage(v->r, REQUEST_SCORE, v->best.score_ms);
    return true;
}

/* ---- after the comparison */

/* Others that ran at the same time may have locked the subject out: running many at once must
 * not be a way round the limit. */
static bool may(void *arg, const struct store_attempts *now)
{
    struct verification *v = arg;

    return attempts_admit(v->r->app->attempts, v->r, now);
}

/* What is not counted and recorded is not told: there would be no limit. */
static bool settle(struct verification *v)
{
    const enum face_decision decision = v->best.result.decision;
    const struct app *app = v->r->app;
    char outcome[CAPTURE_OUTCOME];
    struct errinfo e = {0};
    struct store_probe probe;
    struct store_settled out = {.may = false};
    struct store_settle what = {
        .subject = &v->admission.of.subject,
        .as = !attempts_limited(app->attempts) ? STORE_SETTLE_UNCOUNTED
              : decision == FACE_MATCH         ? STORE_SETTLE_PASSED
                                               : STORE_SETTLE_FAILED,
        .actor = v->r->actor,
        .kind = "verify",
        .template_id = v->admission.of.t[v->best.index].id,
        .outcome = capture_outcome(v->r, verdict_decision(decision), outcome),
        .may = may,
        .arg = v};

    attempts_watch(app->attempts, &what);
    if (decision == FACE_MATCH) {
        what.probe = &probe;
        if (replay_probe(&v->admission.of.t[v->best.index], &v->found, &v->w->probe,
                         &probe, &e) != ST_OK) {
            request_fail(v->r, &e);
            return false;
        }
    }
    if (store_settle(app->store, &what, &out, &e) != ST_OK) {
        request_fail(v->r, &e);
        return false;
    }
    if (!out.may)
        return false;
    attempts_warn(v->r, &out);
    if (out.replayed) {
        (void)replay_refuse(&e);
        request_fail(v->r, &e);
        return false;
    }
    metrics_decision(app->metrics, decision);
    return true;
}

static void respond(struct verification *v)
{
    struct errinfo e = {0};
    const struct describe_times times = {.parse = v->parse_ms,
                                         .prepare = v->prepare_ms,
                                         .align = v->best.result.align_ms,
                                         .score = v->best.score_ms,
                                         .minimal = v->least.ms,
                                         .total = logger_clock_ms() - v->r->start_ms};

    if (nearest_judge(&v->best, &e) != ST_OK) {
        request_fail(v->r, &e);
        return;
    }
    verify_round(v->r, v->w, &v->best.result, &v->least);
    verify_respond(v->r, &(struct describe_comparison){
                             .result = &v->best.result,
                             .minimal = v->detail == PARAMS_DECISION ? NULL : &v->least,
                             .probe = &v->w->probe,
                             .scan = &v->found,
                             .engine = store_made_by(v->r->app->store),
                             .subject = v->admission.of.subject.id,
                             .template_id = v->admission.of.t[v->best.index].id,
                             .templates_compared = v->best.compared,
                             .times = &times,
                             .measure = v->detail != PARAMS_BRIEF,
                             .gap_mm = v->gap,
                             .field = v->gap != NULL ? &v->field : NULL,
                             .n = v->cloud.read,
                         });
}

/* One of subject and template_id is NULL. */
static void verify(struct request *r, struct worker *w, const char *subject,
                   const char *template_id)
{
    struct verification v = {.r = r, .w = w};

    if (!params_detail(r, &v.detail) || !capture_admit(r))
        return;
    if (admit(&v, subject, template_id) && compare(&v) && !request_gone(r) && settle(&v))
        respond(&v);
    admission_free(&w->compare, &v.admission);
    mem_free(v.gap);
    cloudpoints_free(&v.cloud);
}

void verify_subject(struct request *r, struct worker *w)
{
    verify(r, w, r->subject, NULL);
}

void verify_template(struct request *r, struct worker *w)
{
    verify(r, w, NULL, r->template_id);
}
