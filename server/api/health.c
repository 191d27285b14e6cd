#include "health.h"

#include <stdio.h>
#include <string.h>

#include "app.h"
#include "in_force.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "request.h"
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

static void respond(struct request *r, const char *name, const char *value)
{
    struct json *j = json_new();

    json_text(j, name, value);
    request_respond(r, 200, json_compact(j));
}

void health_live(struct request *r, struct worker *w)
{
    (void)w;
    respond(r, "status", "ok");
}

void health_ready(struct request *r, struct worker *w)
{
    struct store_calibration k;
    struct errinfo e = {0};

    (void)w;
    if (atomic_load(&r->app->stopping)) {
        request_problem(r, ERRMAP_NOT_READY, "the daemon is stopping");
    } else if (store_ready(r->app->store, &e) == ST_OK &&
               in_force_get(r->app->store, &k, &e) == ST_OK) {
        respond(r, "status", "ready");
    } else {
        request_problem(r, ERRMAP_NOT_READY, "%s", reason(e.code));
        r->failed = e.code;
        (void)snprintf(r->fault, sizeof r->fault, "%s", e.msg);
    }
}

void health_version(struct request *r, struct worker *w)
{
    /* "surfaced/VERSION measure/N model/HHHHHHHH" */
    const char *from = strchr(store_made_by(r->app->store), '/') + 1;
    char version[32] = "";

    (void)w;
    memcpy(version, from, strcspn(from, " "));
    respond(r, "version", version);
}
