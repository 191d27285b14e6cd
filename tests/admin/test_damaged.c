/* Databases that are damaged, foreign, newer or read-only, without their key, and on a
 * full disk. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "errinfo.h"
#include "face.h"
#include "crypt_file.h"
#include "store.h"
#include "tempdb.h"
#include "tempdb_check.h"

#define NOBODY 65534

static struct errinfo e;

static void write_file(const char *name, const void *bytes, size_t n)
{
    FILE *out = fopen(name, "wb");

    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, n, out), n);
    assert_int_equal(fclose(out), 0);
}

static void assert_refused(const char *name, enum store_mode mode, enum status want,
                           const char *says)
{
    struct store *s;
    const enum status st = store_open(name, mode, NULL, &s, &e);

    print_message("  %s\n", e.msg);
    assert_int_equal(st, want);
    assert_int_equal(e.code, want);
    assert_null(s);
    assert_non_null(strstr(e.msg, says));
}

static void test_refused(void **state)
{
    struct store *s;
    char name[128];

    (void)state;
    tempdb_remove();
    assert_refused(tempdb_path, STORE_WRITE, ST_ENOTFOUND, tempdb_path);
    assert_refused(tempdb_path, STORE_READ, ST_ENOTFOUND, tempdb_path);
    assert_refused("", STORE_CREATE, ST_EINVAL, "path");
    assert_refused(":memory:", STORE_CREATE, ST_EINVAL, ":memory:");
    assert_refused(tempdb_dir, STORE_CREATE, ST_EINVAL, tempdb_dir);
    (void)snprintf(name, sizeof name, "%s/no/such/place", tempdb_dir);
    assert_refused(name, STORE_CREATE, ST_EIO, name);
    write_file(tempdb_path, "", 0);
    assert_refused(tempdb_path, STORE_WRITE, ST_ENOTFOUND, tempdb_path);
    write_file(tempdb_path,
               "this is a letter, not a database; nothing to see in here at all, "
               "but it is long enough to be looked at as if it were one......",
               120);
    assert_refused(tempdb_path, STORE_CREATE, ST_ECORRUPT, "not a database");
    tempdb_remove();
    tempdb_sql("CREATE TABLE recipes (cake TEXT)");
    assert_refused(tempdb_path, STORE_CREATE, ST_ECORRUPT, "another program");
    s = tempdb_fresh();
    store_close(s);
    tempdb_sql("PRAGMA user_version = 2");
    assert_refused(tempdb_path, STORE_WRITE, ST_EVERSION, "newer");
    assert_refused(tempdb_path, STORE_READ, ST_EVERSION, "2");
    assert_int_equal(tempdb_number("PRAGMA user_version"), 2); /* left as it was */
    write_file(tempdb_path, "", 0); /* an empty file may be initialised */
    store_close(tempdb_open(STORE_CREATE));
    store_close(tempdb_open(STORE_WRITE));
}

/* Another key, or none, opens nothing and changes nothing. */
static void test_keys(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    char key[128], away[128];

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    store_close(s);
    (void)snprintf(key, sizeof key, "%s.key", tempdb_path);
    (void)snprintf(away, sizeof away, "%s.away", tempdb_path);
    assert_int_equal(rename(key, away), 0);
    assert_refused(tempdb_path, STORE_WRITE, ST_ENOTFOUND, key);
    assert_refused(tempdb_path, STORE_CREATE, ST_ENOTFOUND, key);
    assert_int_equal(crypt_file_make(key, &e), ST_OK);
    assert_refused(tempdb_path, STORE_WRITE, ST_EDENIED, key);
    assert_int_equal(chmod(away, 0644), 0);
    assert_int_equal(rename(away, key), 0);
    assert_refused(tempdb_path, STORE_READ, ST_EDENIED, "chmod");
    assert_int_equal(chmod(key, 0600), 0);
    store_close(tempdb_open(STORE_READ));
}

/* Paths that we may not write.  Root may write anywhere: then as another user. */
static void test_unwritable(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_subject *list;
    const bool root = geteuid() == 0;
    char name[128];
    size_t n;

    (void)state;
    store_close(s);
    if (root) {
        assert_int_equal(chown(tempdb_dir, NOBODY, NOBODY), 0);
        assert_int_equal(chown(tempdb_path, NOBODY, NOBODY), 0);
        (void)snprintf(name, sizeof name, "%s.key", tempdb_path);
        assert_int_equal(chown(name, NOBODY, NOBODY), 0);
        assert_int_equal(seteuid(NOBODY), 0);
    }
    assert_int_equal(chmod(tempdb_path, 0400), 0);
    assert_refused(tempdb_path, STORE_WRITE, ST_EIO, tempdb_path);
    s = tempdb_open(STORE_READ); /* but it can be read */
    assert_int_equal(store_subject_list(s, 0, 10, &list, &n, &e), ST_OK);
    free(list);
    store_close(s);
    assert_int_equal(chmod(tempdb_path, 0000), 0);
    assert_refused(tempdb_path, STORE_READ, ST_EIO, tempdb_path);
    assert_int_equal(chmod(tempdb_path, 0600), 0);
    assert_int_equal(chmod(tempdb_dir, 0500), 0);
    (void)snprintf(name, sizeof name, "%s/new", tempdb_dir);
    assert_refused(name, STORE_CREATE, ST_EIO, name);
    assert_refused(tempdb_path, STORE_WRITE, ST_EIO,
                   tempdb_path); /* there is no room for its WAL */
    assert_int_equal(chmod(tempdb_dir, 0700), 0);
    store_close(tempdb_open(STORE_WRITE));
    if (root)
        assert_int_equal(seteuid(0), 0);
}

/* A version that comes while we have the database open. */
static void test_ready(void **state)
{
    struct store *s = tempdb_fresh();
    char aside[128];

    (void)state;
    tempdb_sql("PRAGMA user_version = 2");
    assert_int_equal(store_ready(s, &e), ST_EVERSION);
    tempdb_sql("PRAGMA user_version = 1");
    assert_int_equal(store_ready(s, &e), ST_OK);
    (void)snprintf(aside, sizeof aside, "%s.aside", tempdb_path);
    assert_int_equal(rename(tempdb_path, aside), 0);
    assert_int_equal(store_ready(s, &e), ST_EREFUSED);
    assert_int_equal(rename(aside, tempdb_path), 0);
    assert_int_equal(store_ready(s, &e), ST_EREFUSED); /* until it is opened again */
    store_close(s);
    store_close(tempdb_open(STORE_WRITE));
}

static void test_damaged_rows(void **state)
{
    static const char *const damage[] = {
        "UPDATE faces SET face = zeroblob(41)",
        "UPDATE faces SET face = substr(face, 1, 1000)",
        ("UPDATE faces SET face = CAST(substr(face, 1, 5000) ||"
         " x'5555555555555555' || substr(face, 5009) AS BLOB)"),
        "DELETE FROM faces",
        "UPDATE templates SET points = points + 1",
        "UPDATE templates SET points = -7",
        "UPDATE templates SET revision = 2",
        "UPDATE templates SET about = zeroblob(100)",
        "UPDATE templates SET about = substr(about, 1, 60)",
        "UPDATE templates SET engine = 'another'",
        "UPDATE templates SET created = '2026-01-01T00:00:00.000Z'",
        "UPDATE templates SET engine = CAST(zeroblob(1000) AS TEXT)",
        "UPDATE templates SET id = '00000000000000000000000000000000'",
        "UPDATE subjects SET key = zeroblob(72)",
        "PRAGMA foreign_keys = OFF; UPDATE subjects SET uid = zeroblob(16)",
        "UPDATE subjects SET about = zeroblob(100)",
        "UPDATE subjects SET created = '2026-01-01T00:00:00.000Z'",
        "UPDATE subjects SET hold = 1",
        "UPDATE subjects SET expires = '2026-01-01T00:00:00.000Z'",
        "PRAGMA foreign_keys = OFF; DELETE FROM subjects",
    };
    struct store_template t, got;
    struct face f = {0};

    (void)state;
    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        struct store *s = tempdb_fresh();
        struct admin_check found;
        enum status st;

        tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
        tempdb_sql(damage[i]);
        st = store_template_load(s, t.id, &got, tempdb_work, &f, &e);
        print_message("%s: %s\n", damage[i], st == ST_OK ? "loads" : e.msg);
        assert_true(st == ST_ECORRUPT ||
                    (st == ST_ENOTFOUND && strstr(damage[i], "SET id") != NULL));
        found = tempdb_check(s);
        assert_true(found.problems > 0);
        store_close(s);
    }
    face_free(&f);
}

/* More than one thread checks: each template is read once, also one of an odd key. */
static void test_check_shares(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    struct admin_check found;
    char subject[16];

    (void)state;
    for (int i = 0; i < 200; i++) {
        (void)snprintf(subject, sizeof subject, "s%d", i);
        tempdb_enroll(s, subject, "", &tempdb_face[0], &t);
    }
    tempdb_sql(
        "UPDATE templates SET template_key = 9000000000000000070 WHERE template_key = 70;"
        "UPDATE faces SET template_key = 9000000000000000070 WHERE template_key = 70");
    found = tempdb_check(s);
    assert_int_equal(found.templates, 200);
    assert_int_equal(found.problems, 0);
    tempdb_sql("UPDATE faces SET face = zeroblob(length(face)) "
               "WHERE template_key IN (9000000000000000070, 1, 100, 200)");
    found = tempdb_check(s);
    assert_int_equal(found.templates, 200);
    assert_int_equal(found.bad_templates, 4);
    assert_int_equal(found.problems, 4);
    store_close(s);
}

/* Each opening of a file fails: the database is opened, or it is not, and nothing is lost. */
static void test_files(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_subject one = {.id = "alice"};
    struct rlimit was, few;
    unsigned failed = 0;
    enum status st = ST_EIO;

    (void)state;
    store_close(s);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &was), 0);
    few = was;
    for (rlim_t n = 3; n < 64 && st != ST_OK; n++) {
        few.rlim_cur = n;
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
        st = store_open(tempdb_path, STORE_WRITE, NULL, &s, &e);
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &was), 0);
        failed += st != ST_OK;
        assert_true((s != NULL) == (st == ST_OK));
    }
    assert_int_equal(st, ST_OK);
    assert_true(failed > 3);
    assert_int_equal(store_subject_add(s, "test", &one, &e), ST_OK);
    store_close(s);
}

/* The disk is full at any point of an enrolment: nothing half-done, and it goes on
 * later. */
static void test_full_disk(void **state)
{
    struct store *s = tempdb_fresh();
    struct rlimit was, tight;
    struct store_template t;
    struct stat sb;
    bool created, done = false;
    unsigned failures = 0;
    char wal[128];

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    (void)snprintf(wal, sizeof wal, "%s-wal", tempdb_path);
    assert_int_equal(stat(wal, &sb), 0);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &was), 0);
    assert_true(signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
    for (rlim_t room = 100; !done; room += 5000) {
        enum status st;

        tight = was;
        tight.rlim_cur = (rlim_t)sb.st_size + room;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
        st = tempdb_store(s, "test", "bob", "", &tempdb_face[1], &t, &created, &e);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &was), 0);
        if (st == ST_OK) {
            done = true;
        } else {
            assert_int_equal(st, ST_EIO);
            assert_false(created);
            assert_non_null(strstr(e.msg, tempdb_path));
            failures++;
            assert_int_equal(tempdb_number("SELECT count(*) FROM subjects"), 1);
            assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 1);
            assert_int_equal(tempdb_number("SELECT count(*) FROM change_log"), 3);
        }
    }
    print_message("%u enrolments failed: %s\n", failures, e.msg);
    assert_true(failures > 3);
    assert_int_equal(tempdb_check(s).problems, 0);
    assert_int_equal(tempdb_check(s).templates, 2);
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused),      cmocka_unit_test(test_keys),
        cmocka_unit_test(test_unwritable),   cmocka_unit_test(test_ready),
        cmocka_unit_test(test_damaged_rows), cmocka_unit_test(test_check_shares),
        cmocka_unit_test(test_files),        cmocka_unit_test(test_full_disk),
    };

    return cmocka_run_group_tests_name("damaged", tests, tempdb_begin_faces,
                                       tempdb_end_faces);
}
