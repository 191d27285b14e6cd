/* A backup in the place of the database: of what was there only a log that verifies and goes on from
 * the backup's is believed, and only erasures, revocations and removals.  And a state that is
 * accepted as it is. */
#include <unistd.h>

#include "admin_restore.h"
#include "crypt_file.h"
#include "filled.h"
#include "store.h"
#include "store_txn.h"
#include "tempdb.h"
#include "tempdb_check.h"
#include "unit.h"

static struct errinfo e;
static char backup[80], aside[80], key_path[80];
static const struct store_key usual = {.path = key_path, .make = CRYPT_FILE};
static struct filled have;

static void make_backup(struct store *s)
{
    struct admin_copied c;

    must(admin_backup(s, backup, &usual, &c, &e));
    assert_int_equal(c.subjects, 3);
    assert_int_equal(c.templates, 3);
}

static void add(struct store *s, const char *id)
{
    struct store_subject one = {.identify = true};

    (void)snprintf(one.id, sizeof one.id, "%s", id);
    must(store_subject_add(s, "test", &one, &e));
}

/* After the backup: bob is erased, dave comes, a token is revoked and another rotated, a device goes
 * and another comes. */
static struct store *gone_on(void)
{
    struct store *s = filled_fresh(&have);
    struct store_token t;
    char secret[65];

    make_backup(s);
    must(tempdb_erase(s, "test", "bob", &e));
    add(s, "dave");
    must(store_token_revoke(s, "test", have.gate_id, &e));
    must(store_token_rotate(s, "test", have.door_id, 0, 0, secret, &t, &e));
    must(store_device_remove(s, "test", "door-1", &e));
    return s;
}

static enum status restore(bool dry, struct admin_restored *out)
{
    return admin_restore(tempdb_path, backup, &usual, NULL, "me", dry, out, &e);
}

static void assert_restored(void)
{
    struct store *s = tempdb_open(STORE_WRITE);
    struct store_subject one;
    struct store_device *d;
    struct store_token t;
    size_t n;

    must(store_subject_get(s, "", "alice", &one, &e));
    fails(store_subject_get(s, "", "bob", &one, &e), ST_ENOTFOUND);
    fails(store_subject_get(s, "", "dave", &one, &e), ST_ENOTFOUND);
    fails(store_token_check(s, have.gate, &t, &e), ST_EDENIED);
    fails(store_token_check(s, have.door, &t, &e), ST_EDENIED);
    must(store_device_list(s, &d, &n, &e));
    assert_int_equal(n, 1);
    assert_string_equal(d[0].name, "door-2");
    free(d);
    must(store_verify(s, NULL, NULL, &e));
    assert_int_equal(tempdb_check(s).problems, 0);
    add(s, "eve");
    store_close(s);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'restore' AND actor = "
                                  "'me'"),
                     1);
}

TEST(test_restore)
{
    struct store *s = gone_on();
    struct admin_restored r;
    struct log_end end;
    struct store *b;
    bool has;

    store_close(s);
    must(restore(true, &r));
    assert_true(access(aside, F_OK) != 0);
    s = tempdb_open(STORE_READ); /* as it was */
    must(store_subject_get(s, "", "dave", &(struct store_subject){.hold = false}, &e));
    store_close(s);
    must(restore(false, &r));
    assert_true(r.was_there && r.backup.subjects == 3);
    assert_int_equal(r.had_subjects, 3);
    assert_int_equal(r.lost, 1);
    assert_int_equal(r.erased, 1);
    assert_int_equal(r.revoked, 3);
    assert_restored();
    /* Its log goes on from the backup's. */
    must(store_open(backup, STORE_READ, &(struct store_key){.path = key_path}, &b, &e));
    must(store_last_change(b, &end, &e));
    store_close(b);
    s = tempdb_open(STORE_READ);
    must(store_audit_has(s, &end, &has, &e));
    assert_true(has);
    store_close(s);
    assert_int_equal(access(aside, F_OK), 0);
    assert_int_equal(restore(false, &r), ST_EEXISTS); /* what was there is not lost */
}

/* Rows of the database that is there are not asked: with its log as it was, they change nothing. */
TEST(test_poisoned_rows)
{
    static const char *const damage[] = {
        "UPDATE tokens SET revoked = NULL",
        ("INSERT INTO tokens SELECT 9, '0123456789abcdef0123456789abcdef', 1, 'mine', "
         "zeroblob(32), created, NULL, scopes, groups, NULL, NULL, NULL, mac, NULL FROM tokens LIMIT 1"),
        "DELETE FROM subjects WHERE subject_key = 1; DELETE FROM tokens; DELETE FROM devices",
        "DELETE FROM templates",
    };

    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        struct admin_restored r;

        store_close(gone_on());
        tempdb_sql(damage[i]);
        must(restore(false, &r));
        assert_int_equal(r.erased, 1);
        assert_int_equal(r.revoked, 3);
        assert_restored();
    }
}

/* A log that is not as it was written proves nothing: no erasure comes from it. */
TEST(test_poisoned_log)
{
    static const char *const damage[] = {
        ("INSERT INTO change_log SELECT seq + 1, at, 'delete_subject', actor, (SELECT uid FROM "
         "subjects LIMIT 1), object, outcome, digest, daemon, access_seq, access_hash, hash, mac, NULL "
         "FROM change_log ORDER BY seq DESC LIMIT 1"),
        ("UPDATE change_log SET uid = (SELECT uid FROM subjects LIMIT 1) WHERE kind = "
         "'delete_subject'"),
        "DELETE FROM change_log WHERE kind = 'delete_subject'",
        "UPDATE change_log SET kind = 'x' WHERE kind = 'revoke_token'",
        "UPDATE change_log SET actor = 'x' WHERE seq = 2",
        "DELETE FROM access_log WHERE seq = 1",
        "DELETE FROM change_log",
        "UPDATE root SET secrets = zeroblob(136)",
    };

    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        struct admin_restored r;
        enum status st;

        store_close(gone_on());
        tempdb_sql(damage[i]);
        st = restore(false, &r);
        if (st == ST_OK || strstr(e.msg, "move it away first") == NULL)
            fail_msg("%s: %d %s", damage[i], st, e.msg);
        assert_true(access(aside, F_OK) != 0);
        assert_int_equal(tempdb_count("subjects"), 3);
    }
}

/* A backup that is not as it was written, or is of another database. */
TEST(test_bad_backup)
{
    static const char *const damage[] = {
        "UPDATE b.tokens SET revoked = NULL",
        "DELETE FROM b.devices",
        "UPDATE b.change_log SET outcome = 'x' WHERE seq = 2",
        "UPDATE b.faces SET face = zeroblob(100) WHERE template_key = 1",
    };
    struct admin_restored r;
    struct store *s;
    char sql[300];

    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        store_close(gone_on());
        (void)snprintf(sql, sizeof sql, "ATTACH '%s' AS b; %s", backup, damage[i]);
        tempdb_sql(sql);
        assert_int_equal(restore(false, &r), ST_ECORRUPT);
        assert_true(access(aside, F_OK) != 0);
    }
    store_close(gone_on());
    fails(admin_restore(tempdb_path, tempdb_path, &usual, NULL, "", false, &r, &e),
          ST_EINVAL);
    /* Two that have gone on from one. */
    s = gone_on();
    store_close(s);
    must(restore(false, &r));
    assert_int_equal(rename(aside, backup), 0);
    assert_int_equal(restore(false, &r), ST_EMISMATCH);
}

/* A WAL or a journal that somebody has left beside what is to get this name, of an older state:
 * SQLite would change the new file by it.  s: of which that is a backup; NULL: restored. */
static void leave(const char *path, struct store *s)
{
    static const char *const suffix[] = {"-wal", "-journal"};
    struct admin_restored r;
    struct admin_copied c;
    char name[100];

    for (size_t i = 0; i < sizeof suffix / sizeof *suffix; i++) {
        FILE *f;

        (void)snprintf(name, sizeof name, "%s%s", path, suffix[i]);
        assert_non_null(f = fopen(name, "w"));
        assert_true(fputs("older", f) >= 0 && fclose(f) == 0);
        fails(s == NULL ? restore(false, &r) : admin_backup(s, path, &usual, &c, &e),
              ST_EEXISTS);
        assert_non_null(strstr(e.msg, name));
        assert_true(access(path, F_OK) != 0);
        assert_int_equal(unlink(name), 0);
    }
}

/* Nothing is there: by the key's file alone; and a backup that is newer than what is there. */
TEST(test_missing)
{
    struct store *s = filled_fresh(&have);
    static char before[FILLED_TEXT], after[FILLED_TEXT];
    struct admin_restored r;
    char old[80];

    filled_look(s, before);
    make_backup(s);
    store_close(s);
    assert_int_equal(unlink(tempdb_path), 0);
    leave(tempdb_path, NULL);
    must(restore(false, &r));
    assert_false(r.was_there);
    s = tempdb_open(STORE_WRITE);
    filled_look(s, after);
    assert_string_equal(after, before);
    (void)snprintf(old, sizeof old, "%s-old", tempdb_path);
    assert_int_equal(rename(backup, old), 0);
    add(s, "dave");
    leave(backup, s);
    must(admin_backup(s, backup, &usual, &(struct admin_copied){0}, &e));
    store_close(s);
    assert_int_equal(rename(old, tempdb_path), 0);
    must(restore(false, &r));
    s = tempdb_open(STORE_READ);
    must(store_subject_get(s, "", "dave", &(struct store_subject){.hold = false}, &e));
    store_close(s);
}

/* The database was rekeyed since: the backup has another key, and the result the database's. */
TEST(test_other_key)
{
    static char before[FILLED_TEXT], after[FILLED_TEXT];
    struct store *s = filled_fresh(&have);
    struct admin_restored r;
    struct crypt_file *k;
    char old[100];

    filled_look(s, before);
    make_backup(s);
    store_close(s);
    (void)snprintf(old, sizeof old, "%s.kept", key_path);
    assert_int_equal(rename(key_path, old), 0);
    must(crypt_file_make(key_path, &e));
    assert_int_equal(rename(tempdb_path, aside), 0);
    assert_int_equal(restore(false, &r), ST_EDENIED);
    assert_non_null(strstr(e.msg, "--backup-key"));
    must(admin_restore(tempdb_path, backup, &usual, old, "me", false, &r, &e));
    must(crypt_file_read(key_path, &k, &e));
    crypt_file_free(k);
    s = tempdb_open(STORE_WRITE); /* by the configured key */
    filled_look(s, after);
    assert_string_equal(after, before);
    assert_int_equal(tempdb_check(s).problems, 0);
    store_close(s);
    fails(store_open(tempdb_path, STORE_READ, &(struct store_key){.path = old}, &s, &e),
          ST_EDENIED);
}

/* ---- as it is */

static unsigned reported;

static void note(void *arg, const char *line)
{
    (void)arg;
    (void)line;
    reported++;
}

static enum status accept(bool dry, struct admin_accepted *out)
{
    reported = 0;
    return admin_accept(tempdb_path, &usual, "me", dry, note, NULL, out, &e);
}

TEST(test_accept)
{
    static const struct {
        const char *sql, *index, *rows;
        unsigned removed, subjects, templates, tokens, devices;
        bool differed;
    } cases[] = {
        {"", NULL, NULL, 0, 3, 3, 3, 2, false},
        {"UPDATE tokens SET scopes = 'read' WHERE name = 'gate'", NULL, NULL, 1, 3, 3, 2,
         2, true},
        {"UPDATE subjects SET hold = 1 - hold WHERE subject_key = 1", NULL, NULL, 1, 2, 1,
         3, 2, true}, /* with her templates */
        {"UPDATE templates SET engine = 'x' WHERE template_key = 2", NULL, NULL, 1, 3, 2,
         3, 2, true},
        {"UPDATE subjects SET about = zeroblob(100); UPDATE devices SET name = 'x' WHERE "
         "device_key = 1",
         NULL, NULL, 4, 0, 0, 3, 1, true},
        {"DELETE FROM devices", NULL, NULL, 0, 3, 3, 3, 0, true},
        {"", "sqlite_autoindex_tokens_2", "SELECT 9 - token_key, hash FROM tokens", 0, 3,
         3, 3, 2, false},
        {"PRAGMA foreign_keys = OFF; DELETE FROM subjects WHERE subject_key = 2", NULL,
         NULL, 1, 2, 2, 3, 2, true},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct admin_accepted a;
        struct store *s = filled_fresh(&have);

        store_close(s);
        if (cases[i].sql[0] != '\0')
            tempdb_sql(cases[i].sql);
        if (cases[i].index != NULL)
            tempdb_mislead(cases[i].index, cases[i].rows);
        for (int dry = 1; dry >= 0; dry--) {
            must(accept(dry != 0, &a));
            if (a.removed != cases[i].removed || a.differed != cases[i].differed)
                fail_msg("case %zu: %u removed", i, (unsigned)a.removed);
            assert_int_equal(reported, a.removed + a.differed);
        }
        assert_int_equal(tempdb_count("subjects"), cases[i].subjects);
        assert_int_equal(tempdb_count("templates"), cases[i].templates);
        assert_int_equal(tempdb_count("tokens"), cases[i].tokens);
        assert_int_equal(tempdb_count("devices"), cases[i].devices);
        assert_int_equal(tempdb_count("change_log WHERE kind = 'accept_state'"), 1);
        s = tempdb_open(STORE_WRITE);
        must(store_verify(s, NULL, NULL, &e));
        add(s, "eve");
        assert_int_equal(tempdb_check(s).problems, 0);
        store_close(s);
    }
}

/* Two rows of one id; a log without an end.  An older state: tests/box/anchor.sh. */
TEST(test_not_accepted)
{
    struct admin_accepted a;

    store_close(filled_fresh(&have));
    tempdb_sql(
        "CREATE TABLE twin AS SELECT * FROM tokens; DROP TABLE tokens;"
        "ALTER TABLE twin RENAME TO tokens; INSERT INTO tokens SELECT * FROM tokens");
    assert_int_equal(accept(false, &a), ST_ECORRUPT);
    tempdb_sql("UPDATE change_log SET mac = zeroblob(32)");
    assert_int_equal(accept(false, &a), ST_ECORRUPT);
}

BEFORE_ALL(begin)
{
    (void)snprintf(backup, sizeof backup, "%s-backup", tempdb_path);
    (void)snprintf(aside, sizeof aside, "%s.before-restore", tempdb_path);
    (void)snprintf(key_path, sizeof key_path, "%s.key", tempdb_path);
}
