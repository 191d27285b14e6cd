/* options.h -- the settings of the daemon: a table of them, and their values by the
 * configuration file, the environment and the command line, of which each wins over the
 * one before.  surfacectl reads them too: which database there is, and `config`. */
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
#define OPTIONS_WAIT_MAX   86400 /* s, of attempt_wait */
#define OPTIONS_ORIGIN_MAX 255   /* bytes */
#define OPTIONS_ROWS       29

extern const struct setting options_table[OPTIONS_ROWS];

/* One member for each row of the table in options.c.  A path is NULL where it was not
 * given. */
struct options {
    const char *db;
    const char *key;         /* file of the master key of db; NULL: PATH.key beside it */
    const char *anchor;      /* file of the newest change of db; NULL: no anchor */
    bool plaintext_database; /* db is plaintext and has no key */
    const char *model;       /* NULL: the shipped one */
    const char *listen_text; /* as it was given */
    bool no_auth;
    bool no_console;
    const char *cors_origin;    /* origins with commas; NULL: none */
    bool signed_captures;       /* nothing else is taken */
    unsigned workers;           /* 1.. */
    unsigned queue;             /* requests that may wait for a worker */
    size_t max_body;            /* bytes */
    unsigned rate_limit_tokens; /* wrong ones a minute and address; 0: no limit */
    unsigned attempts;          /* verifications that may fail in a row; 0: no limit */
    unsigned attempt_wait;      /* s */
    unsigned attempt_subjects;  /* of a token, without a match in an hour; 0: no limit */
    size_t disk_reserve;        /* bytes that enrolments leave free */
    unsigned cache_mb;          /* of decoded templates; 0: none are kept */
    unsigned log_format;        /* enum log_format */
    unsigned audit_days;        /* that uses are kept in the audit log; 0: for ever */
    const char *tls_cert, *tls_key, *tls_client_ca;
    bool plaintext;
    const char *proxy_protocol; /* proxies, as address_in_list(); NULL: none */
    unsigned max_connections;
    unsigned max_connections_per_address; /* OPTIONS_UNSET: not given */
    unsigned timeout_s;

    bool create;                    /* the database; of the daemon's command line alone */
    struct sockaddr_storage listen; /* IPv4 or IPv6 with the port, or a Unix socket */
    socklen_t listen_len;
    struct settings *settings; /* what the strings above belong to */
};

/* options_new(errors, out): no values yet; errors is borrowed, and gets a line for each
 * problem.  False: no memory.  Release with options_free() whatever it returns. */
bool options_new(FILE *errors, struct options *out);
void options_free(struct options *o);

/* options_load(o, config, flag): all settings, checked one by one and together; the
 * members are filled where settings_problems(o->settings) is 0 then.
 * config  the file; NULL: SURFACED_CONFIG, or OPTIONS_FILE where there is one
 * flag    the value of each row on the command line, NULL where it is missing; or NULL */
void options_load(struct options *o, const char *config,
                  const char *const flag[OPTIONS_ROWS]);

/* options_check_files(o): report the files that cannot be read or made, and a model that
 * is none.  What a certificate holds is checked by the daemon (tls.h).  Writes nothing. */
void options_check_files(struct options *o);

#endif
