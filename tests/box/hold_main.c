/* hold -- for the tests: many slow connections.
 *   hold IPv4:PORT N [--drip MS] [--deaf] < TEXT
 * Opens N connections and sends TEXT on each.  --drip: then sends an "x" every MS
 * milliseconds; --deaf: reads nothing.  Prints "sent" once TEXT is sent on all of them,
 * "answered" once all have received something, and "closed K" whenever the number of
 * connections that the other side has closed grows to K.  Ends when all are closed. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define MOST 4000

static struct pollfd conn[MOST];
static bool answered[MOST];
static unsigned n, nanswered, nclosed;

static void fail(const char *what)
{
    perror(what);
    exit(1);
}

static long now_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1000L + t.tv_nsec / 1000000L;
}

static void say(const char *what, unsigned count)
{
    if (count > 0)
        (void)printf("%s %u\n", what, count);
    else
        (void)printf("%s\n", what);
    (void)fflush(stdout);
}

static void to_address(char *text, struct sockaddr_in *in)
{
    char *colon = strchr(text, ':');

    *in = (struct sockaddr_in){.sin_family = AF_INET};
    if (colon == NULL) {
        (void)fprintf(stderr, "hold: not ADDRESS:PORT: %s\n", text);
        exit(2);
    }
    *colon = '\0';
    in->sin_port = htons((in_port_t)strtoul(colon + 1, NULL, 10));
    if (inet_pton(AF_INET, text, &in->sin_addr) != 1)
        fail(text);
}

static void connect_all(const struct sockaddr_in *in, const char *text, size_t len)
{
    const int small = 4096;

    for (unsigned i = 0; i < n; i++) {
        int fd = socket(AF_INET, SOCK_STREAM, 0);

        /* a small buffer, so that little of a response fits into it */
        if (fd < 0 || setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &small, sizeof small) != 0 ||
            connect(fd, (const struct sockaddr *)in, sizeof *in) != 0)
            fail("connect");
        (void)send(fd, text, len, MSG_NOSIGNAL); /* may fail: closed already */
        conn[i] = (struct pollfd){.fd = fd, .events = POLLIN};
    }
    say("sent", 0);
}

static void close_one(unsigned i)
{
    (void)close(conn[i].fd);
    conn[i].fd = -1;
    nclosed++;
}

static void read_one(unsigned i)
{
    char waste[4096];
    const ssize_t got = recv(conn[i].fd, waste, sizeof waste, MSG_DONTWAIT);

    if (got == 0 || (got < 0 && errno != EAGAIN))
        close_one(i);
    if (got > 0 && !answered[i]) {
        answered[i] = true;
        if (++nanswered == n)
            say("answered", 0);
    }
}

static void drip(void)
{
    for (unsigned i = 0; i < n; i++)
        if (conn[i].fd >= 0 &&
            send(conn[i].fd, "x", 1, MSG_NOSIGNAL | MSG_DONTWAIT) < 0 && errno != EAGAIN)
            close_one(i);
}

/* Polls the connections once; deaf: only for their end. */
static void look(int ms, bool deaf)
{
    if (poll(conn, n, ms) < 0)
        fail("poll");
    for (unsigned i = 0; i < n; i++) {
        if (conn[i].fd < 0 || conn[i].revents == 0)
            continue;
        if (!deaf)
            read_one(i);
        else if ((conn[i].revents & (POLLHUP | POLLERR)) != 0)
            close_one(i);
    }
}

int main(int argc, char **argv)
{
    struct rlimit files = {.rlim_cur = MOST + 50, .rlim_max = MOST + 50};
    struct sockaddr_in in;
    char text[65536];
    size_t len = fread(text, 1, sizeof text, stdin);
    long every = 0, next;
    unsigned told = 0;
    bool deaf = false;

    if (argc < 3 || (n = (unsigned)strtoul(argv[2], NULL, 10)) == 0 || n > MOST) {
        (void)fputs("hold IPv4:PORT N [--drip MS] [--deaf] < TEXT\n", stderr);
        return 2;
    }
    for (int i = 3; i < argc; i++) {
        if (strcmp(argv[i], "--drip") == 0 && i + 1 < argc)
            every = strtol(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--deaf") == 0)
            deaf = true;
    }
    (void)setrlimit(RLIMIT_NOFILE, &files); /* if it fails, the limit may be enough */
    to_address(argv[1], &in);
    connect_all(&in, text, len);
    for (unsigned i = 0; deaf && i < n; i++)
        conn[i].events = 0;
    next = now_ms() + every;
    while (nclosed < n) {
        const long left = next - now_ms();

        look(every == 0 ? -1 : left < 0 ? 0 : (int)left, deaf);
        if (every > 0 && now_ms() >= next) {
            drip();
            next += every;
        }
        if (nclosed > told)
            say("closed", told = nclosed);
    }
    return 0;
}
