#include "ahead.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "cache.h"
#include "face.h"
#include "store.h"

#define ROOM 64 /* queued ids: one behind so many would be loaded too late anyway */

struct ahead {
    const struct app *app;
    struct face_work *work;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    char ring[ROOM][STORE_ID_LEN + 1];
    unsigned head, waiting;
    bool stopping;
};

static bool take(struct ahead *a, char id[STORE_ID_LEN + 1])
{
    bool taken;

    (void)pthread_mutex_lock(&a->lock);
    while (a->waiting == 0 && !a->stopping)
        (void)pthread_cond_wait(&a->wake, &a->lock);
    taken = !a->stopping;
    if (taken) {
        memcpy(id, a->ring[a->head], sizeof a->ring[0]);
        a->head = (a->head + 1) % ROOM;
        a->waiting--;
    }
    (void)pthread_mutex_unlock(&a->lock);
    return taken;
}

static void *load(void *arg)
{
    struct ahead *a = arg;
    char id[STORE_ID_LEN + 1];

    while (take(a, id))
        cache_load(a->app->cache, a->app->store, id, a->work);
    return NULL;
}

static void release(struct ahead *a)
{
    (void)pthread_cond_destroy(&a->wake);
    (void)pthread_mutex_destroy(&a->lock);
    face_work_free(a->work);
    free(a);
}

struct ahead *ahead_start(const struct app *app)
{
    struct ahead *a = calloc(1, sizeof *a);

    if (a == NULL)
        return NULL;
    a->app = app;
    (void)pthread_mutex_init(&a->lock, NULL);
    (void)pthread_cond_init(&a->wake, NULL);
    if ((a->work = face_work_new(app->model)) == NULL ||
        pthread_create(&a->thread, NULL, load, a) != 0) {
        release(a);
        return NULL;
    }
    return a;
}

void ahead_ask(struct ahead *a, const char *id)
{
    (void)pthread_mutex_lock(&a->lock);
    if (a->waiting < ROOM) {
        memcpy(a->ring[(a->head + a->waiting++) % ROOM], id, sizeof a->ring[0]);
        (void)pthread_cond_signal(&a->wake);
    }
    (void)pthread_mutex_unlock(&a->lock);
}

void ahead_stop(struct ahead *a)
{
    if (a == NULL)
        return;
    (void)pthread_mutex_lock(&a->lock);
    a->stopping = true;
    (void)pthread_cond_signal(&a->wake);
    (void)pthread_mutex_unlock(&a->lock);
    (void)pthread_join(a->thread, NULL);
    release(a);
}
