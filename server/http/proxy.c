#define _GNU_SOURCE /* accept4(), sem_clockwait() */
#include "proxy.h"

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
#include <microhttpd.h>

#include "address.h"
#include "errinfo.h"
#include "guard.h"
#include "logger.h"
#include "proxy_header.h"

/* Pause after a connection could not be accepted, for example with too many open files. */
#define PAUSE_MS 100.0
/* Until libmicrohttpd is taken to have dropped the connection that it got. */
#define TAKEN_S 1

/* A connection whose header is not complete. */
struct waiter {
    struct waiter *prev, *next;
    struct sockaddr_storage own;
    socklen_t own_len;
    int fd;
    double end_ms;
    size_t n;
    unsigned char bytes[PROXY_HEADER_MAX];
};

struct proxy {
    const char *from;
    struct MHD_Daemon *daemon;
    struct guard *guard;
    pthread_t thread;
    bool stopped;
    int listen, wake, epoll;
    sem_t taken;
    /* of the thread: */
    struct waiter *first, *last; /* the oldest and the newest */
    unsigned waiting;
    double pause_ms; /* nothing is accepted until then; 0: no pause */
    struct logger_seldom seldom;
};

/* ---- to libmicrohttpd */

/* Libmicrohttpd takes over one connection at a time: so a connection is open with the guard
 * when the next one is admitted, and a busy daemon leaves clients in the kernel's queue.  It
 * closes fd if it cannot, and does not always say so: hence the time. */
static void hand_over(struct proxy *p, int fd, const struct sockaddr_storage *addr,
                      socklen_t len)
{
    struct timespec end;

    while (sem_trywait(&p->taken) == 0) /* of one that took longer */
        continue;
    if (MHD_add_connection(p->daemon, fd, (const struct sockaddr *)addr, len) != MHD_YES)
        return;
    (void)clock_gettime(CLOCK_MONOTONIC, &end);
    end.tv_sec += TAKEN_S;
    while (sem_clockwait(&p->taken, CLOCK_MONOTONIC, &end) != 0 && errno == EINTR)
        continue;
}

void proxy_taken(struct proxy *p)
{
    if (p != NULL)
        (void)sem_post(&p->taken);
}

/* ---- those that wait */

static bool watch(struct proxy *p, int fd, void *what)
{
    struct epoll_event ev = {.events = EPOLLIN, .data = {.ptr = what}};

    return epoll_ctl(p->epoll, EPOLL_CTL_ADD, fd, &ev) == 0;
}

/* NULL, and fd is closed: out of memory. */
static struct waiter *begin_waiting(struct proxy *p, int fd,
                                    const struct sockaddr_storage *own, socklen_t len)
{
    struct waiter *w = malloc(sizeof *w);

    if (w == NULL || !watch(p, fd, w)) {
        (void)close(fd);
        free(w);
        return NULL;
    }
    w->own = *own;
    w->own_len = len;
    w->fd = fd;
    w->end_ms = logger_clock_ms() + PROXY_HEADER_MS;
    w->n = 0;
    w->prev = p->last;
    w->next = NULL;
    *(p->last != NULL ? &p->last->next : &p->first) = w;
    p->last = w;
    p->waiting++;
    return w;
}

/* Its socket stays open. */
static void end_waiting(struct proxy *p, struct waiter *w)
{
    (void)epoll_ctl(p->epoll, EPOLL_CTL_DEL, w->fd, NULL);
    *(w->prev != NULL ? &w->prev->next : &p->first) = w->next;
    *(w->next != NULL ? &w->next->prev : &p->last) = w->prev;
    p->waiting--;
    free(w);
}

static void proxy_drop(struct proxy *p, struct waiter *w)
{
    const int fd = w->fd;

    end_waiting(p, w);
    (void)close(fd);
}

static void proxy_refuse(struct proxy *p, struct waiter *w, const char *why)
{
    const uint64_t n = logger_seldom(&p->seldom, logger_clock_ms());
    char host[ADDRESS_HOST_MAX];
    struct logger_line l;

    guard_note_header(p->guard);
    if (n > 0) {
        address_host((const struct sockaddr *)&w->own, host);
        logger_begin(&l, "warn", "connections of proxies closed");
        logger_count(&l, "connections", n);
        logger_text(&l, "proxy", host);
        logger_text(&l, "reason", why);
        logger_end(&l);
    }
    proxy_drop(p, w);
}

/* Nothing behind the header is read: it is libmicrohttpd's. */
static void proxy_read_header(struct proxy *p, struct waiter *w)
{
    struct proxy_header h;
    enum proxy_header_state state;
    const int fd = w->fd;

    while ((state = proxy_header_read(w->bytes, w->n, &h)) == PROXY_HEADER_MORE) {
        const ssize_t n = recv(fd, w->bytes + w->n, h.len - w->n, 0);

        if (n < 0 && (errno == EAGAIN || errno == EINTR))
            return;
        if (n <= 0 && w->n == 0) { /* as a proxy that looks whether anybody listens */
            proxy_drop(p, w);
            return;
        }
        if (n <= 0) {
            proxy_refuse(p, w, "closed before the header's end");
            return;
        }
        w->n += (size_t)n;
    }
    if (state == PROXY_HEADER_BAD) {
        proxy_refuse(p, w, h.why);
        return;
    }
    if (h.client_len == 0) {
        h.client = w->own;
        h.client_len = w->own_len;
    }
    end_waiting(p, w);
    hand_over(p, fd, &h.client, h.client_len);
}

/* ---- the thread */

static void listen_again(struct proxy *p, bool yes)
{
    struct epoll_event ev = {.events = yes ? EPOLLIN : 0};

    (void)epoll_ctl(p->epoll, EPOLL_CTL_MOD, p->listen, &ev);
    p->pause_ms = yes ? 0.0 : logger_clock_ms() + PAUSE_MS;
}

static void accept_one(struct proxy *p)
{
    struct sockaddr_storage own = {0};
    socklen_t len = sizeof own;
    struct waiter *w;
    const int fd =
        accept4(p->listen, (struct sockaddr *)&own, &len, SOCK_CLOEXEC | SOCK_NONBLOCK);

    if (fd < 0) {
        if (errno != EAGAIN && errno != EINTR && errno != ECONNABORTED)
            listen_again(p, false); /* without a pause it would be tried without end */
        return;
    }
    if (!address_in_list(p->from, (const struct sockaddr *)&own)) {
        hand_over(p, fd, &own, len);
        return;
    }
    if (p->waiting == PROXY_WAITING)
        proxy_refuse(p, p->first, "too many wait for their header");
    w = begin_waiting(p, fd, &own, len);
    if (w != NULL)
        proxy_read_header(p, w); /* the header has usually come */
}

/* Until there is something to do without an event; -1: never. */
static int idle_ms(const struct proxy *p)
{
    double end_ms = p->pause_ms, ms;

    if (p->first != NULL && (end_ms == 0.0 || p->first->end_ms < end_ms))
        end_ms = p->first->end_ms;
    ms = end_ms - logger_clock_ms();
    return end_ms == 0.0 ? -1 : ms < 0.0 ? 0 : (int)ms + 1;
}

static void *proxy_run(void *arg)
{
    struct proxy *p = arg;
    struct epoll_event ev;

    for (;;) {
        /* one at a time: an event may free the waiter of another */
        const int n = epoll_wait(p->epoll, &ev, 1, idle_ms(p));

        if (n > 0 && ev.data.ptr == p)
            return NULL;
        if (n > 0 && ev.data.ptr == NULL)
            accept_one(p);
        else if (n > 0)
            proxy_read_header(p, ev.data.ptr);
        while (p->first != NULL && p->first->end_ms <= logger_clock_ms())
            proxy_refuse(p, p->first, "the header is not complete in time");
        if (p->pause_ms != 0.0 && p->pause_ms <= logger_clock_ms())
            listen_again(p, true);
    }
}

/* ---- start and stop */

enum status proxy_start(const char *from, int fd, struct MHD_Daemon *daemon,
                        struct guard *guard, struct proxy **out, struct errinfo *e)
{
    struct proxy *p = calloc(1, sizeof *p);

    *out = NULL;
    if (p == NULL)
        return errinfo_memory(e);
    p->from = from;
    p->listen = fd;
    p->daemon = daemon;
    p->guard = guard;
    p->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    p->epoll = epoll_create1(EPOLL_CLOEXEC);
    (void)sem_init(&p->taken, 0, 0);
    *out = p;
    if (p->wake >= 0 && p->epoll >= 0 && watch(p, p->wake, p) && watch(p, fd, NULL) &&
        pthread_create(&p->thread, NULL, proxy_run, p) == 0)
        return ST_OK;
    p->stopped = true;
    proxy_free(p);
    *out = NULL;
    return errinfo_set(e, ST_ENOMEM, "cannot start a thread");
}

void proxy_stop(struct proxy *p)
{
    if (p == NULL || p->stopped)
        return;
    p->stopped = true;
    (void)eventfd_write(p->wake, 1);
    (void)pthread_join(p->thread, NULL);
    while (p->first != NULL)
        proxy_drop(p, p->first);
}

void proxy_free(struct proxy *p)
{
    if (p == NULL)
        return;
    if (p->wake >= 0)
        (void)close(p->wake);
    if (p->epoll >= 0)
        (void)close(p->epoll);
    (void)sem_destroy(&p->taken);
    free(p);
}
