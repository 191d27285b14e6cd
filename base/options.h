/* options.h -- the settings of the daemon: a table of them, and their values from the configuration file,
 * the environment and the command line, of which each overrides the one before.  surfacectl reads them for
 * the database that they name. */
#ifndef BASE_OPTIONS_H
#define BASE_OPTIONS_H
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/socket.h>
#include "settings.h"

#define OPTIONS_FILE       "/etc/surfaced.conf"
#define OPTIONS_UNSET      UINT_MAX
#define OPTIONS_WAIT_MAX   86400 /* greatest attempt_wait, s */
#define OPTIONS_ORIGIN_MAX 255   /* bytes of an origin */
#define OPTIONS_ROWS       30

extern const struct setting options_table[OPTIONS_ROWS];

/* One member for each row of the table in options.c.  A path that is not set is NULL. */
struct options {
    const char *db;
    const char *key;    /* file of the master key of db; NULL: db and ".key" */
    const char *anchor; /* file that records the newest change of db; NULL: no anchor */
    bool plaintext_database; /* true: db has no key */
    const char *model;       /* file of the model; NULL: the shipped model */
    const char *listen_text; /* the address of `listen` as text */
    bool no_auth;
    bool no_console;
    const char *cors_origin;    /* origins separated by commas; NULL: none */
    bool signed_captures;       /* true: only signed captures are accepted */
    unsigned workers;           /* threads, 1 or more */
    unsigned queue;             /* greatest number of requests that wait for a worker */
    size_t max_body;            /* greatest body, bytes */
    unsigned rate_limit_tokens; /* wrong tokens a minute and address; 0: no limit */
    unsigned attempts;     /* consecutive failed attempts until a lock-out; 0: no limit */
    unsigned attempt_wait; /* first lock-out, s */
    unsigned attempt_subjects; /* subjects an hour that a token fails on; 0: no limit */
    unsigned
        identify_failures; /* identifications an hour and token without a match; 0: no limit */
    size_t
        gallery_memory; /* bytes for the descriptors of identifications; 0: none are made */
    size_t disk_reserve; /* free bytes that enrolments leave on the disk */
    unsigned log_format; /* enum log_format */
    unsigned
        audit_days; /* days that the audit log keeps access-log entries; 0: for ever */
    const char *tls_cert, *tls_key, *tls_client_ca;
    bool plaintext;
    const char *proxy_protocol; /* list of proxies for address_in_list(); NULL: none */
    unsigned max_connections;
    unsigned max_connections_per_address; /* OPTIONS_UNSET: not set */
    unsigned timeout_s;

    bool create; /* true: --create was given; no setting */
    struct sockaddr_storage
        listen; /* IPv4 or IPv6 address with the port, or Unix socket */
    socklen_t listen_len;
    struct settings *settings; /* owner of the strings above */
};

/* options_new(errors, out): Begins with the defaults.
 *   errors  borrowed; receives a line for each problem
 *   out     to be released by options_free(), also on failure
 * Returns false if out of memory. */
bool options_new(FILE *errors, struct options *out);

/* options_free(o): Releases the settings and the strings of o. */
void options_free(struct options *o);

/* options_load(o, config, flag): Reads all settings and checks each of them and their combinations.  The
 * members are set if settings_problems(o->settings) is 0 then.
 *   config  path of the file; NULL: SURFACED_CONFIG, or OPTIONS_FILE if it exists
 *   flag    values of the rows on the command line, each NULL if not given; NULL: no command line */
void options_load(struct options *o, const char *config,
                  const char *const flag[OPTIONS_ROWS]);

/* options_check_files(o): Reports files that cannot be read or created, and a model that is malformed.  The
 * daemon checks the contents of certificates (tls.h).  Writes nothing. */
void options_check_files(struct options *o);

#endif
