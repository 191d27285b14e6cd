#include "options.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "address.h"
#include "errinfo.h"
#include "libsurface.h"
#include "modelfile.h"

#define MAX_WORKERS 256

/* A row for each setting; man/surfaced.conf.5 and packaging/surfaced.conf describe them
 * too. */
const struct setting options_table[] = {
    {"db", SETTING_PATH, NULL, offsetof(struct options, db), 0, 0, "PATH",
     "the database, a file or postgresql://USER@HOST/NAME; surfacectl init\n"
     "makes it"},
    {"key", SETTING_PATH, NULL, offsetof(struct options, key), 0, 0, "FILE",
     "the database's key or passphrase (PATH.key)"},
    {"anchor", SETTING_PATH, NULL, offsetof(struct options, anchor), 0, 0, "FILE",
     "records the newest state of the database, on another disk or host"},
    {"plaintext-database", SETTING_BOOL, "0",
     offsetof(struct options, plaintext_database), 0, 0, NULL,
     "the database has no key: anyone who has the file can read it"},
    {"model", SETTING_FILE, NULL, offsetof(struct options, model), 0, 0, "FILE",
     "a model that surfacelab train wrote"},
    {"listen", SETTING_ADDRESS, "127.0.0.1:8787", offsetof(struct options, listen_text),
     0, 0, "ADDR:PORT",
     "[::1]:PORT for IPv6, unix:PATH for a Unix socket; port 0 takes a\n"
     "free one, which the log names; other than loopback needs TLS or\n"
     "--plaintext"},
    {"tls-cert", SETTING_FILE, NULL, offsetof(struct options, tls_cert), 0, 0, "FILE",
     "serve TLS with this certificate (PEM); reloaded on SIGHUP"},
    {"tls-key", SETTING_FILE, NULL, offsetof(struct options, tls_key), 0, 0, "FILE",
     "the certificate's key (PEM), not readable by others"},
    {"tls-client-ca", SETTING_FILE, NULL, offsetof(struct options, tls_client_ca), 0, 0,
     "FILE", "clients need a certificate issued by one of these CAs (PEM)"},
    {"plaintext", SETTING_BOOL, "0", offsetof(struct options, plaintext), 0, 0, NULL,
     "allow other addresses than loopback without TLS"},
    {"proxy-protocol", SETTING_TEXT, NULL, offsetof(struct options, proxy_protocol), 0, 0,
     "ADDRESS[,ADDRESS...]",
     "connections of these proxies (192.0.2.1, 10.0.0.0/8, unix) begin with\n"
     "a PROXY protocol header, version 2, whose client is rate-limited and\n"
     "logged instead of the proxy"},
    {"no-auth", SETTING_BOOL, "0", offsetof(struct options, no_auth), 0, 0, NULL,
     "accept requests without a token"},
    {"no-console", SETTING_BOOL, "0", offsetof(struct options, no_console), 0, 0, NULL,
     "do not serve /console, the pages for a browser"},
    {"cors-origin", SETTING_TEXT, NULL, offsetof(struct options, cors_origin), 0, 0,
     "ORIGIN[,ORIGIN...]",
     "pages of these origins may use the API, like https://desk.example.org"},
    {"require-signed-captures", SETTING_BOOL, "0",
     offsetof(struct options, signed_captures), 0, 0, NULL,
     "accept only captures signed by a registered scanner (device add)"},
    {"rate-limit-tokens", SETTING_NUMBER, "10",
     offsetof(struct options, rate_limit_tokens), 0, 10000, "N",
     "wrong tokens a minute from one address, then 429; 0: no limit"},
    {"attempts", SETTING_NUMBER, "3", offsetof(struct options, attempts), 0, 1000, "N",
     "failed verifications in a row that lock a subject out (429);\n"
     "0: no limit"},
    {"attempt-wait", SETTING_NUMBER, "30", offsetof(struct options, attempt_wait), 1,
     OPTIONS_WAIT_MAX, "SECONDS", "the first lock-out; each further failure doubles it"},
    {"attempt-subjects", SETTING_NUMBER, "30", offsetof(struct options, attempt_subjects),
     0, 1000000, "N",
     "subjects that a token may try without a match in an hour, then\n"
     "429; 0: no limit"},
    {"identify-failures", SETTING_NUMBER, "150",
     offsetof(struct options, identify_failures), 0, 1000000, "N",
     "identifications without a match that a token may make in an hour,\n"
     "then 429; 0: no limit"},
    {"gallery-memory", SETTING_BYTES, "1G", offsetof(struct options, gallery_memory), 0,
     UINT_MAX, "BYTES",
     "memory for the descriptors that identifications search, about 160 a\n"
     "person; 0: no identification"},
    {"disk-reserve", SETTING_BYTES, "128M", offsetof(struct options, disk_reserve), 0,
     1UL << 50, "BYTES",
     "free space on the database's disk that enrolments leave to\n"
     "verifications; below it they get 503"},
    {"workers", SETTING_NUMBER, NULL, offsetof(struct options, workers), 1, MAX_WORKERS,
     "N", "threads that compute (one per core)"},
    {"queue", SETTING_NUMBER, "256", offsetof(struct options, queue), 1, 65536, "N",
     "requests that may wait for a worker; more get 503"},
    /* two clouds of 300,000 points as JSON */
    {"max-body", SETTING_BYTES, "64M", offsetof(struct options, max_body), 1, 1UL << 30,
     "BYTES", "longest request body; a longer one gets 413"},
    {"max-connections", SETTING_NUMBER, "4096", offsetof(struct options, max_connections),
     1, 1000000, "N", "connections at once; more are closed"},
    {"max-connections-per-address", SETTING_NUMBER, NULL,
     offsetof(struct options, max_connections_per_address), 0, 1000000, "N",
     "connections from one address, 0: no limit (64; no limit for loopback)"},
    {"timeout", SETTING_NUMBER, "10", offsetof(struct options, timeout_s), 1, 3600, "S",
     "seconds for a request's headers, and the least time for a body, or\n"
     "for the client to take its response"},
    {"audit-days", SETTING_NUMBER, "0", offsetof(struct options, audit_days), 0, 36500,
     "N", "days that the audit log keeps verifications; 0: forever"},
    {"log-format", SETTING_CHOICE, "logfmt", offsetof(struct options, log_format), 0, 0,
     "logfmt|json", "the format of the log's lines"},
};

bool options_new(FILE *errors, struct options *out)
{
    assert(options_table[OPTIONS_ROWS - 1].name != NULL); /* no row is missing */
    *out = (struct options){.max_connections_per_address = OPTIONS_UNSET};
    return settings_new(options_table, OPTIONS_ROWS, errors, &out->settings);
}

void options_free(struct options *o)
{
    settings_free(o->settings);
    o->settings = NULL;
}

/* Of https://desk.example.org,http://localhost:3000: as browsers write an origin, for it is compared
 * letter by letter. */
static bool are_origins(const char *list)
{
    size_t n;

    for (;; list += n + 1) {
        const char *host = strncmp(list, "https://", 8) == 0  ? list + 8
                           : strncmp(list, "http://", 7) == 0 ? list + 7
                                                              : list;

        n = strcspn(list, ",");
        if (host == list || host == list + n || n > OPTIONS_ORIGIN_MAX ||
            host + strspn(host, "abcdefghijklmnopqrstuvwxyz0123456789.-:[]") != list + n)
            return false;
        if (list[n] == '\0')
            return true;
    }
}

/* Returns true if a database's URL has a password, before anything prints it.  Opening it checks the URL
 * in full. */
static bool has_password(const char *url)
{
    const char *user = strstr(url, "://");
    const char *at = user != NULL ? strchr(user + 3, '@') : NULL;

    return user != NULL &&
           (strstr(url, "password=") != NULL ||
            (at != NULL && memchr(user + 3, ':', (size_t)(at - user - 3)) != NULL));
}

/* What a row cannot say: which settings are required, and which contradict each other. */
static void check_together(struct options *o)
{
    struct settings *s = o->settings;
    const bool read = address_read(o->listen_text, &o->listen, &o->listen_len);

    assert(read); /* the value was checked when it was read */
    (void)read;
    if (o->db == NULL)
        settings_wrong(s,
                       "no database: give --db PATH, set SURFACED_DB or write db = PATH "
                       "into the configuration file");
    else if (has_password(o->db))
        settings_wrong(s,
                       "the URL of the database has a password: put it into ~/.pgpass, "
                       "or use a certificate");
    if (o->plaintext_database && o->key != NULL)
        settings_wrong(s, "--plaintext-database contradicts --key");
    if ((o->tls_cert == NULL) != (o->tls_key == NULL))
        settings_wrong(s, "--tls-cert and --tls-key go together");
    if (o->tls_client_ca != NULL && o->tls_cert == NULL)
        settings_wrong(s, "--tls-client-ca needs --tls-cert");
    if (o->cors_origin != NULL && !are_origins(o->cors_origin))
        settings_wrong_value(
            s, "cors-origin",
            "not origins like https://desk.example.org, without a path, with "
            "commas between them");
    if (o->proxy_protocol != NULL && !address_is_list(o->proxy_protocol))
        settings_wrong_value(s, "proxy-protocol",
                             "not addresses like 192.0.2.1, 2001:db8::1, 10.0.0.0/8 or "
                             "unix, with commas between them");
    if (o->plaintext && o->tls_cert != NULL)
        settings_wrong(s, "--plaintext contradicts --tls-cert");
    if (address_is_local((const struct sockaddr *)&o->listen))
        return;
    if (o->no_auth)
        settings_wrong_value(s, "listen",
                             "not a loopback address: --no-auth is for loopback only");
    else if (o->tls_cert == NULL && !o->plaintext)
        settings_wrong_value(
            s, "listen",
            "not a loopback address: give --tls-cert and --tls-key, or --plaintext if a "
            "proxy or tunnel encrypts");
}

static unsigned one_per_core(void)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);

    return cores < 1 ? 1 : cores > MAX_WORKERS ? MAX_WORKERS : (unsigned)cores;
}

void options_load(struct options *o, const char *config,
                  const char *const flag[OPTIONS_ROWS])
{
    const char *env = getenv("SURFACED_CONFIG");
    struct settings *s = o->settings;

    if (config != NULL)
        settings_file(s, config, false);
    else if (env != NULL && *env != '\0')
        settings_file(s, env, false);
    else
        settings_file(s, OPTIONS_FILE, true);
    settings_environment(s);
    for (size_t i = 0; flag != NULL && i < OPTIONS_ROWS; i++)
        if (flag[i] != NULL)
            settings_flag(s, i, flag[i]);
    if (settings_problems(s) > 0)
        return;
    settings_fill(s, o);
    if (o->workers == 0)
        o->workers = one_per_core();
    check_together(o);
}

void options_check_files(struct options *o)
{
    struct settings *s = o->settings;
    struct surface_model *m = NULL;
    struct errinfo e;

    settings_check_files(s);
    if (settings_problems(s) == 0 && o->model != NULL &&
        modelfile_read(o->model, &m, &e) != ST_OK)
        settings_wrong_value(s, "model", e.msg);
    surface_model_free(m);
}
