/* Databases that are damaged, foreign, newer or read-only, or without their key. */
#include <sys/stat.h>
#include <unistd.h>
#include <sodium.h>

#include "expect.h"
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
    s = tempdb_open(STORE_READ); /* but it can be read */
    must(store_subject_list(s, 0, 10, &list, &n, &e));
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
TEST(test_ready)
{
    struct store *s = tempdb_fresh();
    char aside[128];

    tempdb_sql("PRAGMA user_version = 2");
    fails(store_ready(s, &e), ST_EVERSION);
    tempdb_sql("PRAGMA user_version = 1");
    must(store_ready(s, &e));
    (void)snprintf(aside, sizeof aside, "%s.aside", tempdb_path);
    assert_int_equal(rename(tempdb_path, aside), 0);
    fails(store_ready(s, &e), ST_EREFUSED);
    assert_int_equal(rename(aside, tempdb_path), 0);
    fails(store_ready(s, &e), ST_EREFUSED); /* until it is opened again */
    store_close(s);
    store_close(tempdb_open(STORE_WRITE));
}

/* ---- rows: an error where one is used, and found by a check */

static struct store_template front;
static char secret[65];

static enum status load(struct store *s)
{
    struct store_template got;
    struct surface_face *f = NULL;
    const enum status st = store_template_load(s, front.id, &got, tempdb_work, &f, &e);

    surface_face_free(f);
    return st;
}

static enum status find_token(struct store *s)
{
    struct store_token t, *list;
    size_t n;

    fails(store_token_list(s, &list, &n, &e), ST_ECORRUPT);
    return store_token_check(s, secret, &t, &e);
}

static enum status find_calibration(struct store *s)
{
    struct store_calibration k, *list;
    size_t n;

    fails(store_calibration_list(s, &list, &n, &e), ST_ECORRUPT);
    return store_calibration_get(s, &k, &e);
}

static enum status find_device(struct store *s)
{
    struct store_device *list;
    size_t n;

    return store_device_list(s, &list, &n, &e);
}

/* One of each. */
static struct store *written(void)
{
    struct store_calibration k = {.fmr = 0.001,
                                  .low = -701,
                                  .high = -699,
                                  .table = {-700, 2, {{-900, 1}, {-700, 0.001}}}};
    unsigned char public[CRYPT_KEY], own[crypto_sign_SECRETKEYBYTES];
    struct store *s = tempdb_fresh();
    struct store_device d;
    struct store_token t;

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &front);
    must(store_token_create(s, "test", "gate", STORE_SCOPE_VERIFY, 60, secret, &t, &e));
    (void)crypto_sign_keypair(public, own);
    must(store_device_add(s, "test", "door-1", public, &d, &e));
    must(store_calibration_add(s, "test", &k, &e));
    return s;
}

TEST(test_damaged_rows)
{
    static const struct {
        const char *table;
        enum status (*use)(struct store *s);
        const char *set[14];
    } damage[] = {
        {"faces",
         load,
         {"face = zeroblob(41)", "face = substr(face, 1, 1000)",
          "face = CAST(substr(face, 1, 5000) || x'5555555555555555' || substr(face, 5009) "
          "AS BLOB)",
          "template_key = 9"}},
        {"templates",
         load,
         {"points = points + 1", "points = -7", "revision = 2", "about = zeroblob(100)",
          "about = substr(about, 1, 60)", "engine = 'another'",
          "created = '2026-01-01T00:00:00.000Z'",
          "engine = CAST(zeroblob(1000) AS TEXT)"}},
        {"subjects",
         load,
         {"key = zeroblob(72)", "uid = zeroblob(16)", "about = zeroblob(100)",
          "created = '2026-01-01T00:00:00.000Z'", "hold = 1",
          "expires = '2026-01-01T00:00:00.000Z'"}},
        {"tokens",
         find_token,
         {"scopes = 'everything'", "scopes = ''",
          "scopes = 'enroll,verify,identify,read,delete'",
          "expires = CAST(zeroblob(100) AS TEXT)", "expires = '2126-01-01T00:00:00.000Z'",
          "expires = NULL", "id = 'x'", "id = '0123456789abcdef0123456789abcdef'",
          "old_hash = zeroblob(32), old_until = expires", "mac = zeroblob(32)"}},
        {"devices",
         find_device,
         {"name = 'door-3'", "id = '0123456789abcdef0123456789abcdef'",
          "public = zeroblob(32)", "mac = zeroblob(32)"}},
        {"calibrations",
         find_calibration,
         {"knots = zeroblob(32)", "knots = x'00'", "knots = zeroblob(16 * 33)",
          "threshold = 9e999", "threshold = threshold + 1", "fmr = 1", "impostors = -1",
          "engine = CAST(zeroblob(100) AS TEXT)", "calibration_key = -5",
          "calibration_key = 5", "shipped = 1", "actor = 'nobody'",
          "mac = zeroblob(32)"}},
    };

    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++)
        for (size_t k = 0; k < 14 && damage[i].set[k] != NULL; k++) {
            struct store *s = written();
            char sql[200];

            (void)snprintf(sql, sizeof sql, "PRAGMA foreign_keys = OFF; UPDATE %s SET %s",
                           damage[i].table, damage[i].set[k]);
            print_message("%s\n", sql);
            tempdb_sql(sql);
            assert_int_equal(damage[i].use(s), ST_ECORRUPT);
            assert_true(tempdb_check(s).problems > 0);
            assert_int_equal(store_verify(s, NULL, NULL, &e),
                             strcmp(damage[i].table, "faces") == 0 ? ST_OK : ST_EREFUSED);
            store_close(s);
        }
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

BEFORE_ALL(begin)
{
    assert_int_equal(tempdb_begin_faces(NULL), 0);
}

AFTER_ALL(end)
{
    assert_int_equal(tempdb_end_faces(NULL), 0);
}
