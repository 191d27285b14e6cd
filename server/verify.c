#include "verify.h"

#include <stdlib.h>

#include "ahead.h"
#include "app.h"
#include "attempts.h"
#include "cache.h"
#include "cloud.h"
#include "describe.h"
#include "errinfo.h"
#include "errmap.h"
#include "heatmap.h"
#include "render.h"
#include "log.h"
#include "mem.h"
#include "metrics.h"
#include "params.h"
#include "request.h"
#include "store.h"
#include "verdict.h"
#include "worker.h"

void verify_event(struct request *r, const char *kind, const char *subject,
                  const char *template_id, enum face_decision decision)
{
    struct errinfo e = {0};

    metrics_decision(r->app->metrics, decision);
    if (store_event(r->app->store, kind, r->actor, subject, template_id,
                    verdict_decision(decision), &e) != ST_OK) {
        struct log_entry l;

        metrics_lost_event(r->app->metrics);
        metrics_database_error(r->app->metrics, e.code);
        log_begin(&l, "error", "event lost");
        log_text(&l, "request_id", r->id);
        log_text(&l, "event", kind);
        log_text(&l, "fault", e.msg);
        log_end(&l);
    }
}

/* The heatmap of the probe's points against template id, by mem_free(). */
static enum status heatmap(struct worker *w, const char *id, const struct cloud *c,
                           const double transform[16], double **gap, struct errinfo *e)
{
    const struct face *face;
    enum status st =
        cache_hold(w->app->cache, w->app->store, id, w->compare.work, &face, e);

    if (st != ST_OK)
        return st;
    *gap = mem_array(c->n, sizeof **gap);
    if (*gap != NULL)
        heatmap_gaps(&face->surface, c->pts, c->n, transform, *gap);
    cache_release(w->app->cache, face);
    return *gap != NULL ? ST_OK : errinfo_set(e, ST_ENOMEM, "no memory for the heatmap");
}

bool verify_admitted(struct request *r, enum admit admit, const struct errinfo *e)
{
    if (admit != ADMIT_YES)
        request_problem(r, admit == ADMIT_DISABLED ? ERRMAP_DISABLED : ERRMAP_EXPIRED,
                        "%s", e->msg);
    return admit == ADMIT_YES;
}

/* Is the subject there, admitted and not locked out?  *one: as it was read. */
static bool admit(struct request *r, const char *subject, struct store_subject *one)
{
    struct errinfo e = {0};

    if (store_subject_get(r->app->store, subject, one, &e) != ST_OK) {
        request_fail(r, &e);
        return false;
    }
    return verify_admitted(r, admit_subject(one, &e), &e) &&
           attempts_admit(r->app->attempts, r, subject);
}

/* The probe of the body against templates t[0..n-1] of one subject. */
static void verify(struct request *r, struct worker *w, const struct store_template *t,
                   size_t n)
{
    double start = log_clock_ms(), parsed, prepared, *gap = NULL;
    struct errinfo e = {0};
    struct cloud c = {0};
    struct nearest best;
    struct store_subject one;
    enum params_detail detail = PARAMS_BRIEF;
    enum status st;

    if (!params_detail(r, &detail) || !admit(r, t->subject, &one))
        return;
    for (size_t i = 0; i < n; i++)
        ahead_ask(w->app->ahead, t[i].id);
    if (cloud_read(r, &c) != ST_OK)
        return;
    parsed = log_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    if (cloud_build(r, &c, "points", w->compare.work, &w->probe) != ST_OK)
        goto out;
    prepared = log_clock_ms();
    request_stage(r, REQUEST_PREPARE, prepared - parsed);
    st = nearest_find(&w->compare, t, n, &w->probe, &best, &e);
    if (st == ST_OK && detail == PARAMS_HEATMAP)
        st = heatmap(w, t[best.index].id, &c, best.result.align.transform, &gap, &e);
    if (st != ST_OK) {
        request_fail(r, &e);
        goto out;
    }
    request_stage(r, REQUEST_ALIGN, best.align_ms);
    request_stage(r, REQUEST_MEASURE, best.measure_ms);
    if (!attempts_settle(r->app->attempts, r, t->subject,
                         best.result.decision == FACE_MATCH))
        goto out;
    verify_event(r, "verify", t[best.index].subject, t[best.index].id,
                 best.result.decision);
    store_subject_seen(r->app->store, &one);
    request_respond(
        r, 200,
        render_comparison(&(struct describe_comparison){
            .result = &best.result,
            .probe = &w->probe,
            .engine = store_made_by(r->app->store),
            .subject = t[best.index].subject,
            .template_id = t[best.index].id,
            .templates_compared = best.compared,
            .times = &(struct describe_times){.parse = parsed - start,
                                              .prepare = prepared - parsed,
                                              .align = best.align_ms,
                                              .measure = best.measure_ms,
                                              .total = log_clock_ms() - r->start_ms},
            .measure = detail != PARAMS_BRIEF,
            .gap_mm = gap,
            .n = c.n,
        }));
out:
    mem_free(gap);
    cloud_free(&c);
}

void verify_subject(struct request *r, struct worker *w)
{
    struct store_template *t = NULL;
    struct errinfo e = {0};
    size_t n = 0;

    if (store_template_list(r->app->store, r->subject, &t, &n, &e) != ST_OK)
        request_fail(r, &e);
    else if (n == 0)
        request_problem(r, ST_ENOTFOUND, "the subject has no template");
    else
        verify(r, w, t, n);
    free(t);
}

void verify_template(struct request *r, struct worker *w)
{
    struct store_template t;
    struct errinfo e = {0};

    if (store_template_get(r->app->store, r->template_id, &t, &e) != ST_OK)
        request_fail(r, &e);
    else
        verify(r, w, &t, 1);
}
