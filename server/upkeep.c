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
#include "logger.h"
#include "metrics.h"
#include "refusal.h"
#include "store.h"

#define TRIM_MS        3600000.0
#define VERIFY_MS      60000.0 /* at most so often, */
#define VERIFY_PER_RUN 50.0    /* and after so many times as long as it took */

struct upkeep {
    struct app *app;
    unsigned days;
    double trim_ms, verify_ms; /* when they are due */
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed; /* by the monotonic clock */
    bool stopping, ended;
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

/* A difference stands, and all of /v1 is refused from now on. */
static void verify(struct upkeep *u)
{
    if (store_verify(u->app->store, NULL, NULL, NULL) == ST_OK)
        metrics_rows_verified(u->app->metrics);
    else
        refusal_tell(u->app);
}

/* A failover can lose a change that was seen and not yet acknowledged.  Whether it was that, and no
 * older state, the anchor decides, when the daemon starts again. */
static void end(struct upkeep *u)
{
    refusal_tell(u->app);
    logger_line("warn",
                "the database server went back: the daemon ends, to be started again");
    u->ended = true;
    (void)kill(getpid(), SIGTERM);
}

static void look(struct upkeep *u)
{
    const double now = logger_clock_ms();

    if (!u->ended && store_behind(u->app->store))
        end(u);

    store_follow(u->app->store);
    if (u->days > 0 && now >= u->trim_ms) {
        trim(u);
        u->trim_ms = logger_clock_ms() + TRIM_MS;
    }
    if (now >= u->verify_ms) {
        const double begin = logger_clock_ms();
        double end, pause;

        verify(u);
        end = logger_clock_ms();
        pause = (end - begin) * VERIFY_PER_RUN;
        u->verify_ms = end + (pause > VERIFY_MS ? pause : VERIFY_MS);
    }
}

static void *run(void *arg)
{
    struct upkeep *u = arg;
    struct timespec next;

    (void)prctl(PR_SET_NAME, "upkeep");
    (void)pthread_mutex_lock(&u->lock);
    while (!u->stopping) {
        (void)pthread_mutex_unlock(&u->lock);
        look(u);
        (void)clock_gettime(CLOCK_MONOTONIC, &next);
        next.tv_sec++;
        (void)pthread_mutex_lock(&u->lock);
        while (!u->stopping && pthread_cond_timedwait(&u->changed, &u->lock, &next) == 0)
            continue;
    }
    (void)pthread_mutex_unlock(&u->lock);
    return NULL;
}

static void release(struct upkeep *u)
{
    (void)pthread_cond_destroy(&u->changed);
    (void)pthread_mutex_destroy(&u->lock);
    free(u);
}

struct upkeep *upkeep_start(struct app *app, unsigned days)
{
    struct upkeep *u = calloc(1, sizeof *u);
    pthread_condattr_t attr;

    if (u == NULL)
        return NULL;
    u->app = app;
    u->days = days;
    u->verify_ms = logger_clock_ms() + VERIFY_MS;
    metrics_rows_verified(app->metrics);
    (void)pthread_mutex_init(&u->lock, NULL);
    (void)pthread_condattr_init(&attr);
    (void)pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&u->changed, &attr);
    (void)pthread_condattr_destroy(&attr);
    if (pthread_create(&u->thread, NULL, run, u) != 0) {
        release(u);
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
    (void)pthread_cond_signal(&u->changed);
    (void)pthread_mutex_unlock(&u->lock);
    (void)pthread_join(u->thread, NULL);
    release(u);
}
