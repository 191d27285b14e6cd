#include "tempdb.h"

#include <dirent.h>
#include <errno.h>
#include <time.h>
#include <unistd.h>

#include "clouds.h"
#include "errinfo.h"
#include "store_txn.h"
#include "unit.h"
#include "utc.h"

#define POINTS 1500

char tempdb_dir[32], tempdb_path[40];
bool tempdb_server;
struct store_key tempdb_key = {.make = CRYPT_FILE};
struct surface_face tempdb_face[TEMPDB_FACES];
struct surface_work *tempdb_work;

static bool emptied(void)
{
    DIR *dir = opendir(tempdb_dir);
    const struct dirent *entry;
    bool done = dir != NULL;

    while (done && (entry = readdir(dir)) != NULL)
        done = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
               unlinkat(dirfd(dir), entry->d_name, 0) == 0;
    if (!done)
        print_error("%s: cannot be emptied: %s\n", tempdb_dir, strerror(errno));
    if (dir != NULL)
        (void)closedir(dir);
    return done;
}

static void on_server(const char *database, const char *text)
{
    struct rawdb *d;
    struct errinfo e;

    must(rawdb_open(database, &d, &e));
    must(rawdb_run(d, text, &e));
    rawdb_close(d);
}

void tempdb_remove(void)
{
    assert_true(emptied());
    if (tempdb_server)
        on_server(tempdb_path, "DROP SCHEMA IF EXISTS main, aside CASCADE;"
                               "CREATE SCHEMA main; CREATE SCHEMA aside");
}

static void make_server(const char *name)
{
    static char key[sizeof tempdb_path];
    char text[200];

    (void)snprintf(key, sizeof key, "%s/db.key", tempdb_dir);
    tempdb_key.path = key;
    (void)snprintf(tempdb_path, sizeof tempdb_path, "postgresql:///%s", name);
    (void)snprintf(text, sizeof text, "CREATE DATABASE \"%s\"", name);
    on_server("postgresql:///postgres", text);
}

static void begin(void)
{
    static struct dvec3 pts[POINTS];

    (void)snprintf(tempdb_dir, sizeof tempdb_dir, "/tmp/surfaced-test.XXXXXX");
    assert_non_null(mkdtemp(tempdb_dir));
    (void)snprintf(tempdb_path, sizeof tempdb_path, "%s/db", tempdb_dir);
    if ((tempdb_server = getenv("PGHOST") != NULL))
        make_server(strrchr(tempdb_dir, '/') + 1);
    assert_non_null(tempdb_work = surface_work_new(NULL));
    for (uint64_t i = 0; i < TEMPDB_FACES; i++) {
        const size_t n = clouds_scan(i + 1, 0, POINTS, pts);

        assert_int_equal(face_build(pts, n, tempdb_work, &tempdb_face[i], NULL), ST_OK);
    }
}

/* cmocka does not count a tear-down that fails. */
static void end(void)
{
    for (size_t i = 0; i < TEMPDB_FACES; i++)
        face_free(&tempdb_face[i]);
    surface_work_free(tempdb_work);
    if (!emptied() || rmdir(tempdb_dir) != 0) {
        print_error("%s is left behind\n", tempdb_dir);
        exit(EXIT_FAILURE);
    }
}

__attribute__((constructor(101))) static void fixture(void)
{
    unit_add_hook(UNIT_BEFORE_ALL, begin);
    unit_add_hook(UNIT_AFTER_ALL, end);
}

struct store *tempdb_open(enum store_mode mode)
{
    struct store *s = NULL;
    struct errinfo e;

    must(store_open(tempdb_path, mode, &tempdb_key, &s, &e));
    return s;
}

struct store *tempdb_fresh(void)
{
    tempdb_remove();
    return tempdb_open(STORE_CREATE);
}

struct rawdb *tempdb_raw(void)
{
    struct rawdb *d;
    struct errinfo e;
    char aside[100];

    must(rawdb_open(tempdb_path, &d, &e));
    (void)snprintf(aside, sizeof aside, "ATTACH '%s/aside' AS aside", tempdb_dir);
    if (!tempdb_server)
        must(rawdb_run(d, aside, &e));
    return d;
}

void tempdb_sql(const char *text)
{
    struct rawdb *d = tempdb_raw();
    struct errinfo e;

    if (tempdb_server) /* as rawdb_open() has it of a file */
        must(rawdb_run(d,
                       "DO $$ DECLARE c record; BEGIN "
                       "FOR c IN SELECT CAST(conrelid AS regclass) AS t, conname "
                       "FROM pg_constraint WHERE contype = 'c' "
                       "AND connamespace = CAST('main' AS regnamespace) "
                       "LOOP EXECUTE format('ALTER TABLE %s DROP CONSTRAINT %I', c.t, "
                       "c.conname); END LOOP; END $$",
                       &e));
    must(rawdb_run(d, text, &e));
    rawdb_close(d);
}

static void to_number(void *out, const char *data, size_t n)
{
    (void)n;
    *(int64_t *)out = strtoll(data, NULL, 10);
}

int64_t tempdb_number(const char *text)
{
    struct rawdb *d = tempdb_raw();
    struct errinfo e;
    int64_t n = INT64_MIN;

    must(rawdb_each(d, text, to_number, &n, &e));
    if (n == INT64_MIN)
        fail_msg("%s: no row", text);
    rawdb_close(d);
    return n;
}

static const char *const kept[] = {"subjects", "change_log", "access_log"};

void tempdb_keep(const char *name)
{
    char text[300];

    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++) {
        (void)snprintf(text, sizeof text,
                       "CREATE TABLE aside.%s_%s AS SELECT * FROM main.%s", name, kept[i],
                       kept[i]);
        tempdb_sql(text);
    }
}

void tempdb_put_back(const char *name)
{
    char text[600] = "BEGIN;";

    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++) {
        const size_t n = strlen(text);

        (void)snprintf(text + n, sizeof text - n,
                       "DELETE FROM main.%s; INSERT INTO main.%s SELECT * FROM "
                       "aside.%s_%s;",
                       kept[i], kept[i], name, kept[i]);
    }
    (void)strcat(text, "COMMIT");
    tempdb_sql(text);
}

int64_t tempdb_count(const char *rows)
{
    char text[256];

    (void)snprintf(text, sizeof text, "SELECT count(*) FROM %s", rows);
    return tempdb_number(text);
}

/* The index of another table has this content: they change their root pages.  Making a table tells
 * other connections that the schema has changed. */
void tempdb_mislead(const char *index, const char *rows)
{
    char text[800];

    (void)snprintf(
        text, sizeof text,
        "CREATE TABLE twin (k INTEGER PRIMARY KEY, v UNIQUE); INSERT INTO twin %s;"
        "CREATE TABLE aside.root AS SELECT name, rootpage FROM main.sqlite_schema "
        "WHERE name IN ('%s', 'sqlite_autoindex_twin_1');"
        "PRAGMA writable_schema = ON; UPDATE main.sqlite_schema AS s SET rootpage = "
        "(SELECT rootpage FROM aside.root r WHERE r.name <> s.name) "
        "WHERE name IN (SELECT name FROM aside.root);"
        "CREATE TABLE more (a); DROP TABLE aside.root",
        rows, index);
    tempdb_sql(text);
}

enum status tempdb_store(struct store *s, const char *actor, const char *subject,
                         const char *label, const struct surface_face *f,
                         struct store_template *t, bool *created, struct errinfo *e)
{
    unsigned char descriptor[SURFACE_DESCRIPTOR];
    const struct store_sample sample = {.face = f, .descriptor = descriptor};
    const struct store_enroll what = {
        .actor = actor, .subject = subject, .label = label, .sample = &sample, .n = 1};

    (void)surface_describe(tempdb_work, f, descriptor);
    return store_enroll(s, &what, t, created, e);
}

void tempdb_add(struct store *s, const char *subject)
{
    struct store_subject one = {.identify = true};
    struct errinfo e;

    (void)snprintf(one.id, sizeof one.id, "%s", subject);
    must(store_subject_add(s, "test", &one, &e));
}

void tempdb_enroll(struct store *s, const char *subject, const char *label,
                   const struct surface_face *f, struct store_template *t)
{
    struct errinfo e;
    bool created;

    must(tempdb_store(s, "test", subject, label, f, t, &created, &e));
    assert_true(created);
}

enum status tempdb_erase(struct store *s, const char *actor, const char *subject,
                         struct errinfo *e)
{
    struct store_receipt receipt;
    const enum status st = store_subject_erase(s, actor, subject, &receipt, e);

    store_receipt_free(&receipt);
    return st;
}

int64_t tempdb_in(int64_t s)
{
    int64_t now;

    assert_true(utc_now(&now));
    return s == 0 ? STORE_NEVER : now + s * 1000;
}

void tempdb_expire(struct store *s, const char *subject)
{
    char end[UTC_TEXT];
    struct errinfo e;
    int64_t ms;

    assert_true(utc_now(&ms));
    utc_print(ms + 50, end);
    must(store_subject_set(s, "test", subject,
                           &(struct store_subject_change){.expires = end}, &e));
    while (utc_now(&ms) && store_rules_past(end, ms) == 0)
        (void)nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
}

struct store_calibration tempdb_calibration(double threshold)
{
    return (struct store_calibration){
        .fmr = 0.001,
        .low = threshold - 1,
        .high = threshold + 1,
        .subjects = 80,
        .impostors = 6320,
        .genuine = 7,
        .table = {.threshold = threshold,
                  .n = 3,
                  .knot = {{-900, 1}, {-800, 0.25}, {threshold, 0.001}}},
        .det = {.people = 40,
                .n = 2,
                .own = {threshold, 0.001, 0.125, 0.0625, 0.25},
                .shipped = {8, 0, 0.25, 0, 0.5},
                .point = {{-850, 0.5, 0, 0, 0.125}, {-800, 0.2, 0.0625, 0, 0.125}}},
    };
}

enum status tempdb_record(struct store *s, const char *subject, enum store_record_as as,
                          struct errinfo *e)
{
    static const struct store_scan scan = {.noise_mm = 0.25, .quality = 0.9};
    struct store_subject one;
    struct store_recorded out;
    const enum status st = store_subject_get(s, "", subject, &one, e);

    if (st != ST_OK)
        return st;
    return store_record_verification(s,
                                     &(struct store_record){.subject = &one,
                                                            .as = as,
                                                            .actor = "test",
                                                            .kind = "verify",
                                                            .template_id = "",
                                                            .outcome = "settled",
                                                            .decision = "no_match",
                                                            .score = -3,
                                                            .scan = &scan},
                                     &out, e);
}

struct store_attempts tempdb_attempts(struct store *s, const char *token,
                                      const char *subject)
{
    const struct store_snapshot_of what = {.subject = subject, .token = token};
    struct store_snapshot a;
    struct store_attempts is;
    struct errinfo e = {0};

    must(store_snapshot_end(&a, store_snapshot_begin(s, &what, &a, &e), &e));
    is = a.attempts;
    store_snapshot_free(&a);
    return is;
}
