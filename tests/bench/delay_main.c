/* delay FROM TO MICROSECONDS: a network that is slower than this machine's: whoever connects to the Unix
 * socket FROM talks to the one at TO, and each byte arrives so much later.  Until it is killed.
 * It shares the cores with what is measured: so it looks only at what has come, and all chunks wait in
 * one queue, as all wait equally long. */
#define _GNU_SOURCE /* epoll_pwait2 */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#define ENDS   512 /* of connections, two each */
#define CHUNK  65536
#define EVENTS 64

struct chunk {
    struct chunk *next;
    int64_t due_ns;
    int to; /* an end; -1: it was closed */
    size_t n;
    char data[];
};

static struct end {
    int fd;    /* -1: closed */
    int other; /* its index */
} end[ENDS];
static int ends;
static struct chunk *head, **tail = &head;
static int64_t delay_ns;

static int64_t now(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static int open_socket(const char *path, bool listens)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);

    (void)snprintf(at.sun_path, sizeof at.sun_path, "%s", path);
    if (listens)
        (void)unlink(path);
    if (fd >= 0 && (listens ? bind(fd, (struct sockaddr *)&at, sizeof at) != 0 ||
                                  listen(fd, 128) != 0
                            : connect(fd, (struct sockaddr *)&at, sizeof at) != 0)) {
        perror(path);
        exit(1);
    }
    return fd;
}

static void watch(int poller, int fd, int name)
{
    struct epoll_event on = {.events = EPOLLIN, .data.fd = name};

    if (fd < 0 || epoll_ctl(poller, EPOLL_CTL_ADD, fd, &on) != 0)
        exit(1);
}

static int new_end(int poller, int fd)
{
    int i = 0;

    while (i < ends && end[i].fd >= 0)
        i++;
    if (i == ENDS)
        exit(1);
    ends = i < ends ? ends : i + 1;
    end[i].fd = fd;
    watch(poller, fd, i);
    return i;
}

static void close_both(int i)
{
    const int k = end[i].other;

    for (struct chunk *c = head; c != NULL; c = c->next)
        if (c->to == i || c->to == k)
            c->to = -1;
    (void)close(end[i].fd);
    (void)close(end[k].fd);
    end[i].fd = end[k].fd = -1;
}

static void take(int i)
{
    static char data[CHUNK];
    const ssize_t n = read(end[i].fd, data, sizeof data);
    struct chunk *c = n <= 0 ? NULL : malloc(sizeof *c + (size_t)n);

    if (c == NULL) {
        close_both(i);
        return;
    }
    *c = (struct chunk){.due_ns = now() + delay_ns, .to = end[i].other, .n = (size_t)n};
    memcpy(c->data, data, c->n);
    *tail = c;
    tail = &c->next;
}

static void give(struct chunk *c)
{
    ssize_t n;

    for (size_t sent = 0; c->to >= 0 && sent < c->n; sent += (size_t)n)
        if ((n = send(end[c->to].fd, c->data + sent, c->n - sent, MSG_NOSIGNAL)) < 0) {
            close_both(c->to);
            return;
        }
}

/* What is due; when the next will be, in ns from now. */
static int64_t give_due(void)
{
    struct chunk *c;
    int64_t wait;

    while ((c = head) != NULL) {
        if ((wait = c->due_ns - now()) > 0)
            return wait;
        give(c);
        if ((head = c->next) == NULL)
            tail = &head;
        free(c);
    }
    return 1000000000;
}

int main(int argc, char **argv)
{
    struct epoll_event ready[EVENTS];
    int listener, poller;

    if (argc != 4)
        return 64;
    delay_ns = atoll(argv[3]) * 1000;
    listener = open_socket(argv[1], true);
    poller = epoll_create1(0);
    watch(poller, listener, -1);
    (void)prctl(PR_SET_TIMERSLACK, 1);
    for (;;) {
        const int64_t wait = give_due();
        const struct timespec t = {wait / 1000000000, wait % 1000000000};
        const int n = epoll_pwait2(poller, ready, EVENTS, &t, NULL);

        for (int i = 0; i < n; i++)
            if (ready[i].data.fd < 0) {
                const int a = new_end(poller, accept(listener, NULL, NULL));
                const int b = new_end(poller, open_socket(argv[2], false));

                end[a].other = b;
                end[b].other = a;
            } else if (end[ready[i].data.fd].fd >= 0) {
                take(ready[i].data.fd);
            }
    }
}
