/* A schema of another version than the program's: refused, or upgraded as a whole with a
 * copy kept.  There is one version so far: the steps to a second and a third are this
 * test's own, in place of sql_schema.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "errinfo.h"
#include "schema_sql.h"
#include "sql_schema.h"
#include "tempdb.h"

#define STEP_2                                                                           \
    "\n-- version 2\n"                                                                   \
    "PRAGMA user_version = 2;"                                                           \
    "CREATE TABLE moods (mood_key INTEGER PRIMARY KEY, mood TEXT NOT NULL) STRICT;"      \
    "INSERT INTO moods (mood) SELECT 'mood ' || count(*) FROM templates;"
#define STEP_3 "\n-- version 3\nPRAGMA user_version = 3; DROP TABLE moods;"
#define STEP_3_BAD                                                                       \
    "\n-- version 3\nPRAGMA user_version = 3; DROP TABLE moods; DROP TABLE missing;"

static char text[32768];
static int newest;
static struct errinfo e;

const char *sql_schema_text(void)
{
    return text;
}

int sql_schema_newest(void)
{
    return newest;
}

static void use_schema(int version, const char *steps)
{
    newest = version;
    assert_true(snprintf(text, sizeof text, "%s%s", schema_sql, steps) <
                (int)sizeof text);
}

/* A database of version 1 with a subject, and the paths of its copies. */
static char copy[64];

static void make_first(struct store_template *t)
{
    struct store *s;

    use_schema(1, "");
    s = tempdb_fresh();
    tempdb_enroll(s, "alice", "left", &tempdb_face[0], t);
    store_close(s);
    (void)snprintf(copy, sizeof copy, "%s.v1.bak", tempdb_path);
}

static void assert_refused(enum store_mode mode, const char *why)
{
    struct store *s = NULL;

    assert_int_equal(store_open(tempdb_path, mode, NULL, &s, &e), ST_EVERSION);
    assert_null(s);
    assert_non_null(strstr(e.msg, why));
}

static void test_refused(void **state)
{
    struct store_template t;
    struct store_look look;
    enum vault_kind kind;

    (void)state;
    make_first(&t);
    use_schema(2, STEP_2);
    assert_refused(STORE_READ, "surfacectl migrate");
    assert_refused(STORE_WRITE, "surfacectl migrate");
    assert_refused(STORE_CREATE, "surfacectl migrate");
    assert_int_equal(store_kind(tempdb_path, &kind, &e), ST_OK); /* what to ask for */
    assert_int_equal(kind, VAULT_FILE);
    assert_int_equal(store_look(tempdb_path, &look, &e), ST_OK);
    assert_int_equal(look.version, 1);
    assert_int_equal(look.newest, 2);
    assert_int_equal(look.templates, 1);
    assert_int_equal(tempdb_number("PRAGMA user_version"), 1);
    /* An older program refuses a newer database. */
    use_schema(2, STEP_2);
    store_close(tempdb_open(STORE_MIGRATE));
    use_schema(1, "");
    assert_refused(STORE_READ, "newer");
    assert_refused(STORE_MIGRATE, "newer");
    assert_int_equal(tempdb_number("PRAGMA user_version"), 2);
}

static void assert_sound(struct store *s, const struct store_template *t)
{
    struct store_template is;
    struct face f = {0};

    assert_int_equal(tempdb_check(s).problems,
                     0); /* also word for word a new one's tables */
    assert_int_equal(store_template_load(s, t->id, &is, tempdb_work, &f, &e), ST_OK);
    assert_string_equal(is.subject, "alice");
    face_free(&f);
}

static void test_upgraded(void **state)
{
    struct store_template t;
    struct store *s;
    struct stat sb;
    char aside[64];

    (void)state;
    make_first(&t);
    use_schema(2, STEP_2);
    s = tempdb_open(STORE_MIGRATE);
    assert_sound(s, &t);
    assert_int_equal(tempdb_number("PRAGMA user_version"), 2);
    assert_int_equal(tempdb_number("SELECT count(*) FROM moods WHERE mood = 'mood 1'"),
                     1);
    store_close(s);
    assert_int_equal(stat(copy, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    store_close(tempdb_open(STORE_MIGRATE)); /* nothing to do */
    /* The copy is what there was; from it two steps lead to the third version. */
    (void)snprintf(aside, sizeof aside, "%s.aside", tempdb_path);
    assert_int_equal(rename(tempdb_path, aside), 0);
    assert_int_equal(rename(copy, tempdb_path), 0);
    assert_int_equal(tempdb_number("PRAGMA user_version"), 1);
    use_schema(3, STEP_2 STEP_3);
    s = tempdb_open(STORE_MIGRATE);
    assert_sound(s, &t);
    assert_int_equal(tempdb_number("PRAGMA user_version"), 3);
    store_close(s);
}

/* A step that fails: the database stays what it was, without a copy. */
static void test_not_upgraded(void **state)
{
    struct store_template t;
    struct store *s = NULL;

    (void)state;
    make_first(&t);
    use_schema(3, STEP_2 STEP_3_BAD);
    assert_int_equal(store_open(tempdb_path, STORE_MIGRATE, NULL, &s, &e), ST_EDB);
    assert_null(s);
    assert_non_null(strstr(e.msg, "upgrade"));
    assert_int_equal(tempdb_number("PRAGMA user_version"), 1);
    assert_int_not_equal(access(copy, F_OK), 0);
    use_schema(1, "");
    s = tempdb_open(STORE_READ);
    assert_sound(s, &t);
    store_close(s);
}

/* Nor is a damaged one upgraded. */
static void test_damaged(void **state)
{
    struct store_template t;
    struct store *s = NULL;
    FILE *f;

    (void)state;
    make_first(&t);
    tempdb_sql("PRAGMA journal_mode=DELETE");
    f = fopen(tempdb_path, "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, 5 * 16384 + 3, SEEK_SET), 0);
    for (int i = 0; i < 4000; i++)
        assert_int_not_equal(fputc(0xa5, f), EOF);
    assert_int_equal(fclose(f), 0);
    use_schema(2, STEP_2);
    assert_int_equal(store_open(tempdb_path, STORE_MIGRATE, NULL, &s, &e), ST_ECORRUPT);
    assert_null(s);
    assert_int_not_equal(access(copy, F_OK), 0);
    assert_int_equal(tempdb_number("PRAGMA user_version"), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_upgraded),
        cmocka_unit_test(test_not_upgraded),
        cmocka_unit_test(test_damaged),
    };

    return cmocka_run_group_tests(tests, tempdb_begin_faces, tempdb_end_faces);
}
