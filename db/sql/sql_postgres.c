#include "sql_postgres.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "bytes.h"
#include "schema_postgres_sql.h"

#define VERSION   1      /* user_version in schema.sql */
#define SET_UP_MS 10000  /* longer than lock_timeout */
#define WAIT_MS   120000 /* for each result: a query over all rows takes a while */
#define PROVE_MS  10000  /* to find out what became of a commit */
#define ALONE_MS                                                                         \
    2000 /* for the last of others to end; a server notices that a moment later */

/* ---- connections */

static void wait_a_while(void)
{
    (void)nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
}

static void close_conn(struct sql_postgres_conn *c)
{
    if (c != NULL)
        PQfinish(c->pg);
    free(c);
}

/* Prints nothing.  During a commit the server has one notice: it did not wait for a standby, because the wait
 * was cancelled. */
static void take_notice(void *arg, const PGresult *r)
{
    struct sql_postgres_conn *c = arg;

    (void)r;
    c->warned = c->committing;
}

/* A server that is another machine proves its name, unless the URL says otherwise; the one of several
 * that is no standby; a host that is gone is noticed within 10 s. */
static PGconn *dial(const char *url)
{
    /* clang-format off */
    static const char *const key[] = {
        "sslmode", "connect_timeout", "keepalives_idle", "keepalives_interval",
        "keepalives_count", "tcp_user_timeout", "target_session_attrs", "dbname",
        "client_encoding", "fallback_application_name", NULL};
    const char *const value[] = {
        "verify-full", "3", "4", "2",
        "3", "10000", "read-write", url,
        "UTF8", "surfaced", NULL};
    /* clang-format on */

    return PQconnectdbParams(key, value, 1);
}

/* Every connection has a shared lock of its session.  A process that takes the database alone waits for the
 * last of them to end, and keeps the others out. */
#define SETTINGS  "SET synchronous_commit = on; SET lock_timeout = '5s'; "
#define IN_USE    SETTINGS "SELECT pg_advisory_lock_shared(" SQL_IN_USE ")"
#define IF_UNUSED SETTINGS "SELECT 1 WHERE pg_try_advisory_lock(" SQL_IN_USE ")"

static enum status set_up(struct sql_postgres_conn *c, const char *settings,
                          struct errinfo *e)
{
    PGresult *r = sql_postgres_conn_exec(c, settings);
    const char *code = PQresultErrorField(r, PG_DIAG_SQLSTATE);
    enum status st = ST_OK;

    if (code != NULL && strcmp(code, "55P03") == 0)
        st = errinfo_set(e, ST_EBUSY, "%s: another process has it for itself alone",
                         c->of->url);
    else if (c->error.code != ST_OK)
        st = sql_postgres_conn_failed(c, e);
    else if (settings[sizeof SETTINGS - 1] != '\0' && PQntuples(r) == 0)
        st = errinfo_set(e, ST_EBUSY, "%s: another process has it open", c->of->url);
    PQclear(r);
    return st;
}

/* libpq has a line for each host of the URL, and others that begin with a tab. */
static enum status say_unreached(const PGconn *pg, struct errinfo *e)
{
    char text[400] = "";
    size_t n;

    for (const char *p = PQerrorMessage(pg); *p != '\0'; p += n + (p[n] != '\0')) {
        n = strcspn(p, "\n");
        if (p[0] != '\t' && strlen(text) + n + 3 < sizeof text) {
            (void)strcat(text, text[0] != '\0' ? "; " : "");
            (void)strncat(text, p, n);
        }
    }
    return sql_postgres_conn_say(e, ST_EBUSY, "it cannot be reached", text);
}

static enum status connect_to(struct sql_postgres *d, const char *settings, int64_t until,
                              struct sql_postgres_conn **out, struct errinfo *e)
{
    struct sql_postgres_conn *c = calloc(1, sizeof *c);
    enum status st = ST_OK;

    if (c == NULL)
        return errinfo_memory(e);
    c->base.driver = &sql_postgres_driver;
    c->of = d;
    c->wait_ms = SET_UP_MS;
    c->until = until;
    c->pg = dial(d->url);
    if (PQstatus(c->pg) != CONNECTION_OK) {
        st = say_unreached(c->pg, e);
    } else {
        (void)PQsetNoticeReceiver(c->pg, take_notice, c);
        (void)PQsetnonblocking(c->pg, 1);
        if ((st = set_up(c, settings, e)) == ST_OK && PQenterPipelineMode(c->pg) != 1)
            st = sql_postgres_conn_say(e, ST_EBUSY, "it cannot be used",
                                       PQerrorMessage(c->pg));
    }
    if (st == ST_OK)
        *out = c;
    else
        close_conn(c);
    return st;
}

/* One at rest that is still good, or a new one.  until: as c->until. */
static enum status sql_postgres_take(struct sql_postgres *d, int64_t until,
                                     struct sql_postgres_conn **out, struct errinfo *e)
{
    struct sql_postgres_conn *c;

    for (;;) {
        (void)pthread_mutex_lock(&d->lock);
        if ((c = d->idle) != NULL)
            d->idle = c->next;
        (void)pthread_mutex_unlock(&d->lock);
        if (c == NULL)
            return connect_to(d, d->alone != NULL ? SETTINGS : IN_USE, until, out, e);
        if (sql_postgres_conn_good(c)) {
            *out = c;
            return ST_OK;
        }
        close_conn(c);
    }
}

static void close_idle(struct sql_postgres *d)
{
    struct sql_postgres_conn *c;

    (void)pthread_mutex_lock(&d->lock);
    while ((c = d->idle) != NULL) {
        d->idle = c->next;
        close_conn(c);
    }
    (void)pthread_mutex_unlock(&d->lock);
}

/* If a connection is lost or of no more use, the idle ones of the same server probably are too. */
static void give_back(struct sql_postgres_conn *c)
{
    struct sql_postgres *d = c->of;

    if (sql_postgres_conn_lost(c) || c->error.code != ST_OK) {
        if (sql_postgres_conn_lost(c) || c->closing)
            close_idle(d);
        close_conn(c);
        return;
    }
    (void)pthread_mutex_lock(&d->lock);
    c->next = d->idle;
    d->idle = c;
    (void)pthread_mutex_unlock(&d->lock);
}

/* ---- transactions */

/* A SQL_TRY takes no sql_lock(), and so has to see one moment too. */
static const char *const begins[][2] = {
    [SQL_READ] = {"BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY", NULL},
    [SQL_WRITE] = {"BEGIN", NULL},
    [SQL_LAZY] = {"BEGIN", "SET LOCAL synchronous_commit = off"},
    [SQL_TRY] = {"BEGIN ISOLATION LEVEL REPEATABLE READ",
                 "SELECT set_config('synchronous_commit', 'off', true), "
                 "set_config('lock_timeout', '10ms', true)"},
    [SQL_SCHEMA] = {"BEGIN", NULL},
    [SQL_COPY] = {"BEGIN", NULL},
};

/* until: as c->until. */
static enum status begin_until(struct sql_postgres *d, enum sql_begin how, int64_t until,
                               struct sql_txn **t, struct errinfo *e)
{
    struct sql_postgres_conn *c = NULL;
    enum status st;

    if (how != SQL_READ && d->read_only)
        return errinfo_set(e, ST_EDENIED, "%s: opened for reading only", d->url);
    if ((st = sql_postgres_take(d, until, &c, e)) != ST_OK)
        return st;
    c->wait_ms = WAIT_MS;
    c->until = until;
    c->writes = how != SQL_READ;
    c->base.ahead = c->committing = c->committed = c->warned = false;
    c->cursors = c->lock = 0;
    c->proof = NULL;
    st = sql_postgres_conn_run(&c->base, begins[how][0], NULL, 0, false, e);
    if (st == ST_OK && begins[how][1] != NULL)
        st = sql_postgres_conn_run(&c->base, begins[how][1], NULL, 0, false, e);
    if (st != ST_OK)
        close_conn(c);
    *t = &c->base;
    return st;
}

static enum status sql_postgres_begin(struct sql *of, enum sql_begin how,
                                      struct sql_txn **t, struct errinfo *e)
{
    return begin_until((struct sql_postgres *)of, how, INT64_MAX, t, e);
}

static enum status lock(struct sql_txn *t, uint32_t key, struct errinfo *e)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;

    c->lock = key + 1;
    return SQL_RUN(t, e, "SELECT pg_advisory_xact_lock($1)", sql_int(SQL_LOCKS + key));
}

static void prove(struct sql_txn *t, const char *text, const struct sql_value *value,
                  size_t n)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;
    unsigned char *to = c->proof_bytes;

    c->proof = text;
    c->proof_n = n;
    for (size_t i = 0; i < n && i < SQL_POSTGRES_PROOF; i++) {
        c->proof_value[i] = value[i];
        if (value[i].n > 0) {
            assert(value[i].n <= (size_t)(c->proof_bytes + sizeof c->proof_bytes - to));
            c->proof_value[i].data = to;
            bytes_put(&to, value[i].data, value[i].n);
        }
    }
}

/* A commit waits for what it has to write, and so for all before that. */
static enum status sql_postgres_settle(struct sql_txn *t, struct errinfo *e)
{
    return sql_run(t, "SELECT pg_logical_emit_message(true, 'surfaced', '')", NULL, 0, e);
}

/* ST_OK: it was committed; ST_ENOTFOUND: it was not, nor will it be, as the lock that it held is
 * free.  What is seen may not be on a standby yet. */
static enum status sql_postgres_look(const struct sql_postgres_conn *lost, int64_t until,
                                     struct errinfo *e)
{
    struct sql_rows *r;
    struct sql_txn *t;
    enum status st = begin_until(lost->of, SQL_WRITE, until, &t, e);

    if (st != ST_OK)
        return st;
    if (lost->lock == 0 || (st = lock(t, lost->lock - 1, e)) == ST_OK) {
        st = sql_first(t, lost->proof, lost->proof_value, lost->proof_n, &r, e);
        st = sql_done(r, st, e);
    }
    if (st == ST_OK)
        st = sql_postgres_settle(t, e);
    return sql_end(t, st, e);
}

/* The connection was lost amid the commit. */
static enum status find_out(const struct sql_postgres_conn *lost, struct errinfo *e)
{
    const int64_t until = sql_postgres_wait_clock() + PROVE_MS;
    enum status st = ST_EBUSY;

    close_idle(lost->of);
    while (lost->proof != NULL && sql_postgres_wait_clock() < until && st == ST_EBUSY)
        if ((st = sql_postgres_look(lost, until, e)) == ST_EBUSY)
            wait_a_while();
    if (st == ST_OK)
        return st;
    return errinfo_set(e, ST_EBUSY,
                       st == ST_ENOTFOUND
                           ? "the database server was lost: nothing was changed"
                           : "the database server was lost amid the commit, which it may "
                             "have done or not");
}

static enum status sql_postgres_end(struct sql_txn *t, enum status st, struct errinfo *e)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;

    if (c->writes && st == ST_OK && (st = sql_postgres_conn_commit(c, e)) != ST_OK &&
        c->committing && sql_postgres_conn_lost(c))
        st = find_out(c, e);
    else if (st == ST_OK && c->committed && c->warned)
        st = errinfo_set(
            e, ST_EBUSY,
            "the database server did not wait for its standby: a failover may "
            "undo the change");
    if (!c->committed)
        sql_postgres_conn_rollback(c);
    give_back(c);
    return st;
}

/* ---- the schema */

static enum status version(struct sql_txn *t, int *out, struct errinfo *e)
{
    int64_t mine = 0, objects = 0, is = 0;
    struct sql_rows *r;
    enum status st = sql_first(
        t,
        "SELECT count(CASE WHEN relname = 'surfaced_schema' THEN 1 END), count(*) "
        "FROM pg_class WHERE relnamespace = CAST(current_schema() AS regnamespace)",
        NULL, 0, &r, e);

    *out = 0;
    if (st == ST_OK) {
        mine = sql_column(r, 0).i;
        objects = sql_column(r, 1).i;
    }
    if ((st = sql_done(r, st, e)) != ST_OK || objects == 0)
        return st;
    if (mine == 0)
        return errinfo_set(e, ST_ECORRUPT, "%s is the database of another program",
                           ((struct sql_postgres_conn *)t)->of->url);
    st = sql_first(t, "SELECT version FROM surfaced_schema", NULL, 0, &r, e);
    if (st == ST_OK)
        is = sql_column(r, 0).i;
    if ((st = sql_done(r, st, e)) != ST_OK && st != ST_ENOTFOUND)
        return st;
    if (is > VERSION)
        return errinfo_set(e, ST_EVERSION,
                           "%s has schema version %lld, this program knows up to %d: "
                           "use a newer program",
                           ((struct sql_postgres_conn *)t)->of->url, (long long)is,
                           VERSION);
    if (is < 1)
        return errinfo_set(e, ST_ECORRUPT, "%s has the impossible schema version %lld",
                           ((struct sql_postgres_conn *)t)->of->url, (long long)is);
    *out = (int)is;
    return ST_OK;
}

/* Several statements at once, which a pipeline does not take. */
static enum status sql_postgres_create(struct sql_txn *t, struct errinfo *e)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;

    sql_postgres_conn_settle(c, NULL);
    if (c->error.code == ST_OK && PQexitPipelineMode(c->pg) != 1)
        sql_postgres_conn_error(c, NULL);
    if (c->error.code != ST_OK)
        return sql_postgres_conn_failed(c, e);
    PQclear(sql_postgres_conn_exec(c, schema_postgres_sql));
    if (PQenterPipelineMode(c->pg) != 1)
        sql_postgres_conn_error(c, NULL);
    if (c->error.code != ST_OK)
        return sql_postgres_conn_failed(c, e);
    c->of->base.version = VERSION;
    return ST_OK;
}

static enum status bytes(struct sql_txn *t, uint64_t *out, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        sql_first(t, "SELECT pg_database_size(current_database())", NULL, 0, &r, e);

    if (st == ST_OK)
        *out = (uint64_t)sql_column(r, 0).i;
    return sql_done(r, st, e);
}

/* ---- opening */

/* The list of processes and the log would show a password in a URL. */
static enum status check_url(const char *url, struct errinfo *e)
{
    PQconninfoOption *option = PQconninfoParse(url, NULL);
    bool secret = false;

    if (option == NULL)
        return errinfo_set(e, ST_EINVAL,
                           "the URL of the database is malformed: it should be like "
                           "postgresql://user@host1,host2/faces");
    for (PQconninfoOption *o = option; o->keyword != NULL; o++)
        secret = secret || (o->val != NULL && (strcmp(o->keyword, "password") == 0 ||
                                               strcmp(o->keyword, "sslpassword") == 0));
    PQconninfoFree(option);
    return !secret ? ST_OK
                   : errinfo_set(e, ST_EINVAL,
                                 "the URL of the database has a password: put it into "
                                 "~/.pgpass (or a file that passfile= names), or use a "
                                 "certificate");
}

static enum status take_alone(struct sql_postgres *d, struct errinfo *e)
{
    const int64_t until = sql_postgres_wait_clock() + ALONE_MS;
    enum status st;

    while ((st = connect_to(d, IF_UNUSED, INT64_MAX, &d->alone, e)) == ST_EBUSY &&
           sql_postgres_wait_clock() < until)
        wait_a_while();
    return st;
}

static void close_server(struct sql *of)
{
    struct sql_postgres *d = (struct sql_postgres *)of;

    close_idle(d);
    close_conn(d->alone);
    (void)pthread_mutex_destroy(&d->lock);
    free(d->url);
    free(d);
}

enum status sql_postgres_open(const char *url, enum sql_open how, struct sql **out,
                              struct errinfo *e)
{
    struct sql_postgres *d;
    struct sql_txn *t;
    enum status st = check_url(url, e);

    if (st != ST_OK)
        return st;
    if ((d = calloc(1, sizeof *d)) == NULL || (d->url = strdup(url)) == NULL) {
        free(d);
        return errinfo_memory(e);
    }
    d->base.driver = &sql_postgres_driver;
    d->read_only = how == SQL_OPEN_READ;
    (void)pthread_mutex_init(&d->lock, NULL);
    if (how == SQL_OPEN_ALONE)
        st = take_alone(d, e);
    if (st == ST_OK && (st = sql_postgres_begin(&d->base, SQL_READ, &t, e)) == ST_OK)
        st = sql_postgres_end(t, version(t, &d->base.version, e), e);
    if (st == ST_OK)
        *out = &d->base;
    else
        close_server(&d->base);
    return st;
}

const struct sql_driver sql_postgres_driver = {
    .pipelines = true,
    .close = close_server,
    .begin = sql_postgres_begin,
    .end = sql_postgres_end,
    .version = version,
    .create = sql_postgres_create,
    .bytes = bytes,
    .lock = lock,
    .prove = prove,
    .settle = sql_postgres_settle,
    .run = sql_postgres_conn_run,
    .changed = sql_postgres_conn_changed,
    .query = sql_postgres_conn_query,
    .next = sql_postgres_conn_next,
    .column = sql_postgres_conn_column,
    .done = sql_postgres_conn_done,
};
