/* delay FROM TO MICROSECONDS: a network that is slower than this machine's: whoever connects to the Unix
 * socket FROM talks to the one at TO, and each byte arrives so much later.  Until it is killed. */
#define _GNU_SOURCE /* ppoll */
#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#define ENDS  512 /* of connections, two each */
#define CHUNK 65536

struct chunk {
    struct chunk *next;
    int64_t due_ns;
    size_t n, sent;
    char data[CHUNK];
};

struct end {
    int fd;             /* -1: closed */
    int other;          /* its index */
    struct chunk *head; /* to be sent here */
    struct chunk **tail;
};

static struct end end[ENDS];
static int ends;
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

static int new_end(int fd)
{
    int i = 0;

    while (i < ends && end[i].fd >= 0)
        i++;
    if (i == ENDS)
        exit(1);
    ends = i < ends ? ends : i + 1;
    end[i] = (struct end){.fd = fd};
    end[i].tail = &end[i].head;
    return i;
}

static void close_both(int i)
{
    const int pair[] = {i, end[i].other};

    for (int k = 0; k < 2; k++) {
        struct end *x = &end[pair[k]];
        struct chunk *c;

        while ((c = x->head) != NULL) {
            x->head = c->next;
            free(c);
        }
        (void)close(x->fd);
        x->fd = -1;
    }
}

static void take(int i)
{
    struct chunk *c = malloc(sizeof *c);
    struct end *to = &end[end[i].other];
    const ssize_t n = c == NULL ? -1 : read(end[i].fd, c->data, sizeof c->data);

    if (n <= 0) {
        free(c);
        close_both(i);
        return;
    }
    c->next = NULL;
    c->due_ns = now() + delay_ns;
    c->n = (size_t)n;
    c->sent = 0;
    *to->tail = c;
    to->tail = &c->next;
}

/* What is due; when the next will be, in ns from now. */
static int64_t give(int i, int64_t least)
{
    struct end *x = &end[i];
    struct chunk *c;

    while (x->fd >= 0 && (c = x->head) != NULL) {
        const int64_t wait = c->due_ns - now();
        ssize_t n;

        if (wait > 0)
            return wait < least ? wait : least;
        if ((n = send(x->fd, c->data + c->sent, c->n - c->sent, MSG_NOSIGNAL)) < 0) {
            close_both(i);
            return least;
        }
        if ((c->sent += (size_t)n) < c->n)
            continue;
        if ((x->head = c->next) == NULL)
            x->tail = &x->head;
        free(c);
    }
    return least;
}

int main(int argc, char **argv)
{
    int listener;

    if (argc != 4)
        return 64;
    delay_ns = atoll(argv[3]) * 1000;
    listener = open_socket(argv[1], true);
    (void)prctl(PR_SET_TIMERSLACK, 1);
    for (;;) {
        struct pollfd fd[ENDS + 1] = {{.fd = listener, .events = POLLIN}};
        const int n = ends;
        int64_t wait = 1000000000;
        struct timespec t;

        for (int i = 0; i < n; i++)
            wait = give(i, wait);
        for (int i = 0; i < n; i++)
            fd[i + 1] = (struct pollfd){.fd = end[i].fd, .events = POLLIN};
        t = (struct timespec){wait / 1000000000, wait % 1000000000};
        if (ppoll(fd, (nfds_t)n + 1, &t, NULL) < 0 && errno != EINTR)
            return 1;
        for (int i = 0; i < n; i++)
            if (fd[i + 1].revents != 0 && end[i].fd >= 0)
                take(i);
        if (fd[0].revents != 0) {
            const int a = new_end(accept(listener, NULL, NULL));
            const int b = new_end(open_socket(argv[2], false));

            end[a].other = b;
            end[b].other = a;
        }
    }
}
