/* A store on a PostgreSQL (scripts/with_postgres): how often it waits for the server, and what it does
 * when the server ends its connections, amid a commit too. */
/* link: -Wl,--wrap=poll,--wrap=PQpipelineSync */
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

/* The server has done what it was sent; its reply is lost. */
static void cut(int fd)
{
    int ends[2];

    (void)nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    assert_int_equal(dup2(ends[0], fd), fd);
    (void)close(ends[0]);
    (void)close(ends[1]);
}

int __real_poll(struct pollfd *fd, nfds_t n, int ms);
int __wrap_poll(struct pollfd *fd, nfds_t n, int ms);
int __wrap_poll(struct pollfd *fd, nfds_t n, int ms)
{
    waits += !waiting;
    waiting = true;
    return __real_poll(fd, n, ms);
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

    waiting = false;
    if (cut_at > 0 && --cut_at == 0)
        cut(PQsocket(pg));
    return done;
}

static void verify(struct store *s, const char *secret, const char *subject,
                   enum store_record_as as, enum status wanted)
{
    const struct store_snapshot_of of = {.subject = subject, .token = "t"};
    const struct store_probe probe = {
        .read = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"};
    struct store_snapshot is;
    struct store_recorded out;
    struct store_token t;

    assert_int_equal(store_token_check(s, secret, &t, &e), wanted);
    if (wanted != ST_OK)
        return;
    must(store_snapshot_end(&is, store_snapshot_begin(s, &of, &is, &e), &e));
    must(store_record_verification(s,
                                   &(struct store_record){.subject = &is.subject,
                                                          .as = as,
                                                          .actor = "t",
                                                          .kind = "verify",
                                                          .template_id = is.t[0].id,
                                                          .outcome = "match",
                                                          .decision = "match",
                                                          .probe = &probe},
                                   &out, &e));
    assert_false(out.replayed);
    store_snapshot_free(&is);
}

static unsigned enroll(struct store *s, const char *secret, const char *subject)
{
    struct store_template t;
    struct store_token token;

    waits = 0;
    must(store_token_check(s, secret, &token, &e));
    tempdb_enroll(s, subject, "", &tempdb_face[0], &t);
    return waits;
}

TEST(test_round_trips)
{
    struct store_token t;
    struct store *s;
    char secret[65];

    if (!tempdb_server)
        skip();
    s = tempdb_fresh();
    must(store_token_create(s, "test", "t", STORE_SCOPE_ALL, 60, secret, &t, &e));
    (void)enroll(s, secret, "alice"); /* statements are prepared, the token is used */
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
    struct store_subject one = {.id = "eve"};
    struct store_token t;
    struct log_txn x;
    struct store *s;
    char secret[65];

    if (!tempdb_server)
        skip();
    s = tempdb_fresh();
    must(store_token_create(s, "test", "t", STORE_SCOPE_ALL, 60, secret, &t, &e));
    (void)enroll(s, secret, "alice");
    for (int i = 0; i < 3; i++) {
        end_connections();
        verify(s, secret, "alice", STORE_RECORD_PASSED, ST_OK);
    }
    must(store_begin(s, SQL_WRITE, &x, &e));
    end_connections();
    fails(store_end(
              s, &x,
              log_access(&x, &(struct log_act){.actor = "t"}, "verify", NULL, "", "", &e),
              &e),
          ST_EBUSY);
    must(store_subject_add(s, "test", &one, &e));
    assert_int_equal(tempdb_count("subjects"), 2);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

/* Wherever the connection is cut: what was said to be done is there, and nothing else. */
TEST(test_cut)
{
    unsigned done_anyway = 0;
    struct store *s;
    bool cut_it = true;

    if (!tempdb_server)
        skip();
    s = tempdb_fresh();
    tempdb_add(s, "first");
    for (unsigned n = 1; cut_it; n++) {
        struct store_subject one = {.reference = ""}, got;
        enum status st;

        (void)snprintf(one.id, sizeof one.id, "s%u", n);
        cut_at = n;
        st = store_subject_add(s, "test", &one, &e);
        cut_it = cut_at == 0;
        cut_at = 0;
        done_anyway += cut_it && st == ST_OK;
        assert_true(st == ST_OK || (cut_it && st == ST_EBUSY));
        assert_int_equal(store_subject_get(s, one.id, &got, NULL),
                         st == ST_OK ? ST_OK : ST_ENOTFOUND);
        must(store_verify(s, NULL, NULL, &e));
    }
    assert_int_equal(done_anyway, 1); /* the commit */
    store_close(s);
}
