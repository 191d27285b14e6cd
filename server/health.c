#include "health.h"

#include <stdio.h>

#include "app.h"
#include "in_force.h"
#include "errinfo.h"
#include "errmap.h"
#include "render.h"
#include "request.h"

/* The part of the reason that is public; the log has all of it. */
static const char *reason(enum status st)
{
    switch (st) {
    case ST_EVERSION:
        return "the database has another schema than this program's";
    case ST_EBUSY:
        return "the database is locked by another process";
    case ST_EREFUSED:
        return "the database is not the one that was opened, or not as it was written: the log "
               "says more";
    case ST_ENOMEM:
        return "out of memory";
    default:
        return "the database cannot be read";
    }
}

void health_live(struct request *r, struct worker *w)
{
    (void)w;
    request_respond(r, 200, render_state("ok"));
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
        request_respond(r, 200, render_state("ready"));
    } else {
        request_problem(r, ERRMAP_NOT_READY, "%s", reason(e.code));
        r->failed = e.code;
        (void)snprintf(r->fault, sizeof r->fault, "%s", e.msg);
    }
}
