#include "every.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <time.h>

struct every {
    const char *name;
    unsigned ms;
    void (*look)(void *arg);
    void *arg;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake; /* waits by the monotonic clock */
    bool stopping;
};

static bool wait_a_while(struct every *x)
{
    struct timespec t;
    bool goes_on;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    t.tv_nsec += (long)(x->ms % 1000) * 1000000L;
    t.tv_sec += (time_t)(x->ms / 1000) + t.tv_nsec / 1000000000L;
    t.tv_nsec %= 1000000000L;
    (void)pthread_mutex_lock(&x->lock);
    while (!x->stopping && pthread_cond_timedwait(&x->wake, &x->lock, &t) == 0)
        ;
    goes_on = !x->stopping;
    (void)pthread_mutex_unlock(&x->lock);
    return goes_on;
}

static void *every_run(void *arg)
{
    struct every *x = arg;

    (void)prctl(PR_SET_NAME, x->name);
    do
        x->look(x->arg);
    while (wait_a_while(x));
    return NULL;
}

static void every_release(struct every *x)
{
    (void)pthread_cond_destroy(&x->wake);
    (void)pthread_mutex_destroy(&x->lock);
    free(x);
}

struct every *every_start(const char *name, unsigned ms, void (*look)(void *arg),
                          void *arg)
{
    struct every *x = calloc(1, sizeof *x);
    pthread_condattr_t attr;

    if (x == NULL)
        return NULL;
    x->name = name;
    x->ms = ms;
    x->look = look;
    x->arg = arg;
    (void)pthread_mutex_init(&x->lock, NULL);
    (void)pthread_condattr_init(&attr);
    (void)pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&x->wake, &attr);
    (void)pthread_condattr_destroy(&attr);
    if (pthread_create(&x->thread, NULL, every_run, x) != 0) {
        every_release(x);
        return NULL;
    }
    return x;
}

void every_stop(struct every *x)
{
    if (x == NULL)
        return;
    (void)pthread_mutex_lock(&x->lock);
    x->stopping = true;
    (void)pthread_cond_signal(&x->wake);
    (void)pthread_mutex_unlock(&x->lock);
    (void)pthread_join(x->thread, NULL);
    every_release(x);
}
