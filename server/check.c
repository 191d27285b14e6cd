#include "check.h"

#include "app.h"
#include "cloud.h"
#include "describe.h"
#include "logger.h"
#include "metrics.h"
#include "render.h"
#include "request.h"
#include "dry_run.h"
#include "worker.h"

static void respond(struct request *r, const struct worker *w, const struct dry_run *t,
                    const struct describe_times *times)
{
    metrics_check(r->app->metrics, t->enrolment == ST_OK      ? METRICS_ENROLLABLE
                                   : t->verification == ST_OK ? METRICS_USABLE
                                                              : METRICS_UNUSABLE);
    request_respond(r, 200, render_dry_run(t, &w->probe, times));
}

void check_handle(struct request *r, struct worker *w)
{
    const struct scan_options o = {.stop = &r->gone};
    struct describe_times times = {0};
    struct cloudpoints c;
    struct dry_run t = {0};
    const double start = logger_clock_ms();
    double parsed;
    enum status st = cloud_take(r, &c, &t.why);

    if (r->response.http != 0) /* a parameter */
        return;
    parsed = logger_clock_ms();
    request_stage(r, REQUEST_PARSE, times.parse = parsed - start);
    if (st == ST_OK) {
        st = dry_run_run("points", &c, &o, w->compare.work, &w->probe, &t);
        request_stage(r, REQUEST_PREPARE, times.prepare = logger_clock_ms() - parsed);
    } else if (dry_run_is_refusal(st)) {
        const struct errinfo e = t.why;

        dry_run_unread(st, &e, &t);
        st = ST_OK;
    }
    if (request_gone(r)) {
        cloudpoints_free(&c);
        return;
    }
    times.total = logger_clock_ms() - r->start_ms;
    if (st == ST_OK)
        respond(r, w, &t, &times);
    else
        request_fail(r, &t.why);
    cloudpoints_free(&c);
}
