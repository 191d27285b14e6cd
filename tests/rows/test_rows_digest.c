/* The digest: the sum over all rows, whatever was added, changed and removed; and what a file says
 * that somebody else has written is a difference, which no later write takes away. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brute.h"
#include "forge.h"
#include "rows_digest.h"
#include "store.h"
#include "store_txn.h"
#include "tempdb.h"

#define SUBJECTS 3
#define ROUNDS   120

static struct errinfo e;
static char secret[65];

static void must(enum status st)
{
    if (st != ST_OK)
        fail_msg("%s", e.msg);
}

static void add(struct store *s, const char *id)
{
    struct store_subject one = {.reference = ""};

    (void)snprintf(one.id, sizeof one.id, "%s", id);
    must(store_subject_add(s, "test", &one, &e));
}

static void device(struct store *s, const char *name)
{
    unsigned char public[32], key[crypto_sign_SECRETKEYBYTES];
    struct store_device d;

    (void)crypto_sign_keypair(public, key);
    must(store_device_add(s, "test", name, public, &d, &e));
}

static void calibrate(struct store *s, double threshold)
{
    struct store_calibration k = {
        .fmr = 0.001,
        .low = threshold - 1,
        .high = threshold + 1,
        .table = {.threshold = threshold, .n = 2, .knot = {{-50, 1}, {threshold, 0.001}}},
    };

    must(store_calibration_add(s, "test", &k, &e));
}

/* ---- the sum */

/* Digits base 256, by school arithmetic; what the last change says is in t. */
static void assert_sum(struct store *s, unsigned char sum[LOG_DIGEST])
{
    unsigned char one[CRYPT_HASH];
    struct sql_rows *r;
    struct log_txn t;
    bool same = false;

    memset(sum, 0, LOG_DIGEST);
    must(store_begin(s, SQL_READ, &t, &e));
    must(sql_query(t.sql,
                   "SELECT mac FROM subjects UNION ALL SELECT mac FROM templates "
                   "UNION ALL SELECT mac FROM tokens UNION ALL SELECT mac FROM devices "
                   "UNION ALL SELECT mac FROM calibrations",
                   NULL, 0, &r, &e));
    while (sql_next(r)) {
        unsigned carry = 0;

        crypt_lookup(s->crypt, "row", sql_column(r, 0).data, CRYPT_HASH, one);
        for (int i = 0; i < LOG_DIGEST; i++) {
            carry += (unsigned)sum[i] + one[i];
            sum[i] = (unsigned char)carry;
            carry >>= 8;
        }
    }
    must(sql_done(r, ST_OK, &e));
    must(log_txn_agrees(&t, sum, &same, &e));
    assert_true(same);
    must(store_end(s, &t, ST_OK, &e));
}

/* One random change of any sort; some are refused, as there is nothing to change. */
static void step(struct store *s, struct brute_rng *rng)
{
    static const bool yes = true, no = false;
    const struct store_subject_change change = {
        .purpose = "a door", .disabled = brute_rand(rng) % 2 != 0 ? &yes : &no};
    char id[16], name[16];
    struct store_template t, *list = NULL;
    struct store_token token, *tokens;
    bool created;
    size_t n, ntokens;

    (void)snprintf(id, sizeof id, "s%d", (int)(brute_rand(rng) % SUBJECTS));
    (void)snprintf(name, sizeof name, "d%d", (int)(brute_rand(rng) % SUBJECTS));
    (void)store_template_list(s, id, &list, &n, &e);
    must(store_token_list(s, &tokens, &ntokens, &e));
    switch (brute_rand(rng) % 11) {
    case 0:
        (void)tempdb_store(s, "test", id, "",
                           &tempdb_face[brute_rand(rng) % TEMPDB_FACES], &t, &created,
                           &e);
        break;
    case 1:
        (void)tempdb_erase(s, "test", id, &e);
        break;
    case 2:
        (void)store_subject_set(s, "test", id, &change, &e);
        break;
    case 3:
        (void)store_subject_rename(s, "test", id, name, &e);
        (void)store_subject_rename(s, "test", name, id, &e);
        break;
    case 4:
        if (n > 0)
            must(store_template_delete(s, "test", list[brute_rand(rng) % n].id, &e));
        break;
    case 5:
        must(
            store_token_create(s, "test", name, STORE_SCOPE_READ, 0, secret, &token, &e));
        break;
    case 6:
        if (ntokens > 0)
            must(store_token_revoke(s, "test", tokens[brute_rand(rng) % ntokens].id, &e));
        break;
    case 7:
        if (ntokens > 0)
            (void)store_token_rotate(s, "test", tokens[brute_rand(rng) % ntokens].id, 60,
                                     0, secret, &token, &e);
        break;
    case 8:
        if (store_device_remove(s, "test", name, &e) == ST_ENOTFOUND)
            device(s, name);
        break;
    case 9:
        calibrate(s, 1 + brute_real(rng));
        break;
    default: /* what is not in it */
        (void)tempdb_record(s, id, STORE_RECORD_FAILED, &e);
    }
    free(list);
    free(tokens);
}

static void test_sum(void **state)
{
    struct brute_rng rng = {brute_seed("digest")};
    struct store *s = tempdb_fresh(), *other = tempdb_open(STORE_WRITE);
    unsigned char sum[LOG_DIGEST];

    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        step(brute_rand(&rng) % 2 != 0 ? s : other, &rng);
        assert_sum(s, sum);
    }
    must(store_verify(s, NULL, NULL, &e));
    store_close(other);
    store_close(s);
}

/* What was added and removed again has left nothing. */
static void test_undone(void **state)
{
    struct store *s = tempdb_fresh();
    unsigned char before[LOG_DIGEST], sum[LOG_DIGEST];
    struct store_template t;

    (void)state;
    add(s, "alice");
    device(s, "door-1");
    assert_sum(s, before);
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    assert_sum(s, sum);
    assert_memory_not_equal(sum, before, sizeof sum);
    must(store_template_delete(s, "test", t.id, &e));
    assert_sum(s, before); /* alice's row was written: it has a digest of her templates */
    tempdb_enroll(s, "bob", "", &tempdb_face[1], &t);
    must(tempdb_erase(s, "test", "bob", &e));
    assert_sum(s, sum);
    assert_memory_equal(sum, before, sizeof sum);
    device(s, "door-2");
    must(store_device_remove(s, "test", "door-2", &e));
    assert_sum(s, sum);
    assert_memory_equal(sum, before, sizeof sum);
    store_close(s);
}

/* The MACs as db/FORMAT.md has them. */
static void test_format(void **state)
{
    static const bool yes = true;
    struct store *s = tempdb_fresh();
    struct store_token token, got;
    struct store_template t;

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    must(store_subject_set(
        s, "test", "alice",
        &(struct store_subject_change){.expires = "2040-01-01", .hold = &yes}, &e));
    must(store_token_create(s, "test", "t", STORE_SCOPE_ALL, 60, secret, &token, &e));
    must(store_token_rotate(s, "test", token.id, 60, 60, secret, &got, &e));
    device(s, "door");
    calibrate(s, 2.5);
    store_close(s);
    tempdb_sql(
        "CREATE TABLE aside.was AS SELECT mac FROM subjects UNION ALL SELECT mac "
        "FROM templates UNION ALL SELECT mac FROM tokens UNION ALL SELECT mac FROM "
        "devices UNION ALL SELECT mac FROM calibrations");
    must(forge_sql(tempdb_path, "", &e));
    tempdb_sql(
        "CREATE TABLE aside.now AS SELECT mac FROM subjects UNION ALL SELECT mac "
        "FROM templates UNION ALL SELECT mac FROM tokens UNION ALL SELECT mac FROM "
        "devices UNION ALL SELECT mac FROM calibrations;"
        "CREATE TABLE same AS SELECT count(*) AS n FROM was JOIN now USING (mac)");
    assert_int_equal(tempdb_number("SELECT n FROM same"), 5);
}

/* ---- attacks */

static char old[64]; /* a copy from before the second half of written() */

static struct store *written(void)
{
    static const bool yes = true;
    const struct store_subject_change disable = {.disabled = &yes};
    struct store *s = tempdb_fresh();
    struct store_template a, t;
    struct store_token token;
    char copy[128];

    tempdb_enroll(s, "alice", "one", &tempdb_face[0], &a);
    tempdb_enroll(s, "alice", "two", &tempdb_face[1], &t);
    tempdb_enroll(s, "bob", "", &tempdb_face[2], &t);
    must(
        store_token_create(s, "test", "door", STORE_SCOPE_VERIFY, 0, secret, &token, &e));
    device(s, "door-1");
    calibrate(s, 9);
    (void)snprintf(old, sizeof old, "%.40s-old", tempdb_path);
    (void)snprintf(copy, sizeof copy, "VACUUM INTO '%s'", old);
    tempdb_sql(copy);
    must(store_token_revoke(s, "test", token.id, &e));
    must(store_subject_set(s, "test", "alice", &disable, &e));
    must(store_template_delete(s, "test", a.id, &e));
    must(store_device_remove(s, "test", "door-1", &e));
    device(s, "door-2");
    calibrate(s, 1);
    must(tempdb_erase(s, "test", "bob", &e));
    return s;
}

#define BACK(table, where)                                                               \
    "DELETE FROM main." table " WHERE " where "; INSERT INTO main." table                \
    " SELECT * FROM old." table " WHERE " where

/* old: the older copy.  Each is found, by the process that serves too; and stays found, whatever
 * somebody writes who has verified the rows before. */
static void test_attacks(void **state)
{
    static const char *const attack[] = {
        BACK("tokens", "true"),
        "UPDATE tokens SET revoked = NULL",
        "DELETE FROM tokens",
        BACK("subjects", "subject_key = 1"),
        "UPDATE subjects SET disabled = 0",
        BACK("templates", "template_key = 1"),
        "DELETE FROM templates",
        "PRAGMA foreign_keys = OFF; DELETE FROM subjects",
        "DELETE FROM subjects; DELETE FROM templates",
        BACK("subjects", "subject_key = 2"),
        "INSERT INTO devices SELECT 9, id, revision, name, public, created, mac FROM old.devices",
        BACK("devices", "true"),
        "UPDATE devices SET mac = (SELECT mac FROM old.devices)",
        "DELETE FROM calibrations WHERE calibration_key = 2",
        "UPDATE calibrations SET calibration_key = 7 - calibration_key",
        "UPDATE calibrations SET mac = (SELECT mac FROM calibrations WHERE calibration_key "
        "= 1)",
        "CREATE TABLE twin AS SELECT * FROM tokens; DROP TABLE tokens;"
        "ALTER TABLE twin RENAME TO tokens; INSERT INTO tokens SELECT * FROM tokens",
        "CREATE TABLE twin AS SELECT * FROM calibrations; DROP TABLE calibrations;"
        "ALTER TABLE twin RENAME TO calibrations;"
        "INSERT INTO calibrations SELECT * FROM calibrations LIMIT 1",
        /* With the entries that tell of it. */
        "DELETE FROM change_log WHERE kind = 'revoke_token';" BACK("tokens", "true"),
    };

    (void)state;
    for (size_t i = 0; i < sizeof attack / sizeof *attack; i++) {
        struct store *s = written(), *other = tempdb_open(STORE_WRITE), *late;
        struct store_subject one = {.id = "eve"};
        struct store_token token;
        char sql[500];

        must(store_verify(s, NULL, NULL, &e));
        assert_int_equal(store_token_check(s, secret, &token, &e), ST_EDENIED);
        must(store_verify(other, NULL, NULL, &e));
        (void)snprintf(sql, sizeof sql, "ATTACH '%s' AS old; %s", old, attack[i]);
        tempdb_sql(sql);
        add(other, "carol");
        device(other, "door-3");
        if (store_verify(s, NULL, NULL, &e) != ST_EREFUSED)
            fail_msg("not found: %s", sql);
        assert_true(store_refused(s, &e));
        assert_int_equal(store_token_check(s, secret, &token, &e), ST_EREFUSED);
        must(tempdb_erase(other, "test", "carol", &e));
        late = tempdb_open(STORE_WRITE);
        assert_int_equal(store_subject_add(late, "test", &one, &e), ST_EREFUSED);
        assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
        store_close(late);
        store_close(other);
        store_close(s);
    }
}

/* A row is hidden while the daemon runs, a stranger takes its place, and the row comes back. */
static void test_second_alice(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t;

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    tempdb_sql("CREATE TABLE aside.s AS SELECT * FROM subjects;"
               "CREATE TABLE aside.t AS SELECT * FROM templates;"
               "CREATE TABLE aside.f AS SELECT * FROM faces;"
               "DELETE FROM faces; DELETE FROM templates; DELETE FROM subjects");
    tempdb_enroll(s, "alice", "", &tempdb_face[1], &t); /* nothing is found at once */
    tempdb_sql(
        "CREATE TABLE rest AS SELECT * FROM subjects; DROP TABLE subjects;"
        "ALTER TABLE rest RENAME TO subjects; INSERT INTO subjects SELECT * FROM s;"
        "INSERT INTO templates SELECT * FROM t WHERE template_key = 1");
    assert_int_equal(tempdb_number("SELECT count(*) FROM subjects"), 2);
    /* Both rows are authentic, and in the sum; and no index of the file forbids them. */
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    assert_non_null(strstr(e.msg, "subjects: two rows have one id"));
    store_close(s);
}

/* Her templates alone: the next sample is not her first one. */
static void test_first_sample(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    bool created;

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    tempdb_sql("CREATE TABLE aside.t AS SELECT * FROM templates; DELETE FROM templates");
    assert_int_equal(
        tempdb_store(s, "test", "alice", "", &tempdb_face[1], &t, &created, &e),
        ST_ECORRUPT);
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    store_close(s);
}

/* Hidden from an index alone: every row is there, and in the sum. */
static void test_hidden(void **state)
{
    static const struct {
        const char *index, *rows;
    } hide[] = {
        {"sqlite_autoindex_subjects_2",
         "SELECT subject_key, lookup FROM subjects LIMIT 0"},
        {"sqlite_autoindex_subjects_1", "SELECT subject_key, uid FROM subjects LIMIT 0"},
        {"sqlite_autoindex_templates_1",
         "SELECT template_key, id FROM templates LIMIT 0"},
        {"sqlite_autoindex_tokens_2", "SELECT token_key, zeroblob(32) FROM tokens"},
        {"sqlite_autoindex_devices_2", "SELECT device_key, id FROM devices"},
    };

    (void)state;
    for (size_t i = 0; i < sizeof hide / sizeof *hide; i++) {
        struct store *s = written(), *late;
        struct store_subject one = {.id = "eve"};

        tempdb_mislead(hide[i].index, hide[i].rows);
        assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
        assert_non_null(strstr(e.msg, "integrity"));
        late = tempdb_open(STORE_WRITE);
        assert_int_equal(store_subject_add(late, "test", &one, &e), ST_EREFUSED);
        store_close(late);
        store_close(s);
    }
}

static void count(void *arg, const char *line)
{
    char *text = arg;

    (void)snprintf(text + strlen(text), 400 - strlen(text), "%s\n", line);
}

/* Each row that is not authentic is named, and can be removed. */
static void test_named(void **state)
{
    struct store *s = written();
    unsigned char sum[LOG_DIGEST];
    char text[400] = "";
    struct log_txn t;
    uint64_t n;
    bool same;

    (void)state;
    tempdb_sql("UPDATE subjects SET hold = 1; UPDATE templates SET points = points + 1;"
               "UPDATE tokens SET id = 'ab' || char(10); UPDATE devices SET name = 'x';"
               "UPDATE calibrations SET mac = x'00' WHERE calibration_key = 1");
    must(store_begin(s, SQL_WRITE, &t, &e));
    must(rows_digest(&t, count, text, sum, &n, &e));
    assert_int_equal(n, 5);
    assert_non_null(strstr(text, "subjects: the row ? is not authentic\n"));
    assert_non_null(strstr(text, "tokens: the row ab? is not authentic\n"));
    assert_non_null(strstr(text, "devices: the row x is not authentic\n"));
    assert_non_null(strstr(text, "calibrations: the row 1 is not authentic\n"));
    must(rows_digest_clear(&t, NULL, NULL, &n, &e));
    assert_int_equal(n, 4); /* with the subject went its template */
    must(rows_digest(&t, NULL, NULL, sum, &n, &e));
    assert_int_equal(n, 0);
    must(log_txn_agrees(&t, sum, &same, &e));
    assert_false(same);
    assert_int_equal(store_end(s, &t, ST_EHELD, &e), ST_EHELD);
    store_close(s);
    assert_int_equal(tempdb_number("SELECT count(*) FROM subjects"), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sum),          cmocka_unit_test(test_undone),
        cmocka_unit_test(test_format),       cmocka_unit_test(test_attacks),
        cmocka_unit_test(test_second_alice), cmocka_unit_test(test_first_sample),
        cmocka_unit_test(test_hidden),       cmocka_unit_test(test_named),
    };

    return cmocka_run_group_tests_name("rows_digest", tests, tempdb_begin_faces,
                                       tempdb_end_faces);
}
