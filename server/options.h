/* options.h -- what the daemon is told by its command line and by the environment. */
#ifndef SERVER_OPTIONS_H
#define SERVER_OPTIONS_H
#include <stdbool.h>
#include <stddef.h>
#include <sys/socket.h>

struct options {
    const char *db;                 /* borrowed from argv or the environment */
    const char *model;              /* NULL: the shipped one */
    struct sockaddr_storage listen; /* a loopback address (IPv4 or IPv6) and the port */
    socklen_t listen_len;
    bool no_auth;
    unsigned workers; /* 1.. */
    unsigned queue;   /* requests that may wait for a worker */
    size_t max_body;  /* bytes */
};

enum options_outcome { OPTIONS_RUN, OPTIONS_DONE, OPTIONS_BAD };

/* options_read(argc, argv, out, err, size): the command line wins over SURFACED_DB,
 * SURFACED_MODEL, SURFACED_LISTEN, SURFACED_NO_AUTH, SURFACED_WORKERS, SURFACED_QUEUE,
 * SURFACED_MAX_BODY.
 * Returns OPTIONS_RUN; OPTIONS_DONE when --help or --version was printed to stdout;
 * OPTIONS_BAD with one line without newline in err[0..size-1]: an unknown option, one given
 * twice, a number out of its range, an address that is not one, one that is not loopback. */
enum options_outcome options_read(int argc, char **argv, struct options *out, char *err,
                                  size_t size);

#endif
