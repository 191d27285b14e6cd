#include "enroll.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "cloud.h"
#include "errinfo.h"
#include "errmap.h"
#include "idempotency.h"
#include "render.h"
#include "log.h"
#include "metrics.h"
#include "params.h"
#include "queue.h"
#include "request.h"
#include "verify.h"

#define LOCATION "/v1/templates/" /* and the template's id */

/* Does the sample match the best of those that the subject has?  From then on it decides
 * like any of them, so one that cannot be compared (too little in common) does not do.
 * newest: the id of the last one it was compared with, "" where there is none. */
static enum status check_fit(struct request *r, struct worker *w,
                             char newest[STORE_ID_LEN + 1], struct errinfo *e)
{
    struct store_template *t = NULL;
    struct verify_best best = {0};
    size_t n = 0;
    enum status st = store_template_list(r->app->store, r->subject, &t, &n, e);

    newest[0] = '\0';
    if (st == ST_OK && n > 0) {
        memcpy(newest, t[n - 1].id, STORE_ID_LEN + 1);
        st = verify_compare(w, t, n, &w->probe, &best, e);
        request_stage(r, REQUEST_ALIGN, best.align_ms);
        request_stage(r, REQUEST_MEASURE, best.measure_ms);
    }
    free(t);
    if (st == ST_ENOTFOUND || (st == ST_OK && n == 0))
        return ST_OK; /* the first sample */
    if (st == ST_OK && best.result.decision != FACE_MATCH) {
        metrics_enrollment(r->app->metrics, METRICS_MISMATCH);
        request_mismatch(r, &best.result);
        return ST_EMISMATCH;
    }
    if (st != ST_OK)
        request_fail(r, e);
    return st;
}

static void enroll(struct request *r, struct worker *w, const char *label, bool force)
{
    struct store_template t;
    struct errinfo e = {0};
    char newest[STORE_ID_LEN + 1];
    bool created = false;
    enum status st;

    do { /* again only when another enrolment came in between */
        if (!force && check_fit(r, w, newest, &e) != ST_OK)
            return;
        st = store_enroll_after(r->app->store, r->actor, r->subject, label, &w->probe,
                                force ? NULL : newest, &t, &created, &e);
    } while (st == ST_EEXISTS);
    if (st != ST_OK) {
        request_fail(r, &e);
        return;
    }
    metrics_enrollment(r->app->metrics, created ? METRICS_ENROLLED : METRICS_KNOWN);
    request_written(r, created ? 201 : 200, render_template(&t, &w->probe.frame));
    if (r->answer.http < 300)
        (void)snprintf(r->answer.location, sizeof r->answer.location, LOCATION "%s",
                       t.id);
}

static void read_and_enroll(struct request *r, struct worker *w)
{
    char label[STORE_LABEL_MAX + 1];
    struct cloud c;
    bool force = false;
    double start = log_clock_ms(), parsed;
    enum status st = request_query(r, "label", label, sizeof label);

    if (st != ST_OK && st != ST_ENOTFOUND) {
        request_problem(r, ERRMAP_PARAMETER, "label is malformed or longer than %d bytes",
                        STORE_LABEL_MAX);
        return;
    }
    if (!params_flag(r, "force", &force) || cloud_read(r, &c) != ST_OK)
        return;
    parsed = log_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    st = cloud_build(r, &c, "points", w->work, &w->probe);
    request_stage(r, REQUEST_PREPARE, log_clock_ms() - parsed);
    cloud_free(&c);
    if (st == ST_OK)
        enroll(r, w, label, force);
}

/* What an answer tells that is given again must still be true: a template that has been
 * deleted since is not told of any more, and not enrolled by a late retry either. */
static void check_replayed(struct request *r)
{
    struct store_template t;
    struct errinfo e = {0};
    enum status st;

    if (r->answer.http >= 300)
        return;
    st = store_template_get(r->app->store, r->answer.location + strlen(LOCATION), &t, &e);
    if (st == ST_OK)
        return;
    r->answer.replayed = r->answer.minimal = false;
    if (st == ST_ENOTFOUND)
        request_problem(r, st,
                        "what this Idempotency-Key enrolled has been deleted since");
    else
        request_fail(r, &e);
}

void enroll_handle(struct request *r, struct worker *w)
{
    struct idempotency *m = r->app->idempotency;
    uint32_t ticket;

    if (idempotency_begin(m, r, log_clock_ms(), &ticket)) {
        read_and_enroll(r, w);
        idempotency_end(m, r, ticket);
    } else if (r->answer.replayed) {
        check_replayed(r);
    }
}
