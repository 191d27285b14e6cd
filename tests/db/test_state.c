/* The state of the database against somebody who has no key but older copies of the file: rows
 * put back, removed, copied or moved are errors where they are used, and check names each. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "errinfo.h"
#include "store.h"
#include "tempdb.h"

static struct errinfo e;
static char old[64];    /* a copy of the database, from before all was changed */
static char secret[65]; /* of the token that was revoked since */
static struct store_template a, b,
    c; /* alice's: a was deleted since; bob's, who was erased */

static struct store_calibration calibration(double threshold)
{
    return (struct store_calibration){
        .fmr = 0.001,
        .low = threshold - 1,
        .high = threshold + 1,
        .table = {.threshold = threshold, .n = 2, .knot = {{-50, 1}, {threshold, 0.001}}},
    };
}

static void must(enum status st)
{
    if (st != ST_OK)
        fail_msg("%s", e.msg);
}

static struct store *written(void)
{
    static const bool yes = true;
    const struct store_subject_change disable = {.disabled = &yes};
    struct store_calibration loose = calibration(0.9), strict = calibration(0.1);
    struct store *s = tempdb_fresh();
    struct store_token t;
    char copy[128];

    tempdb_enroll(s, "alice", "one", &tempdb_face[0], &a);
    tempdb_enroll(s, "alice", "two", &tempdb_face[1], &b);
    tempdb_enroll(s, "bob", "", &tempdb_face[2], &c);
    must(store_token_create(s, "test", "door", STORE_SCOPE_VERIFY, 0, secret, &t, &e));
    must(store_calibration_add(s, "test", &loose, &e));
    (void)snprintf(old, sizeof old, "%s-old", tempdb_path);
    (void)snprintf(copy, sizeof copy, "VACUUM INTO '%s'", old);
    tempdb_sql(copy);
    must(store_token_revoke(s, "test", t.id, &e));
    must(store_subject_set(s, "test", "alice", &disable, &e));
    must(store_template_delete(s, "test", a.id, &e));
    must(store_calibration_add(s, "test", &strict, &e));
    must(tempdb_erase(s, "test", "bob", &e));
    return s;
}

/* What an attack must not give. */
static void must_be_safe(struct store *s)
{
    struct store_calibration k;
    struct store_subject one;
    struct store_template t, *list;
    struct store_token token;
    size_t n;

    assert_int_not_equal(store_token_check(s, secret, &token, &e), ST_OK);
    if (store_subject_get(s, "alice", &one, &e) == ST_OK)
        assert_true(one.disabled);
    else
        assert_int_equal(e.code, ST_ECORRUPT);
    assert_int_not_equal(store_template_get(s, a.id, &t, &e), ST_OK);
    assert_int_not_equal(store_template_get(s, c.id, &t, &e), ST_OK);
    assert_int_not_equal(store_subject_get(s, "bob", &one, &e), ST_OK);
    if (store_calibration_get(s, &k, &e) == ST_OK)
        assert_true(k.table.threshold == 0.1);
    else
        assert_int_equal(e.code, ST_ECORRUPT);
    if (store_template_list(s, "alice", &list, &n, &e) == ST_OK) {
        assert_int_equal(n, 1); /* one that is missing, or there twice, is found here */
        assert_string_equal(list[0].id, b.id);
        free(list);
    } else {
        assert_int_equal(e.code, ST_ECORRUPT);
    }
}

struct found {
    char text[2000];
    unsigned n;
};

static void note(void *arg, enum store_chain chain, uint64_t seq, const char *line)
{
    struct found *f = arg;
    const size_t len = strlen(f->text);

    (void)chain;
    (void)seq;
    (void)snprintf(f->text + len, sizeof f->text - len, "%s\n", line);
    f->n++;
}

#define BACK(table, where)                                                               \
    "DELETE FROM main." table " WHERE " where "; INSERT INTO main." table                \
    " SELECT * FROM old." table " WHERE " where

static void test_attacks(void **state)
{
    static const struct {
        const char *sql, *line; /* old: the older copy; one of the problems */
    } attack[] = {
        {BACK("tokens", "true"), "its row is an older one, which was put back"},
        {"UPDATE tokens SET revoked = NULL", "its row is an older one"},
        {"DELETE FROM tokens", "the row that this entry left is missing"},
        {BACK("subjects", "subject_key = 1"), "its row is an older one"},
        {"UPDATE subjects SET disabled = 0", "its row is not what was written"},
        {BACK("templates", "subject_key = 1"), "its row was deleted, and is there"},
        {"DELETE FROM templates", "the row that this entry left is missing"},
        {"DELETE FROM templates; UPDATE subjects SET templates = 0",
         "its row is not what was written"},
        {"PRAGMA foreign_keys = OFF; DELETE FROM subjects",
         "the row that this entry left is missing"},
        {"DELETE FROM subjects; DELETE FROM templates",
         "the row that this entry left is missing"},
        {BACK("subjects", "subject_key = 2"), "its row was deleted, and is there"},
        {"INSERT INTO main.subjects SELECT * FROM old.subjects WHERE subject_key = 2;"
         "INSERT INTO main.templates SELECT * FROM old.templates WHERE subject_key = "
         "2",
         "its row was deleted, and is there"},
        {"DELETE FROM calibrations WHERE calibration_key = 2",
         "the row that this entry left is missing"},
        {"UPDATE calibrations SET calibration_key = 7 - calibration_key",
         "its row is not what was written"},
        {"DELETE FROM main.calibrations; INSERT INTO main.calibrations SELECT * FROM "
         "old.calibrations",
         "the row that this entry left is missing"},
        {"CREATE TABLE twin AS SELECT * FROM templates; DROP TABLE templates;"
         "ALTER TABLE twin RENAME TO templates;"
         "INSERT INTO templates SELECT 99, id, subject_key, same, created, engine, points, "
         "triangles, about, model FROM templates",
         "its row is there twice"},
        {"CREATE TABLE twin AS SELECT * FROM tokens; DROP TABLE tokens;"
         "ALTER TABLE twin RENAME TO tokens; INSERT INTO tokens SELECT * FROM tokens",
         "its row is there twice"},
        {"INSERT INTO main.subjects SELECT 9, lookup, uid, key, about, created, "
         "expires, seen, hold, disabled, templates FROM old.subjects WHERE subject_key = 2;"
         "UPDATE templates SET subject_key = 9",
         "its row is not what was written"},
        /* With the entries that tell of it: rows agree, and the chain does not. */
        {"DELETE FROM main.events WHERE kind = 'revoke_token';"
         "DELETE FROM main.tokens; INSERT INTO main.tokens SELECT * FROM old.tokens",
         "is missing"},
        {"DELETE FROM main.events WHERE chain = 0 AND seq > (SELECT max(seq) FROM "
         "old.events); DELETE FROM main.subjects; DELETE FROM main.templates;"
         "INSERT INTO main.subjects SELECT * FROM old.subjects;"
         "INSERT INTO main.templates SELECT * FROM old.templates",
         "cut off the end"},
    };

    (void)state;
    for (size_t i = 0; i < sizeof attack / sizeof *attack; i++) {
        for (int running = 0; running < 2; running++) {
            struct store *s = written();
            struct found f = {.n = 0};
            struct store_audit audit;
            struct store_check check;
            char sql[1000];

            must(store_audit_verify(s, note, &f, &audit, &e));
            assert_int_equal(f.n, 0);
            must_be_safe(s);
            (void)snprintf(sql, sizeof sql, "ATTACH '%s' AS old; %s", old, attack[i].sql);
            if (!running)
                store_close(s);
            tempdb_sql(sql);
            if (!running) /* with altered tables nothing is written any more: test_altered */
                s = tempdb_open(strstr(sql, "DROP TABLE") ? STORE_READ : STORE_WRITE);
            if (strstr(sql, "DELETE FROM main.events") == NULL)
                must_be_safe(s);
            must(store_audit_verify(s, note, &f, &audit, &e));
            if (f.n == 0 ||
                (attack[i].line != NULL && strstr(f.text, attack[i].line) == NULL))
                fail_msg("%s: %s", sql, f.text);
            check = tempdb_check(s);
            assert_true(check.problems >= 1);
            store_close(s);
        }
    }
}

/* Not found, but nobody erased or deleted it. */
static void test_removed(void **state)
{
    struct store *s = written();
    struct store_subject one;
    struct store_template t;

    (void)state;
    tempdb_sql("DELETE FROM subjects; DELETE FROM templates");
    assert_int_equal(store_subject_get(s, "alice", &one, &e), ST_ECORRUPT);
    assert_non_null(strstr(e.msg, "its row is missing, although nobody erased it"));
    assert_int_equal(store_template_get(s, b.id, &t, &e), ST_ECORRUPT);
    assert_non_null(strstr(e.msg, "its row is missing, although nobody deleted it"));
    assert_int_equal(store_subject_get(s, "bob", &one, &e), ST_ENOTFOUND);
    assert_int_equal(store_template_get(s, c.id, &t, &e), ST_ENOTFOUND);
    assert_int_equal(store_subject_get(s, "carol", &one, &e), ST_ENOTFOUND);
    store_close(s);
}

/* A store that serves knows which changes there were, before it and by itself: an older row is no
 * good where the change that replaced it is deleted as well, or tells of it now, or the change that
 * left it comes once more. */
static void test_serving(void **state)
{
    static const char *const hide[] = {
        "DELETE FROM events WHERE kind = 'disable_subject'",
        "UPDATE events SET row_mac = (SELECT row_mac FROM events WHERE kind = "
        "'add_subject') WHERE kind = 'disable_subject'",
        "INSERT INTO events SELECT 99, chain, seq + 99, at, kind, actor, subject, "
        "template_id, outcome, object, row_mac, uses, uses_hash, hash FROM events "
        "WHERE kind = 'add_subject'",
    };
    static const bool yes = true;
    const struct store_subject_change disable = {.disabled = &yes};

    (void)state;
    for (size_t i = 0; i < 2 * sizeof hide / sizeof *hide; i++) {
        const bool by_itself = i % 2 == 1;
        struct store *s = tempdb_fresh();
        struct store_subject one = {.id = "ann"};
        struct store_audit audit;
        struct found f = {.n = 0};

        must(store_subject_add(s, "test", &one, &e));
        tempdb_sql("CREATE TABLE aside.was AS SELECT * FROM subjects");
        if (!by_itself)
            must(store_subject_set(s, "test", "ann", &disable, &e));
        must(store_state_verify(s, note, &f, &audit, &e));
        assert_int_equal(f.n, 0);
        if (by_itself)
            must(store_subject_set(s, "test", "ann", &disable, &e));
        must(store_subject_get(s, "ann", &one, &e));
        assert_true(one.disabled);
        tempdb_sql("UPDATE subjects SET disabled = 0, about = (SELECT about FROM was)");
        tempdb_sql(hide[i / 2]);
        assert_int_equal(store_subject_get(s, "ann", &one, &e), ST_ECORRUPT);
        store_close(s);
        s = tempdb_open(STORE_WRITE);
        assert_int_equal(store_state_verify(s, note, &f, &audit, &e), ST_EREFUSED);
        store_close(s);
    }
}

#define DEFAULT                                                                          \
    "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, "          \
    "'old_until TEXT', 'old_until TEXT DEFAULT ''2099-01-01T00:00:00.000Z''') "          \
    "WHERE name = 'tokens';"

/* Tables with defaults, or without keys, would hold other rows than those that are written, and
 * the row's MAC would be made of these. */
static void test_altered(void **state)
{
    static const char *const alter[] = {
        DEFAULT "PRAGMA schema_version = 99",
        "CREATE UNIQUE INDEX one ON tokens (length(id))",
        "CREATE TABLE more (id BLOB)",
        "ALTER TABLE devices RENAME TO gone",
        DEFAULT, /* who has read the tables goes on with them as they were */
    };
    const struct store_key key = {.make = VAULT_FILE};
    const size_t n = sizeof alter / sizeof *alter;
    struct store *s, *other;
    struct store_token t;
    struct store_subject one;
    struct errinfo why;

    (void)state;
    for (size_t i = 0; i < n; i++) {
        s = written();
        tempdb_sql(alter[i]);
        if (i < n - 1) {
            assert_int_equal(
                store_token_create(s, "test", "x", STORE_SCOPE_READ, 0, secret, &t, &e),
                ST_EREFUSED);
            assert_non_null(strstr(e.msg, "tables are not those of this program"));
            assert_true(store_refused(s, &why));
            assert_int_equal(store_subject_get(s, "alice", &one, &e), ST_EREFUSED);
        } else {
            must(store_token_create(s, "test", "x", STORE_SCOPE_READ, 0, secret, &t, &e));
        }
        assert_int_equal(store_open(tempdb_path, STORE_WRITE, &key, &other, &e),
                         ST_EREFUSED);
        assert_int_equal(tempdb_number("SELECT count(old_until) FROM tokens"), 0);
        store_close(s);
    }
    s = written();
    tempdb_sql("VACUUM; CREATE TABLE more (id BLOB); DROP TABLE more"); /* as before */
    must(store_token_create(s, "test", "x", STORE_SCOPE_READ, 0, secret, &t, &e));
    store_close(s);
}

/* After a rename the former id is free. */
static void test_renamed(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_subject one = {.id = "ann"};

    (void)state;
    must(store_subject_add(s, "test", &one, &e));
    must(store_subject_rename(s, "test", "ann", "bea", &e));
    assert_int_equal(store_subject_get(s, "ann", &one, &e), ST_ENOTFOUND);
    must(store_subject_get(s, "bea", &one, &e));
    tempdb_sql("DELETE FROM subjects");
    assert_int_equal(store_subject_get(s, "ann", &one, &e), ST_ENOTFOUND);
    assert_int_equal(store_subject_get(s, "bea", &one, &e), ST_ECORRUPT);
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_attacks), cmocka_unit_test(test_removed),
        cmocka_unit_test(test_serving), cmocka_unit_test(test_renamed),
        cmocka_unit_test(test_altered),
    };

    return cmocka_run_group_tests_name("state", tests, tempdb_begin_faces,
                                       tempdb_end_faces);
}
