/* options.h -- what the daemon is told by its configuration file, by the environment and by
 * its command line, each stronger than the one before. */
#ifndef SERVER_OPTIONS_H
#define SERVER_OPTIONS_H
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/socket.h>

struct settings; /* settings.h */

#define OPTIONS_UNSET UINT_MAX

/* One member for each row of the table in options.c.  A path is NULL where it was not
 * given. */
struct options {
    const char *db;
    const char *key;         /* its master key; NULL: beside it */
    const char *model;       /* NULL: the shipped one */
    const char *listen_text; /* as it was given */
    bool no_auth;
    unsigned workers;           /* 1.. */
    unsigned queue;             /* requests that may wait for a worker */
    size_t max_body;            /* bytes */
    unsigned rate_limit_tokens; /* wrong ones a minute and address; 0: no limit */
    unsigned attempts;          /* verifications that may fail in a row; 0: no limit */
    unsigned attempt_wait;      /* s */
    unsigned cache_mb;          /* of decoded templates; 0: none are kept */
    unsigned log_format;        /* enum log_format */
    const char *tls_cert, *tls_key, *tls_client_ca;
    bool plaintext;
    unsigned max_connections;
    unsigned max_connections_per_address; /* OPTIONS_UNSET: not given */
    unsigned timeout_s;

    struct sockaddr_storage listen; /* IPv4 or IPv6 with the port, or a Unix socket */
    socklen_t listen_len;
    struct settings *settings; /* what the strings above belong to */
};

enum options_outcome { OPTIONS_RUN, OPTIONS_CHECK, OPTIONS_DONE, OPTIONS_BAD };

/* options_read(argc, argv, errors, out): all settings, checked one by one and together.
 * The file is --config, or SURFACED_CONFIG, or /etc/surfaced.conf where there is one.
 * Writes no file.  Release with options_free() whatever it returns:
 * OPTIONS_RUN; OPTIONS_CHECK for --check-config when no problem was found up to here;
 * OPTIONS_DONE when what --help, --version or --print-config asks for was printed to stdout;
 * OPTIONS_BAD with a line on errors for each problem. */
enum options_outcome options_read(int argc, char **argv, FILE *errors,
                                  struct options *out);
void options_free(struct options *o);

#endif
