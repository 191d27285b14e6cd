#include "access.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "app.h"
#include "dry_run.h"
#include "errinfo.h"
#include "errmap.h"
#include "logger.h"
#include "metrics.h"
#include "request.h"
#include "route.h"
#include "store.h"
#include "throttle.h"

/* Returns true if the operator must look into a request.  Not into a refusal of /readyz, which any client can
 * request, nor of a stream too many; not into a refused database, which was reported once (refusal.h); and not into overload, which gets a
 * line a minute. */
static bool is_error(const struct request *r)
{
    return r->fault[0] != '\0' && r->response.problem != ERRMAP_OVERLOAD &&
           r->response.problem != ERRMAP_NOT_READY &&
           r->response.problem != ERRMAP_STREAMS && r->response.problem != ST_EREFUSED;
}

static void warn_of_overload(const struct request *r)
{
    static struct logger_seldom overload;
    const uint64_t n = logger_seldom(&overload, logger_clock_ms());
    struct logger_line l;

    if (n == 0)
        return;
    logger_begin(&l, "warn", "requests refused: overloaded");
    logger_count(&l, "requests", n);
    logger_text(&l, "last", r->fault);
    logger_end(&l);
}

void access_log(const struct request *r, int http, double ms)
{
    struct logger_line l;
    char key[32];

    logger_begin(&l, is_error(r) ? "error" : "info", "request");
    logger_text(&l, "request_id", r->id);
    logger_text(&l, "method", route_method(r->route));
    logger_text(&l, "route", route_pattern(r->route));
    logger_count(&l, "status", (uint64_t)http);
    logger_real(&l, "ms", ms, 3);
    for (enum request_stage i = 0; i < REQUEST_STAGES; i++) {
        if ((r->stages >> i & 1) == 0)
            continue;
        (void)snprintf(key, sizeof key, "%s_ms", request_stage_name(i));
        logger_real(&l, key, r->stage_ms[i], 3);
    }
    if (r->client[0] != '\0')
        logger_text(&l, "client", r->client);
    if (r->actor[0] != '\0')
        logger_text(&l, "token", r->actor);
    if (r->fault[0] != '\0')
        logger_text(&l, "fault", r->fault);
    logger_end(&l);
    if (http != 0 && r->response.problem == ERRMAP_OVERLOAD)
        warn_of_overload(r);
}

static void lost(struct request *r, const char *kind, const struct errinfo *e)
{
    struct logger_line l;

    metrics_event(r->app->metrics, METRICS_LOST);
    metrics_database_error(r->app->metrics, e->code);
    logger_begin(&l, "error", "event lost");
    logger_text(&l, "request_id", r->id);
    logger_text(&l, "event", kind);
    logger_text(&l, "fault", e->msg);
    logger_end(&l);
}

static void refused_scan(struct request *r, const char *outcome)
{
    static const struct store_scan unusable = {.unusable = true};
    struct errinfo e = {0};

    if (store_event_scan(r->app->store, "refused", r->actor, r->subject, outcome,
                         &unusable, &e) != ST_OK)
        lost(r, "refused", &e);
}

void access_event(struct request *r, const char *kind, const char *outcome)
{
    struct errinfo e = {0};

    if (store_event(r->app->store, kind, r->actor, r->subject, r->template_id, outcome,
                    &e) != ST_OK)
        lost(r, kind, &e);
}

/* A refusal whose cause has an entry already: of what was compared (also if result.scored is set), of a search, of a signed capture. */
static bool is_entered(unsigned problem)
{
    return problem == ST_EMISMATCH || problem == ERRMAP_TWIN || problem == ST_EREPLAYED ||
           problem == ERRMAP_CAPTURE_STALE || problem == ERRMAP_CAPTURE_REPLAYED ||
           problem == ERRMAP_LIVENESS;
}

void access_refusal(struct request *r)
{
    const unsigned problem = r->response.problem;
    const struct errmap *m = errmap_get(problem);
    const double now = logger_clock_ms();
    char outcome[64];

    if (r->result.kind == NULL || r->result.scored || problem == 0 || m->http >= 500 ||
        m->http == 401 || is_entered(problem) ||
        throttle_wait(r->app->refusals, request_sender(r), "", now) > 0)
        return;
    throttle_note(r->app->refusals, request_sender(r), "", false, now);
    (void)snprintf(outcome, sizeof outcome, "%s %s", m->code, r->result.kind);
    if (dry_run_is_refusal((enum status)problem) && strcmp(r->result.kind, "enroll") != 0)
        refused_scan(r, outcome);
    else
        access_event(r, "refused", outcome);
}
