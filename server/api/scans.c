#include "scans.h"

#include "app.h"
#include "cloud.h"
#include "describe.h"
#include "dry_run.h"
#include "json.h"
#include "logger.h"
#include "metrics.h"
#include "request.h"
#include "sample.h"
#include "store.h"
#include "worker.h"

static void respond(struct request *r, const struct worker *w, const struct dry_run *t,
                    const struct describe_times *times)
{
    struct json *j = json_new();

    metrics_check(r->app->metrics, t->enrolment == ST_OK      ? METRICS_ENROLLABLE
                                   : t->verification == ST_OK ? METRICS_USABLE
                                                              : METRICS_UNUSABLE);
    describe_dry_run(j, t, w->probe, times);
    request_respond(r, 200, json_compact(j));
}

void scans_check(struct request *r, struct worker *w)
{
    const struct sample_options o = {.stop = &r->gone};
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

void scans_asymmetry(struct request *r, struct worker *w)
{
    const double start = logger_clock_ms();
    double parsed, prepared, measured;
    struct surface_asymmetry result = {.size = sizeof result};
    struct json *j;
    struct cloudpoints c = {0};
    struct sample_found found;
    enum surface_status st;

    if (cloud_read(r, &c) != ST_OK)
        return;
    parsed = logger_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    if (cloud_build(r, &c, "points", false, w->compare.work, &w->probe, &found) != ST_OK)
        goto out;
    prepared = logger_clock_ms();
    request_stage(r, REQUEST_PREPARE, prepared - parsed);
    if ((st = surface_asymmetry(w->compare.work, w->probe, &result)) != SURFACE_OK) {
        request_problem(r, status_from(st), "measuring the asymmetry: %s",
                        surface_message(st));
        goto out;
    }
    measured = logger_clock_ms();
    request_stage(r, REQUEST_MINIMAL, measured - prepared);
    j = json_new();
    describe_scan(j, "scan", &found);
    describe_asymmetry(j, &result, w->probe, store_made_by(r->app->store),
                       &(struct describe_times){.parse = parsed - start,
                                                .prepare = prepared - parsed,
                                                .minimal = measured - prepared,
                                                .total = measured - r->start_ms});
    request_respond(r, 200, json_compact(j));
out:
    cloudpoints_free(&c);
}
