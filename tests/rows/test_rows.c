/* Rows as db/FORMAT.md has them.  What a file says that somebody else has written is a difference and
 * gets no MAC: a change is of one row or of none.  More attacks: tests/box/attack_store.py. */
#include <sodium.h>

#include "forge.h"
#include "rows_digest.h"
#include "store.h"
#include "store_txn.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;
static char secret[65];

static void device(struct store *s, const char *name)
{
    unsigned char public[32], key[crypto_sign_SECRETKEYBYTES];
    struct store_device d;

    (void)crypto_sign_keypair(public, key);
    must(store_device_add(s, "test", name, public, &d, &e));
}

static struct store_token token(struct store *s, const char *name)
{
    struct store_token t;

    must(store_token_create(s, "test", name, STORE_SCOPE_VERIFY, "", 0, secret, &t, &e));
    return t;
}

static void calibrate(struct store *s)
{
    struct store_calibration k = tempdb_calibration(2.5);

    must(store_calibration_add(s, "test", &k, &e));
}

#define MACS                                                                             \
    "SELECT mac FROM subjects UNION ALL SELECT mac FROM templates UNION ALL SELECT mac " \
    "FROM tokens UNION ALL SELECT mac FROM devices UNION ALL SELECT mac FROM calibrations"

/* The MACs as db/FORMAT.md has them. */
TEST(test_format)
{
    static const bool yes = true;
    struct store *s = tempdb_fresh();
    struct store_token token, got;
    struct store_template t;

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    must(store_subject_set(
        s, "test", "alice",
        &(struct store_subject_change){.expires = "2040-01-01", .hold = &yes}, &e));
    must(store_token_create(s, "test", "t", STORE_SCOPE_ALL, "", tempdb_in(60), secret,
                            &token, &e));
    must(store_token_rotate(s, "test", token.id, 60, tempdb_in(60), secret, &got, &e));
    device(s, "door");
    calibrate(s);
    store_close(s);
    tempdb_sql("CREATE TABLE aside.was AS " MACS);
    must(forge_sql(tempdb_path, &tempdb_key, "", &e));
    tempdb_sql("CREATE TABLE same AS SELECT count(*) AS n FROM was JOIN (" MACS
               ") AS now USING (mac)");
    assert_int_equal(tempdb_number("SELECT n FROM same"), 5);
}

/* ---- what somebody else has written */

/* The rows are refused, and for good: in every process that would write. */
static void assert_found(struct store *s)
{
    struct store *late = tempdb_open(STORE_WRITE);
    struct store_subject one = {.id = "eve"};

    fails(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    fails(store_subject_add(late, "test", &one, &e), ST_EREFUSED);
    store_close(late);
    store_close(s);
}

static void mislead(const char *index, const char *rows)
{
    char name[64];

    (void)snprintf(name, sizeof name, "sqlite_autoindex_%s", index);
    tempdb_mislead(name, rows);
}

/* Her templates are hidden: the next sample is not her first one. */
TEST(test_first_sample)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    bool created;

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    tempdb_sql("DELETE FROM faces; DELETE FROM templates");
    fails(tempdb_store(s, "test", "alice", "", &tempdb_face[1], &t, &created, &e),
          ST_ECORRUPT);
    assert_found(s);
}

static void count(void *arg, const char *line)
{
    char *text = arg;

    (void)snprintf(text + strlen(text), 400 - strlen(text), "%s\n", line);
}

/* Each row that is not authentic is named, and can be removed. */
TEST(test_named)
{
    struct store *s = tempdb_fresh();
    struct store_template of;
    unsigned char sum[LOG_DIGEST];
    char text[400] = "";
    struct log_txn t;
    uint64_t n;
    bool same;

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &of);
    (void)token(s, "door");
    device(s, "door-1");
    calibrate(s);
    tempdb_sql("UPDATE subjects SET hold = 1; UPDATE templates SET points = points + 1;"
               "UPDATE tokens SET id = 'ab\n'; UPDATE devices SET name = 'x';"
               "UPDATE calibrations SET mac = zeroblob(1) WHERE calibration_key = 1");
    must(store_begin(s, SQL_WRITE, &t, &e));
    must(rows_digest(&t, false, count, text, sum, &n, &e));
    assert_int_equal(n, 5);
    assert_non_null(strstr(text, "subjects: the row 1 is not authentic\n"));
    assert_non_null(strstr(text, "tokens: the row ab? is not authentic\n"));
    assert_non_null(strstr(text, "devices: the row x is not authentic\n"));
    assert_non_null(strstr(text, "calibrations: the row 1 is not authentic\n"));
    must(rows_digest(&t, true, NULL, NULL, sum, &n, &e));
    assert_int_equal(n, 4); /* with the subject went its template */
    must(rows_digest(&t, false, NULL, NULL, sum, &n, &e));
    assert_int_equal(n, 0);
    must(log_txn_agrees(&t, sum, &same, &e));
    assert_false(same);
    fails(store_end(s, &t, ST_EHELD, &e), ST_EHELD);
    store_close(s);
    assert_int_equal(tempdb_count("subjects"), 1);
}

/* ---- a change is of one row or of none, and of what was to be written */

/* It is refused, and nothing of it is in the file. */
#define ASSERT_NOTHING(call)                                                             \
    do {                                                                                 \
        const int64_t before = tempdb_count("change_log");                               \
        assert_int_equal(call, ST_ECORRUPT);                                             \
        assert_int_equal(tempdb_count("change_log"), before);                            \
    } while (0)

#define DOUBLE(table, key)                                                               \
    "CREATE TABLE twice AS SELECT * FROM " table "; UPDATE twice SET " key " = " key     \
    " + 1; INSERT INTO twice SELECT * FROM " table "; DROP TABLE " table ";"             \
    "ALTER TABLE twice RENAME TO " table

/* A row that is there twice is not half changed: neither an update nor a removal is taken for done. */
TEST(test_doubled)
{
    struct store *s = tempdb_fresh();
    struct store_token t = token(s, "gate"), got, *list;
    char other[65];
    size_t n;

    device(s, "door-1");
    tempdb_sql(DOUBLE("tokens", "token_key") ";" DOUBLE("devices", "device_key"));
    ASSERT_NOTHING(store_token_revoke(s, "test", t.id, &e));
    assert_non_null(strstr(e.msg, "a change of one row changed 2"));
    ASSERT_NOTHING(store_token_rotate(s, "test", t.id, 0, 0, other, &got, &e));
    ASSERT_NOTHING(store_device_remove(s, "test", "door-1", &e));
    must(store_token_list(s, "", &list, &n, &e));
    assert_true(n == 2 && list[0].revoked[0] == '\0' && list[1].revoked[0] == '\0');
    free(list);
    must(store_token_check(s, secret, &got, &e));
    assert_found(s);
}

/* An index leads to another row, which would get the rights or the end; or the row is read by
 * another index than it is written by. */
TEST(test_misled)
{
    static const bool yes = true;
    const struct store_subject_change disable = {.disabled = &yes};
    struct store *s = tempdb_fresh();
    const struct store_token first = token(s, "first"), second = token(s, "second");
    struct store_subject one;
    struct store_token got;
    char other[65];

    if (tempdb_server)
        skip(); /* a server's indexes are its own */
    tempdb_add(s, "alice");
    tempdb_add(s, "bob");
    device(s, "door-1");
    device(s, "door-2");
    mislead("tokens_1", "SELECT 3 - token_key, id FROM tokens");
    ASSERT_NOTHING(store_token_revoke(s, "test", first.id, &e));
    ASSERT_NOTHING(store_token_rotate(s, "test", second.id, 0, 0, other, &got, &e));
    tempdb_sql("DROP TABLE twin; DROP TABLE more");
    mislead("subjects_2", "SELECT 3 - subject_key, lookup FROM subjects");
    ASSERT_NOTHING(store_subject_get(s, "", "alice", &one, &e));
    ASSERT_NOTHING(store_subject_rename(s, "test", "alice", "carol", &e));
    ASSERT_NOTHING(tempdb_erase(s, "test", "bob", &e));
    tempdb_sql("DROP TABLE twin; DROP TABLE more");
    mislead("devices_2", "SELECT 3 - device_key, name FROM devices");
    ASSERT_NOTHING(store_device_remove(s, "test", "door-1", &e));
    assert_found(s);
    s = tempdb_fresh();
    tempdb_add(s, "alice");
    tempdb_add(s, "bob");
    mislead("subjects_1", "SELECT 3 - subject_key, uid FROM subjects");
    ASSERT_NOTHING(store_subject_set(s, "test", "alice", &disable, &e));
    assert_non_null(strstr(e.msg, "a change of one row changed 0"));
    store_close(s);
}
