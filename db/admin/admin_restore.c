#include "admin_restore.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "admin_copy.h"
#include "admin_rekey.h"
#include "crypt_file.h"
#include "log_anchor.h"
#include "log_row.h"
#include "rows_device.h"
#include "rows_digest.h"
#include "rows_root.h"
#include "rows_token.h"
#include "sql_file.h"
#include "sql_open.h"
#include "store.h"
#include "store_txn.h"

/* ---- a backup */

/* What is there may be replaced if it is a database of this program, and not this one; nor
 * one with a WAL, which SQLite would take for the backup's. */
static enum status replaceable(const char *path, const char *db, struct errinfo *e)
{
    struct sql *d = NULL;
    struct stat there;
    enum status st;

    if (sql_file_same(path, db))
        return errinfo_set(e, ST_EINVAL, "%.160s is the database itself", path);
    if ((st = sql_file_may_be(path, e)) != ST_OK || stat(path, &there) != 0)
        return st;
    st = S_ISREG(there.st_mode) ? sql_open(path, SQL_OPEN_READ, &d, NULL) : ST_EINVAL;
    sql_close(d);
    return st == ST_OK
               ? ST_OK
               : errinfo_set(e, ST_EEXISTS,
                             "%.160s exists and is not a backup: it is not overwritten",
                             path);
}

enum status admin_backup(struct store *s, const char *path, const struct store_key *key,
                         struct admin_copied *out, struct errinfo *e)
{
    struct newfile n = NEWFILE_NONE;
    struct store *copy;
    struct log_txn t;
    enum status st;

    if ((st =
             admin_in_file(s->path,
                           "pg_dump, pg_basebackup or pgBackRest backs it up; surfacectl "
                           "copy FILE makes a file of it",
                           e)) != ST_OK ||
        (st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = replaceable(path, s->path, e)) == ST_OK &&
        (st = newfile_open(path, &n, e)) == ST_OK)
        st = sql_file_copy(t.sql, n.part, e);
    st = store_end(s, &t, st, e);
    if (st == ST_OK && (st = admin_open(n.part, key, NULL, &copy, out, e)) == ST_OK) {
        store_close(copy);
        st = newfile_commit(&n, e);
    }
    newfile_close(&n);
    return st;
}

/* ---- a copy elsewhere */

enum status admin_move(struct store *s, const char *path, const struct store_key *key,
                       struct admin_copied *found, struct errinfo *e)
{
    struct admin_copy c = {.key = key, .fill = admin_copy_as_is};
    struct newfile n = NEWFILE_NONE;
    const bool file = !store_on_server(path);
    enum status st = ST_OK;

    if (file && !newfile_missing(path))
        st = errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", path);
    else if (file)
        st = sql_file_may_be(path, e);
    if (st == ST_OK && (st = admin_copy(s, path, &c, &n, e)) == ST_OK && file)
        st = newfile_keep(&n, e);
    newfile_close(&n);
    *found = c.found;
    return st;
}

/* ---- restoring */

struct restoring {
    const char *path, *from, *from_key;
    const struct store_key *key;
    struct store *held; /* the database that is there; NULL: there is none */
    struct store *backup;
    struct log_end end;      /* of the backup's change log */
    struct log_entry *since; /* [n], changes of the database that is there after that */
    size_t n;
    const char *actor;         /* of the changes that are made in the copy */
    struct crypt_root root;    /* of the restored database, */
    const struct crypt *crypt; /* its keys, */
    struct crypt *made;        /* and these, where neither store has them */
    struct admin_restored *out;
};

/* ---- the database that is there */

static void first_problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(
            first, ST_EREFUSED,
            "the log of the database that is there is not as it was written "
            "(%s, entry %" PRIu64 ": %s): move it away first; then those who "
            "were erased since the backup are back",
            log_word(log), seq, line);
}

/* Nothing of it is believed but a log that verifies. */
static enum status walk_held(struct restoring *r, struct errinfo *e)
{
    unsigned char public[CRYPT_KEY];
    struct errinfo first = {ST_OK, ""};
    struct log_walk w;
    struct log_txn t;
    enum status st;

    crypt_public(r->held->crypt, public);
    log_walk_begin(&w, r->held->crypt, public, first_problem, &first);
    if ((st = store_begin(r->held, SQL_READ, &t, e)) != ST_OK ||
        (st = store_end(r->held, &t, log_walk_all(t.sql, &w, e), e)) != ST_OK)
        return st;
    return first.code == ST_OK ? ST_OK : errinfo_set(e, first.code, "%s", first.msg);
}

static enum status open_held(struct restoring *r, bool dry, struct errinfo *e)
{
    struct store_key by = *r->key;
    struct errinfo why;
    enum status st;

    if (newfile_missing(r->path))
        return sql_file_may_be(r->path, e);
    by.anchor = NULL; /* it may be the older one that is to be replaced */
    st = store_open(r->path, dry ? STORE_READ : STORE_ALONE, &by, &r->held, &why);
    if (st == ST_EBUSY || st == ST_ENOMEM)
        return errinfo_set(e, st, "%s", why.msg);
    if (st != ST_OK)
        return errinfo_set(e, st,
                           "%.300s: move it away first; then those who were erased since "
                           "the backup are back",
                           why.msg);
    if (!dry && (st = store_settle_anchor(r->held, r->key->anchor, e)) != ST_OK)
        return st;
    return walk_held(r, e);
}

/* ---- the backup */

static enum status open_backup(struct restoring *r, struct errinfo *e)
{
    struct store_key by = *r->key;
    enum crypt_kind kind;
    enum status st;

    if (r->from_key != NULL) {
        by.path = r->from_key;
        by.given = NULL;
    }
    st = admin_open(r->from, &by, NULL, &r->backup, &r->out->backup, e);
    if (st == ST_EDENIED && r->from_key == NULL && !by.plaintext &&
        store_kind(r->from, &kind, NULL) == ST_OK && kind != CRYPT_PLAINTEXT)
        return errinfo_set(e, st,
                           "the backup %.150s was made under another key than the "
                           "database's: give that key by --backup-key FILE",
                           r->from);
    return st == ST_OK ? store_last_change(r->backup, &r->end, e) : st;
}

/* ---- what must not be undone by going back in time */

static enum status relate(struct restoring *r, struct errinfo *e)
{
    struct store_stats stats;
    struct log_end end, to = r->end;
    struct log_txn t;
    bool goes_on = false, older = false;
    enum status st;

    if (r->held == NULL)
        return ST_OK;
    r->out->was_there = true;
    if ((st = store_begin(r->held, SQL_READ, &t, e)) != ST_OK)
        return st;
    end = t.changes;
    if ((st = log_has(&t, &r->end, &goes_on, e)) == ST_OK && goes_on)
        st = log_list(t.sql, NULL, r->end.seq, &r->since, &r->n, e);
    for (size_t i = 0; i < r->n && goes_on; i++) /* also what was read just now */
        goes_on = log_follows(t.crypt, &to, &r->since[i]);
    if ((st = store_end(r->held, &t, st, e)) != ST_OK ||
        (st = store_stats(r->held, false, &stats, e)) != ST_OK)
        return st;
    r->out->had_subjects = stats.subjects;
    r->out->had_templates = stats.templates;
    if (goes_on)
        return ST_OK;
    if ((st = store_audit_has(r->backup, &end, &older, e)) != ST_OK || older)
        return st; /* the backup has all that it has, and more */
    return errinfo_set(
        e, ST_EMISMATCH,
        "the backup is not of the same database as %.160s, or both have gone on "
        "since an earlier restore: move that away first; then those who were "
        "erased in it since are back",
        r->path);
}

static enum status erase_again(struct restoring *r, struct log_txn *to,
                               const struct log_entry *c, struct errinfo *e)
{
    struct rows_subject of;
    enum status st = rows_subject_get(to, c->uid, &of, e);

    if (st == ST_ENOTFOUND) /* no older archive brings it back either */
        return log_change(to, "delete_subject", c->uid, "", "erased before", e);
    if (st == ST_OK && (st = store_erase_rows(to, &of, "erased again", NULL, e)) == ST_OK)
        r->out->erased++;
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status revoke_again(struct restoring *r, struct log_txn *to,
                                const struct log_entry *c, struct errinfo *e)
{
    struct rows_token one;
    enum status st = rows_token_get(to, c->object, &one, e);

    if (st != ST_OK || one.token.revoked[0] != '\0')
        return st == ST_ENOTFOUND ? ST_OK : st;
    memcpy(one.token.revoked, to->by.at, sizeof to->by.at);
    if ((st = rows_token_write(to, &one, e)) != ST_OK)
        return st;
    r->out->revoked++;
    return log_change(to, "revoke_token", NULL, c->object, one.token.name, e);
}

static enum status remove_again(struct restoring *r, struct log_txn *to,
                                const struct log_entry *c, struct errinfo *e)
{
    struct rows_device row;
    enum status st = rows_device_get(to, c->object, &row, e);

    if (st != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st;
    if ((st = rows_table_delete(to, &rows_devices, &row, e)) != ST_OK)
        return st;
    r->out->revoked++;
    return log_change(to, "remove_device", NULL, c->object, row.one.name, e);
}

static enum status count_lost(struct restoring *r, struct log_txn *to, struct errinfo *e)
{
    struct sql_rows *rows;
    struct log_txn t;
    enum status st = store_begin(r->held, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    st = sql_stream(t.sql, "SELECT uid FROM subjects", NULL, 0, &rows, e);
    while (st == ST_OK && sql_next(rows)) {
        struct sql_rows *found;

        st = SQL_QUERY(to->sql, &found, e, "SELECT 1 FROM subjects WHERE uid = $1",
                       sql_column(rows, 0));
        r->out->lost += st == ST_OK && !sql_next(found);
        st = sql_done(found, st, e);
    }
    return store_end(r->held, &t, sql_done(rows, st, e), e);
}

typedef enum status repeat(struct restoring *r, struct log_txn *to,
                           const struct log_entry *c, struct errinfo *e);

/* Returns the function that repeats changes of this kind; NULL: they are not repeated. */
static repeat *repeat_of(const struct log_entry *c)
{
    static const struct {
        const char *kind;
        repeat *again;
    } row[] = {{"delete_subject", erase_again},
               {"revoke_token", revoke_again},
               {"rotate_token", revoke_again},
               {"remove_device", remove_again}};

    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        if (strcmp(c->kind, row[i].kind) == 0)
            return row[i].again;
    return NULL;
}

bool admin_again_is(const struct log_entry *c)
{
    return repeat_of(c) != NULL;
}

static enum status do_again(struct restoring *r, struct log_txn *to,
                            const struct log_entry *c, struct errinfo *e)
{
    repeat *const again = repeat_of(c);

    return again != NULL ? again(r, to, c, e) : ST_OK;
}

/* All of the backup, and what was erased, revoked or removed since is so again. */
static enum status admin_restore_fill(void *arg, struct log_txn *from, struct log_txn *to,
                                      struct errinfo *e)
{
    struct restoring *r = arg;
    enum status st = admin_copy_all(NULL, from, to, e);

    for (size_t i = 0; i < r->n && st == ST_OK; i++)
        st = do_again(r, to, &r->since[i], e);
    return st == ST_OK && r->held != NULL ? count_lost(r, to, e) : st;
}

/* ---- the restored database */

static enum status read_root(struct store *s, struct crypt_root *root, struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    return st == ST_OK ? store_end(s, &t, rows_root_read(t.sql, root, e), e) : st;
}

/* The configured key opens the result: its keys are those of the store that it opens, or new ones
 * under it if no store has it. */
static enum status choose_keys(struct restoring *r, struct errinfo *e)
{
    struct store *const of = r->from_key == NULL ? r->backup : r->held;
    struct crypt_file *k = NULL;
    enum status st;

    r->crypt = of != NULL ? of->crypt : NULL;
    if (of != NULL)
        return read_root(of, &r->root, e);
    if ((st = crypt_file_read(r->key->path, &k, e)) == ST_OK)
        st = crypt_file_root(k, r->key->path, CRYPT_FILE, &r->root, &r->made, e);
    r->crypt = r->made;
    crypt_file_free(k);
    return st;
}

/* The database that is there may be an older one, whose log says nothing of what came later. */
static enum status ask_anchor(struct restoring *r, struct errinfo *e)
{
    struct log_anchor said;
    bool has = false;
    enum status st = r->key->anchor != NULL
                         ? log_anchor_read(r->key->anchor, r->crypt, &said, e)
                         : ST_ENOTFOUND;

    if (st != ST_OK)
        return log_anchor_unknown(st) ? st : ST_OK; /* it is made again */
    if (r->held != NULL)
        st = store_audit_has(r->held, &said.end, &has, e);
    if (st == ST_OK && !has)
        st = store_audit_has(r->backup, &said.end, &has, e);
    r->out->missed = has ? 0 : said.end.seq;
    return st;
}

static enum status admin_restore_place(const struct restoring *r, struct newfile *n,
                                       struct newfile *anchor, struct errinfo *e)
{
    char *aside;
    struct errinfo why;
    enum status st = newfile_beside(r->path, ".before-restore", &aside, e);

    if (st != ST_OK)
        return st;
    st = admin_swap(r->path, r->held, n, aside, &why);
    free(aside);
    if (st != ST_OK && st != ST_EUNSYNCED)
        return errinfo_set(e, st, "%s", why.msg);
    if (st == ST_OK && r->key->anchor != NULL)
        st = newfile_commit(anchor, &why);
    newfile_leave(anchor);
    return admin_unfinished(st, "the database was restored", &why, e);
}

static enum status copy_and_place(struct restoring *r, bool dry, struct errinfo *e)
{
    struct admin_copy c = {
        .root = &r->root,
        .crypt = r->crypt,
        .key = r->key,
        .fill = admin_restore_fill,
        .arg = r,
        .actor = r->actor,
        .kind = "restore",
        .outcome = r->out->missed == 0 ? "restored" : "restored, older than the anchor"};
    struct newfile n = NEWFILE_NONE, anchor = NEWFILE_NONE;
    enum status st;

    if ((st = admin_copy(r->backup, r->path, &c, &n, e)) == ST_OK && !dry &&
        r->key->anchor != NULL)
        st = log_anchor_prepare(r->key->anchor, r->crypt,
                                &(struct log_anchor){.end = c.end}, &anchor, e);
    if (st == ST_OK && !dry)
        st = admin_restore_place(r, &n, &anchor, e);
    newfile_close(&anchor);
    newfile_close(&n);
    return st;
}

/* Is the database that is there this backup, restored by an earlier call, and unchanged since?  All that
 * a restore writes behind the backup's log has one time. */
static bool is_restored(const struct restoring *r)
{
    const struct log_entry *last = r->n > 0 ? &r->since[r->n - 1] : NULL;
    bool same = last != NULL && strcmp(last->kind, "restore") == 0;

    for (size_t i = 0; i < r->n && same; i++)
        same = strcmp(r->since[i].at, last->at) == 0 &&
               strcmp(r->since[i].actor, last->actor) == 0;
    return same;
}

/* The anchor too?  A part of it is given its name by opening the database. */
static enum status admin_restore_settle(struct restoring *r, bool dry, struct errinfo *e)
{
    struct store *s;
    enum status st;

    store_close(r->held);
    r->held = NULL;
    st = store_open(r->path, dry ? STORE_READ : STORE_WRITE, r->key, &s, e);
    if (st == ST_EREFUSED)
        return open_held(r, dry, e);
    r->out->already = st == ST_OK;
    store_close(s);
    return st;
}

/* A backup takes the place of a database whose key is known, and stays known. */
static enum status check_key(const struct restoring *r, struct errinfo *e)
{
    enum admin_left left;

    if (admin_rekey_left(r->path, r->key, &left, NULL) == ST_OK && left == ADMIN_LEFT_KEY)
        return errinfo_set(
            e, ST_EBUSY,
            "a rekey of %.160s was interrupted: run surfacectl rekey first, "
            "which completes it",
            r->path);
    return ST_OK;
}

static enum status admin_restore_restore(struct restoring *r, bool dry, struct errinfo *e)
{
    enum status st;

    if ((st = check_key(r, e)) != ST_OK || (st = open_held(r, dry, e)) != ST_OK ||
        (st = open_backup(r, e)) != ST_OK || (st = relate(r, e)) != ST_OK)
        return st;
    if (is_restored(r) &&
        ((st = admin_restore_settle(r, dry, e)) != ST_OK || r->out->already))
        return st;
    if ((st = choose_keys(r, e)) != ST_OK || (st = ask_anchor(r, e)) != ST_OK)
        return st;
    return copy_and_place(r, dry, e);
}

enum status admin_restore(const char *path, const char *from, const struct store_key *key,
                          const char *from_key, const char *actor, bool dry,
                          struct admin_restored *out, struct errinfo *e)
{
    char *target;
    struct restoring r = {
        .from = from, .key = key, .from_key = from_key, .actor = actor, .out = out};
    enum status st = newfile_beside(path, "", &target, e);

    memset(out, 0, sizeof *out);
    if (st != ST_OK)
        return st;
    r.path = target;
    if (sql_file_same(path, from))
        st = errinfo_set(e, ST_EINVAL, "%.160s is the database itself", from);
    else if ((st = admin_in_file(path,
                                 "restore it with the server's own backup (pg_restore, "
                                 "pgBackRest); surfacectl copy puts a file into an empty "
                                 "database",
                                 e)) == ST_OK)
        st = admin_restore_restore(&r, dry, e);
    store_close(r.backup);
    store_close(r.held);
    crypt_free(r.made);
    free(r.since);
    free(target);
    return st;
}

/* Commits t, or rolls it back if dry.  The anchor, whose daemon stays the same, goes on from here. */
static enum status end_alone(struct store *s, struct log_txn *t,
                             const struct store_key *key, bool dry, enum status st,
                             struct errinfo *e)
{
    struct newfile anchor = NEWFILE_NONE;
    struct log_anchor at = {.daemon = 0};

    if (st == ST_OK && !dry && key->anchor != NULL) {
        st = log_anchor_read(key->anchor, s->crypt, &at, e);
        at.end = t->changes;
        if (!log_anchor_unknown(st))
            st = log_anchor_prepare(key->anchor, s->crypt, &at, &anchor, e);
    }
    if (st != ST_OK || dry) {
        (void)store_end(s, t, st != ST_OK ? st : ST_EDENIED, NULL);
        newfile_close(&anchor);
        return st;
    }
    return store_commit(s, t, &anchor, "the change was made", e);
}

/* ---- what a server has restored by itself */

#define BY_SERVER "restored by the server"

bool admin_again_done(const char *path, const struct store_key *key, bool dry)
{
    struct log_entry *list = NULL;
    struct log_txn t;
    struct store *s;
    bool done = false;
    size_t n = 0;

    if (store_open(path, dry ? STORE_READ : STORE_WRITE, key, &s, NULL) != ST_OK)
        return false;
    if (store_begin(s, SQL_READ, &t, NULL) == ST_OK) {
        (void)log_list(t.sql, "restore", t.changes.seq - 1, &list, &n, NULL);
        done = n > 0 && strcmp(list[0].outcome, BY_SERVER) == 0;
        (void)store_end(s, &t, ST_OK, NULL);
    }
    free(list);
    store_close(s);
    return done;
}

enum status admin_again(const char *path, const struct store_key *key, const char *actor,
                        const struct admin_later *later, bool dry,
                        struct admin_restored *out, struct errinfo *e)
{
    struct store_key by_key = *key;
    struct restoring r = {.path = path, .key = key, .out = out};
    struct log_txn t;
    struct store *s;
    enum status st;

    memset(out, 0, sizeof *out);
    by_key.anchor = NULL; /* it names what is not there any more */
    if ((st = store_open(path, STORE_ALONE, &by_key, &s, e)) != ST_OK)
        return st;
    if ((st = store_settle_anchor(s, key->anchor, e)) == ST_OK &&
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) == ST_OK) {
        if (memcmp(&t.changes, &later->after, sizeof t.changes) != 0)
            st = errinfo_set(e, ST_EBUSY, "another process has changed the database");
        for (size_t i = 0; i < later->n && st == ST_OK; i++)
            st = do_again(&r, &t, &later->change[i], e);
        if (st == ST_OK)
            st = log_change(&t, "restore", NULL, "", BY_SERVER, e);
        st = end_alone(s, &t, key, dry, st, e);
    }
    store_close(s);
    return st;
}

/* ---- as it is */

/* Each subject's templates are those that there are. */
static enum status accept_templates(void *arg, struct log_txn *t,
                                    const struct rows_subject *of, struct errinfo *e)
{
    struct rows_subject one = *of;
    const enum status st = rows_template_accept(t, &one, e);

    (void)arg;
    sodium_memzero(&one, sizeof one);
    return st;
}

static enum status accept_rows(struct log_txn *t, store_report *report, void *arg,
                               struct admin_accepted *out, struct errinfo *e)
{
    char outcome[LOG_TEXT + 1];
    unsigned char sum[LOG_DIGEST];
    uint64_t orphans = 0, twins = 0, bad = 0;
    bool same = false;
    enum status st;

    if ((st = rows_digest(t, true, report, arg, sum, &out->removed, e)) != ST_OK ||
        (st = sql_file_reindex(t->sql, e)) != ST_OK ||
        (st = rows_digest_orphans(t, report, arg, &orphans, e)) != ST_OK ||
        (st = rows_digest_twice(t, report, arg, &twins, e)) != ST_OK ||
        (st = rows_digest(t, false, NULL, NULL, sum, &bad, e)) != ST_OK ||
        (st = log_txn_agrees(t, sum, &same, e)) != ST_OK)
        return st;
    if (twins > 0) /* nothing says which of them is right */
        return errinfo_set(e, ST_ECORRUPT,
                           "two rows have what only one may have: restore a backup");
    out->removed += orphans;
    out->differed = !same;
    if (!same)
        report(arg, rows_digest_problem);
    log_txn_accept(t, sum);
    if ((st = admin_each(t, accept_templates, NULL, e)) != ST_OK)
        return st;
    (void)snprintf(outcome, sizeof outcome, "%s, %" PRIu64 " rows removed",
                   same ? "rows as written" : "rows differed", out->removed);
    return log_change(t, "accept_state", NULL, "", outcome, e);
}

enum status admin_accept(const char *path, const struct store_key *key, const char *actor,
                         bool dry, store_report *report, void *arg,
                         struct admin_accepted *out, struct errinfo *e)
{
    struct store_key by_key = *key;
    struct log_txn t;
    struct store *s;
    enum status st;

    memset(out, 0, sizeof *out);
    by_key.anchor = NULL;
    if ((st = store_open(path, STORE_ALONE, &by_key, &s, e)) != ST_OK)
        return st;
    atomic_store(&s->verified, true); /* what is found is accepted */
    if ((st = store_settle_anchor(s, key->anchor, e)) == ST_OK &&
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) == ST_OK) {
        st = accept_rows(&t, report, arg, out, e);
        st = end_alone(s, &t, key, dry, st, e);
    }
    store_close(s);
    return st;
}
