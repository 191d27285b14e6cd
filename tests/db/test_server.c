/* A store on a PostgreSQL (scripts/with_postgres): how often it waits for the server, what it does when
 * the server ends its connections, amid a commit too, sends no more or reads no more, and what it makes
 * of another daemon's commit between any two of its statements. */
/* link: -Wl,--wrap=poll,--wrap=clock_gettime,--wrap=PQisBusy,--wrap=PQgetResult,--wrap=PQfinish,--wrap=PQpipelineSync,--wrap=PQsendPrepare,--wrap=PQsendQueryPrepared,--wrap=PQsendQueryParams */
#include <libpq-fe.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "sql.h"
#include "store.h"
#include "store_txn.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;
static unsigned waits; /* for a round trip, or what is left of one */
static bool waiting;   /* since the last statements were sent */

static unsigned cut_at; /* what is sent for the n-th time is not replied to; 0: none */
static PGconn *last;    /* the connection that was last sent to */

static unsigned fetch_at; /* the n-th FETCH cannot be sent; 0: none */

static unsigned silent_at; /* after so many results a connection has no more; 0: never */
static PGconn *silent;     /* that connection */
static bool hurry;         /* a wait ends after 50 ms, as if its whole time had passed */
static time_t passed_s;    /* by such waits, on the monotonic clock */

/* Connects fd to a socket that no process reads.  Returns the other end. */
static int divert(int fd)
{
    int ends[2];

    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    assert_int_equal(dup2(ends[0], fd), fd);
    (void)close(ends[0]);
    return ends[1];
}

/* The server has done what it was sent; its reply is lost. */
static void cut(int fd)
{
    (void)nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    (void)close(divert(fd));
}

int __real_clock_gettime(clockid_t clock, struct timespec *t);
int __wrap_clock_gettime(clockid_t clock, struct timespec *t);
int __wrap_clock_gettime(clockid_t clock, struct timespec *t)
{
    const int done = __real_clock_gettime(clock, t);

    if (clock == CLOCK_MONOTONIC)
        t->tv_sec += passed_s;
    return done;
}

int __real_poll(struct pollfd *fd, nfds_t n, int ms);
int __wrap_poll(struct pollfd *fd, nfds_t n, int ms);
int __wrap_poll(struct pollfd *fd, nfds_t n, int ms)
{
    const bool mute = silent != NULL && fd->fd == PQsocket(silent);
    int ready = 0;

    waits += !waiting;
    waiting = true;
    if (!mute && !hurry)
        return __real_poll(fd, n, ms);
    if (!mute)
        ready = __real_poll(fd, n, 50);
    if (ready == 0)
        passed_s += (ms + 999) / 1000;
    return ready;
}

int __real_PQisBusy(PGconn *pg);
int __wrap_PQisBusy(PGconn *pg);
int __wrap_PQisBusy(PGconn *pg)
{
    return pg == silent ? 1 : __real_PQisBusy(pg);
}

PGresult *__real_PQgetResult(PGconn *pg);
PGresult *__wrap_PQgetResult(PGconn *pg);
PGresult *__wrap_PQgetResult(PGconn *pg)
{
    PGresult *r = __real_PQgetResult(pg);

    if (r != NULL && silent_at > 0 && --silent_at == 0)
        silent = pg;
    return r;
}

void __real_PQfinish(PGconn *pg);
void __wrap_PQfinish(PGconn *pg);
void __wrap_PQfinish(PGconn *pg)
{
    silent = pg == silent ? NULL : silent;
    __real_PQfinish(pg);
}

/* Every other connection to the database. */
static void end_connections(void)
{
    tempdb_sql("SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity "
               "WHERE datname = current_database() AND pid <> pg_backend_pid()");
}

int __real_PQpipelineSync(PGconn *pg);
int __wrap_PQpipelineSync(PGconn *pg);
int __wrap_PQpipelineSync(PGconn *pg)
{
    const int done = __real_PQpipelineSync(pg);

    last = pg;
    waiting = false;
    if (cut_at > 0 && --cut_at == 0)
        cut(PQsocket(pg));
    return done;
}

/* Returns a new store on the server; without a server the test is skipped. */
static struct store *fresh(void)
{
    if (!tempdb_server)
        skip();
    return tempdb_fresh();
}

static void verify(struct store *s, const char *secret, const char *subject,
                   enum store_record_as as, enum status wanted)
{
    const struct store_snapshot_of of = {.subject = subject, .token = "t"};
    const struct store_scan scan = {.noise_mm = 0.25, .quality = 0.9};
    const struct store_probe probe = {
        .read = {"0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"}};
    struct surface_face *face = NULL;
    struct store_snapshot is;
    struct store_recorded out;
    struct store_token t;

    assert_int_equal(store_token_check(s, secret, &t, &e), wanted);
    if (wanted != ST_OK)
        return;
    must(store_snapshot_begin(s, &of, &is, &e));
    must(store_snapshot_face(&is, 0, tempdb_work, &face, &e));
    must(store_snapshot_end(&is, ST_OK, &e));
    assert_true(surface_face_points(face, NULL) > 0); /* one template: it is whole */
    surface_face_free(face);
    must(store_record_verification(s,
                                   &(struct store_record){.subject = &is.subject,
                                                          .as = as,
                                                          .actor = "t",
                                                          .kind = "verify",
                                                          .template_id = is.t[0].id,
                                                          .outcome = "match",
                                                          .decision = "match",
                                                          .scan = &scan,
                                                          .probe = &probe},
                                   &out, &e));
    assert_false(out.replayed);
    store_snapshot_free(&is);
}

static unsigned enroll(struct store *s, const char *secret, const char *subject)
{
    const struct store_sample sample = {.face = &tempdb_face[0]};
    struct store_template t;
    struct store_token token;
    bool created;

    waits = 0;
    must(store_token_check(s, secret, &token, &e));
    must(store_enroll(
        s,
        &(struct store_enroll){
            .actor = "t", .subject = subject, .label = "", .sample = &sample, .n = 1},
        &t, &created, &e));
    assert_true(created);
    return waits;
}

/* Returns a new store with alice.  Statements are prepared, and the token was used. */
static struct store *with_alice(char secret[65])
{
    struct store *s = fresh();
    struct store_token t;

    must(store_token_create(s, "test", "t", STORE_SCOPE_ALL, "", tempdb_in(60), secret,
                            &t, &e));
    (void)enroll(s, secret, "alice");
    return s;
}

TEST(test_round_trips)
{
    char secret[65];
    struct store *s = with_alice(secret);

    verify(s, secret, "alice", STORE_RECORD_FAILED, ST_OK);
    for (int i = 0; i < 3; i++) {
        char name[8] = "bob0";

        name[3] = (char)('0' + i);
        assert_in_range(enroll(s, secret, name), 1, 8);
        waits = 0;
        verify(s, secret, "alice", STORE_RECORD_PASSED, ST_OK);
        assert_in_range(waits, 1, 6);
        waits = 0;
        verify(s, secret, "alice", STORE_RECORD_FAILED, ST_OK);
        assert_in_range(waits, 1, 6);
    }
    store_close(s);
}

/* At rest: nobody notices.  Amid a transaction: try again later, and nothing is changed. */
TEST(test_lost)
{
    struct store_subject one = {.id = "eve", .identify = true};
    char secret[65];
    struct store *s = with_alice(secret);
    struct log_txn x;

    for (int i = 0; i < 3; i++) {
        end_connections();
        verify(s, secret, "alice", STORE_RECORD_PASSED, ST_OK);
    }
    must(store_begin(s, SQL_WRITE, &x, &e));
    end_connections();
    fails(store_end(s, &x, log_access(&x, "verify", NULL, "", "", &e), &e), ST_EBUSY);
    must(store_subject_add(s, "test", &one, &e));
    assert_int_equal(tempdb_count("subjects"), 2);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

/* Adds subjects, each time with the connection broken at the next step, as *at counts down, until there
 * is no such step.  What was said to be done is there, and nothing else.  Returns how many were done all
 * the same; *said: errors with this text. */
static unsigned add_broken(unsigned *at, const char *text, unsigned *said)
{
    unsigned done_anyway = 0;
    struct store *s = fresh();
    bool broke = true;

    tempdb_add(s, "first");
    *said = 0;
    for (unsigned n = 1; broke; n++) {
        struct store_subject one = {.identify = true}, got;
        enum status st;

        (void)snprintf(one.id, sizeof one.id, "s%u", n);
        *at = n;
        st = store_subject_add(s, "test", &one, &e);
        broke = *at == 0;
        *at = 0;
        silent = NULL;
        assert_true(st == ST_OK || (broke && st == ST_EBUSY));
        *said += st == ST_EBUSY && strstr(e.msg, text) != NULL;
        done_anyway += broke && st == ST_OK;
        assert_int_equal(store_subject_get(s, "", one.id, &got, NULL),
                         st == ST_OK ? ST_OK : ST_ENOTFOUND);
        must(store_verify(s, NULL, NULL, &e));
    }
    store_close(s);
    return done_anyway;
}

TEST(test_cut)
{
    unsigned lost;

    assert_int_equal(add_broken(&cut_at, "was lost", &lost), 1); /* the commit */
    assert_true(lost > 0);
}

/* Whichever result is the last in time: the error says so, or what became of the commit is known. */
TEST(test_silent)
{
    unsigned late;

    assert_in_range(add_broken(&silent_at, "did not answer within 120 s", &late), 1,
                    5); /* from the commit on */
    assert_in_range(late, 5, 100);
}

static const char much[1 << 20]; /* more than a socket takes */

/* The driver waits with a limit to send, and not at all to close the connection. */
TEST(test_reads_no_more)
{
    struct log_txn x;
    struct store *s = fresh();
    uint64_t n;
    int end;

    must(store_begin(s, SQL_READ, &x, &e));
    end = divert(PQsocket(last));
    hurry = true;
    must(SQL_RUN(x.sql, &e, "SELECT length($1)", sql_blob(much, sizeof much)));
    fails(sql_changed(x.sql, &n, &e), ST_EBUSY);
    assert_non_null(strstr(e.msg, "did not answer within 120 s"));
    fails(store_end(s, &x, ST_EBUSY, NULL), ST_EBUSY);
    hurry = false;
    (void)close(end);
    tempdb_add(s, "first");
    store_close(s);
}

/* A connection whose rollback cannot be sent is closed: the server would keep the transaction. */
TEST(test_rollback_unsent)
{
    struct log_txn x;
    struct store *s = fresh();
    int end;

    must(store_begin(s, SQL_READ, &x, &e));
    end = divert(PQsocket(last));
    for (int i = 0; i < 100; i++)
        must(SQL_RUN(x.sql, &e, "SELECT length($1)", sql_blob(much, 8000)));
    fails(store_end(s, &x, ST_ENOTFOUND, NULL), ST_ENOTFOUND);
    tempdb_add(s, "first");
    (void)close(end);
    store_close(s);
}

/* The transaction that finds it fails, and its connection is closed: the next one succeeds. */
TEST(test_stale_plan)
{
    struct store_subject one;
    struct store *s = fresh();

    tempdb_add(s, "first");
    must(store_subject_get(s, "", "first", &one, &e));
    tempdb_sql("ALTER TABLE main.subjects ALTER COLUMN hold TYPE integer");
    fails(store_subject_get(s, "", "first", &one, &e), ST_EBUSY);
    assert_non_null(strstr(e.msg, "cached plan"));
    must(store_subject_get(s, "", "first", &one, &e));
    store_close(s);
}

static void set_timeout(const char *value)
{
    char text[200];

    (void)snprintf(text, sizeof text,
                   "DO $$ BEGIN EXECUTE format('ALTER DATABASE %%I SET "
                   "idle_in_transaction_session_timeout = %s', current_database()); "
                   "END $$",
                   value);
    tempdb_sql(text);
}

TEST(test_idle_in_transaction)
{
    struct log_txn x;
    struct store *s = fresh();
    uint64_t n;

    set_timeout("100");
    end_connections();
    must(store_begin(s, SQL_READ, &x, &e));
    (void)nanosleep(&(struct timespec){.tv_nsec = 300000000}, NULL);
    fails(store_end(s, &x, sql_bytes(x.sql, &n, &e), NULL), ST_EBUSY);
    assert_non_null(strstr(e.msg, "idle-in-transaction timeout"));
    must(store_verify(s, NULL, NULL, &e));
    set_timeout("DEFAULT");
    store_close(s);
}

/* A stream of 40 numbers whose first batch was read. */
static struct sql_rows *stream(struct store *s, struct log_txn *x)
{
    struct sql_rows *r;

    must(store_begin(s, SQL_READ, x, &e));
    must(sql_stream(x->sql, "SELECT CAST(n AS bigint) FROM generate_series(1, 40) n",
                    NULL, 0, &r, &e));
    for (int64_t i = 1; i <= 16; i++) {
        assert_true(sql_next(r));
        assert_int_equal(sql_column(r, 0).i, i);
    }
    return r;
}

TEST(test_stream_cut)
{
    struct sql_rows *r;
    struct log_txn x;
    struct store *s = fresh();
    uint64_t n;

    r = stream(s, &x);
    for (int64_t i = 17; i <= 40; i++)
        assert_true(sql_next(r));
    assert_false(sql_next(r));
    must(store_end(s, &x, sql_done(r, ST_OK, &e), &e));
    fetch_at = 2;
    r = stream(s, &x);
    assert_false(sql_next(r));
    fails(store_end(s, &x, sql_done(r, ST_OK, &e), NULL), ST_EBUSY);
    r = stream(s, &x);
    must(sql_run(x.sql, "SELECT 1 / 0", NULL, 0, &e));
    fails(sql_changed(x.sql, &n, &e), ST_EDB);
    assert_false(sql_next(r));
    fails(store_end(s, &x, sql_done(r, ST_OK, &e), NULL), ST_EDB);
    store_close(s);
}

/* An error of a statement, and a stream after it, do not cost the connection. */
TEST(test_error_keeps_connection)
{
    struct sql_rows *r;
    struct log_txn x;
    struct store *s = fresh();
    uint64_t n;
    int pid;

    must(store_begin(s, SQL_READ, &x, &e));
    pid = PQbackendPID(last);
    must(sql_run(x.sql, "SELECT 1 / 0", NULL, 0, &e));
    fails(sql_changed(x.sql, &n, &e), ST_EDB);
    fails(sql_stream(x.sql, "SELECT 1", NULL, 0, &r, &e), ST_EDB);
    fails(store_end(s, &x, ST_EDB, NULL), ST_EDB);
    must(store_begin(s, SQL_READ, &x, &e));
    assert_int_equal(PQbackendPID(last), pid);
    must(store_end(s, &x, ST_OK, &e));
    store_close(s);
}

/* ---- another daemon */

static struct store *other;   /* which commits something before each statement of ours, */
static bool inside;           /* but not what would have to wait for our transaction */
static bool changes, uses;    /* we have the lock of all changes, one of the others */
static char lock_name[32];    /* of the prepared statement that takes a lock */
static char ends_name[2][32]; /* and of those that end a transaction */
static unsigned others, held; /* times that it did so, and with a lock of ours */

/* Both add to the other's accesses; ours may have the lock of alice. */
static void use_something(void)
{
    const char *who = uses || changes ? "zoe" : "alice";

    must(tempdb_record(other, who, STORE_RECORD_FAILED, &e));
    must(tempdb_record(other, who, STORE_RECORD_PASSED, &e));
}

/* Every third changes rows that are there. */
static void change_something(void)
{
    struct store_template t;
    char name[16];

    (void)snprintf(name, sizeof name, "o%u", others);
    if (others % 3 != 0)
        tempdb_add(other, name);
    else
        tempdb_enroll(other, name, "", &tempdb_face[1], &t);
    if (others % 2 == 0)
        must(tempdb_erase(other, "test", name, &e));
}

static void commit_something(void)
{
    inside = true;
    others++;
    held += changes || uses;
    use_something();
    if (!changes)
        change_something();
    inside = false;
}

/* By what is locked: its key, as it is sent. */
static void note_lock(const char *data)
{
    if (memcmp(data + 4, (const char[4]){0}, 4) == 0)
        changes = true;
    else
        uses = true;
}

int __real_PQsendPrepare(PGconn *pg, const char *name, const char *text, int n,
                         const Oid *type);
int __wrap_PQsendPrepare(PGconn *pg, const char *name, const char *text, int n,
                         const Oid *type);
int __wrap_PQsendPrepare(PGconn *pg, const char *name, const char *text, int n,
                         const Oid *type)
{
    if (strstr(text, "pg_advisory_xact_lock") != NULL)
        (void)snprintf(lock_name, sizeof lock_name, "%s", name);
    if (strcmp(text, "COMMIT") == 0 || strcmp(text, "ROLLBACK") == 0)
        (void)snprintf(ends_name[text[0] == 'R'], sizeof *ends_name, "%s", name);
    return __real_PQsendPrepare(pg, name, text, n, type);
}

int __real_PQsendQueryPrepared(PGconn *pg, const char *name, int n,
                               const char *const *data, const int *len, const int *format,
                               int result);
int __wrap_PQsendQueryPrepared(PGconn *pg, const char *name, int n,
                               const char *const *data, const int *len, const int *format,
                               int result);
int __wrap_PQsendQueryPrepared(PGconn *pg, const char *name, int n,
                               const char *const *data, const int *len, const int *format,
                               int result)
{
    if (other != NULL && !inside) {
        (void)PQflush(pg); /* the server has what is before it */
        commit_something();
        if (strcmp(name, lock_name) == 0)
            note_lock(data[0]);
        else if (strcmp(name, ends_name[0]) == 0 || strcmp(name, ends_name[1]) == 0)
            changes = uses = false;
    }
    return __real_PQsendQueryPrepared(pg, name, n, data, len, format, result);
}

int __real_PQsendQueryParams(PGconn *pg, const char *text, int n, const Oid *type,
                             const char *const *data, const int *len, const int *format,
                             int result);
int __wrap_PQsendQueryParams(PGconn *pg, const char *text, int n, const Oid *type,
                             const char *const *data, const int *len, const int *format,
                             int result);
int __wrap_PQsendQueryParams(PGconn *pg, const char *text, int n, const Oid *type,
                             const char *const *data, const int *len, const int *format,
                             int result)
{
    if (other != NULL && !inside) {
        (void)PQflush(pg);
        commit_something();
    }
    if (fetch_at > 0 && strncmp(text, "FETCH", 5) == 0 && --fetch_at == 0)
        return 0;
    return __real_PQsendQueryParams(pg, text, n, type, data, len, format, result);
}

static void problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    (void)arg, (void)log, (void)seq;
    fail_msg("%s", line);
}

TEST(test_another_daemon)
{
    struct log_walk walk;
    struct store_subject one;
    char secret[65];
    struct store *s = with_alice(secret);

    tempdb_add(s, "zoe");
    other = tempdb_open(STORE_WRITE);
    other->log.daemon = 1;
    other->log.found = (struct log_end){.seq = 0};
    for (int i = 0; i < 3; i++) {
        char name[8] = "bob0";

        name[3] = (char)('0' + i);
        verify(s, secret, "alice", STORE_RECORD_PASSED, ST_OK);
        verify(s, secret, "alice", STORE_RECORD_FAILED, ST_OK);
        (void)enroll(s, secret, name);
        must(store_subject_get(s, "", name, &one, &e));
        must(tempdb_erase(s, "test", name, &e));
        must(store_verify(s, NULL, NULL, &e));
        must(store_audit_verify(s, problem, NULL, &walk, &e));
    }
    assert_in_range(others, 100, 10000);
    assert_in_range(held, 50, others - 50);
    store_close(other);
    other = NULL;
    store_close(s);
    s = tempdb_open(STORE_WRITE);
    must(store_verify(s, NULL, NULL, &e));
    must(store_audit_verify(s, problem, NULL, &walk, &e));
    store_close(s);
}
