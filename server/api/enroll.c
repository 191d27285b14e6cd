#include "enroll.h"

#include <stdio.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "burst.h"
#include "capture.h"
#include "cloud.h"
#include "compare.h"
#include "enrolment.h"
#include "errinfo.h"
#include "errmap.h"
#include "form.h"
#include "intake.h"
#include "json.h"
#include "describe.h"
#include "logger.h"
#include "metrics.h"
#include "params.h"
#include "request.h"
#include "sample.h"
#include "worker.h"

/* What the request asks for, beside the samples. */
struct asked {
    char label[STORE_LABEL_MAX + 1];
    bool force, fuse;       /* fuse: of several files one template */
    struct templates begun; /* of enrolment_begin() */
};

static void tally(struct request *r, const struct enrolment_result *each, size_t n,
                  bool none)
{
    struct metrics *m = r->app->metrics;

    for (size_t i = 0; i < n; i++) {
        const enum status why = each[i].why.code;

        if (why == ST_OK)
            metrics_enrollment(m, each[i].created ? METRICS_ENROLLED : METRICS_KNOWN);
        else if (why == ST_EMISMATCH)
            metrics_enrollment(m, METRICS_MISMATCH);
        else if (i > 0 ||
                 !none) /* else it is the response's problem, and counts as that */
            metrics_refused(m, why);
    }
}

static struct enrolment enrolment_of(const struct request *r, const struct asked *ask)
{
    return (struct enrolment){.actor = r->actor,
                              .subject = r->subject,
                              .label = ask->label,
                              .captured = r->capture.captured,
                              .manager = auth_has(r, STORE_SCOPE_MANAGE),
                              .force = ask->force,
                              .limits =
                                  r->app->limits.failures > 0 ? &r->app->limits : NULL};
}

/* Before the work on a scan.  False: r->response says why not. */
static bool enroll_begin(struct request *r, struct worker *w, struct asked *ask)
{
    const struct enrolment x = enrolment_of(r, ask);
    struct errinfo e = {0};

    if (!intake_admit(r))
        return false;
    if (enrolment_begin(&w->compare, &x, &ask->begun, &e) == ST_OK)
        return true;
    compare_refuse(r, &ask->begun.refusal, &e);
    return false;
}

/* Calls enrolment_add().  Returns true if at least one sample became a template.  On false
 * r->response says why not, unless out->none is set and there are several samples. */
static bool enroll(struct request *r, struct worker *w, struct asked *ask,
                   const struct store_sample *sample, size_t n,
                   struct enrolment_result *each, struct enrolment_outcome *out)
{
    struct enrolment x = enrolment_of(r, ask);
    struct errinfo e = {0};
    enum status st;

    x.sample = sample;
    x.n = n;
    st = enrolment_add(&w->compare, &x, &ask->begun, each, out, &e);
    compare_warn(r, out->warnings);
    if (out->nearest.compared > 0)
        request_stage(r, REQUEST_SCORE, out->nearest.score_ms);
    if (st == ST_OK || out->none)
        tally(r, each, n, out->none);
    if (st != ST_OK)
        compare_refuse(r, &out->refusal, &e);
    return st == ST_OK;
}

/* False: r->response says what is wrong with them, or that the request may not be made. */
static bool read_parameters(struct request *r, struct asked *ask)
{
    const enum status st = request_query(r, "label", ask->label, sizeof ask->label);

    ask->force = false;
    ask->fuse = true;
    if (st != ST_OK && st != ST_ENOTFOUND) {
        request_problem(r, ERRMAP_PARAMETER, "label is malformed or longer than %d bytes",
                        STORE_LABEL_MAX);
        return false;
    }
    return params_flag(r, "force", &ask->force) && params_flag(r, "fuse", &ask->fuse) &&
           (!ask->force || auth_may(r, STORE_SCOPE_MANAGE)) && capture_admit(r);
}

/* ---- one template */

/* Of one face, from one file or from the frames of a form; NULL: from one file. */
static void enroll_face(struct request *r, struct worker *w, struct asked *ask,
                        const struct sample_found *found, const struct session *frames)
{
    struct enrolment_result x = {.created = false};
    struct enrolment_outcome out;
    struct json *j;

    const char *read = frames != NULL ? frames->read : found->digest;

    if (!enroll(r, w, ask, &(struct store_sample){.face = w->probe, .read = read}, 1, &x,
                &out))
        return;
    r->result.outcome = x.created ? "enrolled" : "known";
    j = json_new();
    describe_template(j, &x.tmpl, w->probe, auth_scores(r));
    describe_scan(j, "scan", found);
    if (frames != NULL) {
        session_describe(j, frames);
        request_respond(r, x.created ? 201 : 200, json_compact(j));
    } else {
        request_written(r, x.created ? 201 : 200, json_compact(j));
    }
    if (r->response.http < 300)
        request_template(r, x.tmpl.id);
}

static void enroll_one(struct request *r, struct worker *w, struct asked *ask)
{
    struct sample_found found;
    struct cloudpoints c;
    double start = logger_clock_ms(), parsed;
    enum status st;

    if (cloud_read(r, &c) != ST_OK)
        return;
    parsed = logger_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    st = cloud_build(r, &c, "points", true, w->compare.work, &w->probe, &found);
    request_stage(r, REQUEST_PREPARE, logger_clock_ms() - parsed);
    cloudpoints_free(&c);
    if (st == ST_OK)
        enroll_face(r, w, ask, &found, NULL);
}

static void enroll_fused(struct request *r, struct worker *w, struct asked *ask)
{
    const struct sample_options o = {.enrolment = true, .stop = &r->gone};
    struct form *f = form_read(r, MULTIPART_FILES_MAX);
    const double start = logger_clock_ms();
    struct sample_found found;
    struct errinfo e = {0};
    enum status st;

    if (f == NULL)
        return;
    request_stage(r, REQUEST_PARSE, f->parse_ms);
    st = session_build(&f->session, &o, w->compare.work, &w->probe, &found, &e);
    request_stage(r, REQUEST_PREPARE, logger_clock_ms() - start);
    if (st == ST_OK)
        enroll_face(r, w, ask, &found, &f->session);
    else if (!request_gone(r))
        form_refuse(r, f, &e);
    form_free(f);
}

/* ---- a template of each file */

static void enroll_each(struct request *r, struct worker *w, struct asked *ask)
{
    struct burst *b = burst_read(r, w->compare.work);
    struct enrolment_outcome out;

    if (b == NULL)
        return;
    r->result.outcome = "enrolled";
    if (enroll(r, w, ask, b->sample, b->n, b->each, &out))
        burst_respond(r, b);
    else if (out.none)
        burst_refuse(r, b);
    burst_free(b);
}

static void enroll_scans(struct request *r, struct worker *w, struct asked *ask)
{
    if (r->media != REQUEST_FORM)
        enroll_one(r, w, ask);
    else if (ask->fuse)
        enroll_fused(r, w, ask);
    else
        enroll_each(r, w, ask);
}

void enroll_handle(struct request *r, struct worker *w)
{
    struct asked ask = {.begun = {.context = &w->compare}};

    r->result.kind = "enroll";
    if (read_parameters(r, &ask) && enroll_begin(r, w, &ask))
        enroll_scans(r, w, &ask);
    templates_free(&ask.begun);
}
