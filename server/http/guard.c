#define _GNU_SOURCE /* POLLRDHUP, pthread_cond_clockwait() */
#include "guard.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "address.h"
#include "errinfo.h"
#include "logger.h"

/* File descriptors for other things: the database's, those that linger, libmicrohttpd's. */
#define OTHER_FILES 256
#define TICK_MS     200
#define LINGER_MAX  64
#define LINGER_MS   2000.0
#define LINGER_TICK 20
#define HALF_MS     2000.0 /* that work goes on for a client that closed its side */
#define REPORT_MS   10000.0
#define SETTLED_MS  1000.0 /* how long a connection is safe from others of its address */
#define NO_END      1e300

struct guard_peer {
    struct guard *guard;
    struct guard_peer *prev, *next;
    uint64_t from; /* address_key() */
    int fd;
    enum guard_step step;
    double begin_ms, end_ms;
    void (*gone)(void *arg); /* callback of GUARD_WORK; NULL: it was called */
    void *arg;
    bool cut; /* amid a body the client had gone at the last look, with nothing unread */
    bool ended; /* shut down here, and not yet closed by libmicrohttpd */
};

struct guard {
    struct guard_rules rules;
    pthread_t thread;
    pthread_mutex_t lock; /* protects the members below and every peer */
    pthread_cond_t wake;
    struct guard_peer *peers;
    struct guard_state state;
    unsigned ended;    /* open connections with ended set */
    uint64_t reported; /* refused and late connections in the last line of the log */
    double report_ms;
    bool stopping;
    int linger[LINGER_MAX]; /* sockets that are read from and shut down for writing, */
    double linger_ms[LINGER_MAX]; /* until then */
    unsigned lingering;
};

/* ---- how many */

static void guard_end(struct guard_peer *p)
{
    (void)shutdown(p->fd, SHUT_RDWR);
    p->ended = true;
    p->guard->ended++;
}

static bool is_waited_for(const struct guard_peer *p)
{
    return !p->ended && (p->step == GUARD_IDLE || p->step == GUARD_REQUEST ||
                         p->step == GUARD_HEADERS);
}

/* Returns the address with most of the connections that are waited for, by the majority vote of Boyer and
 * Moore: it finds an address that has more than half of them. */
static uint64_t crowd(const struct guard *l)
{
    uint64_t most = ADDRESS_NO_KEY;
    unsigned lead = 0;

    for (const struct guard_peer *p = l->peers; p != NULL; p = p->next) {
        if (!is_waited_for(p))
            continue;
        if (lead == 0)
            most = p->from;
        if (most == p->from)
            lead++;
        else
            lead--;
    }
    return most;
}

/* Closes the oldest connection of the crowd: at once for another address, and for its own only after
 * SETTLED_MS.  Returns false if there is none. */
static bool crowd_out(struct guard *l, uint64_t from)
{
    const uint64_t most = crowd(l);
    struct guard_peer *oldest = NULL;

    for (struct guard_peer *p = l->peers; p != NULL; p = p->next)
        if (is_waited_for(p) && p->from == most &&
            (oldest == NULL || p->begin_ms < oldest->begin_ms))
            oldest = p;
    if (oldest == NULL ||
        (most == from && logger_clock_ms() - oldest->begin_ms < SETTLED_MS))
        return false;
    guard_end(oldest);
    l->state.crowded_out++;
    return true;
}

bool guard_admit(struct guard *l, const struct sockaddr *addr)
{
    const uint64_t from = address_key(addr);
    const bool counted = from != ADDRESS_NO_KEY && l->rules.per_address > 0 &&
                         (l->rules.local_too || !address_is_local(addr));
    unsigned n = 0;
    bool ok = true;

    (void)pthread_mutex_lock(&l->lock);
    if (l->state.open - l->ended >= l->rules.connections && !crowd_out(l, from)) {
        l->state.refused_total++;
        ok = false;
    } else if (counted) {
        for (const struct guard_peer *p = l->peers; p != NULL; p = p->next)
            n += p->from == from;
        ok = n < l->rules.per_address;
        l->state.refused_address += !ok;
    }
    (void)pthread_mutex_unlock(&l->lock);
    return ok;
}

/* ---- connections */

/* The time that step has at most left. */
static double allowed_ms(const struct guard_peer *p, enum guard_step step)
{
    return 1000.0 * p->guard->rules.timeout_s *
           (step == GUARD_IDLE || step == GUARD_STREAM ? GUARD_IDLE_FACTOR : 1);
}

static void guard_begin_step(struct guard_peer *p, enum guard_step step)
{

    if (step == GUARD_HEADERS && p->step == GUARD_REQUEST)
        return;
    p->step = step;
    p->gone = NULL;
    p->cut = false;
    p->begin_ms = logger_clock_ms();
    if (step == GUARD_WORK)
        p->end_ms = NO_END;
    else
        p->end_ms = p->begin_ms + allowed_ms(p, step);
}

struct guard_peer *guard_open(struct guard *l, int fd, const struct sockaddr *addr)
{
    struct guard_peer *p = calloc(1, sizeof *p);

    if (p == NULL)
        return NULL;
    p->guard = l;
    p->fd = fd;
    p->from = address_key(addr);
    (void)pthread_mutex_lock(&l->lock);
    guard_begin_step(p, GUARD_REQUEST);
    p->next = l->peers;
    if (p->next != NULL)
        p->next->prev = p;
    else
        (void)pthread_cond_signal(&l->wake);
    l->peers = p;
    l->state.open++;
    (void)pthread_mutex_unlock(&l->lock);
    return p;
}

void guard_close(struct guard_peer *p)
{
    struct guard *l = p->guard;

    (void)pthread_mutex_lock(&l->lock);
    if (p->prev != NULL)
        p->prev->next = p->next;
    else
        l->peers = p->next;
    if (p->next != NULL)
        p->next->prev = p->prev;
    l->state.open--;
    l->ended -= p->ended;
    (void)pthread_mutex_unlock(&l->lock);
    free(p);
}

void guard_begin(struct guard_peer *p, enum guard_step step)
{
    (void)pthread_mutex_lock(&p->guard->lock);
    guard_begin_step(p, step);
    (void)pthread_mutex_unlock(&p->guard->lock);
}

void guard_work(struct guard_peer *p, void (*gone)(void *arg), void *arg)
{
    (void)pthread_mutex_lock(&p->guard->lock);
    guard_begin_step(p, GUARD_WORK);
    p->gone = gone;
    p->arg = arg;
    (void)pthread_mutex_unlock(&p->guard->lock);
}

void guard_more(struct guard_peer *p, size_t bytes)
{
    struct guard *l = p->guard;
    const double timeout_ms = 1000.0 * l->rules.timeout_s;

    (void)pthread_mutex_lock(&l->lock);
    p->cut = false;
    if (p->step == GUARD_STREAM)
        p->end_ms = logger_clock_ms() + allowed_ms(p, p->step);
    else
        p->end_ms = fmin(p->end_ms + 1000.0 * (double)bytes / GUARD_BYTES_PER_S,
                         logger_clock_ms() + timeout_ms);
    if (p->step == GUARD_BODY)
        p->end_ms = fmin(p->end_ms, p->begin_ms + GUARD_BODY_FACTOR * timeout_ms);
    (void)pthread_mutex_unlock(&l->lock);
}

void guard_note_header(struct guard *l)
{
    (void)pthread_mutex_lock(&l->lock);
    l->state.proxy_header++;
    (void)pthread_mutex_unlock(&l->lock);
}

void guard_look(struct guard *l, struct guard_state *out)
{
    (void)pthread_mutex_lock(&l->lock);
    *out = l->state;
    (void)pthread_mutex_unlock(&l->lock);
}

/* ---- late connections */

/* Logs the numbers at most every REPORT_MS: many connections may be closed at once. */
static void guard_report(struct guard *l)
{
    const struct guard_state *s = &l->state;
    uint64_t late = 0, sum;
    struct logger_line line;

    for (int i = 0; i < GUARD_NSTEPS; i++)
        late += s->late[i];
    sum = late + s->refused_total + s->refused_address + s->crowded_out;
    if (sum == l->reported || logger_clock_ms() < l->report_ms)
        return;
    l->reported = sum;
    l->report_ms = logger_clock_ms() + REPORT_MS;
    logger_begin(&line, "warn", "connections closed");
    logger_count(&line, "open", s->open);
    logger_count(&line, "late", late);
    logger_count(&line, "too_many", s->refused_total);
    logger_count(&line, "crowded_out", s->crowded_out);
    logger_count(&line, "too_many_of_one_address", s->refused_address);
    logger_end(&line);
}

/* Returns the events of a socket whose client has closed its side, or was reset; 0: neither.  Bytes that the
 * client sent before may still be unread. */
static short look_at(int fd)
{
    struct pollfd p = {.fd = fd, .events = POLLRDHUP};

    return poll(&p, 1, 0) > 0 ? p.revents : 0;
}

/* A client that gives up closes its side, as does one that only says that it has sent all and
 * waits: this one is let wait for HALF_MS. */
static bool has_gone(const struct guard_peer *p, double now)
{
    const short seen = look_at(p->fd);

    return (seen & ~POLLRDHUP) != 0 || (seen != 0 && now - p->begin_ms > HALF_MS);
}

/* libmicrohttpd (0.9.75) does not always see that a client goes amid a body, and would hold what
 * came until its time is over.  At the second look in a row it has had the time to. */
static void look_at_body(struct guard_peer *p)
{
    const bool was_cut = p->cut;
    int unread = 0;

    p->cut = look_at(p->fd) != 0 && ioctl(p->fd, FIONREAD, &unread) == 0 && unread == 0;
    if (was_cut && p->cut) {
        guard_end(p);
        p->guard->state.gone++;
    }
}

static void sweep(struct guard *l)
{
    double now = logger_clock_ms();

    for (struct guard_peer *p = l->peers; p != NULL; p = p->next) {
        if (p->gone != NULL && !p->ended && has_gone(p, now)) {
            p->gone(p->arg);
            p->gone = NULL;
            l->state.gone++;
        }
        if (p->step == GUARD_BODY && !p->ended)
            look_at_body(p);
        if (now < p->end_ms || p->ended)
            continue;
        guard_end(p);
        if (p->step != GUARD_IDLE) /* whose time is over as a matter of course */
            l->state.late[p->step]++;
    }
}

/* ---- lingering close */

void guard_linger(struct guard *l, int fd)
{
    (void)shutdown(fd, SHUT_WR);
    (void)pthread_mutex_lock(&l->lock);
    if (l->lingering < LINGER_MAX) {
        l->linger_ms[l->lingering] = logger_clock_ms() + LINGER_MS;
        l->linger[l->lingering++] = fd;
        fd = -1;
    }
    (void)pthread_cond_signal(&l->wake);
    (void)pthread_mutex_unlock(&l->lock);
    if (fd >= 0)
        (void)close(fd);
}

/* Discards the bytes that have come.  Closes each socket whose client has closed it or whose time is over. */
static void drain(struct guard *l)
{
    static char waste[65536]; /* used by this thread alone */

    for (unsigned i = l->lingering; i-- > 0;) {
        ssize_t n = 0;

        for (int k = 0;
             k < 16 && (n = recv(l->linger[i], waste, sizeof waste, MSG_DONTWAIT)) > 0;
             k++)
            continue;
        if ((n > 0 || (n < 0 && errno == EAGAIN)) &&
            logger_clock_ms() < l->linger_ms[i] && !l->stopping)
            continue;
        (void)close(l->linger[i]);
        l->linger[i] = l->linger[--l->lingering];
        l->linger_ms[i] = l->linger_ms[l->lingering];
    }
}

static void *guard_run(void *arg)
{
    struct guard *l = arg;
    struct timespec t;

    (void)pthread_mutex_lock(&l->lock);
    while (!l->stopping) {
        if (l->peers == NULL && l->lingering == 0) {
            (void)pthread_cond_wait(&l->wake, &l->lock);
            continue;
        }
        (void)clock_gettime(CLOCK_MONOTONIC, &t);
        t.tv_nsec += (l->lingering > 0 ? LINGER_TICK : TICK_MS) * 1000000L;
        if (t.tv_nsec >= 1000000000L) {
            t.tv_nsec -= 1000000000L;
            t.tv_sec++;
        }
        (void)pthread_cond_clockwait(&l->wake, &l->lock, CLOCK_MONOTONIC, &t);
        sweep(l);
        guard_report(l);
        drain(l);
    }
    drain(l);
    (void)pthread_mutex_unlock(&l->lock);
    return NULL;
}

/* ---- start and stop */

/* As many connections as there may be open files, and no more than wanted. */
static unsigned ask_for_files(unsigned wanted, rlim_t others)
{
    rlim_t need = wanted + others;
    struct logger_line line;
    struct rlimit r;

    if (getrlimit(RLIMIT_NOFILE, &r) != 0 || r.rlim_cur >= need)
        return wanted;
    if (r.rlim_max > r.rlim_cur) {
        r.rlim_cur = r.rlim_max < need ? r.rlim_max : need;
        if (setrlimit(RLIMIT_NOFILE, &r) != 0)
            (void)getrlimit(RLIMIT_NOFILE, &r);
    }
    if (r.rlim_cur >= need)
        return wanted;
    need = r.rlim_cur > 2 * others ? r.rlim_cur - others : r.rlim_cur / 2;
    logger_begin(&line, "warn",
                 "fewer connections than wanted: too few open files are allowed");
    logger_count(&line, "wanted", wanted);
    logger_count(&line, "connections", need);
    logger_count(&line, "open_files", r.rlim_cur);
    logger_end(&line);
    return (unsigned)need;
}

enum status guard_start(const struct guard_rules *rules, struct guard **out,
                        struct errinfo *e)
{
    struct guard *l;

    *out = NULL;
    l = calloc(1, sizeof *l);
    if (l == NULL)
        return errinfo_memory(e);
    l->rules = *rules;
    l->rules.connections =
        ask_for_files(rules->connections, OTHER_FILES + rules->waiting);
    (void)pthread_mutex_init(&l->lock, NULL);
    (void)pthread_cond_init(&l->wake, NULL);
    if (pthread_create(&l->thread, NULL, guard_run, l) != 0) {
        (void)pthread_cond_destroy(&l->wake);
        (void)pthread_mutex_destroy(&l->lock);
        free(l);
        return errinfo_set(e, ST_ENOMEM, "cannot start a thread");
    }
    *out = l;
    return ST_OK;
}

void guard_stop(struct guard *l)
{
    if (l == NULL)
        return;
    (void)pthread_mutex_lock(&l->lock);
    l->stopping = true;
    (void)pthread_cond_signal(&l->wake);
    (void)pthread_mutex_unlock(&l->lock);
    (void)pthread_join(l->thread, NULL);
    (void)pthread_cond_destroy(&l->wake);
    (void)pthread_mutex_destroy(&l->lock);
    free(l);
}
