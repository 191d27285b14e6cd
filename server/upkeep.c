#include "upkeep.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#include "app.h"
#include "errinfo.h"
#include "expiry.h"
#include "gallery.h"
#include "logger.h"
#include "metrics.h"
#include "refusal.h"
#include "store.h"

#define LOOK_S         1 /* between two looks */
#define HOUR_MS        3600000.0
#define VERIFY_MS      60000.0 /* at most so often, */
#define VERIFY_PER_RUN 50.0    /* and after so many times as long as it took */

struct upkeep {
    struct app *app;
    unsigned days;
    double hour_ms,
        verify_ms; /* time of the next hourly work, of the next verification */
    struct expiry expiry;
    pthread_t thread;
    pthread_mutex_t lock; /* protects stopping */
    pthread_cond_t wake;
    bool stopping;
    bool ended;
    bool unread; /* the last verification could not read the rows */
};

static void tell_gallery(struct gallery_state is)
{
    struct logger_line l;

    logger_begin(&l, "info", "the gallery is loaded");
    logger_count(&l, "subjects", is.subjects);
    logger_count(&l, "templates", is.templates);
    logger_count(&l, "bytes", is.bytes);
    logger_end(&l);
}

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

static void trim_days(struct upkeep *u)
{
    struct errinfo e;
    const enum status st = store_days_trim(u->app->store, &e);

    if (st != ST_OK)
        metrics_database_error(u->app->metrics, st);
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

/* So that a search finds little to do, and what was erased is soon gone from memory. */
static void upkeep_gallery(struct upkeep *u)
{
    struct gallery *g = u->app->gallery;
    const enum gallery_phase before = g != NULL ? gallery_phase(g) : GALLERY_FULL;
    struct store_people *people;
    struct errinfo e;
    enum status st;

    if (before == GALLERY_FULL || store_refused(u->app->store, NULL))
        return;
    if ((st = store_people_begin(u->app->store, "", 0, &people, &e)) == ST_OK)
        st = store_people_end(people, gallery_follow(g, people, &e), &e);
    if (st == ST_ELIMIT)
        logger_line("error", "nobody can be identified", "reason", e.msg);
    else if (st == ST_OK && before == GALLERY_LOADING)
        tell_gallery(gallery_state(g));
    else if (st != ST_OK)
        metrics_database_error(u->app->metrics, st);
}

static void upkeep_look(struct upkeep *u)
{
    const double now = logger_clock_ms();

    if (!u->ended && store_behind(u->app->store))
        upkeep_end(u);
    store_follow(u->app->store);
    upkeep_gallery(u);
    if (now >= u->hour_ms) {
        expiry_look(&u->expiry, u->app);
        if (u->days > 0)
            trim(u);
        trim_days(u);
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

static bool upkeep_pause(struct upkeep *u)
{
    struct timespec t;
    bool goes_on;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    t.tv_sec += LOOK_S;
    (void)pthread_mutex_lock(&u->lock);
    while (!u->stopping && pthread_cond_timedwait(&u->wake, &u->lock, &t) == 0)
        ;
    goes_on = !u->stopping;
    (void)pthread_mutex_unlock(&u->lock);
    return goes_on;
}

static void *upkeep_run(void *arg)
{
    struct upkeep *u = arg;

    (void)prctl(PR_SET_NAME, "upkeep");
    do
        upkeep_look(u);
    while (upkeep_pause(u));
    return NULL;
}

static void upkeep_release(struct upkeep *u)
{
    (void)pthread_cond_destroy(&u->wake);
    (void)pthread_mutex_destroy(&u->lock);
    free(u);
}

struct upkeep *upkeep_start(struct app *app, unsigned days)
{
    struct upkeep *u = calloc(1, sizeof *u);
    pthread_condattr_t monotonic;

    if (u == NULL)
        return NULL;
    u->app = app;
    u->days = days;
    u->verify_ms = logger_clock_ms() + VERIFY_MS;
    (void)pthread_mutex_init(&u->lock, NULL);
    /* Not pthread_cond_clockwait(): the tests let this clock run faster, which does not reach that. */
    (void)pthread_condattr_init(&monotonic);
    (void)pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&u->wake, &monotonic);
    (void)pthread_condattr_destroy(&monotonic);
    metrics_rows_verified(app->metrics);
    if (pthread_create(&u->thread, NULL, upkeep_run, u) != 0) {
        upkeep_release(u);
        return NULL;
    }
    return u;
}

void upkeep_stop(struct upkeep *u)
{
    if (u == NULL)
        return;
    (void)pthread_mutex_lock(&u->lock);
    u->stopping = true;
    (void)pthread_cond_signal(&u->wake);
    (void)pthread_mutex_unlock(&u->lock);
    (void)pthread_join(u->thread, NULL);
    upkeep_release(u);
}
