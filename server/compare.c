#include "compare.h"

#include "app.h"
#include "cloud.h"
#include "describe.h"
#include "errinfo.h"
#include "errmap.h"
#include "heatmap.h"
#include "render.h"
#include "log.h"
#include "mem.h"
#include "minimal.h"
#include "metrics.h"
#include "params.h"
#include "request.h"
#include "store.h"
#include "verdict.h"
#include "verify.h"
#include "worker.h"

/* There is no subject to protect: where the event is lost the response stands. */
static void add_event(struct request *r, enum face_decision decision)
{
    struct errinfo e = {0};

    metrics_decision(r->app->metrics, decision);
    if (store_event(r->app->store, "compare", r->actor, "", "",
                    verdict_decision(decision), &e) != ST_OK)
        verify_event_lost(r, "compare", &e);
}

void compare_handle(struct request *r, struct worker *w)
{
    struct errinfo e = {0};
    double start = log_clock_ms(), parsed, prepared, *gap = NULL;
    struct cloud a = {0}, b = {0};
    struct face_result result;
    struct minimal least;
    enum params_detail detail = PARAMS_BRIEF;
    enum status st;

    if (!params_detail(r, &detail) || cloud_read_two(r, &a, &b) != ST_OK)
        return;
    parsed = log_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    if (cloud_build(r, &a, "a.points", w->compare.work, &w->other) != ST_OK ||
        cloud_build(r, &b, "b.points", w->compare.work, &w->probe) != ST_OK)
        goto out;
    if (admission_calibrate(&w->compare, &e) != ST_OK) {
        request_fail(r, &e);
        goto out;
    }
    prepared = log_clock_ms();
    request_stage(r, REQUEST_PREPARE, prepared - parsed);
    st = face_compare(&w->other, &w->probe, 0.0, log_clock_ms, w->compare.work, &result);
    if (st == ST_OK)
        st = face_minimal(&w->other, &w->probe, result.align.transform, log_clock_ms,
                          w->compare.work, &least);
    if (st == ST_OK && detail == PARAMS_HEATMAP) {
        gap = mem_array(b.n, sizeof *gap);
        st = gap == NULL ? ST_ENOMEM
                         : heatmap_gaps(&w->other.surface, b.pts, b.n,
                                        result.align.transform, gap);
    }
    if (st != ST_OK) {
        request_problem(r, st, "comparing: %s", status_message(st));
        goto out;
    }
    request_stage(r, REQUEST_ALIGN, result.align_ms);
    request_stage(r, REQUEST_MEASURE, result.measure_ms);
    add_event(r, result.decision);
    request_respond(
        r, 200,
        render_comparison(&(struct describe_comparison){
            .result = &result,
            .minimal = &least,
            .probe = &w->probe,
            .engine = store_made_by(r->app->store),
            .templates_compared = 1,
            .times = &(struct describe_times){.parse = parsed - start,
                                              .prepare = prepared - parsed,
                                              .align = result.align_ms,
                                              .measure = result.measure_ms,
                                              .minimal = least.ms,
                                              .total = log_clock_ms() - r->start_ms},
            .measure = detail != PARAMS_BRIEF,
            .gap_mm = gap,
            .n = b.n,
        }));
out:
    mem_free(gap);
    cloud_free(&a);
    cloud_free(&b);
}
