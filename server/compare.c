#include "compare.h"

#include <math.h>
#include <stdbool.h>

#include "app.h"
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
#include "params.h"
#include "request.h"
#include "scan.h"
#include "store.h"
#include "verdict.h"
#include "verify.h"
#include "worker.h"

/* There is no subject to protect: where the event is lost the response stands. */
static void tell(struct request *r, enum face_decision decision)
{
    char outcome[CAPTURE_OUTCOME];

    metrics_decision(r->app->metrics, decision);
    event_add(r, "compare", capture_outcome(r, verdict_decision(decision), outcome));
}

/* One comparison of two clouds, of which a is the template. */
struct comparison {
    struct request *r;
    struct worker *w;
    enum params_detail detail;
    struct cloudpoints a, b;
    struct scan_found found_a, found_b;
    double parse_ms, prepare_ms;
    struct face_result result;
    struct minimal least; /* not for PARAMS_DECISION */
    double *gap; /* the heatmap of b's points, by mem_free(); NULL: not asked for */
    struct face_field field; /* with it */
};

/* Both faces.  False: r->response says why not. */
static bool build(struct comparison *c)
{
    const double start = logger_clock_ms();
    struct face_work *work = c->w->compare.work;
    struct errinfo e = {0};
    double parsed;

    if (cloud_read_two(c->r, &c->a, &c->b) != ST_OK)
        return false;
    parsed = logger_clock_ms();
    request_stage(c->r, REQUEST_PARSE, c->parse_ms = parsed - start);
    if (cloud_build(c->r, &c->a, "a.points", false, work, &c->w->other, &c->found_a) !=
            ST_OK ||
        cloud_build(c->r, &c->b, "b.points", false, work, &c->w->probe, &c->found_b) !=
            ST_OK)
        return false;
    if (admission_calibrate(&c->w->compare, &e) != ST_OK) {
        request_fail(c->r, &e);
        return false;
    }
    request_stage(c->r, REQUEST_PREPARE, c->prepare_ms = logger_clock_ms() - parsed);
    return true;
}

static enum status heatmap(struct comparison *c)
{
    enum status st;

    c->gap = mem_array(c->b.read, sizeof *c->gap);
    if (c->gap == NULL)
        return ST_ENOMEM;
    st = heatmap_gaps(&c->w->other.surface, c->b.at, c->b.n, c->result.align.transform,
                      c->gap);
    if (st != ST_OK)
        return st;
    cloud_spread(&c->b, c->gap);
    return face_field(&c->w->other, &c->w->probe, c->w->compare.work, &c->field);
}

static bool compare(struct comparison *c)
{
    const struct face *a = &c->w->other, *b = &c->w->probe;
    struct face_work *work = c->w->compare.work;
    enum status st = face_compare(a, b, (double)NAN, logger_clock_ms, work, &c->result);

    if (st == ST_OK && c->detail != PARAMS_DECISION) {
        st = face_minimal(a, b, logger_clock_ms, work, &c->result, &c->least);
        request_stage(c->r, REQUEST_ALIGN, c->result.align_ms);
        request_stage(c->r, REQUEST_MINIMAL, c->least.ms);
    }
    if (st == ST_OK && c->detail >= PARAMS_MEASURE)
        st = face_weigh(a, b, work, &c->least);
    if (st == ST_OK && c->detail >= PARAMS_MEASURE)
        st = face_regions(a, b, work, &c->result);
    if (st == ST_OK && c->detail == PARAMS_HEATMAP)
        st = heatmap(c);
    if (st != ST_OK) {
        request_problem(c->r, st, "comparing: %s", status_message(st));
        return false;
    }
    request_stage(c->r, REQUEST_SCORE, c->result.score_ms);
    return true;
}

static void respond(struct comparison *c)
{
    const struct describe_times times = {.parse = c->parse_ms,
                                         .prepare = c->prepare_ms,
                                         .align = c->result.align_ms,
                                         .score = c->result.score_ms,
                                         .minimal = c->least.ms,
                                         .total = logger_clock_ms() - c->r->start_ms};

    verify_round(c->r, c->w, &c->result, &c->least);
    verify_respond(c->r, &(struct describe_comparison){
                             .result = &c->result,
                             .minimal = c->detail == PARAMS_DECISION ? NULL : &c->least,
                             .probe = &c->w->probe,
                             .scan = &c->found_b,
                             .other = &c->found_a,
                             .engine = store_made_by(c->r->app->store),
                             .templates_compared = 1,
                             .times = &times,
                             .measure = c->detail != PARAMS_BRIEF,
                             .gap_mm = c->gap,
                             .field = c->gap != NULL ? &c->field : NULL,
                             .n = c->b.read,
                         });
}

void compare_handle(struct request *r, struct worker *w)
{
    struct comparison c = {.r = r, .w = w};

    if (!params_detail(r, &c.detail) || !capture_admit(r))
        return;
    if (build(&c) && compare(&c)) {
        tell(r, c.result.decision);
        respond(&c);
    }
    mem_free(c.gap);
    cloudpoints_free(&c.a);
    cloudpoints_free(&c.b);
}
