/* surfaced -- the daemon: options, start, wait for a signal, stop. */
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>
#include <sodium.h>

#include "access.h"
#include "app.h"
#include "errinfo.h"
#include "events.h"
#include "flags.h"
#include "gallery.h"
#include "http.h"
#include "libsurface.h"
#include "logger.h"
#include "mem.h"
#include "metrics.h"
#include "nodump.h"
#include "modelfile.h"
#include "options.h"
#include "outfile.h"
#include "queue.h"
#include "recent.h"
#include "routes.h"
#include "systemd.h"
#include "settings.h"
#include "store.h"
#include "throttle.h"
#include "tls.h"
#include "upkeep.h"

#define MINUTE_MS  60000.0
#define HOUR_MS    3600000.0
#define GRACE_MS   10000.0 /* for the requests that have begun, on a stop */
#define STALLED_MS 60000.0 /* without a response from any worker: something is wrong */
#define SERVER_S   60     /* that a start waits for a database server that takes writes */
#define TOLD       20     /* problems of a database in the log */
#define FLUSH_MS   2000.0 /* for the responses that are ready by then */

static void tell_problem(void *arg, const char *line)
{
    unsigned *told = arg;

    if (++*told <= TOLD)
        logger_line("error", "the database is not as it was written", "problem", line);
}

/* While a failover lasts, or all machines start at once, no server takes writes yet. */
static enum status open_store(const struct options *o, struct store **out,
                              struct errinfo *e)
{
    const struct store_key key = {
        .path = o->key,
        .anchor = o->anchor,
        .make = o->plaintext_database ? CRYPT_PLAINTEXT : CRYPT_FILE,
        .plaintext = o->plaintext_database,
    };
    enum status st;

    for (int s = 0;; s++) {
        st = store_open(o->db, o->create ? STORE_BEGIN : STORE_WRITE, &key, out, e);
        if (st != ST_EBUSY || !store_on_server(o->db) || s == SERVER_S ||
            systemd_pause(1000))
            return st;
        if (s == 0)
            logger_line("warn", "the database server is waited for", "reason", e->msg);
    }
}

static enum status server_start(const struct options *o, struct app *app,
                                struct http **http, char url[HTTP_URL_MAX],
                                struct errinfo *e)
{
    unsigned told = 0;
    enum status st = ST_OK;

    if (o->model != NULL)
        st = modelfile_read(o->model, &app->model, e);
    if (st == ST_OK)
        st = open_store(o, &app->store, e);
    if (st != ST_OK || (st = store_verify(app->store, tell_problem, &told, e)) != ST_OK)
        return st;
    store_use_model(app->store, app->model);
    app->routes = routes_table(&app->nroutes);
    if (o->gallery_memory > 0 && (app->gallery = gallery_new(o->gallery_memory)) == NULL)
        return errinfo_memory(e);
    app->metrics = metrics_new(app->routes, app->nroutes);
    app->limits =
        (struct store_limits){o->attempts, o->attempt_wait, o->attempt_subjects};
    app->throttle = throttle_new(o->rate_limit_tokens, MINUTE_MS);
    app->searches = throttle_new(o->identify_failures, HOUR_MS);
    app->refusals = throttle_new(ACCESS_REFUSALS, MINUTE_MS);
    app->recent = recent_new();
    app->db = o->db;
    app->disk_reserve = o->disk_reserve;
    if (app->metrics == NULL || app->throttle == NULL || app->searches == NULL ||
        app->refusals == NULL || app->recent == NULL ||
        (app->events = events_start(app)) == NULL ||
        (app->upkeep = upkeep_start(app, o->audit_days)) == NULL)
        return errinfo_memory(e);
    st = queue_start(app, o->workers, o->queue, http_run, &app->queue);
    if (st != ST_OK)
        return errinfo_set(e, st, "cannot start %u workers", o->workers);
    st = queue_start(app, 1, 1, http_run, &app->slow);
    if (st != ST_OK)
        return errinfo_set(e, st, "cannot start a worker for the audit log");
    return http_start(o, app, http, url, e);
}

static void stop_workers(struct app *app)
{
    if (app->queue != NULL)
        queue_stop(app->queue);
    if (app->slow != NULL)
        queue_stop(app->slow);
}

static void stop(struct app *app, struct http *http)
{
    stop_workers(app);
    events_stop(app->events);
    http_stop(http);
    events_free(app->events);
    queue_free(app->queue);
    queue_free(app->slow);
    upkeep_stop(app->upkeep);
    metrics_free(app->metrics);
    throttle_free(app->throttle);
    throttle_free(app->searches);
    throttle_free(app->refusals);
    gallery_free(app->gallery);
    recent_free(app->recent);
    store_close(app->store);
    surface_model_free(app->model);
}

/* A calibration that is ignored changes decisions: the operator must learn of it. */
static void warn_of_calibration(struct store *s)
{
    struct store_calibration k;
    struct logger_line l;

    if (store_calibration_current(s, &k, NULL) != ST_OK || !k.ignored)
        return;
    logger_begin(&l, "warn", "calibration is not used: made by another measure or model");
    logger_count(&l, "version", (uint64_t)k.version);
    logger_text(&l, "made_by", k.engine);
    logger_real(&l, "threshold", k.table.threshold, 2);
    logger_end(&l);
}

/* Each costs time at its first use, until the templates are re-encoded. */
static void warn_of_outdated(struct store *s)
{
    struct logger_line l;
    size_t n;

    if (store_reencode_due(s, NULL, &n, NULL) != ST_OK || n == 0)
        return;
    logger_begin(&l, "warn",
                 "templates were made by another engine: surfacectl template reencode");
    logger_count(&l, "templates", n);
    logger_end(&l);
}

static void say_listening(const struct options *o, const struct store *s, const char *url)
{
    struct logger_line l;
    char msg[HTTP_URL_MAX + 16];

    (void)snprintf(msg, sizeof msg, "listening on %s", url);
    logger_begin(&l, "info", msg);
    logger_text(&l, "engine", store_made_by(s));
    logger_count(&l, "workers", o->workers);
    logger_count(&l, "queue", o->queue);
    logger_count(&l, "max_body", o->max_body);
    logger_text(&l, "auth", o->no_auth ? "none" : "token");
    logger_end(&l);
}

/* The newest state, outside of the database and of its anchor: by this an older copy of both is
 * found. */
static void say_last_change(struct store *s)
{
    struct logger_line l;
    struct log_end end;
    char hash[2 * LOG_HASH + 1];

    if (store_last_change(s, &end, NULL) != ST_OK)
        return;
    (void)sodium_bin2hex(hash, sizeof hash, end.hash, LOG_HASH);
    logger_begin(&l, "info", "last change of the database");
    logger_count(&l, "seq", end.seq);
    logger_text(&l, "hash", hash);
    logger_end(&l);
}

/* What the hooks of systemd_wait() see. */
struct daemon {
    struct app *app;
    struct http *http;
    uint64_t served;    /* when it was looked at last */
    double progress_ms; /* when it had changed, or had nothing to do, last */
};

static void reload(void *arg)
{
    struct daemon *d = arg;

    http_reload(d->http);
}

/* Returns true if the workers make progress.  The time of one request depends on the machine, so STALLED_MS is
 * far longer than any request should take. */
static bool healthy(void *arg)
{
    struct daemon *d = arg;
    const double now = logger_clock_ms();
    struct queue_state q;

    queue_look(d->app->queue, &q);
    if (q.served != d->served || q.waiting + q.running == 0) {
        d->served = q.served;
        d->progress_ms = now;
    }
    return now - d->progress_ms < STALLED_MS;
}

/* --check-config: what the files of TLS hold. */
static bool check_files(const struct options *o)
{
    const struct tls_names names = {o->tls_cert, o->tls_key, o->tls_client_ca};
    struct tls *tls = NULL;
    struct errinfo e = {0};

    if (o->tls_cert != NULL && tls_open(&names, &tls, &e) != ST_OK)
        settings_wrong_value(o->settings, "tls-cert", e.msg);
    tls_close(tls);
    if (settings_problems(o->settings) > 0)
        return false;
    (void)puts("surfaced: the configuration is good");
    return true;
}

/* Returns the exit status after the requested text was printed. */
static int end_of_output(void)
{
    if (outfile_flush(stdout))
        return 0;
    (void)fputs("surfaced: the output cannot be written\n", stderr);
    return EX_IOERR;
}

/* Freed memory that each arena keeps, bytes.  An ordinary request allocates no block of MEM_MAPPED, so all its
 * memory is reused. */
#define KEPT_FREE (8 << 20)

/* The kernel dumps no memory (nodump.h).  The allocator overwrites freed blocks of more than 1 KB, also those of
 * libraries like GnuTLS that do not; core/basic/mem.h does it for all its blocks.  Freed blocks that only
 * large requests need go back to the system. */
static void prepare_memory(void)
{
    nodump_begin();
    (void)mallopt(M_PERTURB, 1);
    (void)mallopt(M_MMAP_THRESHOLD, (int)MEM_MAPPED);
    (void)mallopt(M_TRIM_THRESHOLD, KEPT_FREE);
}

int main(int argc, char **argv)
{
    struct app app = {0};
    struct http *http = NULL;
    struct options o = {0};
    struct errinfo e = {0};
    char url[HTTP_URL_MAX];
    struct daemon d = {.app = &app};
    bool behind;
    int sig, status = 1;

    switch (flags_read(argc, argv, stderr, &o)) {
    case FLAGS_CHECK:
        status = check_files(&o) ? end_of_output() : EX_USAGE;
        goto out;
    case FLAGS_DONE:
        status = end_of_output();
        goto out;
    case FLAGS_BAD:
        status = EX_USAGE;
        goto out;
    case FLAGS_RUN:
        break;
    }
    if (sodium_init() < 0) {
        (void)fprintf(stderr, "surfaced: no source of random numbers\n");
        goto out;
    }
    prepare_memory();
    logger_use((enum logger_format)o.log_format);
    systemd_begin();
    app.no_auth = o.no_auth;
    app.no_console = o.no_console;
    app.cors_origin = o.cors_origin;
    app.signed_captures = o.signed_captures;
    app.max_body = o.max_body;
    if (server_start(&o, &app, &http, url, &e) != ST_OK) {
        (void)fprintf(stderr, "surfaced: %s\n", e.msg);
        stop(&app, http);
        goto out;
    }
    say_listening(&o, app.store, url);
    say_last_change(app.store);
    warn_of_calibration(app.store);
    warn_of_outdated(app.store);
    d.http = http;
    d.progress_ms = logger_clock_ms();
    systemd_ready(url);
    sig = systemd_wait(&(struct systemd_hooks){reload, healthy, &d});
    logger_line("info", "stopping", "signal", sig == SIGTERM ? "SIGTERM" : "SIGINT");
    http_quiesce(http, GRACE_MS);
    stop_workers(&app); /* queued requests are still handled */
    http_quiesce(http, FLUSH_MS);
    say_last_change(app.store);
    store_follow(app.store);
    behind = store_behind(app.store);
    stop(&app, http);
    logger_line("info", "stopped", NULL, NULL);
    status = behind ? EX_TEMPFAIL : 0; /* a service manager starts the daemon again */
out:
    options_free(&o);
    return status;
}
