/* link: -Wl,--wrap=sql_prove */
/* What a transaction sees of the logs: an open store refuses for good what is older than it has
 * seen or another branch, and takes what others add; no store takes an end that is not authentic. */
#include <sys/wait.h>
#include <unistd.h>

#include "errinfo.h"
#include "store_txn.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;

static unsigned proofs; /* of commits, each asked for at the end of its transaction */

void __wrap_sql_prove(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n);
void __wrap_sql_prove(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n)
{
    struct sql_rows *r;

    const enum status st = sql_first(t, text, value, n, &r, &e);

    must(sql_done(r, st, &e));
    proofs++;
}

static void use(struct store *s)
{
    must(store_event(s, "verify", "test", "", "", "match", &e));
}

static uint64_t last(struct store *s)
{
    struct log_end end;

    must(store_last_change(s, &end, &e));
    return end.seq;
}

static void assert_refused(struct store *s, const char *why)
{
    struct errinfo again = {ST_OK, ""};
    struct log_end end;

    fails(store_last_change(s, &end, &e), ST_EREFUSED);
    assert_non_null(strstr(e.msg, why));
    assert_true(store_refused(s, &again));
    assert_string_equal(again.msg, e.msg);
    fails(store_event(s, "verify", "", "", "", "", &e), ST_EREFUSED);
}

/* Another handle, and another process. */
TEST(test_follow)
{
    struct store *s = tempdb_fresh(), *other = tempdb_open(STORE_WRITE);
    pid_t child;
    int status;

    assert_int_equal(last(s), 1);
    for (int i = 0; i < 3; i++) {
        tempdb_add(other, (char[]){'a', (char)('0' + i), '\0'});
        assert_int_equal(last(s), 2 + 2 * i);
        tempdb_add(s, (char[]){'b', (char)('0' + i), '\0'});
        assert_int_equal(last(other), 3 + 2 * i);
    }
    if ((child = fork()) == 0) {
        struct store_subject one = {.id = "carol", .identify = true};
        struct store *mine;

        _exit(store_open(tempdb_path, STORE_WRITE, &tempdb_key, &mine, &e) == ST_OK &&
                      store_subject_add(mine, "test", &one, &e) == ST_OK
                  ? 0
                  : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_int_equal(last(s), 8);
    must(store_verify(s, NULL, NULL, &e));
    store_close(other);
    store_close(s);
}

/* All of the older state, which verifies: who has seen more refuses it, however it goes on. */
TEST(test_older)
{
    struct store *s = tempdb_fresh(), *late, *other;

    tempdb_add(s, "alice");
    tempdb_keep("old");
    tempdb_add(s, "bob");
    late = tempdb_open(STORE_WRITE);
    assert_int_equal(last(late), 3);
    tempdb_put_back("old");
    assert_refused(s, "it is an older one, without change 3");
    other = tempdb_open(STORE_WRITE); /* which cannot know */
    tempdb_add(other, "c1");
    tempdb_add(other, "c2");
    assert_int_equal(last(other), 4);
    assert_refused(s, "it is an older one, without change 3");
    assert_refused(late, "its log is another one from change 3");
    store_close(other);
    store_close(late);
    store_close(s);
}

/* Between what was seen and the end: each entry follows the one before. */
TEST(test_between)
{
    static const char *const sql[] = {
        "UPDATE change_log SET outcome = 'x' WHERE seq = 3",
        "UPDATE change_log SET hash = zeroblob(32) WHERE seq = 3",
        "DELETE FROM change_log WHERE seq = 3",
        "UPDATE change_log SET digest = zeroblob(72) WHERE seq = 3",
        "UPDATE change_log SET access_seq = 1 WHERE seq = 3",
    };

    for (size_t i = 0; i < sizeof sql / sizeof *sql; i++) {
        struct store *s = tempdb_fresh(), *other = tempdb_open(STORE_WRITE);

        tempdb_add(s, "alice");
        tempdb_add(other, "bob");
        tempdb_add(other, "carol");
        tempdb_add(other, "dave");
        tempdb_sql(sql[i]);
        assert_refused(s, "its log is another one from change 2");
        store_close(other);
        store_close(s);
    }
}

/* The last entry: each column of it, and its being there. */
TEST(test_end)
{
    static const char *const sql[] = {
        "UPDATE change_log SET at = '2020-01-01T00:00:00.000Z' WHERE seq = 3",
        "UPDATE change_log SET kind = 'x' WHERE seq = 3",
        "UPDATE change_log SET actor = 'x' WHERE seq = 3",
        "UPDATE change_log SET uid = zeroblob(16) WHERE seq = 3",
        "UPDATE change_log SET object = 'x' WHERE seq = 3",
        "UPDATE change_log SET outcome = 'x' WHERE seq = 3",
        "UPDATE change_log SET access_seq = 0 WHERE seq = 3",
        "UPDATE change_log SET daemon = 1 WHERE seq = 3",
        "UPDATE change_log SET access_hash = zeroblob(32) WHERE seq = 3",
        "UPDATE change_log SET hash = zeroblob(32) WHERE seq = 3",
        "UPDATE change_log SET mac = zeroblob(32) WHERE seq = 3",
        "UPDATE change_log SET seq = 4 WHERE seq = 3",
        "UPDATE change_log SET digest = (SELECT digest FROM change_log WHERE seq = 2)",
        ("UPDATE change_log SET digest = (SELECT digest FROM branch_change_log WHERE seq = 3)"
         " WHERE seq = 3"), /* of the same number, by the same key */
        "UPDATE change_log SET hash = zeroblob(32) WHERE seq = 2",
        "DELETE FROM change_log",
    };

    for (size_t i = 0; i < sizeof sql / sizeof *sql; i++) {
        struct store *s = tempdb_fresh(), *other;

        use(s);
        tempdb_add(s, "alice");
        tempdb_keep("old");
        tempdb_add(s, "carol");
        tempdb_keep("branch");
        store_close(s);
        tempdb_put_back("old");
        s = tempdb_open(STORE_WRITE);
        tempdb_add(s, "bob");
        tempdb_sql(sql[i]);
        fails(store_open(tempdb_path, STORE_READ, &tempdb_key, &other, &e), ST_ECORRUPT);
        assert_refused(s, "");
        store_close(s);
    }
}

/* Accesses follow the last one, whose MAC is verified, and the one that the last change found. */
TEST(test_accesses)
{
    static const char *const sql[] = {
        "UPDATE access_log SET mac = zeroblob(32) WHERE seq = 3",
        "UPDATE access_log SET hash = zeroblob(32) WHERE seq = 3",
        "DELETE FROM access_log WHERE seq >= 2", /* the last change found two */
        "DELETE FROM access_log",
    };

    for (size_t i = 0; i < sizeof sql / sizeof *sql; i++) {
        struct store *s = tempdb_fresh();
        struct store_subject bob = {.id = "bob"};

        use(s);
        use(s);
        tempdb_add(s, "alice");
        use(s);
        tempdb_sql(sql[i]);
        fails(store_event(s, "verify", "", "", "", "", &e), ST_ECORRUPT);
        assert_non_null(strstr(e.msg, "the last entry of the access log"));
        fails(store_subject_add(s, "test", &bob, &e), ST_ECORRUPT);
        assert_int_equal(tempdb_count("change_log"), 2);
        store_close(s);
    }
}

/* Rows are not changed without an entry, and an entry's digest is that of the rows. */
TEST(test_unlogged)
{
    struct store *s = tempdb_fresh();
    unsigned char mac[CRYPT_HASH] = {1}, sum[LOG_DIGEST];
    struct log_txn t;
    bool same;

    must(store_act_begin(s, "test", SQL_WRITE, &t, &e));
    must(log_txn_count(&t, NULL, mac, &e));
    fails(store_end(s, &t, ST_OK, &e), ST_EINTERNAL);
    assert_int_equal(last(s), 1);

    must(store_act_begin(s, "test", SQL_WRITE, &t, &e));
    must(log_txn_count(&t, NULL, mac, &e));
    must(log_change(&t, "test", NULL, "", "", &e));
    must(store_end(s, &t, ST_OK, &e));
    must(store_begin(s, SQL_READ, &t, &e));
    memset(sum, 0, sizeof sum);
    log_txn_sum(s->crypt, NULL, mac, sum);
    must(log_txn_agrees(&t, sum, &same, &e));
    assert_true(same);
    sum[31] ^= 0x80;
    must(log_txn_agrees(&t, sum, &same, &e));
    assert_false(same);
    must(store_end(s, &t, ST_OK, &e));
    store_close(s);
}

/* A commit whose reply is lost is proved by the entry that it has added. */
TEST(test_proof)
{
    struct store *s = tempdb_fresh();
    struct log_txn t;

    proofs = 0;
    use(s);
    tempdb_add(s, "alice");
    assert_int_equal(proofs, 2);
    must(store_begin(s, SQL_LAZY, &t, &e)); /* which adds none */
    must(store_end(s, &t, ST_OK, &e));
    assert_int_equal(proofs, 2);
    store_close(s);
}
