/* http_fuzz -- sends a daemon requests with changed bytes: request line, headers, chunks,
 * bodies.  The same seed gives the same requests.
 * Usage: http_fuzz PORT COUNT SEED FILE...   each FILE one or more valid requests, raw
 * Prints the number of responses of each status.  Exit status: 1 if a response is not HTTP or
 * is a 500, or a request is neither read nor rejected; 2 if nothing can be sent. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define FILES_MAX   64
#define REQUEST_MAX (1 << 20) /* of a request, changed or not */
#define PATIENCE    30        /* ms without a byte once all is sent */
#define STUCK       60000
#define STATUS_MAX  600

struct bytes {
    unsigned char *at;
    size_t len;
};

static struct bytes files[FILES_MAX], work;
static size_t nfiles;
static unsigned long statuses[STATUS_MAX];
static uint64_t state;

static uint64_t draw(void) /* splitmix64 */
{
    uint64_t z = state += UINT64_C(0x9E3779B97F4A7C15);

    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static size_t below(size_t n)
{
    return n == 0 ? 0 : (size_t)(draw() % n);
}

static void read_file(const char *path)
{
    FILE *f = fopen(path, "rb");
    struct bytes *b = &files[nfiles];

    b->at = malloc(REQUEST_MAX);
    if (f == NULL || b->at == NULL) {
        perror(path);
        exit(2);
    }
    b->len = fread(b->at, 1, REQUEST_MAX, f);
    (void)fclose(f);
    if (b->len == 0) {
        fprintf(stderr, "%s is empty\n", path);
        exit(2);
    }
    nfiles++;
}

/* ---- changes */

/* Replaces del bytes at p by n others; bytes that do not fit are dropped. */
static void splice(size_t p, size_t del, const void *with, size_t n)
{
    if (del > work.len - p)
        del = work.len - p;
    if (work.len - del + n > REQUEST_MAX)
        return;
    memmove(work.at + p + n, work.at + p + del, work.len - p - del);
    if (n > 0)
        memcpy(work.at + p, with, n);
    work.len = work.len - del + n;
}

/* Words that have a meaning in HTTP or in bodies. */
static const char *const words[] = {
    "\r\n",
    "\n",
    "\r",
    "\r\n\r\n",
    " ",
    "\t",
    ":",
    ";",
    ",",
    "%",
    "%00",
    "%2F",
    "%zz",
    "/",
    "/../",
    "//",
    "?",
    "&",
    "=",
    "#",
    "\"",
    "\\",
    "{",
    "}",
    "[[[[",
    "null",
    "1e999",
    "-1",
    "0",
    "0x10",
    "+5",
    "99999999999999999999",
    "18446744073709551615",
    "ffffffffffffffff",
    "HTTP/1.0",
    "HTTP/0.9",
    "HTTP/2.0",
    "HEAD",
    "OPTIONS",
    "CONNECT",
    "*",
    "GET",
    "\r\nContent-Length: 5\r\n",
    "\r\nContent-Length: -1\r\n",
    "\r\nTransfer-Encoding: chunked\r\n",
    "\r\nTransfer-Encoding: gzip, chunked\r\n",
    "\r\nExpect: 100-continue\r\n",
    "\r\nConnection: keep-alive\r\n",
    "\r\nConnection: close\r\n",
    "\r\nContent-Encoding: gzip\r\n",
    "\r\nContent-Encoding: zstd\r\n",
    "\r\nHost:\r\n",
    "\r\n folded: line\r\n",
    "\r\nX-Request-Id: a\tb\r\n",
    "\r\nPrefer: return=\"minimal\r\n",
    "\r\nCookie: a=b; c\r\n",
    "\r\nUpgrade: h2c\r\n",
    "\r\n0\r\n\r\n",
    "\r\n1;x=y\r\nz\r\n",
    "\r\nffffffff\r\n",
    "\r\nAuthorization: Bearer \r\n",
    "\xff\xfe",
    "\xc0\x80",
    "nan",
    "element vertex 4294967295\n",
    "property list uchar int x\n",
};

static void insert_word(size_t p)
{
    const char *w = words[below(sizeof words / sizeof *words)];

    splice(p, below(3) == 0 ? strlen(w) : 0, w, strlen(w));
}

static void insert_many(size_t p)
{
    static unsigned char run[70000];
    size_t n = below(8) == 0 ? sizeof run : below(300);

    memset(run, (int)below(256), n);
    splice(p, 0, run, n);
}

static void change(void)
{
    /* Most changes hit the head: it is short, and most of the parsing is there. */
    size_t head = work.len < 400 ? work.len : 400;
    size_t p = below(below(10) < 7 ? head : work.len);
    size_t q = below(nfiles), from, n;
    unsigned char byte = (unsigned char)draw();

    if (work.len == 0)
        return;
    switch (below(9)) {
    case 0:
        work.at[p] ^= (unsigned char)(1U << below(8));
        break;
    case 1:
        work.at[p] = byte;
        break;
    case 2:
        splice(p, 0, &byte, 1);
        break;
    case 3:
        splice(p, 1 + below(below(4) == 0 ? work.len : 16), NULL, 0);
        break;
    case 4: /* twice */
        n = 1 + below(work.len - p < 200 ? work.len - p : 200);
        if (work.len + n <= REQUEST_MAX) {
            memmove(work.at + p + n, work.at + p, work.len - p);
            work.len += n;
        }
        break;
    case 5:
        work.len = below(4) == 0 ? p : work.len;
        break;
    case 6: /* a piece of another request */
        from = below(files[q].len);
        splice(p, below(100), files[q].at + from, below(files[q].len - from));
        break;
    case 7:
        insert_many(p);
        break;
    default:
        insert_word(p);
    }
}

static void make_request(void)
{
    const struct bytes *b = &files[below(nfiles)];

    memcpy(work.at, b->at, b->len);
    work.len = b->len;
    for (size_t n = below(20) == 0 ? 0 : 1 + below(4); n > 0; n--)
        change();
}

/* ---- the exchange */

static int dial(const struct sockaddr_in *to)
{
    int fd = socket(AF_INET, SOCK_STREAM, 0);

    if (fd < 0 || connect(fd, (const struct sockaddr *)to, sizeof *to) != 0) {
        perror("connect");
        exit(2);
    }
    return fd;
}

/* Appends the received bytes to got (*len); false at the end of the connection. */
static bool take(int fd, char *got, size_t *len, size_t size)
{
    char rest[4096];
    ssize_t n = *len < size ? recv(fd, got + *len, size - *len, MSG_DONTWAIT)
                            : recv(fd, rest, sizeof rest, MSG_DONTWAIT);

    if (n > 0 && *len < size)
        *len += (size_t)n;
    return n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
}

/* Sends the request in pieces while it reads the response, shuts down its side, and reads the
 * rest.  A partial request gets no response before the daemon's time-out, which is not waited
 * for.  False: the daemon neither reads the request nor closes the connection. */
static bool exchange(int fd, char *got, size_t *len, size_t size)
{
    size_t sent = 0, piece = below(3) == 0 ? 1 + below(50) : REQUEST_MAX;
    bool all = false;

    for (;;) {
        struct pollfd p = {.fd = fd, .events = (short)(all ? POLLIN : POLLIN | POLLOUT)};

        if (poll(&p, 1, all ? PATIENCE : STUCK) == 0)
            return all;
        if ((p.revents & (POLLIN | POLLHUP | POLLERR)) && !take(fd, got, len, size))
            return true;
        if (!all && (p.revents & POLLOUT)) {
            size_t left = work.len - sent;
            ssize_t n = send(fd, work.at + sent, left < piece ? left : piece,
                             MSG_NOSIGNAL | MSG_DONTWAIT);

            if (n > 0)
                sent += (size_t)n;
            if (sent >= 400) /* small pieces for the head alone */
                piece = REQUEST_MAX;
            all = sent == work.len || (n < 0 && errno != EAGAIN && errno != EINTR);
            if (all)
                (void)shutdown(fd, SHUT_WR);
        }
    }
}

/* Prints the request and its response. */
static void show(const char *what, unsigned long serial, const char *got, size_t len)
{
    printf("request %lu: %s\n--- sent, %zu bytes:\n%.*s\n--- got:\n%.*s\n", serial, what,
           work.len, (int)(work.len < 600 ? work.len : 600), (const char *)work.at,
           (int)len, got);
}

static bool run_one(const struct sockaddr_in *to, unsigned long serial)
{
    char got[512];
    size_t len = 0;
    int fd, status = 0;
    bool taken = true;
    const struct linger reset = {.l_onoff = 1, .l_linger = 0};

    make_request();
    fd = dial(to);
    if (below(16) == 0) { /* closed before the response */
        (void)send(fd, work.at, work.len, MSG_NOSIGNAL | MSG_DONTWAIT);
    } else {
        taken = exchange(fd, got, &len, sizeof got - 1);
    }
    /* Resets the connection: after a mere close the daemon may wait for its time-out and run
     * out of connections. */
    (void)setsockopt(fd, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
    (void)close(fd);
    got[len] = '\0';
    if (!taken) {
        show("not taken", serial, got, len);
        return false;
    }
    if (len > 0 && (sscanf(got, "HTTP/1.%*1[01] %3d ", &status) != 1 || status < 100)) {
        show("not an answer", serial, got, len);
        return false;
    }
    if (status == 500) {
        show("internal error", serial, got, len);
        return false;
    }
    statuses[status < STATUS_MAX ? status : 0]++;
    return true;
}

int main(int argc, char **argv)
{
    struct sockaddr_in to = {.sin_family = AF_INET};
    unsigned long count, bad = 0;

    if (argc < 5 || argc - 4 > FILES_MAX) {
        fprintf(stderr, "usage: http_fuzz PORT COUNT SEED FILE...\n");
        return 2;
    }
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons((uint16_t)strtoul(argv[1], NULL, 10));
    count = strtoul(argv[2], NULL, 10);
    state = strtoul(argv[3], NULL, 10);
    for (int i = 4; i < argc; i++)
        read_file(argv[i]);
    work.at = malloc(REQUEST_MAX);
    if (work.at == NULL)
        return 2;
    for (unsigned long i = 0; i < count && bad < 5; i++)
        bad += !run_one(&to, i);
    printf("seed %s, %lu requests, unanswered: %lu; by status:", argv[3], count,
           statuses[0]);
    for (int s = 1; s < STATUS_MAX; s++)
        if (statuses[s] > 0)
            printf(" %d: %lu", s, statuses[s]);
    printf("\n");
    for (size_t i = 0; i < nfiles; i++)
        free(files[i].at);
    free(work.at);
    return bad > 0;
}
