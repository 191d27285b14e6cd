/* The master key of an open store: transactions end with the key that they began with, and an old
 * key is kept no longer; what another process makes of the key record is taken only where the key
 * has authenticated it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "errinfo.h"
#include "row_event.h"
#include "store_txn.h"
#include "tempdb.h"

static struct errinfo e;

static int vaults(const struct store *s)
{
    int n = 0;

    for (const struct store_vault *k = s->vaults.newest; k != NULL; k = k->older)
        n++;
    return n;
}

static void rekey(struct store *s)
{
    if (store_rekey(s, "test", &(struct store_rekey){.kind = VAULT_FILE}, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

static struct store_txn begin(struct store *s)
{
    struct store_txn t;

    if (store_txn_begin(s, SQL_READ, &t, &e) != ST_OK)
        fail_msg("%s", e.msg);
    return t;
}

/* Reads with the key of the transaction. */
static void assert_reads(struct store_txn *t)
{
    unsigned char hash[STORE_CHAIN_HASH];
    uint64_t seq;

    if (row_event_end(t, STORE_CHAIN_CHANGES, &seq, hash, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

static void test_old_keys(void **state)
{
    struct store *s = tempdb_fresh(), *other = tempdb_open(STORE_WRITE);
    struct store_txn first, second, third;

    (void)state;
    first = begin(s);
    rekey(other);
    assert_int_equal(vaults(other), 1); /* its own old one is wiped */
    assert_reads(&first);
    second = begin(s);
    assert_int_equal(vaults(s), 2);
    rekey(other);
    rekey(other);
    third = begin(s);
    assert_int_equal(vaults(s), 3);
    assert_reads(&first);
    assert_reads(&second);
    assert_reads(&third);
    assert_int_equal(store_txn_end(&second, ST_OK, &e), ST_OK);
    assert_int_equal(vaults(s), 2);
    assert_reads(&first);
    assert_int_equal(store_txn_end(&first, ST_OK, &e), ST_OK);
    assert_int_equal(vaults(s), 1);
    assert_int_equal(store_txn_end(&third, ST_OK, &e), ST_OK);
    assert_int_equal(vaults(s), 1); /* the newest stays */
    for (int i = 0; i < 20; i++) {
        rekey(other);
        third = begin(s);
        assert_int_equal(store_txn_end(&third, ST_OK, &e), ST_OK);
        assert_int_equal(vaults(s), 1);
    }
    store_close(other);
    store_close(s);
}

static void assert_refused(struct store *s, const char *why)
{
    struct errinfo again = {ST_OK, ""};
    struct store_txn t;

    assert_int_equal(store_txn_begin(s, SQL_READ, &t, &e), ST_EREFUSED);
    assert_non_null(strstr(e.msg, why));
    assert_true(store_refused(s, &again));
    assert_string_equal(again.msg, e.msg);
    assert_int_equal(store_txn_begin(s, SQL_WRITE, &t, &e), ST_EREFUSED);
    assert_int_equal(store_ready(s, &e), ST_EREFUSED);
}

/* Every column of the key record, changed under an open store; back again is not enough. */
static void test_changed(void **state)
{
    static const char *const change[] = {
        "kind = 0",
        "kind = 2, passes = 16, mib = 1024, version = version + 1",
        "version = version + 1",
        "version = version + 9",
        "passes = 1",
        "mib = 1",
        "salt = randomblob(16)",
        "plaintext = randomblob(32)",
        "public = randomblob(32)",
        "secrets = randomblob(136)",
        "mac = randomblob(32)",
        "version = version + 1, kind = 0, plaintext = randomblob(32)",
    };
    struct store *s = tempdb_fresh();
    char text[200];

    (void)state;
    tempdb_sql("CREATE TABLE aside.kept AS SELECT * FROM root");
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        assert_int_equal(store_ready(s, &e), ST_OK);
        assert_false(store_refused(s, &e));
        (void)snprintf(text, sizeof text, "UPDATE root SET %s", change[i]);
        tempdb_sql(text);
        assert_refused(s, "key record");
        tempdb_sql("DELETE FROM root; INSERT INTO root SELECT * FROM kept");
        assert_refused(s, "key record");
        store_close(s);
        s = tempdb_open(STORE_WRITE);
    }
    store_close(s);
}

/* One that the key has authenticated, and that is not the newest any more. */
static void test_older(void **state)
{
    struct store *s = tempdb_fresh();
    char key[64], kept[64];

    (void)state;
    (void)snprintf(key, sizeof key, "%s.key", tempdb_path);
    (void)snprintf(kept, sizeof kept, "%s.kept", tempdb_path);
    tempdb_sql("CREATE TABLE aside.kept AS SELECT * FROM root");
    assert_int_equal(link(key, kept), 0);
    rekey(s);
    assert_int_equal(store_ready(s, &e), ST_OK);
    assert_int_equal(rename(kept, key), 0); /* even with the key that opens it */
    tempdb_sql("DELETE FROM root; INSERT INTO root SELECT * FROM kept");
    assert_refused(s, "older");
    store_close(s);
}

/* A record that the key has authenticated, and a key that is not there yet. */
static void test_waiting(void **state)
{
    struct store *s = tempdb_fresh(), *other = tempdb_open(STORE_WRITE);
    struct store_txn t;
    char key[64], away[64];

    (void)state;
    (void)snprintf(key, sizeof key, "%s.key", tempdb_path);
    (void)snprintf(away, sizeof away, "%s.away", tempdb_path);
    rekey(other);
    assert_int_equal(rename(key, away), 0);
    assert_int_equal(store_txn_begin(s, SQL_READ, &t, &e), ST_EREFUSED);
    assert_non_null(strstr(e.msg, "key was changed"));
    assert_false(store_refused(s, &e));
    assert_int_equal(rename(away, key), 0);
    assert_int_equal(store_txn_begin(s, SQL_READ, &t, &e),
                     ST_EREFUSED); /* not tried yet */
    s->vaults.failed_s -= 2;
    t = begin(s);
    assert_int_equal(store_txn_end(&t, ST_OK, &e), ST_OK);
    store_close(other);
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_old_keys),
        cmocka_unit_test(test_changed),
        cmocka_unit_test(test_older),
        cmocka_unit_test(test_waiting),
    };

    return cmocka_run_group_tests(tests, tempdb_begin, tempdb_end);
}
