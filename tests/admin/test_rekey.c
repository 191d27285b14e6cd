/* Every secret made anew: all that a store tells stays, the logs go on, and nothing of the old keys
 * is left or good for anything.  That what is not as it was written is not rekeyed is in
 * tests/box/store-attacks.sh. */
#include <fcntl.h>
#include <unistd.h>

#include "admin_copy.h"
#include "admin_rekey.h"
#include "crypt_file.h"
#include "filled.h"
#include "rows_subject.h"
#include "store_txn.h"
#include "tempdb.h"
#include "tempdb_check.h"
#include "unit.h"

static struct errinfo e;
static bool completed; /* by admin_rekey() */
static char key_path[80];
static const struct store_key usual = {.path = key_path, .make = CRYPT_FILE};

static bool is_there(const char *suffix)
{
    char name[80];

    (void)snprintf(name, sizeof name, "%s%s", tempdb_path, suffix);
    return access(name, F_OK) == 0;
}

/* What the keys make of the same: a MAC, a lookup, the public key; the subjects' own keys. */
struct keys {
    unsigned char made[3][CRYPT_KEY], own[3][CRYPT_KEY], wrapped[3][CRYPT_WRAPPED];
};

static struct keys keys_of(struct store *s)
{
    static const char *const id[] = {"alice", "bob", "carol"};
    struct rows_subject of;
    struct log_txn t;
    struct keys k;

    crypt_mac(s->crypt, "x", 1, k.made[0]);
    crypt_lookup(s->crypt, "x", "x", 1, k.made[1]);
    crypt_public(s->crypt, k.made[2]);
    must(store_begin(s, SQL_READ, &t, &e));
    for (size_t i = 0; i < 3; i++) {
        must(rows_subject_find(&t, id[i], &of, &e));
        memcpy(k.own[i], of.key, CRYPT_KEY);
        memcpy(k.wrapped[i], of.wrapped, CRYPT_WRAPPED);
    }
    must(store_end(s, &t, ST_OK, &e));
    return k;
}

/* Of the old database and the new one, which columns have a value in common? */
static void assert_nothing_common(void)
{
    static const struct {
        const char *table, *column;
    } of[] = {
        {"root", "salt"},       {"root", "public"},     {"root", "secrets"},
        {"subjects", "key"},    {"subjects", "lookup"}, {"subjects", "about"},
        {"subjects", "mac"},    {"templates", "used"},  {"templates", "read"},
        {"templates", "about"}, {"templates", "mac"},   {"faces", "face"},
        {"tokens", "mac"},      {"devices", "mac"},     {"calibrations", "mac"},
        {"change_log", "mac"},  {"access_log", "mac"},
    };

    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        char text[300];

        (void)snprintf(text, sizeof text,
                       "ATTACH '%s.before-rekey' AS old; CREATE TABLE main.m AS SELECT "
                       "count(*) AS n FROM main.%s a JOIN old.%s b USING (%s)",
                       tempdb_path, of[i].table, of[i].table, of[i].column);
        tempdb_sql(text);
        if (tempdb_number("SELECT n FROM m") != 0)
            fail_msg("%s.%s has not changed", of[i].table, of[i].column);
        tempdb_sql("DROP TABLE main.m");
    }
}

/* A row that the thief of the old key wrote is good for nothing in the new database. */
static void assert_old_rows_refused(void)
{
    static const char *const table[] = {"tokens", "templates", "subjects", "root"};

    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        struct store *s = NULL;
        char text[300];

        (void)snprintf(text, sizeof text,
                       "PRAGMA foreign_keys = OFF; ATTACH '%s.before-rekey' AS old;"
                       "CREATE TABLE IF NOT EXISTS aside.%s AS SELECT * FROM main.%s;"
                       "DELETE FROM main.%s; INSERT INTO main.%s SELECT * FROM old.%s",
                       tempdb_path, table[i], table[i], table[i], table[i], table[i]);
        tempdb_sql(text);
        if (store_open(tempdb_path, STORE_READ, NULL, &s, &e) == ST_OK)
            fails(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
        else
            assert_int_equal(e.code, ST_EDENIED);
        store_close(s);
        (void)snprintf(text, sizeof text,
                       "PRAGMA foreign_keys = OFF; DELETE FROM main.%s;"
                       "INSERT INTO main.%s SELECT * FROM aside.%s",
                       table[i], table[i], table[i]);
        tempdb_sql(text);
    }
}

TEST(test_same)
{
    static char before[FILLED_TEXT], after[FILLED_TEXT], hashes[FILLED_TEXT],
        more[FILLED_TEXT];
    struct filled f;
    struct store *s = filled_fresh(&f);
    char key_old[80], last[80];
    struct store_key old = usual;
    struct keys was, is;
    struct store_token t;
    struct log_end end;

    filled_look(s, before);
    filled_hashes(hashes);
    was = keys_of(s);
    must(store_last_change(s, &end, &e));
    store_close(s);
    must(admin_rekey(tempdb_path, &usual,
                     &(struct admin_rekey){.kind = CRYPT_FILE, .keep = true}, "me",
                     &completed, &e));

    s = tempdb_open(STORE_WRITE);
    filled_look(s, after);
    assert_string_equal(after, before);
    filled_hashes(more); /* one change more */
    assert_int_equal(
        strncmp(more, hashes, strlen(hashes) - strlen(strstr(hashes, "acc"))), 0);
    assert_non_null(strstr(more, strstr(hashes, "acc")));
    (void)snprintf(last, sizeof last, "change %d ", (int)end.seq + 1);
    assert_non_null(strstr(more, last));
    assert_int_equal(tempdb_count("change_log WHERE kind = 'rekey' "
                                  "AND actor = 'me' AND outcome = 'file'"),
                     1);
    must(store_token_check(s, f.door, &t, &e));
    must(store_verify(s, NULL, NULL, &e));
    assert_int_equal(tempdb_check(s).problems, 0);

    is = keys_of(s);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            assert_memory_not_equal(was.made[i], is.made[k], CRYPT_KEY);
            assert_memory_not_equal(was.own[i], is.own[k], CRYPT_KEY);
            assert_memory_not_equal(was.wrapped[i], is.wrapped[k], CRYPT_WRAPPED);
        }
    store_close(s);
    assert_nothing_common();
    assert_old_rows_refused();
    (void)snprintf(key_old, sizeof key_old, "%s.key.old", tempdb_path);
    old.path = key_old;
    fails(store_open(tempdb_path, STORE_READ, &old, &s, &e), ST_EDENIED);
    assert_false(is_there(".key.new"));
}

/* The old database and its key are gone, unless they are kept. */
TEST(test_files)
{
    struct filled f;

    store_close(filled_fresh(&f));
    must(admin_rekey(tempdb_path, &usual, &(struct admin_rekey){.kind = CRYPT_FILE}, "me",
                     &completed, &e));
    assert_false(completed || is_there(".before-rekey") || is_there(".discard") ||
                 is_there(".key.old") || is_there(".key.new"));
    must(admin_rekey(tempdb_path, &usual,
                     &(struct admin_rekey){.kind = CRYPT_FILE, .keep = true}, "me",
                     &completed, &e));
    assert_true(is_there(".before-rekey") && is_there(".key.old"));
    fails(admin_rekey(tempdb_path, &usual, &(struct admin_rekey){.kind = CRYPT_FILE},
                      "me", &completed, &e),
          ST_EEXISTS);
    must(admin_rekey(tempdb_path, &usual,
                     &(struct admin_rekey){.kind = CRYPT_FILE, .keep = true}, "me",
                     &completed, &e)); /* asked for again, as if it had been killed */
    assert_true(completed && is_there(".before-rekey") && is_there(".key.old"));
}

/* What is copied is what was written, also where somebody changes it after it was verified. */
TEST(test_copied)
{
    static const struct {
        const char *sql;
        enum status st;
    } cases[] = {
        {"DELETE FROM devices WHERE device_key = 1", ST_EREFUSED},
        {"DELETE FROM subjects WHERE subject_key = 3", ST_EREFUSED},
        {"DELETE FROM templates WHERE template_key = 1", ST_ECORRUPT},
        {"UPDATE tokens SET revoked = NULL, mac = zeroblob(32)", ST_ECORRUPT},
        {"UPDATE change_log SET actor = 'x' WHERE seq = 2", ST_ECORRUPT},
        {"UPDATE change_log SET actor = 'x' WHERE seq = 1", ST_ECORRUPT},
        {"UPDATE access_log SET outcome = 'x' WHERE seq = 1", ST_ECORRUPT},
        {"DELETE FROM access_log WHERE seq = 1", ST_ECORRUPT},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct filled f;
        struct store *s = filled_fresh(&f);
        struct newfile n = NEWFILE_NONE;
        struct crypt_root root;
        struct crypt *crypt;
        struct admin_copy c = {.root = &root,
                               .key = &usual,
                               .fill = admin_copy_all,
                               .actor = "me",
                               .kind = "rekey",
                               .outcome = "file"};

        must(crypt_make(CRYPT_PLAINTEXT, NULL, 0, &root, &crypt, &e));
        c.crypt = crypt;
        must(store_verify(s, NULL, NULL, &e));
        tempdb_sql(cases[i].sql);
        if (admin_copy(s, tempdb_path, &c, &n, &e) != cases[i].st)
            fail_msg("%s: %s", cases[i].sql, e.msg);
        newfile_close(&n);
        crypt_free(crypt);
        store_close(s);
    }
}

static void move(const char *from, const char *to)
{
    char a[80], b[80];

    (void)snprintf(a, sizeof a, "%s%s", tempdb_path, from);
    (void)snprintf(b, sizeof b, "%s%s", tempdb_path, to);
    assert_int_equal(rename(a, b), 0);
}

static void make_key(const char *suffix)
{
    char path[80];

    (void)snprintf(path, sizeof path, "%s%s", tempdb_path, suffix);
    must(crypt_file_make(path, &e));
}

static enum admin_left left_now(void)
{
    enum admin_left left;

    must(admin_rekey_left(tempdb_path, &usual, &left, &e));
    return left;
}

static void rekey_again(bool keep)
{
    must(admin_rekey(tempdb_path, &usual,
                     &(struct admin_rekey){.kind = CRYPT_FILE, .keep = keep}, "",
                     &completed, &e));
}

/* A rekey that was killed has left a key: what it is of is tried, and decides. */
TEST(test_left)
{
    struct filled f;
    enum admin_left left;

    store_close(filled_fresh(&f));
    assert_int_equal(left_now(), ADMIN_LEFT_NOTHING);
    make_key(".key.new"); /* before the swap */
    assert_int_equal(left_now(), ADMIN_LEFT_USELESS);
    rekey_again(false);
    assert_false(completed || is_there(".key.new"));
    store_close(tempdb_open(STORE_READ));

    move(".key", ".key.new"); /* behind it */
    assert_int_equal(left_now(), ADMIN_LEFT_KEY);
    store_close(tempdb_open(STORE_READ));
    make_key(".key"); /* the old one, still in its place */
    assert_int_equal(left_now(), ADMIN_LEFT_KEY);
    store_close(tempdb_open(STORE_READ));
    rekey_again(false);
    assert_true(completed && is_there(".key") && is_there(".key.old"));
    assert_false(is_there(".key.new"));
    store_close(tempdb_open(STORE_READ));
    move(".key.old", ".elsewhere");

    make_key(".key.new"); /* it would be useless, could the database be read */
    move("", ".away");
    fails(admin_rekey_left(tempdb_path, &usual, &left, &e), ST_ENOTFOUND);
    fails(admin_rekey(tempdb_path, &usual, &(struct admin_rekey){.kind = CRYPT_FILE}, "",
                      &completed, &e),
          ST_ENOTFOUND);
    assert_true(is_there(".key") && is_there(".key.new"));
    move(".away", "");
    move(".key", ".moved"); /* or were the database's own key there */
    assert_int_equal(left_now(), ADMIN_LEFT_UNKNOWN);
    fails(admin_rekey(tempdb_path, &usual, &(struct admin_rekey){.kind = CRYPT_FILE}, "",
                      &completed, &e),
          ST_EEXISTS);
    assert_true(is_there(".key.new"));
    move(".moved", ".key");
    assert_int_equal(left_now(), ADMIN_LEFT_USELESS);

    /* One that was overwritten, and could not be removed then. */
    {
        char name[80];
        int fd;

        (void)snprintf(name, sizeof name, "%s.key.new", tempdb_path);
        assert_true((fd = open(name, O_WRONLY)) >= 0);
        assert_int_equal(pwrite(fd, "\0\0\0", 3, 0), 3);
        assert_int_equal(close(fd), 0);
    }
    assert_int_equal(left_now(), ADMIN_LEFT_USELESS);
    rekey_again(false);
    assert_false(completed || is_there(".key.new"));

    /* The key of a database beside it is needed. */
    rekey_again(true);
    move(".key.old", ".key.new");
    assert_int_equal(left_now(), ADMIN_LEFT_UNKNOWN);
}

BEFORE_ALL(begin)
{
    (void)snprintf(key_path, sizeof key_path, "%s.key", tempdb_path);
}
