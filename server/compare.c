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
#include "params.h"
#include "request.h"
#include "store.h"
#include "verify.h"
#include "worker.h"

void compare_handle(struct request *r, struct worker *w)
{
    struct errinfo e = {0};
    double start = log_clock_ms(), parsed, prepared, *gap = NULL;
    struct cloud a = {0}, b = {0};
    struct face_result result;
    enum params_detail detail = PARAMS_BRIEF;
    enum status st;

    if (!params_detail(r, &detail) || cloud_read_two(r, &a, &b) != ST_OK)
        return;
    parsed = log_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    if (cloud_build(r, &a, "a.points", w->compare.work, &w->other) != ST_OK ||
        cloud_build(r, &b, "b.points", w->compare.work, &w->probe) != ST_OK)
        goto out;
    if (nearest_calibrate(&w->compare, &e) != ST_OK) {
        request_fail(r, &e);
        goto out;
    }
    prepared = log_clock_ms();
    request_stage(r, REQUEST_PREPARE, prepared - parsed);
    st = face_compare(&w->other, &w->probe, 0.0, log_clock_ms, w->compare.work, &result);
    if (st == ST_OK && detail == PARAMS_HEATMAP) {
        gap = mem_array(b.n, sizeof *gap);
        if (gap == NULL)
            st = ST_ENOMEM;
        else
            heatmap_gaps(&w->other.surface, b.pts, b.n, result.align.transform, gap);
    }
    if (st != ST_OK) {
        request_problem(r, st, "comparing: %s", status_message(st));
        goto out;
    }
    request_stage(r, REQUEST_ALIGN, result.align_ms);
    request_stage(r, REQUEST_MEASURE, result.measure_ms);
    verify_event(r, "compare", "", "", result.decision);
    request_respond(
        r, 200,
        render_comparison(&(struct describe_comparison){
            .result = &result,
            .probe = &w->probe,
            .engine = store_made_by(r->app->store),
            .templates_compared = 1,
            .times = &(struct describe_times){.parse = parsed - start,
                                              .prepare = prepared - parsed,
                                              .align = result.align_ms,
                                              .measure = result.measure_ms,
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
