#define _GNU_SOURCE /* pthread_cond_clockwait() */
#include "queue.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "logger.h"
#include "worker.h"

/* A worker wipes its memory after IDLE_MS without a request, and at least every BUSY_MS: that costs less than a
 * thousandth of the time. */
#define IDLE_MS 200
#define BUSY_MS 500.0

#define FIRST_MS 10.0 /* what a request of an unknown sender is taken to cost */
#define HEAVY_MS 50.0 /* a sender whose requests take longer is a heavy one */
#define FORGET   0.8  /* part of the last cost that stays after a cheaper request */
#define KNOWN    64   /* senders that are remembered beside those that have requests */

struct sender {
    uint64_t id;
    double
        time_ms; /* virtual time: processor time of its requests, also of running ones */
    double cost_ms; /* processor time of one of its last requests */
    double seen_ms;
    unsigned waiting, running;
};

struct waiting {
    struct request *r;
    struct sender *sender;
    enum queue_kind kind;
    uint64_t serial;
};

/* A thread, its memory, and the request that it runs. */
struct server {
    struct queue *queue;
    struct worker worker;
    pthread_t thread;
    bool used; /* since it was wiped */
    double wiped_ms;
    struct sender
        *sender; /* sender of the running request; NULL: none, or a token is checked */
    bool heavy;
    double begin_ms, charged_ms;
};

struct queue {
    void (*run)(struct worker *w, struct request *r);
    pthread_mutex_t lock;
    pthread_cond_t wake;
    struct waiting *waits; /* [limit], in no order */
    struct sender *senders;
    unsigned waiting, limit, running, heavy, nsenders;
    double time_ms; /* the virtual time of the sender that was last served */
    uint64_t serial, served;
    bool closed;
    unsigned workers, started;
    struct server *servers;
};

/* The processor time of this thread: what else the machine does makes no sender a heavy one. */
static double cpu_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* ---- what waits; the lock is held */

/* There is always one without requests: more are remembered than can have some. */
static struct sender *find_sender(struct queue *q, uint64_t id)
{
    struct sender *oldest = q->senders;

    for (struct sender *s = q->senders; s < q->senders + q->nsenders; s++) {
        if (s->seen_ms > 0 && s->id == id)
            return s;
        if (s->waiting + s->running == 0 &&
            (oldest->waiting + oldest->running > 0 || s->seen_ms < oldest->seen_ms))
            oldest = s;
    }
    *oldest = (struct sender){.id = id, .cost_ms = FIRST_MS};
    return oldest;
}

static bool is_heavy(const struct waiting *w)
{
    return w->kind == QUEUE_LARGE ||
           (w->kind == QUEUE_SMALL && w->sender->cost_ms > HEAVY_MS);
}

static bool before(const struct waiting *a, const struct waiting *b)
{
    if ((a->kind == QUEUE_TOKEN) != (b->kind == QUEUE_TOKEN))
        return a->kind == QUEUE_TOKEN;
    if (a->kind != QUEUE_TOKEN && a->sender->time_ms != b->sender->time_ms)
        return a->sender->time_ms < b->sender->time_ms;
    return a->serial < b->serial;
}

/* What a worker takes now; NULL: nothing. */
static struct waiting *first(struct queue *q)
{
    const bool room = q->heavy + 1 < q->workers || q->heavy == 0;
    struct waiting *best = NULL;

    for (struct waiting *w = q->waits; w < q->waits + q->waiting; w++)
        if ((room || !is_heavy(w)) && (best == NULL || before(w, best)))
            best = w;
    return best;
}

/* The newest of the sender that has most waiting. */
static struct waiting *last(struct queue *q)
{
    struct waiting *worst = NULL;

    for (struct waiting *w = q->waits; w < q->waits + q->waiting; w++)
        if (worst == NULL || w->sender->waiting > worst->sender->waiting ||
            (w->sender == worst->sender && w->serial > worst->serial))
            worst = w;
    return worst;
}

static struct request *remove_one(struct queue *q, struct waiting *w)
{
    struct request *r = w->r;

    w->sender->waiting--;
    *w = q->waits[--q->waiting];
    return r;
}

/* ---- workers; the lock is held unless a comment says otherwise */

/* Waits for a request.  Returns false if none came for IDLE_MS and s was used. */
static bool wait_for_more(struct queue *q, const struct server *s)
{
    struct timespec t;

    if (!s->used)
        return pthread_cond_wait(&q->wake, &q->lock) == 0;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    t.tv_nsec += IDLE_MS * 1000000L;
    t.tv_sec += t.tv_nsec / 1000000000L;
    t.tv_nsec %= 1000000000L;
    return pthread_cond_clockwait(&q->wake, &q->lock, CLOCK_MONOTONIC, &t) != ETIMEDOUT;
}

/* The sender pays what its requests have cost so far, and later the difference. */
static struct request *queue_begin(struct queue *q, struct server *s, struct waiting *w)
{
    q->running++;
    s->sender = NULL;
    if (w->kind != QUEUE_TOKEN) {
        s->sender = w->sender;
        s->heavy = is_heavy(w);
        s->begin_ms = cpu_ms();
        s->charged_ms = w->sender->cost_ms;
        q->time_ms = fmax(q->time_ms, w->sender->time_ms);
        w->sender->time_ms += s->charged_ms;
        w->sender->running++;
        q->heavy += s->heavy;
    }
    return remove_one(q, w);
}

static void queue_end(struct queue *q, struct server *s)
{
    struct sender *of = s->sender;

    q->running--;
    q->served++;
    if (of == NULL)
        return;
    const double ms = cpu_ms() - s->begin_ms;

    of->seen_ms = logger_clock_ms();
    of->running--;
    of->time_ms += ms - s->charged_ms;
    of->cost_ms = fmax(ms, FORGET * of->cost_ms);
    q->heavy -= s->heavy;
}

/* Returns the next request.  NULL: s is to be wiped first, or *ended is set: the queue is closed and empty.
 * Without the lock. */
static struct request *queue_take(struct queue *q, struct server *s, bool was_running,
                                  bool *ended)
{
    struct request *r = NULL;
    struct waiting *w;

    (void)pthread_mutex_lock(&q->lock);
    if (was_running)
        queue_end(q, s);
    while ((w = first(q)) == NULL && !(q->closed && q->waiting == 0) &&
           wait_for_more(q, s))
        ;
    if (w != NULL)
        r = queue_begin(q, s, w);
    else
        *ended = q->closed && q->waiting == 0;
    if (first(q) != NULL)
        (void)pthread_cond_signal(&q->wake);
    if (q->closed && q->waiting == 0)
        (void)pthread_cond_broadcast(&q->wake);
    (void)pthread_mutex_unlock(&q->lock);
    return r;
}

static void wipe(struct server *s)
{
    worker_wipe(&s->worker);
    s->used = false;
    s->wiped_ms = logger_clock_ms();
}

static void *serve(void *arg)
{
    struct server *s = arg;
    bool ran = false, ended = false;

    while (!ended) {
        struct request *r = queue_take(s->queue, s, ran, &ended);

        if ((ran = r != NULL)) {
            s->queue->run(&s->worker, r);
            s->used = true;
        }
        if (s->used && (!ran || logger_clock_ms() - s->wiped_ms > BUSY_MS))
            wipe(s);
    }
    return NULL;
}

/* ---- start and stop */

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
    q->workers = workers;
    q->nsenders = limit + workers + KNOWN;
    (void)pthread_mutex_init(&q->lock, NULL);
    (void)pthread_cond_init(&q->wake, NULL);
    q->waits = calloc(limit, sizeof *q->waits);
    q->senders = calloc(q->nsenders, sizeof *q->senders);
    q->servers = calloc(workers, sizeof *q->servers);
    if (q->waits == NULL || q->senders == NULL || q->servers == NULL)
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
        q->started++;
    }
    *out = q;
    return ST_OK;
fail:
    queue_stop(q);
    queue_free(q);
    return ST_ENOMEM;
}

struct request *queue_push(struct queue *q, struct request *r, enum queue_kind kind,
                           uint64_t sender)
{
    struct request *out = NULL;
    struct waiting *worst;
    struct sender *of;

    (void)pthread_mutex_lock(&q->lock);
    of = find_sender(q, sender);
    if (q->closed) {
        out = r;
    } else if (q->waiting == q->limit) {
        worst = last(q);
        out = worst->sender->waiting > of->waiting + 1 ? remove_one(q, worst) : r;
    }
    if (out != r) {
        of->seen_ms = logger_clock_ms();
        if (of->waiting + of->running == 0) /* its unused time is lost */
            of->time_ms = fmax(of->time_ms, q->time_ms);
        of->waiting++;
        q->waits[q->waiting++] = (struct waiting){r, of, kind, ++q->serial};
        (void)pthread_cond_signal(&q->wake);
    }
    (void)pthread_mutex_unlock(&q->lock);
    return out;
}

bool queue_drop(struct queue *q, const struct request *r)
{
    bool found = false;

    (void)pthread_mutex_lock(&q->lock);
    for (unsigned i = 0; i < q->waiting && !found; i++)
        if ((found = q->waits[i].r == r))
            (void)remove_one(q, &q->waits[i]);
    (void)pthread_mutex_unlock(&q->lock);
    return found;
}

void queue_stop(struct queue *q)
{
    (void)pthread_mutex_lock(&q->lock);
    q->closed = true;
    (void)pthread_cond_broadcast(&q->wake);
    (void)pthread_mutex_unlock(&q->lock);
    for (unsigned i = 0; i < q->started; i++) {
        (void)pthread_join(q->servers[i].thread, NULL);
        worker_close(&q->servers[i].worker);
    }
    q->started = 0;
}

void queue_free(struct queue *q)
{
    if (q == NULL)
        return;
    (void)pthread_cond_destroy(&q->wake);
    (void)pthread_mutex_destroy(&q->lock);
    free(q->waits);
    free(q->senders);
    free(q->servers);
    free(q);
}

void queue_look(struct queue *q, struct queue_state *out)
{
    (void)pthread_mutex_lock(&q->lock);
    out->waiting = q->waiting;
    out->running = q->running;
    out->served = q->served;
    (void)pthread_mutex_unlock(&q->lock);
}
