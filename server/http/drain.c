#include "drain.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "logger.h"

#define DRAIN_MAX 64
#define DRAIN_MS  2000.0

struct drain {
    pthread_t thread;
    pthread_mutex_t lock;
    int wake[2];          /* a pipe: written to when there is a new one, closed to stop */
    int fresh[DRAIN_MAX]; /* under the lock: adopted, not yet with the thread */
    unsigned nfresh;
};

/* The thread's own: place 0 is the pipe. */
struct pool {
    struct pollfd poll[1 + DRAIN_MAX];
    double until_ms[1 + DRAIN_MAX];
    nfds_t n;
};

static void take_fresh(struct drain *l, struct pool *p)
{
    (void)pthread_mutex_lock(&l->lock);
    while (l->nfresh > 0) {
        int fd = l->fresh[--l->nfresh];

        if (p->n == 1 + DRAIN_MAX) {
            (void)close(fd);
            continue;
        }
        (void)shutdown(fd, SHUT_WR);
        p->poll[p->n] = (struct pollfd){.fd = fd, .events = POLLIN};
        p->until_ms[p->n++] = logger_clock_ms() + DRAIN_MS;
    }
    (void)pthread_mutex_unlock(&l->lock);
}

/* Reads and discards what is there; false when the client has closed. */
static bool throw_away(int fd)
{
    char waste[65536];

    return recv(fd, waste, sizeof waste, MSG_DONTWAIT) > 0;
}

static void *run(void *arg)
{
    struct drain *l = arg;
    struct pool p = {.n = 1};
    char waste[64];

    p.poll[0] = (struct pollfd){.fd = l->wake[0], .events = POLLIN};
    for (;;) {
        if (poll(p.poll, p.n, p.n > 1 ? 100 : -1) < 0)
            continue; /* interrupted */
        if (p.poll[0].revents != 0 && read(l->wake[0], waste, sizeof waste) == 0)
            break;
        for (nfds_t i = p.n; i-- > 1;) {
            bool keep = logger_clock_ms() < p.until_ms[i];

            if (keep && p.poll[i].revents != 0)
                keep = throw_away(p.poll[i].fd);
            if (!keep) {
                (void)close(p.poll[i].fd);
                p.poll[i] = p.poll[--p.n];
                p.until_ms[i] = p.until_ms[p.n];
            }
        }
        take_fresh(l, &p);
    }
    take_fresh(l, &p);
    while (p.n > 1)
        (void)close(p.poll[--p.n].fd);
    return NULL;
}

struct drain *drain_start(void)
{
    struct drain *l = calloc(1, sizeof *l);

    if (l == NULL)
        return NULL;
    if (pipe(l->wake) != 0) {
        free(l);
        return NULL;
    }
    for (int i = 0; i < 2; i++)
        (void)fcntl(l->wake[i], F_SETFD, FD_CLOEXEC);
    (void)fcntl(l->wake[1], F_SETFL, O_NONBLOCK);
    (void)pthread_mutex_init(&l->lock, NULL);
    if (pthread_create(&l->thread, NULL, run, l) != 0) {
        (void)close(l->wake[0]);
        (void)close(l->wake[1]);
        (void)pthread_mutex_destroy(&l->lock);
        free(l);
        return NULL;
    }
    return l;
}

void drain_adopt(struct drain *l, int fd)
{
    bool room;

    (void)pthread_mutex_lock(&l->lock);
    room = l->nfresh < DRAIN_MAX;
    if (room)
        l->fresh[l->nfresh++] = fd;
    (void)pthread_mutex_unlock(&l->lock);
    if (!room)
        (void)close(fd);
    else if (write(l->wake[1], "", 1) < 0)
        return; /* the pipe is full: the thread is awake already */
}

void drain_stop(struct drain *l)
{
    if (l == NULL)
        return;
    (void)close(l->wake[1]);
    (void)pthread_join(l->thread, NULL);
    (void)close(l->wake[0]);
    (void)pthread_mutex_destroy(&l->lock);
    free(l);
}
