/* Databases that are damaged, foreign, newer or read-only, or without their key.  Rows that somebody
 * has changed: test_hostile.c and tests/box/store-attacks.sh. */
#include <sys/stat.h>
#include <unistd.h>

#include "face.h"
#include "crypt_file.h"
#include "store.h"
#include "tempdb.h"
#include "tempdb_check.h"
#include "unit.h"

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

TEST(test_refused)
{
    struct store *s;
    char name[128];

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
TEST(test_keys)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    char key[128], away[128];

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    store_close(s);
    (void)snprintf(key, sizeof key, "%s.key", tempdb_path);
    (void)snprintf(away, sizeof away, "%s.away", tempdb_path);
    assert_int_equal(rename(key, away), 0);
    assert_refused(tempdb_path, STORE_WRITE, ST_ENOTFOUND, key);
    assert_refused(tempdb_path, STORE_CREATE, ST_ENOTFOUND, key);
    must(crypt_file_make(key, &e));
    assert_refused(tempdb_path, STORE_WRITE, ST_EDENIED, key);
    assert_int_equal(chmod(away, 0644), 0);
    assert_int_equal(rename(away, key), 0);
    assert_refused(tempdb_path, STORE_READ, ST_EDENIED, "chmod");
    assert_int_equal(chmod(key, 0600), 0);
    store_close(tempdb_open(STORE_READ));
}

/* Paths that we may not write.  Root may write anywhere: then as another user. */
TEST(test_unwritable)
{
    struct store *s = tempdb_fresh();
    struct store_subject *list;
    const bool root = geteuid() == 0;
    char name[128];
    size_t n;

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
    assert_int_equal(chmod(tempdb_path, 0400), 0);
    s = tempdb_open(STORE_READ); /* but it can be read */
    must(store_subject_list(s, 0, 10, &list, &n, &e));
    free(list);
    store_close(s);
    if (root)
        assert_int_equal(seteuid(0), 0);
}

/* More than one thread checks: each template is read once, also one of an odd key. */
TEST(test_check_shares)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    struct admin_check found;
    char subject[16];

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
