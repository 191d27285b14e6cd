#include "refusal.h"

#include <pthread.h>

#include "app.h"
#include "errinfo.h"
#include "logger.h"
#include "request.h"
#include "route.h"
#include "store.h"

bool refusal_stands(struct request *r)
{
    struct errinfo e;

    if (route_open(r->route) || !store_refused(r->app->store, &e))
        return false;
    request_fail(r, &e);
    return true;
}

bool refusal_found(struct request *r)
{
    struct errinfo e;

    if (route_open(r->route) || !r->app->no_auth ||
        store_ready(r->app->store, &e) == ST_OK)
        return false;
    request_fail(r, &e);
    return true;
}

static void refusal_tell_log(const char *level, const char *what, const struct errinfo *e)
{
    struct logger_line l;

    logger_begin(&l, level, what);
    logger_text(&l, "reason", e->msg);
    logger_end(&l);
}

/* The lock keeps the lines of several threads in the order of what they report. */
static void tell_anchor(struct app *app)
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    struct errinfo e;
    bool behind;

    (void)pthread_mutex_lock(&lock);
    behind = store_anchor_fault(app->store, &e);
    if (behind && !app->anchor_behind)
        refusal_tell_log("warn", "the database's anchor is not up to date", &e);
    else if (!behind && app->anchor_behind)
        logger_line("info", "the database's anchor is up to date again");
    app->anchor_behind = behind;
    (void)pthread_mutex_unlock(&lock);
}

void refusal_tell(struct app *app)
{
    struct errinfo e;

    if (store_refused(app->store, &e) && !atomic_flag_test_and_set(&app->refusal_told))
        refusal_tell_log("error", "the database is refused until the daemon is restarted",
                         &e);
    tell_anchor(app);
}
