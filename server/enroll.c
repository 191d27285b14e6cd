#include "enroll.h"

#include <stdio.h>
#include <string.h>

#include "app.h"
#include "attempts.h"
#include "auth.h"
#include "capture.h"
#include "cloud.h"
#include "enrolment.h"
#include "errinfo.h"
#include "errmap.h"
#include "event.h"
#include "render.h"
#include "log.h"
#include "metrics.h"
#include "params.h"
#include "request.h"
#include "scan.h"
#include "verify.h"
#include "worker.h"

static bool may(void *arg, const struct store_attempts *now)
{
    struct request *r = arg;

    return attempts_admit(r->app->attempts, r, now);
}

static void enroll(struct request *r, struct worker *w, const char *label, bool force,
                   const struct scan_found *found)
{
    struct store_settle limits = {.actor = r->actor};
    struct enrolment x = {.actor = r->actor,
                          .subject = r->subject,
                          .label = label,
                          .face = &w->probe,
                          .read = found->digest,
                          .captured = r->capture.captured,
                          .force = force,
                          .may = attempts_limited(r->app->attempts) ? may : NULL,
                          .arg = r};
    struct enrolment_outcome out;
    struct errinfo e = {0};
    enum status st;

    attempts_watch(r->app->attempts, &limits);
    x.warn_failures = limits.warn_failures;
    x.warn_tried = limits.warn_tried;
    st = enrolment_add(&w->compare, &x, &out, &e);
    attempts_warn(r, &(struct store_settled){.locked_out = out.locked_out,
                                             .many_subjects = out.many_subjects});

    if (out.nearest.compared > 0) {
        request_stage(r, REQUEST_ALIGN, out.nearest.align_ms);
        request_stage(r, REQUEST_MEASURE, out.nearest.measure_ms);
    }
    if (out.lost.code != ST_OK)
        event_lost(r, "enroll_mismatch", &out.lost);
    if (out.locked || !verify_admitted(r, out.admit, &e)) /* r->response is set */
        return;
    if (st != ST_OK) {
        if (st == ST_EMISMATCH)
            metrics_enrollment(r->app->metrics, METRICS_MISMATCH);
        request_fail(r, &e);
        return;
    }
    metrics_enrollment(r->app->metrics, out.created ? METRICS_ENROLLED : METRICS_KNOWN);
    request_written(r, out.created ? 201 : 200,
                    render_enrolled(&out.tmpl, &w->probe.frame, found));
    if (r->response.http >= 300)
        return;
    memcpy(r->response.template_id, out.tmpl.id, sizeof out.tmpl.id);
    (void)snprintf(r->response.location, sizeof r->response.location, "/v1/templates/%s",
                   out.tmpl.id);
}

static void read_and_enroll(struct request *r, struct worker *w)
{
    char label[STORE_LABEL_MAX + 1];
    struct scan_found found;
    struct cloudpoints c;
    bool force = false;
    double start = log_clock_ms(), parsed;
    enum status st = request_query(r, "label", label, sizeof label);

    if (st != ST_OK && st != ST_ENOTFOUND) {
        request_problem(r, ERRMAP_PARAMETER, "label is malformed or longer than %d bytes",
                        STORE_LABEL_MAX);
        return;
    }
    if (!params_flag(r, "force", &force) || (force && !auth_may(r, STORE_SCOPE_MANAGE)) ||
        !capture_admit(r) || cloud_read(r, &c) != ST_OK)
        return;
    parsed = log_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    st = cloud_build(r, &c, "points", true, w->compare.work, &w->probe, &found);
    request_stage(r, REQUEST_PREPARE, log_clock_ms() - parsed);
    cloudpoints_free(&c);
    if (st == ST_OK)
        enroll(r, w, label, force, &found);
}

void enroll_handle(struct request *r, struct worker *w)
{
    verify_once(r, w, read_and_enroll);
}
