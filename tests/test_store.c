/* The store: what it promises, and what it does with damaged, foreign, newer, locked and
 * full databases. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>
#include <sqlite3.h>

#include "errinfo.h"
#include "face.h"
#include "facegen.h"
#include "keyfile.h"
#include "store.h"

#define FACES  4
#define NOBODY 65534

static char dir[64], path[96];
static struct face face[FACES];
static struct face_work *work;
static struct errinfo e;

static void make_face(uint64_t subject, struct face *f)
{
    static struct dvec3 pts[1500];
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = subject;
    s.points = 1500;
    assert_int_equal(face_build(pts, facegen_sample(&s, pts), work, f, NULL), ST_OK);
}

static void remove_database(void)
{
    static const char *const suffix[] = {"", "-wal", "-shm", "-journal"};
    char name[128];

    for (size_t i = 0; i < 4; i++) {
        (void)snprintf(name, sizeof name, "%s%s", path, suffix[i]);
        (void)unlink(name);
    }
}

static struct store *fresh(void)
{
    struct store *s = NULL;

    remove_database();
    assert_int_equal(store_open(path, STORE_CREATE, NULL, &s, &e), ST_OK);
    return s;
}

static struct store *again(enum store_mode mode)
{
    struct store *s = NULL;

    if (store_open(path, mode, NULL, &s, &e) != ST_OK)
        fail_msg("%s", e.msg);
    return s;
}

static void add(struct store *s, const char *subject, const struct face *f,
                struct store_template *t)
{
    bool created;

    if (store_enroll(s, "test", subject, "", f, t, &created, &e) != ST_OK)
        fail_msg("%s", e.msg);
    assert_true(created);
}

/* Run SQL on the file as another program would. */
static void sql(const char *text)
{
    sqlite3 *db;
    char *why = NULL;

    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    (void)sqlite3_busy_timeout(db, 5000);
    if (sqlite3_exec(db, text, NULL, NULL, &why) != SQLITE_OK)
        fail_msg("%s: %s", text, why);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static uint64_t count(const char *text)
{
    sqlite3 *db;
    sqlite3_stmt *stmt;
    uint64_t n;

    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, text, -1, &stmt, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(stmt), SQLITE_ROW);
    n = (uint64_t)sqlite3_column_int64(stmt, 0);
    (void)sqlite3_finalize(stmt);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    return n;
}

static void print_report(void *arg, const char *line)
{
    unsigned *lines = arg;

    print_message("  reported: %s\n", line);
    (*lines)++;
}

static void count_report(void *arg, const char *line)
{
    unsigned *lines = arg;

    assert_true(line[0] != '\0');
    (*lines)++;
}

static struct store_check check(struct store *s)
{
    struct store_check found;
    unsigned lines = 0;

    assert_int_equal(store_check(s, print_report, &lines, &found, &e), ST_OK);
    assert_int_equal(lines, found.problems);
    return found;
}

/* More than one thread checks: each template is read once, also one of an odd key. */
static void test_check_shares(void **state)
{
    struct store *s = fresh();
    struct store_template t;
    struct store_check found;
    char subject[16];

    (void)state;
    for (int i = 0; i < 200; i++) {
        (void)snprintf(subject, sizeof subject, "s%d", i);
        add(s, subject, &face[0], &t);
    }
    sql("UPDATE templates SET template_key = -70 WHERE template_key = 70");
    found = check(s);
    assert_int_equal(found.templates, 200);
    assert_int_equal(found.problems, 0);
    sql("UPDATE templates SET model = zeroblob(length(model)) "
        "WHERE template_key IN (-70, 1, 100, 200)");
    found = check(s);
    assert_int_equal(found.templates, 200);
    assert_int_equal(found.bad_templates, 4);
    assert_int_equal(found.problems, 4);
    store_close(s);
}

/* ---- what it is for */

static void test_templates(void **state)
{
    struct store *s = fresh();
    struct store_template a, b, got, *list;
    struct store_subject subject;
    struct face f = {0};
    struct stat sb;
    bool created = true;
    size_t n;

    (void)state;
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    assert_int_equal(store_ready(s, &e), ST_OK);
    add(s, "alice", &face[0], &a);
    assert_int_equal(a.points, face[0].mesh.nv);
    assert_string_equal(a.engine, store_made_by(s));

    /* The same cloud again is the same template; for somebody else it is another. */
    assert_int_equal(store_enroll(s, "test", "alice", "x", &face[0], &b, &created, &e),
                     ST_OK);
    assert_false(created);
    assert_memory_equal(&a, &b, sizeof a);
    add(s, "bob", &face[0], &b);
    assert_string_equal(a.digest, b.digest);
    assert_string_not_equal(a.id, b.id);

    assert_int_equal(store_template_load(s, a.id, &got, work, &f, &e), ST_OK);
    assert_memory_equal(&a, &got, sizeof a);
    assert_int_equal(f.mesh.nv, face[0].mesh.nv);
    assert_memory_equal(f.mesh.twin, face[0].mesh.twin,
                        3 * f.mesh.nt * sizeof *f.mesh.twin);
    assert_memory_equal(&f.quality, &face[0].quality, sizeof f.quality);
    assert_memory_equal(f.spacing, face[0].spacing, f.mesh.nv * sizeof *f.spacing);
    assert_memory_equal(f.bridge, face[0].bridge, f.mesh.nt);
    assert_true(f.measured == face[0].measured);

    assert_int_equal(
        store_enroll(s, "test", "alice", "K\xc3\xb6ln", &face[1], &b, &created, &e),
        ST_OK);
    assert_int_equal(store_template_list(s, "alice", &list, &n, &e), ST_OK);
    assert_int_equal(n, 2);
    assert_string_equal(list[0].id, a.id);
    assert_string_equal(list[1].label, "K\xc3\xb6ln");
    free(list);
    assert_int_equal(store_subject_get(s, "alice", &subject, &e), ST_OK);
    assert_int_equal(subject.templates, 2);

    store_close(s); /* it is all in the file */
    s = again(STORE_READ);
    assert_int_equal(store_template_get(s, b.id, &got, &e), ST_OK);
    assert_memory_equal(&b, &got, sizeof b);
    assert_int_equal(store_template_delete(s, "", b.id, &e), ST_EDENIED);
    store_close(s);
    s = again(STORE_WRITE);
    assert_int_equal(store_template_delete(s, "test", b.id, &e), ST_OK);
    assert_int_equal(store_template_get(s, b.id, &got, &e), ST_ENOTFOUND);
    assert_int_equal(store_template_delete(s, "test", b.id, &e), ST_ENOTFOUND);
    assert_int_equal(check(s).problems, 0);
    face_free(&f);
    store_close(s);
}

/* An enrolment that was decided on templates that have changed since. */
static void test_enroll_after(void **state)
{
    struct store *s = fresh();
    struct store_template a, b, t;
    struct store_subject who;
    bool created;

    (void)state;
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[0], "", &a, &created, &e), ST_OK);
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[1], "", &t, &created, &e),
        ST_EEXISTS);
    assert_false(created);
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[0], "", &t, &created, &e), ST_OK);
    assert_false(created); /* the same cloud again changes nothing */
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[1], a.id, &b, &created, &e), ST_OK);
    assert_true(created);
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[2], a.id, &t, &created, &e),
        ST_EEXISTS);
    assert_int_equal(store_template_delete(s, "", b.id, &e), ST_OK);
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[2], b.id, &t, &created, &e),
        ST_EEXISTS); /* nothing new, but it cannot know */
    assert_int_equal(
        store_enroll_after(s, "", "bob", "", &face[2], a.id, &t, &created, &e),
        ST_EEXISTS);
    assert_int_equal(store_subject_get(s, "bob", &who, &e), ST_ENOTFOUND);
    assert_int_equal(
        store_enroll_after(s, "", "alice", "", &face[2], a.id, &t, &created, &e), ST_OK);
    store_close(s);
    assert_int_equal(count("SELECT count(*) FROM templates"), 2);
    assert_int_equal(count("SELECT count(*) FROM events WHERE kind = 'enroll'"), 3);
}

static void test_subjects(void **state)
{
    struct store *s = fresh();
    struct store_template t, *list;
    struct store_subject *page, one;
    uint32_t removed;
    char name[16];
    int64_t last = 0;
    int seen = 0;
    size_t n;

    (void)state;
    for (int i = 0; i < 25; i++) {
        (void)snprintf(name, sizeof name, "s%02d", (i * 7) % 25);
        add(s, name, &face[i % FACES], &t);
    }
    do {
        assert_int_equal(store_subject_list(s, last, 10, &page, &n, &e), ST_OK);
        for (size_t i = 0; i < n; i++, seen++) {
            (void)snprintf(name, sizeof name, "s%02d", seen * 7 % 25);
            assert_string_equal(page[i].id, name);
            assert_true(page[i].key > last);
            last = page[i].key;
        }
        free(page);
    } while (n == 10);
    assert_int_equal(seen, 25);
    add(s, "s03", &face[1], &t);
    assert_int_equal(store_subject_delete(s, "test", "s03", &removed, &e), ST_OK);
    assert_int_equal(removed, 2);
    assert_int_equal(store_subject_get(s, "s03", &one, &e), ST_ENOTFOUND);
    assert_int_equal(store_template_list(s, "s03", &list, &n, &e), ST_ENOTFOUND);
    assert_null(list);
    assert_int_equal(store_template_get(s, t.id, &t, &e), ST_ENOTFOUND);
    assert_int_equal(store_subject_delete(s, "test", "s03", &removed, &e), ST_ENOTFOUND);
    store_close(s);
}

/* Nothing of a deleted model is left in the files. */
/* n bytes of a BLOB, as they lie in the file. */
static void blob(const char *text, unsigned char *out, size_t n)
{
    sqlite3 *db;
    sqlite3_stmt *stmt;

    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, text, -1, &stmt, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(stmt), SQLITE_ROW);
    assert_int_equal(sqlite3_column_bytes(stmt, 0), n);
    memcpy(out, sqlite3_column_blob(stmt, 0), n);
    (void)sqlite3_finalize(stmt);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

/* Are these bytes in the database or its log? */
static bool in_files(const void *needle, size_t len)
{
    bool found = false;

    for (int i = 0; i < 2; i++) {
        unsigned char *bytes;
        char name[128];
        FILE *in;
        size_t n;

        (void)snprintf(name, sizeof name, "%s%s", path, i == 0 ? "" : "-wal");
        if ((in = fopen(name, "rb")) == NULL)
            continue;
        assert_non_null(bytes = malloc(4 << 20));
        n = fread(bytes, 1, 4 << 20, in);
        (void)fclose(in);
        for (size_t k = 0; k + len <= n; k++)
            found = found || memcmp(bytes + k, needle, len) == 0;
        free(bytes);
    }
    return found;
}

static void test_erased(void **state)
{
    struct store *s = fresh();
    struct store_template t;
    unsigned char key[72], model[64];

    (void)state;
    add(s, "keep", &face[0], &t);
    add(s, "gone", &face[1], &t);
    blob("SELECT key FROM subjects ORDER BY subject_key DESC LIMIT 1", key, sizeof key);
    blob(
        "SELECT substr(model, 1000, 64) FROM templates ORDER BY template_key DESC LIMIT 1",
        model, sizeof model);
    assert_true(in_files(key, 64));
    assert_true(in_files(model, sizeof model));
    assert_int_equal(store_subject_delete(s, "test", "gone", NULL, &e), ST_OK);
    assert_false(in_files(key, 16));
    assert_false(in_files(model, 16));
    store_close(s);
}

static void test_events(void **state)
{
    struct store *s = fresh();
    struct store_template t;
    struct store_stats stats;

    (void)state;
    add(s, "alice", &face[0], &t);
    assert_int_equal(store_event(s, "verify", "test", "alice", t.id, "match", &e), ST_OK);
    assert_int_equal(store_event(s, "compare", "", "", "", "no_match", &e), ST_OK);
    assert_int_equal(store_event(s, "", "", "", "", "", &e), ST_EINVAL);
    assert_int_equal(store_event(s, "verify", "a\nb", "", "", "", &e), ST_EINVAL);
    assert_int_equal(store_event(s, "verify", "", "no spaces", "", "", &e), ST_EINVAL);
    assert_int_equal(store_subject_delete(s, "test", "alice", NULL, &e), ST_OK);
    assert_int_equal(store_stats(s, &stats, &e), ST_OK);
    assert_int_equal(stats.events,
                     5); /* create_key, enroll, verify, compare, delete_subject */
    assert_int_equal(stats.subjects, 0);
    assert_int_equal(stats.templates, 0);
    assert_true(stats.file_bytes > 0);
    store_close(s);
    assert_int_equal(count("SELECT count(DISTINCT subject) FROM events"), 2);
    assert_int_equal(count("SELECT count(*) FROM events WHERE length(subject) = 16"), 3);
}

static void test_bad_arguments(void **state)
{
    static const char *const subject[] = {"",    "a b",      "a/b", "../a",
                                          "a\n", "\xc3\xa4", "a;b"};
    static const char *const label[] = {"\x01", "a\nb",         "\xff",
                                        "\xc3", "\xed\xa0\x80", "\xc2\x85"};
    struct store *s = fresh();
    struct store_template t;
    char longest[STORE_SUBJECT_MAX + 2], text[STORE_LABEL_MAX + 2];
    bool created;

    (void)state;
    for (size_t i = 0; i < sizeof subject / sizeof *subject; i++) {
        assert_false(store_subject_valid(subject[i]));
        assert_int_equal(store_enroll(s, "", subject[i], "", &face[0], &t, &created, &e),
                         ST_EINVAL);
    }
    for (size_t i = 0; i < sizeof label / sizeof *label; i++)
        assert_int_equal(store_enroll(s, "", "a", label[i], &face[0], &t, &created, &e),
                         ST_EINVAL);
    memset(longest, 'x', sizeof longest);
    longest[STORE_SUBJECT_MAX + 1] = '\0';
    assert_false(store_subject_valid(longest));
    longest[STORE_SUBJECT_MAX] = '\0';
    memset(text, 'y', sizeof text);
    text[STORE_LABEL_MAX + 1] = '\0';
    assert_int_equal(store_enroll(s, "", longest, text, &face[0], &t, &created, &e),
                     ST_EINVAL);
    text[STORE_LABEL_MAX] = '\0';
    assert_int_equal(store_enroll(s, "", longest, text, &face[0], &t, &created, &e),
                     ST_OK);
    assert_string_equal(t.subject, longest);
    assert_string_equal(t.label, text);
    assert_int_equal(store_template_get(s, "nonsense", &t, &e), ST_EINVAL);
    assert_int_equal(store_template_get(s, "0123456789ABCDEF0123456789abcdef", &t, &e),
                     ST_EINVAL);
    store_close(s);
}

/* ---- databases that are not what they should be */

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
    remove_database();
    assert_refused(path, STORE_WRITE, ST_ENOTFOUND, path);
    assert_refused(path, STORE_READ, ST_ENOTFOUND, path);
    assert_refused("", STORE_CREATE, ST_EINVAL, "path");
    assert_refused(":memory:", STORE_CREATE, ST_EINVAL, ":memory:");
    assert_refused(dir, STORE_CREATE, ST_EINVAL, dir);
    (void)snprintf(name, sizeof name, "%s/no/such/place", dir);
    assert_refused(name, STORE_CREATE, ST_EIO, name);
    write_file(path, "", 0);
    assert_refused(path, STORE_WRITE, ST_ENOTFOUND, path);
    write_file(path,
               "this is a letter, not a database; nothing to see in here at all, "
               "but it is long enough to be looked at as if it were one......",
               120);
    assert_refused(path, STORE_CREATE, ST_ECORRUPT, "not a database");
    remove_database();
    sql("CREATE TABLE recipes (cake TEXT)");
    assert_refused(path, STORE_CREATE, ST_ECORRUPT, "another program");
    s = fresh();
    store_close(s);
    sql("PRAGMA user_version = 5");
    assert_refused(path, STORE_WRITE, ST_EVERSION, "newer");
    assert_refused(path, STORE_READ, ST_EVERSION, "5");
    assert_int_equal(count("PRAGMA user_version"), 5); /* left as it was */
    remove_database();
    write_file(path, "", 0); /* an empty file may be initialised */
    store_close(again(STORE_CREATE));
    store_close(again(STORE_WRITE));
}

/* What is stored of a person cannot be read by who has the file alone. */
static void test_sealed(void **state)
{
    struct store *s = fresh(), *other = NULL;
    struct store_subject who = {
        .id = "mary-jane", .reference = "consent 4711", .purpose = "the front door"};
    struct store_template t;
    char key[128], away[128];
    bool created;

    (void)state;
    assert_int_equal(store_subject_add(s, "test", &who, &e), ST_OK);
    assert_int_equal(store_subject_add(s, "test", &who, &e), ST_EEXISTS);
    assert_int_equal(
        store_enroll(s, "test", "mary-jane", "left camera", &face[1], &t, &created, &e),
        ST_OK);
    assert_int_equal(store_event(s, "verify", "door", "mary-jane", t.id, "match", &e),
                     ST_OK);
    assert_true(in_files(t.id, 32)); /* the search finds things */
    assert_false(in_files("mary-jane", 9));
    assert_false(in_files("consent 4711", 12));
    assert_false(in_files("front door", 10));
    assert_false(in_files("left camera", 11));
    assert_false(in_files(t.digest, 64));
    assert_false(in_files(face[1].mesh.z + 700, 16));
    memset(&who, 0, sizeof who);
    assert_int_equal(store_subject_get(s, "mary-jane", &who, &e), ST_OK);
    assert_string_equal(who.reference, "consent 4711");
    assert_string_equal(who.purpose, "the front door");
    assert_int_equal(who.templates, 1);
    store_close(s);

    /* Another key, or none, opens nothing and changes nothing. */
    (void)snprintf(key, sizeof key, "%s.key", path);
    (void)snprintf(away, sizeof away, "%s.away", path);
    assert_int_equal(rename(key, away), 0);
    assert_refused(path, STORE_WRITE, ST_ENOTFOUND, key);
    assert_refused(path, STORE_CREATE, ST_ENOTFOUND, key);
    assert_int_equal(keyfile_make(key, &e), ST_OK);
    assert_refused(path, STORE_WRITE, ST_EDENIED, key);
    assert_int_equal(chmod(away, 0644), 0);
    assert_int_equal(rename(away, key), 0);
    assert_refused(path, STORE_READ, ST_EDENIED, "chmod");
    assert_int_equal(chmod(key, 0600), 0);
    assert_int_equal(store_open(path, STORE_READ, NULL, &other, &e), ST_OK);
    store_close(other);
}

/* Paths that we may not write.  Root may write anywhere: then as another user. */
static void test_unwritable(void **state)
{
    struct store *s = fresh();
    struct store_subject *list;
    const bool root = geteuid() == 0;
    char name[128];
    size_t n;

    (void)state;
    store_close(s);
    if (root) {
        assert_int_equal(chown(dir, NOBODY, NOBODY), 0);
        assert_int_equal(chown(path, NOBODY, NOBODY), 0);
        (void)snprintf(name, sizeof name, "%s.key", path);
        assert_int_equal(chown(name, NOBODY, NOBODY), 0);
        assert_int_equal(seteuid(NOBODY), 0);
    }
    assert_int_equal(chmod(path, 0400), 0);
    assert_refused(path, STORE_WRITE, ST_EIO, path);
    s = again(STORE_READ); /* but it can be read */
    assert_int_equal(store_subject_list(s, 0, 10, &list, &n, &e), ST_OK);
    free(list);
    store_close(s);
    assert_int_equal(chmod(path, 0000), 0);
    assert_refused(path, STORE_READ, ST_EIO, path);
    assert_int_equal(chmod(path, 0600), 0);
    assert_int_equal(chmod(dir, 0500), 0);
    (void)snprintf(name, sizeof name, "%s/new", dir);
    assert_refused(name, STORE_CREATE, ST_EIO, name);
    assert_refused(path, STORE_WRITE, ST_EIO, path); /* there is no room for its log */
    assert_int_equal(chmod(dir, 0700), 0);
    store_close(again(STORE_WRITE));
    if (root)
        assert_int_equal(seteuid(0), 0);
}

/* A version that comes while we have the database open. */
static void test_ready(void **state)
{
    struct store *s = fresh();
    char aside[128];

    (void)state;
    sql("PRAGMA user_version = 5");
    assert_int_equal(store_ready(s, &e), ST_EVERSION);
    sql("PRAGMA user_version = 4");
    assert_int_equal(store_ready(s, &e), ST_OK);
    (void)snprintf(aside, sizeof aside, "%s.aside", path);
    assert_int_equal(rename(path, aside), 0);
    assert_int_equal(store_ready(s, &e), ST_EIO);
    assert_int_equal(rename(aside, path), 0);
    assert_int_equal(store_ready(s, &e), ST_OK);
    store_close(s);
}

static void test_damaged_rows(void **state)
{
    static const char *const damage[] = {
        "UPDATE templates SET model = zeroblob(41)",
        "UPDATE templates SET model = zeroblob(100)",
        "UPDATE templates SET model = substr(model, 1, 1000)",
        "UPDATE templates SET model = CAST(substr(model, 1, 5000) || x'55' ||"
        " substr(model, 5002) AS BLOB)",
        "UPDATE templates SET points = points + 1",
        "PRAGMA ignore_check_constraints = ON; UPDATE templates SET points = -7",
        "UPDATE templates SET about = zeroblob(100)",
        "UPDATE templates SET about = substr(about, 1, 60)",
        "UPDATE templates SET engine = 'another'",
        "UPDATE templates SET created = '2026-01-01T00:00:00.000Z'",
        "PRAGMA ignore_check_constraints = ON;"
        "UPDATE templates SET engine = CAST(zeroblob(1000) AS TEXT)",
        "UPDATE templates SET id = '00000000000000000000000000000000'",
        "UPDATE subjects SET key = zeroblob(72)",
        "UPDATE subjects SET uid = zeroblob(16)",
        "UPDATE subjects SET about = zeroblob(100)",
        "UPDATE subjects SET created = '2026-01-01T00:00:00.000Z'",
        "UPDATE subjects SET hold = 1",
        "UPDATE subjects SET disabled = 1",
        "UPDATE subjects SET expires = '2026-01-01T00:00:00.000Z'",
        "PRAGMA foreign_keys = OFF; DELETE FROM subjects",
    };
    struct store_template t, got;
    struct face f = {0};

    (void)state;
    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        struct store *s = fresh();
        struct store_check found;
        enum status st;

        add(s, "alice", &face[0], &t);
        sql(damage[i]);
        st = store_template_load(s, t.id, &got, work, &f, &e);
        print_message("%s: %s\n", damage[i], st == ST_OK ? "loads" : e.msg);
        assert_true(st == ST_ECORRUPT ||
                    (st == ST_ENOTFOUND && (strstr(damage[i], "DELETE") != NULL ||
                                            strstr(damage[i], "SET id") != NULL)));
        assert_true(st == ST_OK || f.mesh.nv == 0 || strstr(damage[i], "model") == NULL);
        found = check(s);
        assert_true(found.problems > 0);
        store_close(s);
    }
    face_free(&f);
}

/* Bytes of the file itself changed: an error or the right answer, never a crash. */
static void test_damaged_pages(void **state)
{
    struct store *s = fresh();
    struct store_template t, got;
    struct face f = {0};
    unsigned char *good, *bad;
    unsigned errors = 0;
    size_t n;
    FILE *in;

    (void)state;
    add(s, "alice", &face[0], &t);
    store_close(s);
    assert_non_null(good = malloc(1 << 20));
    assert_non_null(bad = malloc(1 << 20));
    assert_non_null(in = fopen(path, "rb"));
    n = fread(good, 1, 1 << 20, in);
    (void)fclose(in);
    for (size_t i = 0; i < 400; i++) {
        const size_t at = i < 150 ? i : (i * 7919) % n;
        struct store_check found;
        unsigned lines = 0;
        enum status st;

        memcpy(bad, good, n);
        bad[at] ^= (unsigned char)(1 + i % 255);
        remove_database();
        write_file(path, bad, n);
        if ((st = store_open(path, STORE_WRITE, NULL, &s, &e)) == ST_OK) {
            st = store_template_load(s, t.id, &got, work, &f, &e);
            if (st == ST_OK)
                assert_int_equal(f.mesh.nv, face[0].mesh.nv);
            (void)store_check(s, count_report, &lines, &found, &e);
            store_close(s);
        }
        errors += st != ST_OK;
    }
    print_message("%u of 400 damaged files gave an error\n", errors);
    assert_true(errors > 100);
    free(good);
    free(bad);
    face_free(&f);
}

/* The disk is full at any point of an enrolment: nothing half-done, and it goes on later. */
static void test_full_disk(void **state)
{
    struct store *s = fresh();
    struct rlimit was, tight;
    struct store_template t;
    struct stat sb;
    bool created, done = false;
    unsigned failures = 0;
    char wal[128];

    (void)state;
    add(s, "alice", &face[0], &t);
    (void)snprintf(wal, sizeof wal, "%s-wal", path);
    assert_int_equal(stat(wal, &sb), 0);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &was), 0);
    assert_true(signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
    for (rlim_t room = 100; !done; room += 5000) {
        enum status st;

        tight = was;
        tight.rlim_cur = (rlim_t)sb.st_size + room;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
        st = store_enroll(s, "test", "bob", "", &face[1], &t, &created, &e);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &was), 0);
        if (st == ST_OK) {
            done = true;
        } else {
            assert_int_equal(st, ST_EIO);
            assert_false(created);
            assert_non_null(strstr(e.msg, path));
            failures++;
            assert_int_equal(count("SELECT count(*) FROM subjects"), 1);
            assert_int_equal(count("SELECT count(*) FROM templates"), 1);
            assert_int_equal(count("SELECT count(*) FROM events"), 2);
        }
    }
    print_message("%u enrolments failed: %s\n", failures, e.msg);
    assert_true(failures > 3);
    assert_int_equal(check(s).problems, 0);
    assert_int_equal(check(s).templates, 2);
    store_close(s);
}

/* ---- several at once */

#define ROUNDS 40

static void *reader(void *arg)
{
    struct store *s = arg;
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};
    struct errinfo why;
    intptr_t bad = w == NULL;

    for (int i = 0; i < ROUNDS && !bad; i++) {
        struct store_template *list, got;
        size_t n;
        enum status st = store_template_list(s, "alice", &list, &n, &why);

        if (st != ST_OK || n < 1)
            bad = 1;
        for (size_t k = 0; k < n && !bad; k++) {
            st = store_template_load(s, list[k].id, &got, w, &f, &why);
            if (st != ST_OK && st != ST_ENOTFOUND) /* deleted meanwhile */
                bad = 1;
        }
        free(list);
    }
    face_free(&f);
    face_work_free(w);
    return (void *)bad;
}

static void *writer(void *arg)
{
    struct store *s = arg;
    struct errinfo why;
    struct store_template t;
    intptr_t bad = 0;
    bool created;

    for (int i = 0; i < ROUNDS && !bad; i++)
        if (store_enroll(s, "test", "alice", "", &face[1 + i % 3], &t, &created, &why) !=
                ST_OK ||
            store_template_delete(s, "test", t.id, &why) != ST_OK)
            bad = 1;
    return (void *)bad;
}

static void test_threads(void **state)
{
    struct store *s = fresh();
    struct store_template t;
    pthread_t thread[5];

    (void)state;
    add(s, "alice", &face[0], &t);
    for (int i = 0; i < 5; i++)
        assert_int_equal(pthread_create(&thread[i], NULL, i == 0 ? writer : reader, s),
                         0);
    for (int i = 0; i < 5; i++) {
        void *bad;

        assert_int_equal(pthread_join(thread[i], &bad), 0);
        assert_null(bad);
    }
    assert_int_equal(check(s).problems, 0);
    assert_int_equal(check(s).templates, 1);
    store_close(s);
}

/* Another process adds and deletes while this one has the database open. */
static void test_processes(void **state)
{
    struct store *s = fresh();
    struct store_template t, got;
    struct store_subject one;
    pid_t child;
    int status;

    (void)state;
    add(s, "alice", &face[0], &t);
    if ((child = fork()) == 0) {
        /* The parent's connections are not the child's to use: it opens its own. */
        struct store *mine;
        struct store_template u;
        struct errinfo why;
        bool created;

        _exit(store_open(path, STORE_WRITE, NULL, &mine, &why) == ST_OK &&
                      store_enroll(mine, "test", "bob", "", &face[1], &u, &created,
                                   &why) == ST_OK &&
                      store_template_delete(mine, "test", t.id, &why) == ST_OK
                  ? 0
                  : 1);
    }
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_int_equal(store_template_get(s, t.id, &got, &e), ST_ENOTFOUND);
    assert_int_equal(store_subject_get(s, "bob", &one, &e), ST_OK);
    assert_int_equal(one.templates, 1);
    add(s, "bob", &face[2], &t); /* and we can write after it */
    assert_int_equal(check(s).problems, 0);
    store_close(s);
}

/* Locked by another process for longer than we wait. */
static void test_locked(void **state)
{
    struct store *s = fresh();
    struct store_template t, got, *list;
    sqlite3 *db;
    size_t n;
    bool created;

    (void)state;
    add(s, "alice", &face[0], &t);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(store_enroll(s, "", "bob", "", &face[1], &t, &created, &e),
                     ST_EBUSY);
    assert_int_equal(store_template_list(s, "alice", &list, &n, &e), ST_OK);
    assert_int_equal(n, 1);
    free(list);
    assert_int_equal(sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    assert_int_equal(store_enroll(s, "", "bob", "", &face[1], &got, &created, &e), ST_OK);
    store_close(s);
}

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(dir, sizeof dir, "/tmp/test_store.XXXXXX");
    if (mkdtemp(dir) == NULL || (work = face_work_new(NULL)) == NULL)
        return 1;
    (void)snprintf(path, sizeof path, "%s/db", dir);
    for (uint64_t i = 0; i < FACES; i++)
        make_face(i + 1, &face[i]);
    return 0;
}

static int tear_down(void **state)
{
    char key[128];

    (void)state;
    remove_database();
    (void)snprintf(key, sizeof key, "%s.key", path);
    (void)unlink(key);
    for (int i = 0; i < FACES; i++)
        face_free(&face[i]);
    face_work_free(work);
    return rmdir(dir);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_templates),    cmocka_unit_test(test_check_shares),
        cmocka_unit_test(test_subjects),     cmocka_unit_test(test_erased),
        cmocka_unit_test(test_events),       cmocka_unit_test(test_bad_arguments),
        cmocka_unit_test(test_sealed),       cmocka_unit_test(test_refused),
        cmocka_unit_test(test_unwritable),   cmocka_unit_test(test_ready),
        cmocka_unit_test(test_damaged_rows), cmocka_unit_test(test_damaged_pages),
        cmocka_unit_test(test_full_disk),    cmocka_unit_test(test_threads),
        cmocka_unit_test(test_processes),    cmocka_unit_test(test_locked),
        cmocka_unit_test(test_enroll_after),
    };

    return cmocka_run_group_tests_name("store", tests, set_up, tear_down);
}
