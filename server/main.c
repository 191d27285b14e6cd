/* surfaced -- the daemon: options, start, wait for a signal, stop. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <sodium.h>

#include "app.h"
#include "attempts.h"
#include "cache.h"
#include "in_force.h"
#include "erasures.h"
#include "errinfo.h"
#include "expiry.h"
#include "face.h"
#include "flags.h"
#include "http.h"
#include "intake.h"
#include "log.h"
#include "metrics.h"
#include "modelfile.h"
#include "options.h"
#include "process.h"
#include "queue.h"
#include "retention.h"
#include "routes.h"
#include "service.h"
#include "settings.h"
#include "store.h"
#include "throttle.h"
#include "tls.h"

#define GRACE_MS   10000.0 /* for the requests that have begun, on a stop */
#define STALLED_MS 60000.0 /* without a response from any worker: something is wrong */
#define TOLD       20      /* problems of a database in the log */
#define FLUSH_MS   2000.0  /* for the responses that are ready by then */

static void tell_row(void *arg, enum store_chain chain, uint64_t seq, const char *line)
{
    unsigned *told = arg;
    struct log_entry l;

    (void)chain;
    if (++*told > TOLD)
        return;
    log_begin(&l, "error", "the database is not what was written");
    log_count(&l, "change", seq);
    log_text(&l, "problem", line);
    log_end(&l);
}

/* A row that is not what was written last is an error where it is used; here it is told. */
static enum status verify_state(struct store *s, struct errinfo *e)
{
    struct store_audit found;
    unsigned told = 0;

    return store_state_verify(s, tell_row, &told, &found, e);
}

static enum status start(const struct options *o, struct app *app, struct http **http,
                         char url[HTTP_URL_MAX], struct errinfo *e)
{
    const struct store_key key = {
        .path = o->key,
        .anchor = o->anchor,
        .make = o->plaintext_database ? VAULT_PLAINTEXT : VAULT_FILE,
        .plaintext = o->plaintext_database,
    };
    enum status st = ST_OK;

    if (o->model != NULL)
        st = modelfile_read(o->model, &app->model, e);
    if (st == ST_OK)
        st = store_open(o->db, o->create ? STORE_BEGIN : STORE_WRITE, &key, &app->store,
                        e);
    if (st != ST_OK || (st = verify_state(app->store, e)) != ST_OK ||
        (st = store_serve(app->store, e)) != ST_OK)
        return st;
    store_use_model(app->store, app->model);
    app->cache = cache_new((size_t)o->cache_mb << 20);
    app->routes = routes_table(&app->nroutes);
    app->metrics = metrics_new(app->routes, app->nroutes);
    app->attempts = attempts_new(o->attempts, o->attempt_wait, o->attempt_subjects);
    app->throttle = throttle_new(o->rate_limit_tokens);
    app->intake = intake_new(o->enrollments, o->db, o->disk_reserve);
    if (o->audit_days > 0)
        app->retention = retention_start(app->store, o->audit_days);
    if ((app->retention == NULL && o->audit_days > 0) || app->cache == NULL ||
        app->metrics == NULL || app->attempts == NULL || app->throttle == NULL ||
        app->intake == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    st = queue_start(app, o->workers, o->queue, http_run, &app->queue);
    if (st != ST_OK)
        return errinfo_set(e, st, "cannot start %u workers", o->workers);
    if ((app->erasures = erasures_start(app)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    st = http_listen(o, http, url, e);
    return st == ST_OK ? http_start(*http, app, e) : st;
}

static void stop(struct app *app, struct http *http)
{
    if (app->queue != NULL)
        queue_stop(app->queue);
    http_stop(http);
    queue_free(app->queue);
    retention_stop(app->retention);
    erasures_stop(app->erasures);
    cache_free(app->cache);
    metrics_free(app->metrics);
    attempts_free(app->attempts);
    throttle_free(app->throttle);
    intake_free(app->intake);
    store_close(app->store);
    free(app->model);
}

/* A calibration that is ignored changes decisions: the operator must learn of it. */
static void warn_of_calibration(struct store *s)
{
    struct store_calibration k;
    struct log_entry l;

    if (in_force_get(s, &k, NULL) != ST_OK || !k.ignored)
        return;
    log_begin(&l, "warn", "calibration is not used: made by another measure or model");
    log_count(&l, "version", (uint64_t)k.version);
    log_text(&l, "made_by", k.engine);
    log_real(&l, "threshold", k.table.threshold, 2);
    log_end(&l);
}

/* Each costs time at its first use, until the templates are re-encoded. */
static void warn_of_outdated(struct store *s)
{
    struct log_entry l;
    uint64_t n;

    if (store_reencode_count(s, &n, NULL) != ST_OK || n == 0)
        return;
    log_begin(&l, "warn",
              "templates were made by another engine: surfacectl template reencode");
    log_count(&l, "templates", n);
    log_end(&l);
}

static void say_listening(const struct options *o, const struct store *s, const char *url)
{
    struct log_entry l;
    char msg[HTTP_URL_MAX + 16];

    (void)snprintf(msg, sizeof msg, "listening on %s", url);
    log_begin(&l, "info", msg);
    log_text(&l, "engine", store_made_by(s));
    log_count(&l, "workers", o->workers);
    log_count(&l, "queue", o->queue);
    log_count(&l, "max_body", o->max_body);
    log_count(&l, "cache_mb", o->cache_mb);
    log_text(&l, "auth", o->no_auth ? "none" : "token");
    log_end(&l);
}

/* The newest state, outside of the database and of its anchor: by this an older copy of both is
 * found. */
static void say_last_change(struct store *s)
{
    struct log_entry l;
    char hash[65];
    uint64_t seq;

    if (store_last_change(s, &seq, hash, NULL) != ST_OK)
        return;
    log_begin(&l, "info", "last change of the database");
    log_count(&l, "seq", seq);
    log_text(&l, "hash", hash);
    log_end(&l);
}

static void say_stopping(int sig)
{
    struct log_entry l;

    log_begin(&l, "info", "stopping");
    log_text(&l, "signal", sig == SIGTERM ? "SIGTERM" : "SIGINT");
    log_end(&l);
}

/* What the hooks of service_wait() see. */
struct daemon {
    struct app *app;
    struct http *http;
    struct expiry expiry;
    uint64_t served;    /* when it was looked at last */
    double progress_ms; /* when it had changed, or had nothing to do, last */
};

static void reload(void *arg)
{
    struct daemon *d = arg;

    http_reload(d->http);
}

/* The workers get on with what they have.  How long one request may take depends on the
 * machine, so the time is far longer than any should. */
static bool healthy(void *arg)
{
    struct daemon *d = arg;
    const double now = log_clock_ms();
    struct queue_state q;

    queue_look(d->app->queue, &q);
    if (q.served != d->served || q.waiting + q.running == 0) {
        d->served = q.served;
        d->progress_ms = now;
    }
    return now - d->progress_ms < STALLED_MS;
}

static void hourly(void *arg)
{
    struct daemon *d = arg;

    expiry_look(&d->expiry, d->app);
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

int main(int argc, char **argv)
{
    struct app app = {0};
    struct http *http = NULL;
    struct options o = {0};
    struct errinfo e = {0};
    char url[HTTP_URL_MAX];
    struct daemon d = {.app = &app};
    int sig, status = 1;

    switch (flags_read(argc, argv, stderr, &o)) {
    case FLAGS_CHECK:
        status = check_files(&o) ? 0 : EX_USAGE;
        goto out;
    case FLAGS_DONE:
        status = 0;
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
    process_begin();
    log_use((enum log_format)o.log_format);
    service_begin();
    app.no_auth = o.no_auth;
    app.signed_captures = o.signed_captures;
    app.max_body = o.max_body;
    if (start(&o, &app, &http, url, &e) != ST_OK) {
        (void)fprintf(stderr, "surfaced: %s\n", e.msg);
        stop(&app, http);
        goto out;
    }
    say_listening(&o, app.store, url);
    say_last_change(app.store);
    warn_of_calibration(app.store);
    warn_of_outdated(app.store);
    d.http = http;
    d.progress_ms = log_clock_ms();
    service_ready(url);
    sig = service_wait(&(struct service_hooks){reload, healthy, hourly, &d});
    say_stopping(sig);
    http_quiesce(http, GRACE_MS);
    queue_stop(app.queue); /* queued requests are still handled */
    http_quiesce(http, FLUSH_MS);
    say_last_change(app.store);
    stop(&app, http);
    log_line("info", "stopped");
    status = 0;
out:
    options_free(&o);
    return status;
}
