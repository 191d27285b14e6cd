#include "builder.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sodium.h>

#include "face.h"

struct builder {
    struct face_work *work;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    void (*build)(void *arg, struct face_work *w); /* NULL: nothing to do */
    void *arg;
    bool stopping;
};

static void *run(void *arg)
{
    struct builder *b = arg;

    (void)pthread_mutex_lock(&b->lock);
    while (!b->stopping)
        if (b->build == NULL) {
            (void)pthread_cond_wait(&b->changed, &b->lock);
        } else {
            (void)pthread_mutex_unlock(&b->lock);
            b->build(b->arg, b->work);
            (void)pthread_mutex_lock(&b->lock);
            b->build = NULL;
            (void)pthread_cond_signal(&b->changed);
        }
    (void)pthread_mutex_unlock(&b->lock);
    return NULL;
}

static void release(struct builder *b)
{
    (void)pthread_cond_destroy(&b->changed);
    (void)pthread_mutex_destroy(&b->lock);
    face_work_free(b->work);
    free(b);
}

struct builder *builder_start(const struct model *m)
{
    struct builder *b = calloc(1, sizeof *b);

    if (b == NULL)
        return NULL;
    (void)pthread_mutex_init(&b->lock, NULL);
    (void)pthread_cond_init(&b->changed, NULL);
    if ((b->work = face_work_new(m)) == NULL ||
        pthread_create(&b->thread, NULL, run, b) != 0) {
        release(b);
        return NULL;
    }
    return b;
}

void builder_begin(struct builder *b, void (*build)(void *arg, struct face_work *w),
                   void *arg)
{
    (void)pthread_mutex_lock(&b->lock);
    b->build = build;
    b->arg = arg;
    (void)pthread_cond_signal(&b->changed);
    (void)pthread_mutex_unlock(&b->lock);
}

void builder_wait(struct builder *b)
{
    (void)pthread_mutex_lock(&b->lock);
    while (b->build != NULL)
        (void)pthread_cond_wait(&b->changed, &b->lock);
    (void)pthread_mutex_unlock(&b->lock);
}

static void wipe(void *arg, struct face_work *w)
{
    (void)arg;
    face_work_wipe(w);
    sodium_stackzero(BUILDER_STACK);
}

void builder_wipe(struct builder *b)
{
    builder_begin(b, wipe, NULL);
    builder_wait(b);
}

void builder_stop(struct builder *b)
{
    if (b == NULL)
        return;
    (void)pthread_mutex_lock(&b->lock);
    b->stopping = true;
    (void)pthread_cond_signal(&b->changed);
    (void)pthread_mutex_unlock(&b->lock);
    (void)pthread_join(b->thread, NULL);
    release(b);
}
