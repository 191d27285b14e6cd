#include "queue.h"

#include <pthread.h>
#include <stdlib.h>

#include "app.h"

struct queue {
    void (*run)(struct worker *w, struct request *r);
    pthread_mutex_t lock;
    pthread_cond_t wake;
    struct request **ring; /* [limit] */
    unsigned head, waiting, limit, running;
    uint64_t served;
    bool closed;
    unsigned nworkers; /* how many threads there are */
    pthread_t *threads;
    struct worker *workers;
};

/* The next request; NULL when the queue is closed and empty. */
static struct request *take(struct queue *q, bool was_running)
{
    struct request *r = NULL;

    (void)pthread_mutex_lock(&q->lock);
    q->running -= was_running;
    q->served += was_running;
    while (q->waiting == 0 && !q->closed)
        (void)pthread_cond_wait(&q->wake, &q->lock);
    if (q->waiting > 0) {
        r = q->ring[q->head];
        q->head = (q->head + 1) % q->limit;
        q->waiting--;
        q->running++;
    }
    (void)pthread_mutex_unlock(&q->lock);
    return r;
}

static void *serve(void *arg)
{
    struct worker *w = arg;
    struct request *r = take(w->queue, false);

    while (r != NULL) {
        w->queue->run(w, r);
        r = take(w->queue, true);
    }
    return NULL;
}

enum status queue_start(struct app *app, unsigned workers, unsigned limit,
                        void (*run)(struct worker *w, struct request *r),
                        struct queue **out)
{
    struct queue *q = calloc(1, sizeof *q);

    *out = NULL;
    if (q == NULL)
        return ST_ENOMEM;
    q->run = run;
    q->limit = limit;
    (void)pthread_mutex_init(&q->lock, NULL);
    (void)pthread_cond_init(&q->wake, NULL);
    q->ring = calloc(limit, sizeof *q->ring);
    q->threads = calloc(workers, sizeof *q->threads);
    q->workers = calloc(workers, sizeof *q->workers);
    if (q->ring == NULL || q->threads == NULL || q->workers == NULL)
        goto fail;
    for (unsigned i = 0; i < workers; i++) {
        struct worker *w = &q->workers[i];

        w->app = app;
        w->queue = q;
        w->work = face_work_new(app->model);
        if (w->work == NULL)
            goto fail;
        if (pthread_create(&q->threads[i], NULL, serve, w) != 0) {
            face_work_free(w->work);
            goto fail;
        }
        q->nworkers++;
    }
    *out = q;
    return ST_OK;
fail:
    queue_stop(q);
    queue_free(q);
    return ST_ENOMEM;
}

bool queue_push(struct queue *q, struct request *r)
{
    bool fits;

    (void)pthread_mutex_lock(&q->lock);
    fits = !q->closed && q->waiting < q->limit;
    if (fits) {
        q->ring[(q->head + q->waiting) % q->limit] = r;
        q->waiting++;
        (void)pthread_cond_signal(&q->wake);
    }
    (void)pthread_mutex_unlock(&q->lock);
    return fits;
}

void queue_stop(struct queue *q)
{
    (void)pthread_mutex_lock(&q->lock);
    q->closed = true;
    (void)pthread_cond_broadcast(&q->wake);
    (void)pthread_mutex_unlock(&q->lock);
    for (unsigned i = 0; i < q->nworkers; i++) {
        (void)pthread_join(q->threads[i], NULL);
        face_free(&q->workers[i].probe);
        face_free(&q->workers[i].other);
        face_work_free(q->workers[i].work);
    }
    q->nworkers = 0;
}

void queue_free(struct queue *q)
{
    if (q == NULL)
        return;
    (void)pthread_cond_destroy(&q->wake);
    (void)pthread_mutex_destroy(&q->lock);
    free(q->ring);
    free(q->threads);
    free(q->workers);
    free(q);
}

void queue_look(struct queue *q, struct queue_state *out)
{
    (void)pthread_mutex_lock(&q->lock);
    out->waiting = q->waiting;
    out->limit = q->limit;
    out->workers = q->nworkers;
    out->running = q->running;
    out->served = q->served;
    (void)pthread_mutex_unlock(&q->lock);
}
