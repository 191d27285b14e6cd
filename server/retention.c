#include "retention.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>

#include "errinfo.h"
#include "log.h"
#include "store.h"

#define EVERY_S 3600

struct retention {
    struct store *store;
    unsigned days;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed; /* by the monotonic clock */
    bool stopping;
};

static void trim(struct retention *r)
{
    struct log_entry l;
    struct errinfo e;
    uint64_t cut;
    const enum status st =
        store_audit_trim(r->store, "surfaced", r->days, false, &cut, &e);

    if (st == ST_OK && cut == 0)
        return;
    log_begin(&l, st == ST_OK ? "info" : "error",
              "audit log: the oldest uses are cut off");
    log_count(&l, "entries", cut);
    if (st != ST_OK)
        log_text(&l, "reason", e.msg);
    log_end(&l);
}

static void *run(void *arg)
{
    struct retention *r = arg;
    struct timespec next;

    (void)pthread_mutex_lock(&r->lock);
    while (!r->stopping) {
        (void)pthread_mutex_unlock(&r->lock);
        trim(r);
        (void)clock_gettime(CLOCK_MONOTONIC, &next);
        next.tv_sec += EVERY_S;
        (void)pthread_mutex_lock(&r->lock);
        while (!r->stopping && pthread_cond_timedwait(&r->changed, &r->lock, &next) == 0)
            continue;
    }
    (void)pthread_mutex_unlock(&r->lock);
    return NULL;
}

static void release(struct retention *r)
{
    (void)pthread_cond_destroy(&r->changed);
    (void)pthread_mutex_destroy(&r->lock);
    free(r);
}

struct retention *retention_start(struct store *s, unsigned days)
{
    struct retention *r = calloc(1, sizeof *r);
    pthread_condattr_t attr;

    if (r == NULL)
        return NULL;
    r->store = s;
    r->days = days;
    (void)pthread_mutex_init(&r->lock, NULL);
    (void)pthread_condattr_init(&attr);
    (void)pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&r->changed, &attr);
    (void)pthread_condattr_destroy(&attr);
    if (pthread_create(&r->thread, NULL, run, r) != 0) {
        release(r);
        return NULL;
    }
    return r;
}

void retention_stop(struct retention *r)
{
    if (r == NULL)
        return;
    (void)pthread_mutex_lock(&r->lock);
    r->stopping = true;
    (void)pthread_cond_signal(&r->changed);
    (void)pthread_mutex_unlock(&r->lock);
    (void)pthread_join(r->thread, NULL);
    release(r);
}
