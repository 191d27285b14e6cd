#include "upkeep.h"

#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "app.h"
#include "errinfo.h"
#include "every.h"
#include "expiry.h"
#include "logger.h"
#include "metrics.h"
#include "refusal.h"
#include "store.h"

#define LOOK_MS        1000
#define HOUR_MS        3600000.0
#define VERIFY_MS      60000.0 /* at most so often, */
#define VERIFY_PER_RUN 50.0    /* and after so many times as long as it took */

struct upkeep {
    struct app *app;
    unsigned days;
    double hour_ms,
        verify_ms; /* time of the next hourly work, of the next verification */
    struct expiry expiry;
    struct every *thread;
    bool ended;
    bool unread; /* the last verification could not read the rows */
};

static void trim(struct upkeep *u)
{
    struct logger_line l;
    struct errinfo e;
    uint64_t cut;
    const enum status st =
        store_audit_trim(u->app->store, "surfaced", u->days, false, &cut, &e);

    if (st == ST_OK && cut == 0)
        return;
    logger_begin(&l, st == ST_OK ? "info" : "error",
                 "the oldest entries of the access log were deleted");
    logger_count(&l, "entries", cut);
    if (st != ST_OK)
        logger_text(&l, "reason", e.msg);
    logger_end(&l);
}

/* After a difference all of /v1 is refused: refusal_tell() reports it.  Rows that could not be read are
 * reported once, until they were. */
static void upkeep_verify(struct upkeep *u)
{
    struct errinfo e;
    const enum status st = store_verify(u->app->store, NULL, NULL, &e);

    if (st == ST_OK)
        metrics_rows_verified(u->app->metrics);
    if (st == ST_OK && u->unread)
        logger_line("info", "the rows were verified again", NULL, NULL);
    if (st != ST_OK)
        metrics_database_error(u->app->metrics, st);
    if (st != ST_OK && st != ST_EREFUSED && !u->unread)
        logger_line("warn", "the rows could not be verified", "reason", e.msg);
    u->unread = st != ST_OK && st != ST_EREFUSED;
}

/* A failover can lose a change that was seen and not yet acknowledged.  Whether it was that, and no
 * older state, the anchor decides, when the daemon starts again. */
static void upkeep_end(struct upkeep *u)
{
    refusal_tell(u->app);
    logger_line("warn",
                "the database server went back: the daemon ends, to be started again",
                NULL, NULL);
    u->ended = true;
    (void)kill(getpid(), SIGTERM);
}

static void upkeep_look(void *arg)
{
    struct upkeep *u = arg;
    const double now = logger_clock_ms();

    if (!u->ended && store_behind(u->app->store))
        upkeep_end(u);
    store_follow(u->app->store);
    if (now >= u->hour_ms) {
        expiry_look(&u->expiry, u->app);
        if (u->days > 0)
            trim(u);
        u->hour_ms = logger_clock_ms() + HOUR_MS;
    }
    if (now >= u->verify_ms) {
        const double begin = logger_clock_ms();
        double end, pause;

        upkeep_verify(u);
        end = logger_clock_ms();
        pause = (end - begin) * VERIFY_PER_RUN;
        u->verify_ms = end + (pause > VERIFY_MS ? pause : VERIFY_MS);
    }
    refusal_tell(u->app);
}

struct upkeep *upkeep_start(struct app *app, unsigned days)
{
    struct upkeep *u = calloc(1, sizeof *u);

    if (u == NULL)
        return NULL;
    u->app = app;
    u->days = days;
    u->verify_ms = logger_clock_ms() + VERIFY_MS;
    metrics_rows_verified(app->metrics);
    if ((u->thread = every_start("upkeep", LOOK_MS, upkeep_look, u)) == NULL) {
        free(u);
        return NULL;
    }
    return u;
}

void upkeep_stop(struct upkeep *u)
{
    if (u != NULL)
        every_stop(u->thread);
    free(u);
}
