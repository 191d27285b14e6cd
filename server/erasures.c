#include "erasures.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <time.h>

#include "app.h"
#include "cache.h"
#include "store.h"

#define LOOK_MS 400 /* between two looks */

struct erasures {
    struct app *app;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    bool stopping;
};

/* Is it known not to be there?  Not so where the store is busy. */
static bool is_gone(enum status st)
{
    return st == ST_ENOTFOUND || st == ST_ECORRUPT;
}

static void drop_templates(const struct app *app)
{
    struct store_template t;
    size_t n;
    char(*ids)[STORE_ID_LEN + 1] = cache_list(app->cache, &n);

    for (size_t i = 0; i < n; i++)
        if (is_gone(store_template_get(app->store, ids[i], &t, NULL)))
            cache_forget(app->cache, ids[i]);
    free(ids);
}

static bool wait_a_while(struct erasures *x)
{
    struct timespec t;
    bool goes_on;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    t.tv_nsec += LOOK_MS * 1000000L;
    t.tv_sec += t.tv_nsec / 1000000000L;
    t.tv_nsec %= 1000000000L;
    (void)pthread_mutex_lock(&x->lock);
    while (!x->stopping && pthread_cond_timedwait(&x->wake, &x->lock, &t) == 0)
        ;
    goes_on = !x->stopping;
    (void)pthread_mutex_unlock(&x->lock);
    return goes_on;
}

static void *run(void *arg)
{
    struct erasures *x = arg;
    int64_t since = 0;
    bool erased;

    (void)prctl(PR_SET_NAME, "erasures");
    while (wait_a_while(x))
        if (store_erased_since(x->app->store, &since, &erased, NULL) == ST_OK && erased)
            drop_templates(x->app);
    return NULL;
}

static void release(struct erasures *x)
{
    (void)pthread_cond_destroy(&x->wake);
    (void)pthread_mutex_destroy(&x->lock);
    free(x);
}

struct erasures *erasures_start(struct app *app)
{
    struct erasures *x = calloc(1, sizeof *x);
    pthread_condattr_t attr;

    if (x == NULL)
        return NULL;
    x->app = app;
    (void)pthread_mutex_init(&x->lock, NULL);
    (void)pthread_condattr_init(&attr);
    (void)pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&x->wake, &attr);
    (void)pthread_condattr_destroy(&attr);
    if (pthread_create(&x->thread, NULL, run, x) != 0) {
        release(x);
        return NULL;
    }
    return x;
}

void erasures_stop(struct erasures *x)
{
    if (x == NULL)
        return;
    (void)pthread_mutex_lock(&x->lock);
    x->stopping = true;
    (void)pthread_cond_signal(&x->wake);
    (void)pthread_mutex_unlock(&x->lock);
    (void)pthread_join(x->thread, NULL);
    release(x);
}
