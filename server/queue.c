#include "queue.h"

#include <pthread.h>
#include <stdlib.h>

#include "worker.h"

/* A thread and what it works with. */
struct server {
    struct queue *queue;
    struct worker worker;
    pthread_t thread;
};

struct queue {
    void (*run)(struct worker *w, struct request *r);
    pthread_mutex_t lock;
    pthread_cond_t wake;
    struct request **ring; /* [limit] */
    unsigned head, waiting, limit, running;
    uint64_t served;
    bool closed;
    unsigned nservers; /* how many there are */
    struct server *servers;
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
    struct server *s = arg;
    struct request *r = take(s->queue, false);

    while (r != NULL) {
        s->queue->run(&s->worker, r);
        r = take(s->queue, true);
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
    q->servers = calloc(workers, sizeof *q->servers);
    if (q->ring == NULL || q->servers == NULL)
        goto fail;
    for (unsigned i = 0; i < workers; i++) {
        struct server *s = &q->servers[i];

        s->queue = q;
        if (worker_open(&s->worker, app) != ST_OK)
            goto fail;
        if (pthread_create(&s->thread, NULL, serve, s) != 0) {
            worker_close(&s->worker);
            goto fail;
        }
        q->nservers++;
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
    for (unsigned i = 0; i < q->nservers; i++) {
        (void)pthread_join(q->servers[i].thread, NULL);
        worker_close(&q->servers[i].worker);
    }
    q->nservers = 0;
}

void queue_free(struct queue *q)
{
    if (q == NULL)
        return;
    (void)pthread_cond_destroy(&q->wake);
    (void)pthread_mutex_destroy(&q->lock);
    free(q->ring);
    free(q->servers);
    free(q);
}

void queue_look(struct queue *q, struct queue_state *out)
{
    (void)pthread_mutex_lock(&q->lock);
    out->waiting = q->waiting;
    out->limit = q->limit;
    out->workers = q->nservers;
    out->running = q->running;
    out->served = q->served;
    (void)pthread_mutex_unlock(&q->lock);
}
