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

/* The lock keeps the lines of several threads in the order of the events. */
static void tell_anchor(struct app *app)
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    struct errinfo e;
    bool behind;

    (void)pthread_mutex_lock(&lock);
    behind = store_anchor_fault(app->store, &e);
    if (behind && !app->anchor_behind)
        logger_line("warn", "the database's anchor is not up to date", "reason", e.msg);
    else if (!behind && app->anchor_behind)
        logger_line("info", "the database's anchor is up to date again", NULL, NULL);
    app->anchor_behind = behind;
    (void)pthread_mutex_unlock(&lock);
}

void refusal_tell(struct app *app)
{
    struct errinfo e;

    if (store_refused(app->store, &e) && !atomic_flag_test_and_set(&app->refusal_told))
        logger_line("error", "the database is refused until the daemon is restarted",
                    "reason", e.msg);
    tell_anchor(app);
}
