/* link: -Wl,--wrap=sql_run,--wrap=sql_run_one,--wrap=sql_done,--wrap=sql_ahead */
/* Nothing is written on top of what was not verified: the first write of an open store verifies the
 * rows, and one that differs refuses it, whatever write it is; the file stays as it is.  And what
 * fails halfway has not happened. */
#include <sodium.h>

#include "fail_sql.h"
#include "sql.h"
#include "store.h"
#include "store_txn.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;
static char secret[65];
static struct store_token token;
static struct store_template tmpl;

static struct store *written(void)
{
    struct store *s = tempdb_fresh();

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &tmpl);
    must(store_token_create(s, "test", "t", STORE_SCOPE_ALL, "", 0, secret, &token, &e));
    return s;
}

/* ---- every sort of write */

static enum status write_subject(struct store *s, int sort)
{
    const struct store_subject_change change = {.purpose = "x"};

    switch (sort) {
    case 0:
        return store_subject_add(
            s, "test", &(struct store_subject){.id = "bob", .identify = true}, &e);
    case 1:
        return store_subject_rename(s, "test", "alice", "bob", &e);
    case 2:
        return store_subject_set(s, "test", "alice", &change, &e);
    case 3:
        return tempdb_erase(s, "test", "alice", &e);
    case 4:
        return store_subject_purge(s, "test", "alice", &e);
    case 5:
        return store_attempts_reset(s, "test", "alice", &e);
    case 6:
        return tempdb_record(s, "alice", STORE_RECORD_PASSED, &e);
    default:
        return tempdb_record(s, "alice", STORE_RECORD_FAILED, &e);
    }
}

static enum status write_template(struct store *s, int sort)
{
    struct store_template t;
    bool created;

    switch (sort) {
    case 0:
        return tempdb_store(s, "test", "bob", "", &tempdb_face[1], &t, &created, &e);
    case 1:
        return tempdb_store(s, "test", "alice", "", &tempdb_face[0], &t, &created, &e);
    case 2:
        return store_template_delete(s, "test", tmpl.id, &e);
    default:
        return store_reencode(s, "test", tmpl.id, tempdb_work, &created, &e);
    }
}

static enum status write_log(struct store *s, int sort)
{
    struct log_entry entry;
    uint64_t cut;

    switch (sort) {
    case 0:
        return store_event(s, "verify", "test", "", "", "match", &e);
    case 1:
        return store_audit_sign(s, "test", LOG_CHECKPOINT, &entry, NULL, &e);
    default:
        return store_audit_trim(s, "test", 1, false, &cut, &e);
    }
}

static enum status write_other(struct store *s, int sort)
{
    struct store_calibration k = tempdb_calibration(1);
    unsigned char public[32], key[crypto_sign_SECRETKEYBYTES];
    struct store_device d;
    struct store_token t;
    char text[65];

    switch (sort) {
    case 0:
        return store_token_create(s, "test", "t", STORE_SCOPE_ALL, "", 0, text, &t, &e);
    case 1:
        return store_token_rotate(s, "test", token.id, 0, 0, text, &t, &e);
    case 2:
        return store_token_revoke(s, "test", token.id, &e);
    case 3:
        (void)crypto_sign_keypair(public, key);
        return store_device_add(s, "test", "door-1", public, &d, &e);
    case 4:
        return store_device_remove(s, "test", "door-1", &e);
    default:
        return store_calibration_add(s, "test", &k, &e);
    }
}

#define WRITES 21

static enum status write_it(struct store *s, size_t i)
{
    const int sort = (int)i;

    return sort < 8    ? write_subject(s, sort)
           : sort < 12 ? write_template(s, sort - 8)
           : sort < 15 ? write_log(s, sort - 12)
                       : write_other(s, sort - 15);
}

/* ---- the tests */

#define MACS                                                                             \
    "SELECT mac FROM subjects UNION ALL SELECT mac FROM templates UNION ALL SELECT mac " \
    "FROM tokens UNION ALL SELECT mac FROM devices UNION ALL SELECT mac FROM calibrations"

/* The sum of the rows' summands is what the last change says: digits base 256, by school arithmetic. */
static void assert_sum(struct store *s)
{
    unsigned char one[CRYPT_HASH], sum[LOG_DIGEST] = {0};
    struct sql_rows *r;
    struct log_txn t;
    bool same = false;

    must(store_begin(s, SQL_READ, &t, &e));
    must(sql_query(t.sql, MACS, NULL, 0, &r, &e));
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

static void add_text(void *out, const char *data, size_t n)
{
    (void)strncat(out, data, n);
}

/* The file, or on a server every row. */
static unsigned char *read_all(size_t *n)
{
    static const char *const table[] = {
        "subjects", "templates", "faces",        "attempts",   "tokens",
        "devices",  "nonces",    "calibrations", "change_log", "access_log"};
    unsigned char *bytes = calloc(4, 1 << 20);

    assert_non_null(bytes);
    if (tempdb_server) {
        struct rawdb *d = tempdb_raw();

        for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
            char text[100];

            (void)snprintf(text, sizeof text, "SELECT CAST(t AS text) FROM %s AS t",
                           table[i]);
            must(rawdb_each(d, text, add_text, bytes, &e));
        }
        rawdb_close(d);
        *n = strlen((char *)bytes);
    } else {
        FILE *f = fopen(tempdb_path, "rb");

        assert_non_null(f);
        *n = fread(bytes, 1, 4 << 20, f);
        (void)fclose(f);
    }
    assert_true(*n > 0);
    return bytes;
}

TEST(test_first_write)
{
    const size_t n = WRITES;
    struct store_template *list;
    struct store_token t;
    unsigned char *before, *after;
    size_t nbefore, nafter, templates;
    struct store *s = written(), *other;

    store_close(s);
    s = tempdb_open(STORE_WRITE);
    other = tempdb_open(STORE_WRITE);
    for (size_t i = 0; i < 4 * n;
         i++) { /* as written: all but what is not there succeeds */
        assert_int_not_equal(write_it(i % 2 != 0 ? s : other, i % n), ST_EREFUSED);
        assert_sum(i % 3 != 0 ? s : other);
    }
    store_close(other);
    store_close(s);

    store_close(written());
    tempdb_sql(
        "UPDATE tokens SET used = NULL; UPDATE subjects SET disabled = 1 - disabled");
    if (!tempdb_server)
        tempdb_sql("PRAGMA journal_mode = DELETE; PRAGMA journal_mode = WAL");
    before = read_all(&nbefore);
    for (size_t i = 0; i < n; i++) {
        s = tempdb_open(STORE_WRITE);
        must(store_token_check(s, secret, &t, &e)); /* reads go on, and note no use */
        assert_string_equal(t.used, "");
        fails(store_template_list(s, "", "alice", &list, &templates, &e),
              ST_ECORRUPT); /* her row is read, and is not authentic */
        if (write_it(s, i) != ST_EREFUSED && e.code != ST_ECORRUPT)
            fail_msg("write %zu: %s", i, e.msg);
        if (e.code == ST_EREFUSED) { /* it came to the write */
            assert_true(store_refused(s, &e));
            fails(store_token_check(s, secret, &t, &e), ST_EREFUSED);
            fails(store_ready(s, &e), ST_EREFUSED);
        }
        fails(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
        store_close(s);
        after = read_all(&nafter);
        assert_int_equal(nafter, nbefore);
        assert_memory_equal(after, before, nbefore);
        free(after);
    }
    free(before);
}

/* ---- a statement fails */

TEST(test_failed)
{
    unsigned failed = 0;

    for (size_t i = 0; i < WRITES; i++) {
        struct store *s = written(), *other = tempdb_open(STORE_READ);
        const int64_t changes = tempdb_count("change_log"),
                      accesses = tempdb_count("access_log");
        bool done = false;

        for (unsigned n = 1; !done; n++) {
            fail_sql_at(n, ST_EIO);
            (void)write_it(s, i);
            done = fail_sql_count() < n; /* it has no n-th */
            fail_sql_at(0, ST_OK);
            if (!done) {
                failed++;
                assert_int_equal(e.code, ST_EIO);
                assert_int_equal(tempdb_count("change_log"), changes);
                assert_int_equal(tempdb_count("access_log"), accesses);
            }
            must(store_verify(s, NULL, NULL, &e));
            must(store_verify(other, NULL, NULL, &e));
        }
        must(write_log(s, 0));
        store_close(other);
        store_close(s);
    }
    print_message("  %u failures\n", failed);
    assert_true(failed > 40);
}

/* ---- reading fails, once or for a while */

/* An error of the engine is that of one call: only a difference is taken for tampering.  Whatever
 * the error, the next call is served. */
TEST(test_not_read)
{
    static const enum status kind[] = {ST_EBUSY, ST_EIO,      ST_ENOMEM,
                                       ST_EDB,   ST_ECORRUPT, ST_ELIMIT};
    struct store *s = written();
    unsigned failed = 0;

    for (size_t k = 0; k < sizeof kind / sizeof *kind; k++) {
        bool done = false;

        for (unsigned n = 1; !done; n++) {
            struct store_token t;

            fail_sql_at(n, kind[k]);
            if (store_verify(s, NULL, NULL, &e) != ST_OK) {
                failed++;
                assert_int_equal(e.code, kind[k]);
            }
            done = fail_sql_count() < n; /* it has no n-th */
            fail_sql_at(0, ST_OK);
            assert_false(store_refused(s, &e));
            must(store_token_check(s, secret, &t, &e));
            must(store_ready(s, &e));
            must(write_other(s, 0));
        }
    }
    print_message("  %u failures\n", failed);
    assert_true(failed >= 6 * sizeof kind / sizeof *kind);

    /* Rows that cannot be read may hide a difference: what uses them waits until they were. */
    for (size_t k = 0; k < sizeof kind / sizeof *kind; k++) {
        const bool passes =
            kind[k] == ST_EBUSY || kind[k] == ST_EIO || kind[k] == ST_ENOMEM;
        const struct store_use use = {.appends = true};
        const unsigned table = tempdb_server ? 2 : 3; /* behind BEGIN and the log's end */
        struct log_txn t;

        must(store_verify(s, NULL, NULL, &e));
        fail_sql_at(table, kind[k]);
        fails(store_verify(s, NULL, NULL, &e), kind[k]);
        fail_sql_at(table, kind[k]);
        assert_int_equal(store_start(s, NULL, SQL_READ, &use, &t, &e),
                         passes ? ST_OK : kind[k]);
        if (passes)
            must(sql_end(t.sql, ST_OK, &e));
        fail_sql_at(table, kind[k]); /* a read too */
        assert_int_equal(store_ready(s, &e), passes ? ST_OK : kind[k]);
        fail_sql_at(0, ST_OK);
        must(store_start(s, NULL, SQL_READ, &use, &t, &e));
        must(sql_end(t.sql, ST_OK, &e));
    }
    store_close(s);
}

struct lines {
    unsigned n;
    char last[200];
};

static void note(void *arg, const char *line)
{
    struct lines *l = arg;

    l->n++;
    (void)snprintf(l->last, sizeof l->last, "%s", line);
}

/* It says what is wrong, and a store that only reads can verify too. */
TEST(test_verify)
{
    struct lines l = {0};
    struct store *s = written();
    char scopes[STORE_SCOPES_MAX], back[STORE_SCOPES_MAX + 40];

    must(store_verify(s, note, &l, &e));
    assert_int_equal(l.n, 0);
    store_close(s);
    s = tempdb_open(STORE_READ);
    must(store_verify(s, NULL, NULL, &e));
    tempdb_sql("UPDATE tokens SET scopes = 'read'");
    fails(store_verify(s, note, &l, &e), ST_EREFUSED);
    assert_int_equal(l.n, 2); /* the row, and so the sum */
    assert_non_null(strstr(l.last, "not those of the last change"));
    fails(store_verify(s, note, &l, &e), ST_EREFUSED);
    assert_int_equal(l.n, 2); /* it is not asked again */
    store_close(s);
    s = tempdb_open(STORE_WRITE);
    fails(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    assert_non_null(strstr(e.msg, token.id)); /* the first problem is told */
    rows_scopes_write(STORE_SCOPE_ALL, scopes);
    (void)snprintf(back, sizeof back, "UPDATE tokens SET scopes = '%s'", scopes);
    tempdb_sql(back);
    fails(store_verify(s, NULL, NULL, &e), ST_EREFUSED); /* for good */
    store_close(s);
    s = tempdb_open(STORE_WRITE);
    must(store_verify(s, NULL, NULL, &e));
    must(write_other(s, 0));
    store_close(s);
}

/* The schema leads to another tree, with a token that was not revoked, by which SQLite's own sign of a
 * change stays as it was: who has read it before does not see that.  All see the same afterwards. */
TEST(test_other_tree)
{
    struct store *s = written();
    struct store_token t;

    if (tempdb_server)
        skip();
    tempdb_sql("CREATE TABLE twin AS SELECT * FROM tokens");
    must(store_token_revoke(s, "test", token.id, &e));
    must(store_verify(s, NULL, NULL, &e));
    tempdb_sql("PRAGMA writable_schema = ON; UPDATE sqlite_schema SET rootpage = (SELECT "
               "rootpage FROM sqlite_schema WHERE name = 'twin') WHERE name = 'tokens'");
    fails(store_token_check(s, secret, &t, &e), ST_EDENIED); /* by what it knows */
    fails(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
    store_close(s);

    s = written();
    tempdb_sql("CREATE TABLE twin AS SELECT * FROM tokens");
    must(store_token_revoke(s, "test", token.id, &e));
    tempdb_sql(
        "CREATE TEMP TABLE page AS SELECT rootpage FROM sqlite_schema WHERE name = "
        "'tokens'; PRAGMA writable_schema = ON; UPDATE sqlite_schema SET rootpage = "
        "(SELECT rootpage FROM sqlite_schema WHERE name = 'twin') WHERE name = "
        "'tokens'; PRAGMA schema_version = 900; UPDATE sqlite_schema SET rootpage = "
        "(SELECT rootpage FROM page) WHERE name = 'tokens'");
    must(store_verify(s, NULL, NULL, &e)); /* as it is in the file */
    fails(store_token_check(s, secret, &t, &e), ST_EDENIED);
    store_close(s);
}
