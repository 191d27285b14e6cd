#define _GNU_SOURCE /* pthread_cond_clockwait() */
#include "events.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "event.h"
#include "guard.h"
#include "logger.h"
#include "mem.h"
#include "place.h"
#include "request.h"
#include "stream.h"
#include "utc.h"

#define TURN    500   /* entries that are read at a time */
#define LOOK_MS 200.0 /* until another daemon's entry is seen */
/* Between two reads: entries of this time are sent together, so that many streams cost verifications little. */
#define GATHER_MS     20.0
#define GATHER_ONE_MS 1.0     /* more for each stream */
#define BEAT_MS       15000.0 /* of silence, then a heartbeat follows */
#define SCAN_MS                                                                          \
    2000.0 /* that the log is searched for what a token may see, then a page is empty */
#define FAILED_MS 5000.0 /* that the log cannot be read: clients then look elsewhere */
#define CUT_MS    500.0  /* on a stop: then connections that do not take it are cut */
#define DEAD_MS   60000u /* after which a client that acknowledges nothing is gone */

struct events {
    struct app *app;
    pthread_t thread;
    pthread_mutex_t lock; /* streams and counters; never held while the log is read */
    struct events_stream *first, *last;
    struct events_state state;
    uint64_t serial;
    bool stopping;
    pthread_mutex_t wake_lock; /* the last to be taken */
    pthread_cond_t wake;
    bool poked;
    atomic_uint open; /* as state.open */
    /* On the thread only. */
    struct store_audit_place head; /* what live streams have seen */
    bool begun;                    /* head is set */
    double read_ms, good_ms;       /* when the head was read last, and without an error */
    double rest_ms;                /* until then no page is read for one stream */
};

/* ---- the list */

static void link_last(struct events *ev, struct events_stream *s)
{
    s->prev = ev->last;
    s->next = NULL;
    if (ev->last != NULL)
        ev->last->next = s;
    else
        ev->first = s;
    ev->last = s;
}

/* Its turn is the next: a client waits for the page. */
static void link_first(struct events *ev, struct events_stream *s)
{
    s->prev = NULL;
    s->next = ev->first;
    if (ev->first != NULL)
        ev->first->prev = s;
    else
        ev->last = s;
    ev->first = s;
}

static void unlink_one(struct events *ev, struct events_stream *s)
{
    if (s->prev != NULL)
        s->prev->next = s->next;
    else
        ev->first = s->next;
    if (s->next != NULL)
        s->next->prev = s->prev;
    else
        ev->last = s->prev;
}

static void count_open(struct events *ev, int more)
{
    ev->state.open += (unsigned)more;
    atomic_store(&ev->open, ev->state.open);
}

/* text: as in stream_give().  It may also be missing for lack of memory. */
static void give_all(struct events *ev, const struct store_audit_entry *a,
                     const char *text, bool missing)
{
    for (struct events_stream *s = ev->first; s != NULL; s = s->next)
        if (s->live && (missing || !stream_give(s, a, text)))
            s->live = false; /* it goes on by pages of its own */
}

/* To one stream, or, if it is NULL, to all that are live.  Returns the number of entries that the one has got. */
static size_t deliver(struct events *ev, const struct store_audit_entry *a, size_t n,
                      struct events_stream *one)
{
    size_t i;
    bool ok = true;

    for (i = 0; i < n && ok; i++) {
        const bool event = event_type(&a[i].entry) != NULL;
        char *text = event ? event_text(&a[i]) : NULL;
        const bool missing = event && text == NULL;

        if (one == NULL)
            give_all(ev, &a[i], text, missing);
        else
            ok = !missing && stream_give(one, &a[i], text);
        free(text);
    }
    return ok ? i : i - 1;
}

/* ---- tokens */

/* The entry may end streams of a token. */
static void notice(struct events *ev, const struct log_entry *entry)
{
    if (strcmp(entry->kind, "revoke_token") != 0 &&
        strcmp(entry->kind, "rotate_token") != 0)
        return;
    for (struct events_stream *s = ev->first; s != NULL; s = s->next)
        if (strcmp(s->token, entry->object) == 0)
            s->unchecked = true;
}

/* Where s is now; NULL: it was closed while the lock was not held. */
static struct events_stream *find(const struct events *ev, uint64_t serial)
{
    struct events_stream *s = ev->first;

    while (s != NULL && s->serial != serial)
        s = s->next;
    return s;
}

/* False: the row cannot be read now. */
static bool check_token(struct events *ev, struct events_stream *s)
{
    const uint64_t serial = s->serial;
    char id[STORE_ID_LEN + 1];
    struct store_token t;
    enum status st = ST_OK;

    s->unchecked = false;
    if (s->token[0] == '\0')
        return true;
    memcpy(id, s->token, sizeof id);
    (void)pthread_mutex_unlock(&ev->lock);
    st = store_token_get(ev->app->store, "", id, &t, NULL);
    (void)pthread_mutex_lock(&ev->lock);
    if ((s = find(ev, serial)) == NULL)
        return true;
    if (st == ST_OK)
        stream_judge(s, &t);
    else if (st == ST_ENOTFOUND || st == ST_ECORRUPT)
        s->until_ms = 0;
    else
        s->unchecked = true;
    return !s->unchecked;
}

static void check_tokens(struct events *ev)
{
    struct events_stream *s;

    do
        for (s = ev->first; s != NULL && !s->unchecked; s = s->next)
            continue;
    while (s != NULL && check_token(ev, s));
}

/* ---- reading the log */

static bool read_log(struct events *ev, const struct store_audit_place *from,
                     struct store_audit_entry **list, size_t *n,
                     struct store_audit_place *next)
{
    const struct store_audit_filter all = {.from = *from, .most = TURN, .names = true};
    struct errinfo e;
    enum status st;

    (void)pthread_mutex_unlock(&ev->lock);
    st = store_audit_list(ev->app->store, &all, list, n, next, &e);
    (void)pthread_mutex_lock(&ev->lock);
    if (st == ST_OK)
        ev->good_ms = logger_clock_ms();
    return st == ST_OK;
}

static void begin(struct events *ev)
{
    enum status st;

    (void)pthread_mutex_unlock(&ev->lock);
    st = store_audit_end(ev->app->store, &ev->head, NULL);
    (void)pthread_mutex_lock(&ev->lock);
    ev->begun = st == ST_OK;
    if (ev->begun)
        ev->good_ms = logger_clock_ms();
}

/* Reads what has come since, for all streams that are live. */
static void events_read_head(struct events *ev)
{
    struct store_audit_entry *list = NULL;
    struct store_audit_place next;
    size_t n = 0;

    ev->read_ms = logger_clock_ms();
    if (!ev->begun || !read_log(ev, &ev->head, &list, &n, &next))
        return;
    for (size_t i = 0; i < n; i++)
        notice(ev, &list[i].entry);
    deliver(ev, list, n, NULL);
    free(list);
    ev->head = next;
    for (struct events_stream *s = ev->first; s != NULL; s = s->next)
        if (s->live)
            stream_pass(&s->place, &next);
    if (!next.end)
        events_poke(ev);
}

/* One page for a stream that is behind.  False: the log cannot be read. */
static bool turn(struct events *ev, struct events_stream *s)
{
    const struct store_audit_place from = s->place;
    const uint64_t serial = s->serial;
    struct store_audit_entry *list = NULL;
    struct store_audit_place next;
    size_t n = 0;

    unlink_one(ev, s); /* the next turn is another's */
    link_last(ev, s);
    if (!read_log(ev, &from, &list, &n, &next)) {
        if ((s = find(ev, serial)) != NULL)
            s->failed = true;
        return false;
    }
    if ((s = find(ev, serial)) != NULL) {
        s->full = deliver(ev, list, n, s) < n;
        if (!s->full)
            stream_pass(&s->place, &next);
        s->live =
            !s->full && next.end && ev->begun && stream_covers(&s->place, &ev->head);
    }
    free(list);
    return true;
}

/* The next one whose turn it is: behind, and with room. */
static struct events_stream *next_behind(const struct events *ev)
{
    struct events_stream *s = ev->first;

    while (s != NULL && (s->live || s->ended || stream_held(s) > STREAM_BUFFER / 2))
        s = s->next;
    return s;
}

/* ---- ends */

static void finish(struct events *ev, struct events_stream *s)
{
    void (*const done)(void *arg) = s->done;
    void *const arg = s->arg;

    unlink_one(ev, s);
    count_open(ev, -1);
    s->r->waits = NULL;
    stream_free(s);
    done(arg);
}

static void tend_one(struct events *ev, struct events_stream *s, double now, int64_t ms)
{
    const bool valid = ms < s->until_ms;
    const bool failed =
        now - ev->good_ms > FAILED_MS || (s->failed && s->r != NULL && s->n == 0);

    if (s->r != NULL) {
        if (s->done == NULL) /* its worker still has it */
            return;
        if (s->full || (s->live && s->n > 0) ||
            now >= s->end_ms + (s->live ? 0 : SCAN_MS) || !valid || failed ||
            ev->stopping || atomic_load(&s->r->gone)) {
            stream_respond(s, valid, failed);
            finish(ev, s);
        }
    } else if (!valid || failed || ev->stopping) {
        s->from = s->len; /* at once */
        stream_end(s);
    } else if (stream_held(s) == 0 && now - s->wrote_ms >= BEAT_MS) {
        stream_put_place(s, ":\n");
    }
}

static void tend(struct events *ev)
{
    const double now = logger_clock_ms();
    struct events_stream *next;
    int64_t ms = 0;

    (void)utc_now(&ms);
    for (struct events_stream *s = ev->first; s != NULL; s = next) {
        next = s->next;
        tend_one(ev, s, now, ms);
    }
}

/* ---- the thread */

/* When the head is to be read. */
static double due_ms(const struct events *ev)
{
    return ev->read_ms +
           (ev->poked ? GATHER_MS + GATHER_ONE_MS * atomic_load(&ev->open) : LOOK_MS);
}

static bool take_poke(struct events *ev)
{
    bool due;

    (void)pthread_mutex_lock(&ev->wake_lock);
    due = logger_clock_ms() >= due_ms(ev);
    if (due)
        ev->poked = false;
    (void)pthread_mutex_unlock(&ev->wake_lock);
    return due;
}

/* Until the head is to be read, or, with behind, a page for a stream.  idle: there are no streams. */
static void events_pause(struct events *ev, bool idle, bool behind)
{
    (void)pthread_mutex_lock(&ev->wake_lock);
    for (;;) {
        const double until = behind ? fmin(due_ms(ev), ev->rest_ms) : due_ms(ev);
        const double left = until - logger_clock_ms();
        struct timespec t;

        if (idle ? ev->poked : left <= 0)
            break;
        (void)clock_gettime(CLOCK_MONOTONIC, &t);
        t.tv_nsec += idle ? 0 : (long)(left * 1e6) + 1;
        t.tv_sec += idle ? 3600 : t.tv_nsec / 1000000000;
        t.tv_nsec %= 1000000000;
        (void)pthread_cond_clockwait(&ev->wake, &ev->wake_lock, CLOCK_MONOTONIC, &t);
    }
    (void)pthread_mutex_unlock(&ev->wake_lock);
}

/* Then rests as long as it took: streams that are behind leave half of a processor to verifications. */
static void take_turn(struct events *ev)
{
    const double begun = logger_clock_ms();
    struct events_stream *s = begun >= ev->rest_ms ? next_behind(ev) : NULL;

    if (s != NULL)
        ev->rest_ms = turn(ev, s) ? 2 * logger_clock_ms() - begun : begun + LOOK_MS;
}

static void events_round(struct events *ev)
{
    bool behind;

    if (!ev->begun)
        begin(ev);
    if (take_poke(ev))
        events_read_head(ev);
    check_tokens(ev);
    take_turn(ev);
    tend(ev);
    behind = next_behind(ev) != NULL;
    if (ev->stopping)
        return;
    (void)pthread_mutex_unlock(&ev->lock);
    events_pause(ev, false, behind);
    (void)pthread_mutex_lock(&ev->lock);
}

static void *events_run(void *arg)
{
    struct events *ev = arg;

    (void)pthread_mutex_lock(&ev->lock);
    while (!ev->stopping) {
        if (ev->first != NULL) {
            events_round(ev);
            continue;
        }
        ev->begun = false;
        (void)pthread_mutex_unlock(&ev->lock);
        events_pause(ev, true, false);
        (void)pthread_mutex_lock(&ev->lock);
        ev->good_ms = logger_clock_ms();
    }
    tend(ev);
    (void)pthread_mutex_unlock(&ev->lock);
    return NULL;
}

static void wake_up(struct events *ev)
{
    (void)pthread_mutex_lock(&ev->wake_lock);
    ev->poked = true;
    (void)pthread_cond_signal(&ev->wake);
    (void)pthread_mutex_unlock(&ev->wake_lock);
}

void events_poke(struct events *ev)
{
    if (atomic_load(&ev->open) > 0)
        wake_up(ev);
}

/* ---- streams */

/* False: there are too many. */
static bool has_room(const struct events *ev, const char *token)
{
    unsigned own = 0;

    for (const struct events_stream *s = ev->first; s != NULL; s = s->next)
        own += strcmp(s->token, token) == 0;
    return !ev->stopping && ev->state.open < EVENTS_STREAMS &&
           (token[0] == '\0' || own < EVENTS_OF_TOKEN);
}

struct events_stream *events_open(struct events *ev, struct request *r,
                                  const struct store_audit_place *place, size_t limit,
                                  double wait_ms)
{
    struct events_stream *s = stream_new(ev, r, place);

    if (s == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for a stream of events");
        return NULL;
    }
    s->sent = &ev->state.sent;
    s->limit = limit;
    s->r = limit > 0 ? r : NULL;
    s->end_ms = logger_clock_ms() + wait_ms;
    (void)pthread_mutex_lock(&ev->lock);
    if (!has_room(ev, s->token)) {
        (void)pthread_mutex_unlock(&ev->lock);
        stream_free(s);
        request_problem(r, ERRMAP_STREAMS,
                        "%d streams of events are open, or %d of one token",
                        EVENTS_STREAMS, EVENTS_OF_TOKEN);
        r->response.retry_after = 10;
        return NULL;
    }
    if (limit == 0)
        stream_put_place(s, "");
    s->serial = ++ev->serial;
    if (limit > 0)
        link_first(ev, s);
    else
        link_last(ev, s);
    count_open(ev, 1);
    (void)pthread_mutex_unlock(&ev->lock);
    return s;
}

void events_wait(struct events_stream *s, void (*done)(void *arg), void *arg)
{
    struct events *ev = s->of;

    (void)pthread_mutex_lock(&ev->lock);
    s->done = done;
    s->arg = arg;
    if (ev->stopping)
        tend_one(ev, s, logger_clock_ms(), 0);
    (void)pthread_mutex_unlock(&ev->lock);
    events_poke(ev);
}

void events_close(void *arg)
{
    struct events_stream *s = arg;
    struct events *ev;

    if (s == NULL)
        return;
    ev = s->of;
    if (s->to.place != NULL)
        guard_begin(s->to.place, GUARD_RESPONSE); /* on_gone() is not called any more */
    (void)pthread_mutex_lock(&ev->lock);
    unlink_one(ev, s);
    count_open(ev, -1);
    (void)pthread_mutex_unlock(&ev->lock);
    stream_free(s);
}

/* ---- connections */

/* On the guard's thread. */
static void on_gone(void *arg)
{
    struct events_stream *s = arg;

    (void)pthread_mutex_lock(&s->of->lock);
    s->gone = true;
    stream_end(s);
    (void)pthread_mutex_unlock(&s->of->lock);
}

void events_attach(struct events_stream *s, const struct stream_connection *to)
{
    const unsigned ms = DEAD_MS;
    const int bytes = STREAM_BUFFER;

    (void)setsockopt(to->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &ms, sizeof ms);
    /* Else the kernel would hold megabytes for each client that does not read. */
    (void)setsockopt(to->fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    (void)pthread_mutex_lock(&s->of->lock);
    s->to = *to;
    (void)pthread_mutex_unlock(&s->of->lock);
    events_poke(s->of);
}

ssize_t events_read(struct events_stream *s, char *to, size_t max)
{
    struct events *ev = s->of;
    bool behind;
    ssize_t n;

    (void)pthread_mutex_lock(&ev->lock);
    n = stream_take(s, to, max);
    behind = !s->live && stream_held(s) <= STREAM_BUFFER / 2;
    (void)pthread_mutex_unlock(&ev->lock);
    if (n == 0)
        guard_work(s->to.place, on_gone, s);
    else if (!s->sending)
        guard_begin(s->to.place, GUARD_STREAM);
    s->sending = n != 0;
    if (n > 0)
        guard_more(s->to.place, (size_t)n);
    if (behind && n > 0)
        events_poke(ev);
    return n;
}

/* ---- start and stop */

void events_look(struct events *ev, struct events_state *out)
{
    (void)pthread_mutex_lock(&ev->lock);
    *out = ev->state;
    (void)pthread_mutex_unlock(&ev->lock);
}

struct events *events_start(struct app *app)
{
    struct events *ev = calloc(1, sizeof *ev);

    if (ev == NULL)
        return NULL;
    ev->app = app;
    (void)pthread_mutex_init(&ev->lock, NULL);
    (void)pthread_mutex_init(&ev->wake_lock, NULL);
    (void)pthread_cond_init(&ev->wake, NULL);
    if (pthread_create(&ev->thread, NULL, events_run, ev) == 0)
        return ev;
    ev->stopping = true; /* there is no thread */
    events_free(ev);
    return NULL;
}

void events_stop(struct events *ev)
{
    const struct timespec pause = {0, 5 * 1000 * 1000};
    const double until = logger_clock_ms() + CUT_MS;
    bool stopped;

    if (ev == NULL)
        return;
    (void)pthread_mutex_lock(&ev->lock);
    stopped = ev->stopping;
    ev->stopping = true;
    (void)pthread_mutex_unlock(&ev->lock);
    if (stopped)
        return;
    wake_up(ev);
    (void)pthread_join(ev->thread, NULL);
    while (atomic_load(&ev->open) > 0 && logger_clock_ms() < until)
        (void)nanosleep(&pause, NULL);
    (void)pthread_mutex_lock(&ev->lock);
    for (struct events_stream *s = ev->first; s != NULL; s = s->next)
        if (s->to.conn != NULL)
            (void)shutdown(s->to.fd, SHUT_RDWR);
    (void)pthread_mutex_unlock(&ev->lock);
}

void events_free(struct events *ev)
{
    if (ev == NULL)
        return;
    events_stop(ev);
    (void)pthread_cond_destroy(&ev->wake);
    (void)pthread_mutex_destroy(&ev->wake_lock);
    (void)pthread_mutex_destroy(&ev->lock);
    free(ev);
}
