#include "options.h"

#include <arpa/inet.h>
#include <errno.h>
#include <getopt.h>
#include <netinet/in.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "face.h"

#define MAX_WORKERS  256
#define MAX_QUEUE    65536
#define MAX_BODY     ((size_t)1 << 30)
#define DEFAULT_BODY ((size_t)64 << 20) /* two clouds of 300,000 points as JSON */

enum { DB, MODEL, LISTEN, NO_AUTH, WORKERS, QUEUE, BODY, NOPTIONS, HELP, VERSION };

static const struct {
    const char *name, *env, *fallback;
} known[NOPTIONS] = {
    [DB] = {"db", "SURFACED_DB", NULL},
    [MODEL] = {"model", "SURFACED_MODEL", NULL},
    [LISTEN] = {"listen", "SURFACED_LISTEN", "127.0.0.1:8787"},
    [NO_AUTH] = {"no-auth", "SURFACED_NO_AUTH", "0"},
    [WORKERS] = {"workers", "SURFACED_WORKERS", NULL},
    [QUEUE] = {"queue", "SURFACED_QUEUE", "256"},
    [BODY] = {"max-body", "SURFACED_MAX_BODY", NULL},
};

static const char usage[] =
    "Usage: surfaced --db PATH [OPTION]...\n"
    "Verify faces by the shape of their surface, over HTTP.\n"
    "\n"
    "  --db PATH           the database; made if it is missing\n"
    "  --model FILE        judge by a model that surfacectl train wrote\n"
    "  --listen ADDR:PORT  a loopback address, [::1]:PORT for IPv6; port 0 takes a free one,\n"
    "                      which the line logged at the start names (127.0.0.1:8787)\n"
    "  --no-auth           ask for no token\n"
    "  --workers N         threads that compute (one per core)\n"
    "  --queue N           requests that may wait for a worker; beyond it: 503 (256)\n"
    "  --max-body BYTES    longest request body; beyond it: 413 (67108864)\n"
    "  --help, --version   print this, or the version, and exit\n"
    "\n"
    "The same as environment: SURFACED_DB, SURFACED_MODEL, SURFACED_LISTEN,\n"
    "SURFACED_NO_AUTH=1, SURFACED_WORKERS, SURFACED_QUEUE, SURFACED_MAX_BODY.  An option wins.\n"
    "SIGTERM and SIGINT finish the running requests.  Exit status: 0 after a clean stop,\n"
    "1 when it could not start or go on, 2 for a bad option.\n";

/* Digits only, within lo..hi. */
static bool read_number(const char *s, unsigned long lo, unsigned long hi,
                        unsigned long *out)
{
    char *end;

    if (*s < '0' || *s > '9')
        return false;
    errno = 0;
    *out = strtoul(s, &end, 10);
    return errno == 0 && *end == '\0' && *out >= lo && *out <= hi;
}

static bool loopback(const struct sockaddr_storage *ss)
{
    if (ss->ss_family == AF_INET) {
        struct sockaddr_in in;

        memcpy(&in, ss, sizeof in);
        return (ntohl(in.sin_addr.s_addr) >> 24) == 127;
    } else {
        struct sockaddr_in6 in6;

        memcpy(&in6, ss, sizeof in6);
        return IN6_IS_ADDR_LOOPBACK(&in6.sin6_addr) != 0;
    }
}

/* "127.0.0.1:8787", "localhost:8787", "[::1]:8787".  No name is looked up. */
static bool read_address(const char *s, struct options *out)
{
    const char *colon = strrchr(s, ':');
    struct sockaddr_in in = {.sin_family = AF_INET};
    struct sockaddr_in6 in6 = {.sin6_family = AF_INET6};
    char host[64];
    unsigned long port;
    size_t len;

    if (colon == NULL || !read_number(colon + 1, 0, 65535, &port))
        return false;
    len = (size_t)(colon - s);
    if (len == 0 || len >= sizeof host)
        return false;
    memcpy(host, s, len);
    host[len] = '\0';
    memset(&out->listen, 0, sizeof out->listen);
    if (host[0] == '[' && host[len - 1] == ']') {
        host[len - 1] = '\0';
        in6.sin6_port = htons((uint16_t)port);
        memcpy(&out->listen, &in6, sizeof in6);
        out->listen_len = sizeof in6;
        if (inet_pton(AF_INET6, host + 1, &in6.sin6_addr) != 1)
            return false;
        memcpy(&out->listen, &in6, sizeof in6);
        return true;
    }
    in.sin_port = htons((uint16_t)port);
    if (inet_pton(AF_INET, strcmp(host, "localhost") == 0 ? "127.0.0.1" : host,
                  &in.sin_addr) != 1)
        return false;
    memcpy(&out->listen, &in, sizeof in);
    out->listen_len = sizeof in;
    return true;
}

static bool read_values(const char *const value[NOPTIONS], struct options *out, char *err,
                        size_t size)
{
    unsigned long n;
    long cores;

    out->db = value[DB];
    if (out->db == NULL || *out->db == '\0') {
        (void)snprintf(err, size, "no database: give --db PATH or set SURFACED_DB");
        return false;
    }
    out->model = value[MODEL];
    if (!read_address(value[LISTEN], out)) {
        (void)snprintf(err, size,
                       "--listen %s: not an address like 127.0.0.1:8787 or "
                       "[::1]:8787",
                       value[LISTEN]);
        return false;
    }
    if (!read_number(value[NO_AUTH], 0, 1, &n)) {
        (void)snprintf(err, size, "SURFACED_NO_AUTH=%s: neither 0 nor 1", value[NO_AUTH]);
        return false;
    }
    out->no_auth = n == 1;
    if (!loopback(&out->listen)) {
        (void)snprintf(
            err, size,
            "--listen %s: not a loopback address%s; there is no TLS yet, so put "
            "a TLS proxy in front and listen on 127.0.0.1 or [::1]",
            value[LISTEN], out->no_auth ? ", and --no-auth is for loopback only" : "");
        return false;
    }
    cores = sysconf(_SC_NPROCESSORS_ONLN);
    n = cores < 1 ? 1 : cores > MAX_WORKERS ? MAX_WORKERS : (unsigned long)cores;
    if (value[WORKERS] != NULL && !read_number(value[WORKERS], 1, MAX_WORKERS, &n)) {
        (void)snprintf(err, size, "--workers %s: not a number from 1 to %d",
                       value[WORKERS], MAX_WORKERS);
        return false;
    }
    out->workers = (unsigned)n;
    if (!read_number(value[QUEUE], 1, MAX_QUEUE, &n)) {
        (void)snprintf(err, size, "--queue %s: not a number from 1 to %d", value[QUEUE],
                       MAX_QUEUE);
        return false;
    }
    out->queue = (unsigned)n;
    n = DEFAULT_BODY;
    if (value[BODY] != NULL && !read_number(value[BODY], 1, MAX_BODY, &n)) {
        (void)snprintf(err, size, "--max-body %s: not a number of bytes from 1 to %zu",
                       value[BODY], MAX_BODY);
        return false;
    }
    out->max_body = n;
    return true;
}

enum options_outcome options_read(int argc, char **argv, struct options *out, char *err,
                                  size_t size)
{
    static const struct option longopts[] = {
        {"db", required_argument, NULL, DB},
        {"model", required_argument, NULL, MODEL},
        {"listen", required_argument, NULL, LISTEN},
        {"no-auth", no_argument, NULL, NO_AUTH},
        {"workers", required_argument, NULL, WORKERS},
        {"queue", required_argument, NULL, QUEUE},
        {"max-body", required_argument, NULL, BODY},
        {"help", no_argument, NULL, HELP},
        {"version", no_argument, NULL, VERSION},
        {NULL, 0, NULL, 0},
    };
    const char *value[NOPTIONS];
    bool given[NOPTIONS] = {false};
    int opt;

    for (int i = 0; i < NOPTIONS; i++) {
        value[i] = getenv(known[i].env);
        if (value[i] == NULL || *value[i] == '\0')
            value[i] = known[i].fallback;
    }
    opterr = 0;
    while ((opt = getopt_long(argc, argv, ":", longopts, NULL)) != -1) {
        switch (opt) {
        case HELP:
            (void)fputs(usage, stdout);
            return OPTIONS_DONE;
        case VERSION:
            (void)puts(FACE_ENGINE);
            return OPTIONS_DONE;
        case '?':
            (void)snprintf(err, size, "%s: no such option; see --help", argv[optind - 1]);
            return OPTIONS_BAD;
        case ':':
            (void)snprintf(err, size, "%s: its value is missing", argv[optind - 1]);
            return OPTIONS_BAD;
        default:
            if (given[opt]) {
                (void)snprintf(err, size, "--%s is given twice", known[opt].name);
                return OPTIONS_BAD;
            }
            given[opt] = true;
            value[opt] = opt == NO_AUTH ? "1" : optarg;
        }
    }
    if (optind < argc) {
        (void)snprintf(err, size, "%s: not an option; see --help", argv[optind]);
        return OPTIONS_BAD;
    }
    return read_values(value, out, err, size) ? OPTIONS_RUN : OPTIONS_BAD;
}
