/* A row's MAC is of what was to be written, and a change is of one row or of none: what a file says
 * that somebody else has written, its indexes, triggers and doubled rows, gets no MAC and is not
 * taken for what was changed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "store.h"
#include "tempdb.h"

static struct errinfo e;
static char secret[65];

static void must(enum status st)
{
    if (st != ST_OK)
        fail_msg("%s", e.msg);
}

static struct store_token token(struct store *s, const char *name)
{
    struct store_token t;

    must(store_token_create(s, "test", name, STORE_SCOPE_VERIFY, 0, secret, &t, &e));
    return t;
}

static void device(struct store *s, const char *name)
{
    unsigned char public[32], key[crypto_sign_SECRETKEYBYTES];
    struct store_device d;

    (void)crypto_sign_keypair(public, key);
    must(store_device_add(s, "test", name, public, &d, &e));
}

static struct store_calibration calibration(double threshold)
{
    return (struct store_calibration){
        .fmr = 0.001,
        .low = threshold - 1,
        .high = threshold + 1,
        .table = {.threshold = threshold, .n = 2, .knot = {{-50, 1}, {threshold, 0.001}}},
    };
}

static int64_t changes(void)
{
    return tempdb_number("SELECT count(*) FROM change_log");
}

/* It is refused, and nothing of it is in the file. */
static void assert_nothing(enum status st, int64_t before)
{
    assert_int_equal(st, ST_ECORRUPT);
    assert_int_equal(changes(), before);
}

#define DOUBLE(table, key)                                                               \
    "CREATE TABLE twice AS SELECT * FROM " table "; DROP TABLE " table ";"               \
    "ALTER TABLE twice RENAME TO " table "; INSERT INTO " table " SELECT * FROM " table  \
    ";"                                                                                  \
    "UPDATE " table " SET " key " = rowid"

/* A row that is there twice is not half changed: neither an update nor a removal is taken for done. */
static void test_doubled(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_token t = token(s, "gate"), got, *list;
    char other[65];
    int64_t before;
    size_t n;

    (void)state;
    device(s, "door-1");
    tempdb_sql(DOUBLE("tokens", "token_key") ";" DOUBLE("devices", "device_key"));
    before = changes();
    assert_nothing(store_token_revoke(s, "test", t.id, &e), before);
    assert_non_null(strstr(e.msg, "a change of one row changed 2"));
    assert_nothing(store_token_rotate(s, "test", t.id, 0, 0, other, &got, &e), before);
    assert_nothing(store_device_remove(s, "test", "door-1", &e), before);
    must(store_token_list(s, &list, &n, &e));
    assert_true(n == 2 && !list[0].revoked && !list[1].revoked);
    free(list);
    must(store_token_check(s, secret, &got, &e));
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    store_close(s);
}

/* An index leads to another row: of another token, which would get the rights or the end. */
static void test_misled(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_token first = token(s, "first"), second = token(s, "second"), got;
    struct store_subject one = {.id = "alice"};
    char other[65];
    int64_t before;

    (void)state;
    must(store_subject_add(s, "test", &one, &e));
    one = (struct store_subject){.id = "bob"};
    must(store_subject_add(s, "test", &one, &e));
    device(s, "door-1");
    device(s, "door-2");
    tempdb_mislead("sqlite_autoindex_tokens_1", "SELECT 3 - token_key, id FROM tokens");
    before = changes();
    assert_nothing(store_token_revoke(s, "test", first.id, &e), before);
    assert_nothing(store_token_rotate(s, "test", second.id, 0, 0, other, &got, &e),
                   before);
    tempdb_sql("DROP TABLE twin; DROP TABLE more");
    tempdb_mislead("sqlite_autoindex_subjects_2",
                   "SELECT 3 - subject_key, lookup FROM subjects");
    assert_nothing(store_subject_rename(s, "test", "alice", "carol", &e), before);
    assert_nothing(tempdb_erase(s, "test", "bob", &e), before);
    tempdb_sql("DROP TABLE twin; DROP TABLE more");
    tempdb_mislead("sqlite_autoindex_devices_2",
                   "SELECT 3 - device_key, name FROM devices");
    assert_nothing(store_device_remove(s, "test", "door-1", &e), before);
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    store_close(s);
}

/* By the row that it is to write over: it was read by another index than it is found by now. */
static void test_written_elsewhere(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_subject alice = {.id = "alice"}, bob = {.id = "bob"};
    const bool yes = true;
    const struct store_subject_change disable = {.disabled = &yes};
    int64_t before;

    (void)state;
    must(store_subject_add(s, "test", &alice, &e));
    must(store_subject_add(s, "test", &bob, &e));
    before = changes();
    tempdb_mislead("sqlite_autoindex_subjects_1",
                   "SELECT 3 - subject_key, uid FROM subjects");
    assert_nothing(store_subject_set(s, "test", "alice", &disable, &e), before);
    assert_non_null(strstr(e.msg, "a change of one row changed 0"));
    store_close(s);
}

/* Triggers and defaults of the file do nothing. */
static void test_triggers(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_token t, got;
    struct store_device *list;
    char other[65];
    size_t n;

    (void)state;
    device(s, "door-1");
    tempdb_sql(
        "CREATE TRIGGER a AFTER INSERT ON tokens BEGIN UPDATE tokens SET scopes = "
        "'enroll,verify,identify,read,delete,manage,detail'; END;"
        "CREATE TRIGGER b BEFORE UPDATE ON tokens BEGIN SELECT RAISE(IGNORE); END;"
        "CREATE TRIGGER c BEFORE DELETE ON devices BEGIN SELECT RAISE(IGNORE); END;"
        "CREATE TRIGGER d AFTER INSERT ON change_log BEGIN "
        "UPDATE subjects SET disabled = 0; END;"
        "ALTER TABLE tokens RENAME COLUMN old_hash TO was;"
        "ALTER TABLE tokens ADD COLUMN old_hash BLOB DEFAULT x'00'");
    t = token(s, "gate");
    must(store_token_check(s, secret, &got, &e));
    assert_int_equal(got.scopes, STORE_SCOPE_VERIFY);
    must(store_token_rotate(s, "test", t.id, 0, 0, other, &got, &e));
    assert_int_equal(store_token_check(s, secret, &got, &e), ST_EDENIED);
    must(store_token_revoke(s, "test", t.id, &e));
    assert_int_equal(store_token_check(s, other, &got, &e), ST_EDENIED);
    must(store_device_remove(s, "test", "door-1", &e));
    must(store_device_list(s, &list, &n, &e));
    assert_int_equal(n, 0);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

/* A row that was planted gets no MAC, whatever is written beside it. */
static void test_planted(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_calibration k = calibration(0.5), got;
    struct store_token t = token(s, "gate");

    (void)state;
    must(store_calibration_add(s, "test", &k, &e));
    tempdb_sql(
        "INSERT INTO calibrations SELECT 2, revision, created, actor, engine, shipped,"
        "fmr, 900, low, 901, subjects, impostors, genuine, knots, mac FROM calibrations;"
        "INSERT INTO tokens SELECT 2, '0123456789abcdef0123456789abcdef', revision, "
        "name, zeroblob(32), created, revoked, scopes, expires, old_hash, old_until, "
        "mac, used FROM tokens");
    assert_int_equal(store_calibration_get(s, &got, &e), ST_ECORRUPT);
    assert_int_equal(
        store_token_revoke(s, "test", "0123456789abcdef0123456789abcdef", &e),
        ST_ECORRUPT);
    k = calibration(0.25);
    k.shipped = true;
    must(store_calibration_add(s, "test", &k, &e));
    (void)token(s, "other");
    must(store_token_revoke(s, "test", t.id, &e));
    must(store_calibration_get(s, &got, &e));
    assert_true(got.version == 3 && got.table.threshold == 0.25);
    tempdb_sql("DELETE FROM calibrations WHERE calibration_key = 3");
    assert_int_equal(store_calibration_get(s, &got, &e), ST_ECORRUPT);
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_doubled),           cmocka_unit_test(test_misled),
        cmocka_unit_test(test_written_elsewhere), cmocka_unit_test(test_triggers),
        cmocka_unit_test(test_planted),
    };

    return cmocka_run_group_tests_name("rows_table", tests, tempdb_begin, tempdb_end);
}
