#include "routes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "errinfo.h"
#include "errmap.h"
#include "gallery.h"
#include "json.h"
#include "metrics.h"
#include "queue.h"
#include "request.h"
#include "stats.h"
#include "store.h"

/* The part of the reason that is public; the log has all of it. */
static const char *reason(enum status st)
{
    switch (st) {
    case ST_EBUSY:
        return "the database is locked by another process";
    case ST_EREFUSED:
        return "the database is not the one that was opened, or was altered: see the "
               "daemon's log";
    case ST_ENOMEM:
        return "out of memory";
    default:
        return "the database cannot be read";
    }
}

static void health_respond(struct request *r, const char *name, const char *value)
{
    struct json *j = json_new();

    json_text(j, name, value);
    request_respond(r, 200, json_compact(j));
}

void health_live(struct request *r, struct worker *w)
{
    (void)w;
    health_respond(r, "status", "ok");
}

void health_ready(struct request *r, struct worker *w)
{
    struct store_calibration k;
    struct errinfo e = {0};

    (void)w;
    if (atomic_load(&r->app->stopping)) {
        request_problem(r, ERRMAP_NOT_READY, "the daemon is stopping");
    } else if (r->app->gallery != NULL &&
               gallery_phase(r->app->gallery) == GALLERY_LOADING) {
        request_problem(r, ERRMAP_NOT_READY, "the gallery is being loaded");
    } else if (store_ready(r->app->store, &e) == ST_OK &&
               store_calibration_current(r->app->store, &k, &e) == ST_OK) {
        health_respond(r, "status", "ready");
    } else {
        request_problem(r, ERRMAP_NOT_READY, "%s", reason(e.code));
        r->failed = e.code;
        (void)snprintf(r->fault, sizeof r->fault, "%s", e.msg);
    }
}

/* "surfaced/VERSION measure/N model/HHHHHHHH" */
static void version_of(const struct store *s, char out[32])
{
    const char *from = strchr(store_made_by(s), '/') + 1;

    (void)snprintf(out, 32, "%.*s", (int)strcspn(from, " "), from);
}

void health_version(struct request *r, struct worker *w)
{
    char version[32];

    (void)w;
    version_of(r->app->store, version);
    health_respond(r, "version", version);
}

static void describe_daemon(struct json *j, struct app *app)
{
    char version[32];
    struct queue_state q;

    version_of(app->store, version);
    json_text(j, "version", version);
    queue_look(app->queue, &q);
    json_object(j, "queue");
    json_number(j, "waiting", q.waiting);
    json_number(j, "running", q.running);
    json_number(j, "served", (double)q.served);
    json_close(j);
    metrics_describe(app->metrics, j);
}

void health_stats(struct request *r, struct worker *w)
{
    struct store_day *days = NULL;
    struct json *j = json_new();
    struct errinfo e = {0};
    size_t n = 0;

    (void)w;
    if (store_days(r->app->store, &days, &n, &e) == ST_OK &&
        stats_describe(j, r->app->store, days, n, auth_scores(r), &e) == ST_OK) {
        describe_daemon(j, r->app);
        request_respond(r, 200, json_compact(j));
    } else {
        json_discard(j);
        request_fail(r, &e);
    }
    free(days);
}
