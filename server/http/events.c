#define _GNU_SOURCE /* pthread_cond_clockwait() */
#include "events.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <microhttpd.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "event.h"
#include "guard.h"
#include "logger.h"
#include "mem.h"
#include "place.h"
#include "request.h"
#include "utc.h"

#define TURN    500   /* entries that are read at a time */
#define LOOK_MS 200.0 /* until another daemon's entry is seen */
/* Between two reads: entries of this time are sent together, so that many streams cost verifications little. */
#define GATHER_MS     20.0
#define GATHER_ONE_MS 0.5     /* more for each stream */
#define BEAT_MS       15000.0 /* of silence, then a heartbeat follows */
#define FAILED_MS     5000.0 /* that the log cannot be read: clients then look elsewhere */
#define CUT_MS        500.0  /* on a stop: then connections that do not take it are cut */
#define DEAD_MS       60000u /* after which a client that acknowledges nothing is gone */
#define LINE_MAX      (2 * PLACE_MAX + 1024) /* bytes of an event */

struct events_stream {
    struct events *of;
    struct events_stream *prev, *next;
    uint64_t serial;
    /* Members below are protected by the lock of `of`. */
    struct store_audit_place place; /* what the client has got, or has in the buffer */
    bool live;                      /* place is not before the head's */
    bool full, failed;              /* of the last page: no room for all; not read */
    bool ended;                     /* after the buffer the response ends */
    bool unchecked;   /* the token may have been revoked or rotated since the last look */
    int64_t until_ms; /* end of the secret, ms since 1970 */
    double wrote_ms;  /* when something was put into the buffer */
    char *buf;        /* [EVENTS_BUFFER], or NULL: empty */
    size_t from, len; /* what is in it: buf[from..len-1] */
    /* A request that waits. */
    struct request *r; /* NULL: endless */
    void (*done)(void *arg);
    void *arg;
    size_t limit, n; /* events in the buffer */
    double end_ms;
    /* A connection. */
    struct MHD_Connection *conn;
    int fd;
    bool suspended, gone;
    /* Constant. */
    char token[STORE_ID_LEN + 1], groups[GROUPS_SIZE];
    int64_t revision; /* of the token's row, when the secret was new */
    /* On the I/O thread only. */
    struct guard_peer *peer;
    bool sending;
};

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

static void release(struct events_stream *s)
{
    mem_free(s->buf);
    free(s);
}

/* ---- the buffer of a stream */

static size_t held(const struct events_stream *s)
{
    return s->len - s->from;
}

static bool put(struct events_stream *s, const char *text, size_t n)
{
    if (held(s) + n > EVENTS_BUFFER ||
        (s->buf == NULL && (s->buf = mem_array(EVENTS_BUFFER, 1)) == NULL))
        return false;
    if (s->len + n > EVENTS_BUFFER) {
        memmove(s->buf, s->buf + s->from, held(s));
        s->len -= s->from;
        s->from = 0;
    }
    memcpy(s->buf + s->len, text, n);
    s->len += n;
    s->wrote_ms = logger_clock_ms();
    return true;
}

static void resume(struct events_stream *s)
{
    if (!s->suspended)
        return;
    s->suspended = false;
    MHD_resume_connection(s->conn);
}

static void end(struct events_stream *s)
{
    s->ended = true;
    resume(s);
}

/* An event at the stream's place.  text: of event_text().  False: there is no room. */
static bool put_event(struct events_stream *s, const char *type, const char *text)
{
    char cursor[PLACE_MAX], line[LINE_MAX];
    int n;

    place_print(&s->place, cursor);
    if (s->r != NULL)
        n = snprintf(line, sizeof line, "%s{\"cursor\":\"%s\",%s", s->n > 0 ? "," : "",
                     cursor, text + 1);
    else
        n = snprintf(line, sizeof line,
                     "id: %s\nevent: %s\ndata: {\"cursor\":\"%s\",%s\n\n", cursor, type,
                     cursor, text + 1);
    if (n < 0 || (size_t)n >= sizeof line || (s->r != NULL && s->n == s->limit) ||
        !put(s, line, (size_t)n))
        return false;
    s->n++;
    s->of->state.sent++;
    resume(s);
    return true;
}

/* An id without data: a client that was sent nothing else goes on from there. */
static void put_place(struct events_stream *s, const char *comment)
{
    char cursor[PLACE_MAX], line[PLACE_MAX + 32];
    int n;

    place_print(&s->place, cursor);
    n = snprintf(line, sizeof line, "%sid: %s\n\n", comment, cursor);
    if (s->r == NULL && put(s, line, (size_t)n))
        resume(s);
}

/* ---- entries for streams */

static uint64_t *place_of(struct store_audit_place *p, const struct log_entry *entry,
                          uint32_t **mark)
{
    if (entry->log == LOG_CHANGES) {
        *mark = &p->change_mark;
        return &p->changes;
    }
    if (p->daemons <= entry->daemon)
        p->daemons = entry->daemon + 1;
    *mark = &p->access_mark[entry->daemon];
    return &p->accesses[entry->daemon];
}

static bool give_gap(struct events_stream *s, const struct log_entry *entry,
                     uint64_t *seq, uint32_t *mark)
{
    const uint64_t was = *seq;
    const uint32_t was_mark = *mark;
    char *text = event_gap(entry->at);
    bool ok;

    *seq = entry->seq - 1;
    *mark = 0;
    ok = text != NULL && put_event(s, "gap", text);
    free(text);
    if (!ok) {
        *seq = was;
        *mark = was_mark;
    }
    return ok;
}

/* text: of the event; NULL: the entry is none.  False: there was no room, and s is where it was. */
static bool give(struct events_stream *s, const struct store_audit_entry *a,
                 const char *text)
{
    const struct log_entry *entry = &a->entry;
    uint32_t *mark, was_mark;
    uint64_t *seq = place_of(&s->place, entry, &mark), was;

    if (entry->seq <= *seq)
        return true;
    if (entry->seq > *seq + 1 && !give_gap(s, entry, seq, mark))
        return false;
    was = *seq;
    was_mark = *mark;
    *seq = entry->seq;
    *mark = store_audit_mark(entry);
    if (text == NULL || !event_visible(a, s->token, s->groups) ||
        put_event(s, event_type(entry), text))
        return true;
    *seq = was;
    *mark = was_mark;
    return false;
}

/* text: as in give().  It may also be missing for lack of memory. */
static void give_all(struct events *ev, const struct store_audit_entry *a,
                     const char *text, bool missing)
{
    for (struct events_stream *s = ev->first; s != NULL; s = s->next)
        if (s->live && (missing || !give(s, a, text)))
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
            ok = !missing && give(one, &a[i], text);
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

static void shorten(struct events_stream *s, const char *until)
{
    int64_t ms;

    if (!utc_read(until, &ms))
        s->until_ms = 0;
    else if (ms < s->until_ms)
        s->until_ms = ms;
}

/* A rotation leaves the secret of s valid for a while, a second one does not. */
static void judge(struct events_stream *s, const struct store_token *t)
{
    if (t->revoked[0] != '\0' || t->revision > s->revision + 1)
        s->until_ms = 0;
    else if (t->revision != s->revision)
        shorten(s, t->old_until);
}

static void check_token(struct events *ev, struct events_stream *s)
{
    const uint64_t serial = s->serial;
    char id[STORE_ID_LEN + 1];
    struct store_token t;
    enum status st = ST_OK;

    memcpy(id, s->token, sizeof id);
    s->unchecked = false;
    (void)pthread_mutex_unlock(&ev->lock);
    if (id[0] != '\0')
        st = store_token_get(ev->app->store, "", id, &t, NULL);
    (void)pthread_mutex_lock(&ev->lock);
    if (id[0] == '\0' || (s = find(ev, serial)) == NULL)
        return;
    if (st == ST_OK)
        judge(s, &t);
    else if (st == ST_ENOTFOUND || st == ST_ECORRUPT)
        s->until_ms = 0;
    else
        s->unchecked = true;
}

static void check_tokens(struct events *ev)
{
    struct events_stream *s = ev->first;

    while (s != NULL && !s->unchecked)
        s = s->next;
    if (s != NULL)
        check_token(ev, s);
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

static bool covers(const struct store_audit_place *a, const struct store_audit_place *b)
{
    for (uint32_t i = 0; i < b->daemons; i++)
        if (a->accesses[i] < b->accesses[i])
            return false;
    return a->changes >= b->changes;
}

/* Moves p on to q: p has all that lies between. */
static void pass(struct store_audit_place *p, const struct store_audit_place *q)
{
    if (p->changes < q->changes) {
        p->changes = q->changes;
        p->change_mark = q->change_mark;
    }
    if (p->daemons < q->daemons)
        p->daemons = q->daemons;
    for (uint32_t i = 0; i < q->daemons; i++)
        if (p->accesses[i] < q->accesses[i]) {
            p->accesses[i] = q->accesses[i];
            p->access_mark[i] = q->access_mark[i];
        }
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
static void read_head(struct events *ev)
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
            pass(&s->place, &next);
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
            pass(&s->place, &next);
        s->live = !s->full && next.end && ev->begun && covers(&s->place, &ev->head);
    }
    free(list);
    return true;
}

/* The next one whose turn it is: behind, and with room. */
static struct events_stream *next_behind(const struct events *ev)
{
    struct events_stream *s = ev->first;

    while (s != NULL && (s->live || s->ended || held(s) > EVENTS_BUFFER / 2))
        s = s->next;
    return s;
}

/* ---- ends */

static void respond(struct events_stream *s, bool valid, bool failed)
{
    const size_t len = held(s), room = len + PLACE_MAX + 64;
    char cursor[PLACE_MAX], *text;

    if (!valid) {
        request_problem(s->r, ERRMAP_NO_TOKEN, "the token is not valid any more");
        s->r->response.bad_token = true;
    } else if (failed) {
        request_problem(s->r, ST_EBUSY, "the log cannot be read");
    } else {
        place_print(&s->place, cursor);
        if ((text = malloc(room)) != NULL)
            (void)snprintf(text, room, "{\"events\":[%.*s],\"next_cursor\":\"%s\"}",
                           (int)len, len > 0 ? s->buf + s->from : "", cursor);
        request_respond(s->r, 200, text);
    }
}

static void finish(struct events *ev, struct events_stream *s)
{
    void (*const done)(void *arg) = s->done;
    void *const arg = s->arg;

    unlink_one(ev, s);
    count_open(ev, -1);
    s->r->waits = NULL;
    release(s);
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
        if (s->full || (s->live && (s->n > 0 || now >= s->end_ms)) || !valid || failed ||
            ev->stopping || atomic_load(&s->r->gone)) {
            respond(s, valid, failed);
            finish(ev, s);
        }
    } else if (!valid || failed || ev->stopping) {
        s->from = s->len; /* at once */
        end(s);
    } else if (held(s) == 0 && now - s->wrote_ms >= BEAT_MS) {
        put_place(s, ":\n");
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

/* Until the head is to be read.  idle: there are no streams. */
static void events_pause(struct events *ev, bool idle)
{
    (void)pthread_mutex_lock(&ev->wake_lock);
    for (;;) {
        const double left = due_ms(ev) - logger_clock_ms();
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

static void events_round(struct events *ev)
{
    struct events_stream *s;

    if (!ev->begun)
        begin(ev);
    if (take_poke(ev))
        read_head(ev);
    check_tokens(ev);
    s = next_behind(ev);
    if (s != NULL && !turn(ev, s))
        s = NULL;
    tend(ev);
    if (s != NULL || ev->stopping)
        return;
    (void)pthread_mutex_unlock(&ev->lock);
    events_pause(ev, false);
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
        events_pause(ev, true);
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

static struct events_stream *new_stream(struct events *ev, const struct request *r,
                                        const struct store_audit_place *place)
{
    struct events_stream *s = calloc(1, sizeof *s);

    if (s == NULL)
        return NULL;
    s->of = ev;
    s->place = *place;
    s->unchecked = true;
    s->until_ms = INT64_MAX;
    if (r->token_expires[0] != '\0')
        shorten(s, r->token_expires);
    s->wrote_ms = logger_clock_ms();
    memcpy(s->token, r->actor, sizeof s->token);
    memcpy(s->groups, r->groups, sizeof s->groups);
    s->revision = r->token_revision;
    return s;
}

struct events_stream *events_open(struct events *ev, struct request *r,
                                  const struct store_audit_place *place, size_t limit,
                                  double wait_ms)
{
    struct events_stream *s = new_stream(ev, r, place);

    if (s == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for a stream of events");
        return NULL;
    }
    s->limit = limit;
    s->r = limit > 0 ? r : NULL;
    s->end_ms = logger_clock_ms() + wait_ms;
    (void)pthread_mutex_lock(&ev->lock);
    if (!has_room(ev, s->token)) {
        (void)pthread_mutex_unlock(&ev->lock);
        release(s);
        request_problem(r, ERRMAP_STREAMS,
                        "%d streams of events are open, or %d of one token",
                        EVENTS_STREAMS, EVENTS_OF_TOKEN);
        r->response.retry_after = 10;
        return NULL;
    }
    if (limit == 0)
        put_place(s, "");
    s->serial = ++ev->serial;
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
    if (s->peer != NULL)
        guard_begin(s->peer, GUARD_RESPONSE); /* on_gone() is not called any more */
    (void)pthread_mutex_lock(&ev->lock);
    unlink_one(ev, s);
    count_open(ev, -1);
    (void)pthread_mutex_unlock(&ev->lock);
    release(s);
}

/* ---- connections */

/* On the guard's thread. */
static void on_gone(void *arg)
{
    struct events_stream *s = arg;

    (void)pthread_mutex_lock(&s->of->lock);
    s->gone = true;
    resume(s);
    (void)pthread_mutex_unlock(&s->of->lock);
}

void events_attach(struct events_stream *s, struct MHD_Connection *conn,
                   struct guard_peer *peer)
{
    const unsigned ms = DEAD_MS;

    (void)pthread_mutex_lock(&s->of->lock);
    s->conn = conn;
    s->fd = MHD_get_connection_info(conn, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
    (void)setsockopt(s->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &ms, sizeof ms);
    (void)pthread_mutex_unlock(&s->of->lock);
    s->peer = peer;
    events_poke(s->of);
}

/* Takes what there is, or suspends the connection. */
static ssize_t events_take(struct events_stream *s, char *to, size_t max)
{
    const size_t n = held(s) < max ? held(s) : max;

    if (n > 0) {
        memcpy(to, s->buf + s->from, n);
        s->from += n;
    } else if (s->gone || s->ended) {
        return s->gone ? MHD_CONTENT_READER_END_WITH_ERROR
                       : MHD_CONTENT_READER_END_OF_STREAM;
    } else {
        MHD_suspend_connection(s->conn);
        s->suspended = true;
    }
    if (held(s) == 0) {
        mem_free(s->buf);
        s->buf = NULL;
        s->from = s->len = 0;
    }
    return (ssize_t)n;
}

ssize_t events_read(void *arg, uint64_t pos, char *to, size_t max)
{
    struct events_stream *s = arg;
    struct events *ev = s->of;
    bool behind;
    ssize_t n;

    (void)pos;
    (void)pthread_mutex_lock(&ev->lock);
    n = events_take(s, to, max);
    behind = !s->live && held(s) <= EVENTS_BUFFER / 2;
    (void)pthread_mutex_unlock(&ev->lock);
    if (n == 0)
        guard_work(s->peer, on_gone, s);
    else if (!s->sending)
        guard_begin(s->peer, GUARD_STREAM);
    s->sending = n != 0;
    if (n > 0)
        guard_more(s->peer, (size_t)n);
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
        if (s->conn != NULL)
            (void)shutdown(s->fd, SHUT_RDWR);
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
