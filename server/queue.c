#include "queue.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "logger.h"
#include "worker.h"

/* A worker that has had nothing to do for so long wipes what it worked with, and one that is
 * busy does so as often as this: it costs less than a thousandth of the time. */
#define IDLE_MS 200
#define BUSY_MS 500.0

/* For so long after a sender was served, another that has a request running leaves it the last free
 * worker: longer than a client needs between the response and its next request.  So a request keeps
 * a worker free for little more than this. */
#define ABOUT_MS 200.0

/* A thread and what it works with. */
struct server {
    struct queue *queue;
    struct worker worker;
    pthread_t thread;
    bool kept; /* for what is not large */
    bool used; /* since it was wiped */
    bool runs; /* what is more than a token to check, of this sender */
    uint64_t sender;
    double wiped_ms;
};

/* Start-time fair queueing: a request's turn is the one after its sender's last that waits, or
 * after the last that was served. */
struct waiting {
    struct request *r;
    enum queue_kind kind;
    uint64_t sender, turn, serial;
};

/* When a sender was last served. */
struct served {
    uint64_t sender;
    double ms;
};

struct queue {
    void (*run)(struct worker *w, struct request *r);
    pthread_mutex_t lock;
    pthread_cond_t wake, wake_kept;
    struct waiting *waits; /* [limit], in no order */
    unsigned waiting, limit, running;
    uint64_t turn; /* of the last that was served */
    uint64_t serial, served;
    struct served latest, other; /* other: the latest of another sender than latest's */
    bool kept_waits;             /* the kept worker waits for wake_kept */
    bool closed;
    unsigned workers, started;
    struct server *servers;
};

/* ---- what waits; the lock is held */

static bool before(const struct waiting *a, const struct waiting *b)
{
    if ((a->kind == QUEUE_TOKEN) != (b->kind == QUEUE_TOKEN))
        return a->kind == QUEUE_TOKEN;
    return a->turn != b->turn ? a->turn < b->turn : a->serial < b->serial;
}

static void note_served(struct queue *q, uint64_t sender)
{
    if (q->latest.sender != sender)
        q->other = q->latest;
    q->latest = (struct served){sender, logger_clock_ms()};
}

static bool was_about(const struct queue *q, uint64_t sender)
{
    const struct served *s = q->latest.sender != sender ? &q->latest : &q->other;

    return logger_clock_ms() - s->ms < ABOUT_MS;
}

/* Whether the last free worker is to be left to others than w's sender. */
static bool is_left(const struct queue *q, const struct waiting *w)
{
    bool has_one = false, others = false;

    if (w->kind == QUEUE_TOKEN || q->closed || q->running + 1 < q->workers)
        return false;
    for (const struct server *s = q->servers; s < q->servers + q->workers; s++) {
        has_one = has_one || (s->runs && s->sender == w->sender);
        others = others || (s->runs && s->sender != w->sender);
    }
    return has_one && (others || was_about(q, w->sender));
}

/* What a worker takes now; kept: the kept one. */
static struct waiting *first(struct queue *q, bool kept)
{
    struct waiting *best = NULL;

    for (struct waiting *w = q->waits; w < q->waits + q->waiting; w++)
        if ((!kept || w->kind != QUEUE_LARGE) && (best == NULL || before(w, best)) &&
            !is_left(q, w))
            best = w;
    return best;
}

static struct waiting *last(struct queue *q)
{
    struct waiting *worst = NULL;

    for (struct waiting *w = q->waits; w < q->waits + q->waiting; w++)
        if (worst == NULL || before(worst, w))
            worst = w;
    return worst;
}

static struct request *remove_one(struct queue *q, struct waiting *w)
{
    struct request *r = w->r;

    *w = q->waits[--q->waiting];
    return r;
}

static uint64_t turn_of(const struct queue *q, uint64_t sender)
{
    uint64_t turn = q->turn;

    for (const struct waiting *w = q->waits; w < q->waits + q->waiting; w++)
        if (w->sender == sender && w->turn > turn)
            turn = w->turn;
    return turn + 1;
}

/* Who waits, for what it can take; the kept worker first: it can take fewer than the others.  For
 * what is left to others, who waits looks again in IDLE_MS. */
static void wake(struct queue *q)
{
    if (q->kept_waits && first(q, true) != NULL) {
        (void)pthread_cond_signal(&q->wake_kept);
    } else if (first(q, false) != NULL) {
        (void)pthread_cond_signal(&q->wake);
    } else if (q->waiting > 0) {
        (void)pthread_cond_signal(&q->wake_kept);
        (void)pthread_cond_signal(&q->wake);
    }
}

/* ---- workers */

/* Until there may be something to take; false: nothing came for IDLE_MS, and s was used, or what
 * waits may no longer be left to others. */
static bool wait_for_more(struct queue *q, struct server *s)
{
    pthread_cond_t *wake_up = s->kept ? &q->wake_kept : &q->wake;
    struct timespec t;
    int got = 0;

    q->kept_waits = q->kept_waits || s->kept;
    if (s->used || q->waiting > 0) {
        (void)clock_gettime(CLOCK_MONOTONIC, &t);
        t.tv_nsec += IDLE_MS * 1000000L;
        t.tv_sec += t.tv_nsec / 1000000000L;
        t.tv_nsec %= 1000000000L;
        got = pthread_cond_timedwait(wake_up, &q->lock, &t);
    } else {
        (void)pthread_cond_wait(wake_up, &q->lock);
    }
    if (s->kept)
        q->kept_waits = false;
    return got != ETIMEDOUT;
}

/* The next request; NULL when the queue is closed and empty, or s is to be wiped first. */
static struct request *take(struct queue *q, struct server *s, bool was_running)
{
    struct request *r = NULL;
    struct waiting *w;

    (void)pthread_mutex_lock(&q->lock);
    q->running -= was_running;
    q->served += was_running;
    if (s->runs)
        note_served(q, s->sender);
    s->runs = false;
    while ((w = first(q, s->kept)) == NULL && !q->closed && wait_for_more(q, s))
        ;
    if ((w = first(q, s->kept)) != NULL) {
        if (w->kind != QUEUE_TOKEN && w->turn > q->turn)
            q->turn = w->turn;
        s->runs = w->kind != QUEUE_TOKEN;
        s->sender = w->sender;
        r = remove_one(q, w);
        q->running++;
    }
    wake(q); /* for what s could not take, or what could not be taken while it ran */
    (void)pthread_mutex_unlock(&q->lock);
    return r;
}

static bool is_closed(struct queue *q)
{
    bool closed;

    (void)pthread_mutex_lock(&q->lock);
    closed = q->closed;
    (void)pthread_mutex_unlock(&q->lock);
    return closed;
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
    bool ran = false;

    for (;;) {
        struct request *r = take(s->queue, s, ran);

        if ((ran = r != NULL)) {
            s->queue->run(&s->worker, r);
            s->used = true;
        } else if (!s->used && is_closed(s->queue)) {
            return NULL;
        }
        if (s->used && (!ran || logger_clock_ms() - s->wiped_ms > BUSY_MS))
            wipe(s);
    }
}

/* ---- start and stop */

static void make_conditions(struct queue *q)
{
    pthread_condattr_t attr;

    (void)pthread_condattr_init(&attr);
    (void)pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&q->wake, &attr);
    (void)pthread_cond_init(&q->wake_kept, &attr);
    (void)pthread_condattr_destroy(&attr);
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
    q->workers = workers;
    (void)pthread_mutex_init(&q->lock, NULL);
    make_conditions(q);
    q->waits = calloc(limit, sizeof *q->waits);
    q->servers = calloc(workers, sizeof *q->servers);
    if (q->waits == NULL || q->servers == NULL)
        goto fail;
    for (unsigned i = 0; i < workers; i++) {
        struct server *s = &q->servers[i];

        s->queue = q;
        s->kept = i == 0 && workers > 1;
        if (worker_open(&s->worker, app, s->kept) != ST_OK)
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
    struct waiting w = {.r = r, .kind = kind, .sender = sender}, *worst;
    struct request *out = NULL;

    (void)pthread_mutex_lock(&q->lock);
    w.turn = turn_of(q, sender);
    w.serial = ++q->serial;
    if (q->closed) {
        out = r;
    } else if (q->waiting == q->limit) {
        worst = last(q);
        out = before(&w, worst) ? remove_one(q, worst) : r;
    }
    if (out != r) {
        q->waits[q->waiting++] = w;
        wake(q);
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
    (void)pthread_cond_broadcast(&q->wake_kept);
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
    (void)pthread_cond_destroy(&q->wake_kept);
    (void)pthread_mutex_destroy(&q->lock);
    free(q->waits);
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
