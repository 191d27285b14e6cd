/* A backup in the place of the database.  It is copied and verified beside it first; what
 * must not be undone by going back in time is carried over from the database that is there:
 * who was erased, and which secrets of tokens count.  Then its pages replace the others' in
 * one transaction, in the same file: whoever waits for it does not end up with the old one. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "newfile.h"
#include "store_sqlite.h"

struct restoring {
    struct store_sqlite_conn *held; /* the database that is there; NULL: there is none */
    struct store_sqlite_conn *c;    /* the backup's copy, in a transaction */
    const struct store_act *by;
    struct store_restored *out;
};

typedef enum status restore_row(struct restoring *r, sqlite3_stmt *row,
                                struct errinfo *e);

/* Each row of the database that is there. */
static enum status each(struct restoring *r, const char *sql, restore_row *use,
                        struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;
    int rc = SQLITE_DONE;

    if (sqlite3_prepare_v2(r->held->db, sql, -1, &stmt, NULL) != SQLITE_OK)
        return store_sqlite_fail(r->held, "cannot read", e);
    while (st == ST_OK && (rc = sqlite3_step(stmt)) == SQLITE_ROW)
        st = use(r, stmt, e);
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(r->held, "cannot read", e);
    (void)sqlite3_finalize(stmt);
    return st;
}

/* ---- who was erased */

static enum status erase(struct restoring *r, int64_t row, const char *id,
                         struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(r->c, SQL_SUBJECT_DELETE, &stmt, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, row) != SQLITE_OK)
        return store_sqlite_fail(r->c, "cannot erase a subject", e);
    if ((st = store_sqlite_run(r->c, stmt, e)) != ST_OK)
        return st;
    r->out->erased++;
    return store_sqlite_event_add(r->c, r->by, "delete_subject", id, "", "erased again",
                                  e);
}

/* Whoever has the uid of the first column in the copy: their row, 0 for nobody, and their id, ""
 * where the row is damaged, which does not keep it from being erased. */
static enum status find(struct restoring *r, sqlite3_stmt *held, int64_t *row,
                        char id[STORE_SUBJECT_MAX + 1], struct errinfo *e)
{
    struct store_sqlite_person p = {0};
    struct store_subject who = {0};
    unsigned char uid[STORE_UID];
    enum status st;

    *row = 0;
    id[0] = '\0';
    if (!store_sqlite_bytes(held, 0, uid, sizeof uid))
        return errinfo_set(e, ST_ECORRUPT, "the database that is there is damaged");
    st = store_sqlite_subject_same(r->c, uid, &p, &who, e);
    *row = st == ST_ENOTFOUND ? 0 : p.row;
    memcpy(id, who.id, sizeof who.id);
    sodium_memzero(&p, sizeof p);
    sodium_memzero(&who, sizeof who);
    return st == ST_ENOTFOUND || (st == ST_ECORRUPT && *row != 0) ? ST_OK : st;
}

/* A row of `erased` for the copy too, and nobody there whom it names. */
static enum status was_erased(struct restoring *r, sqlite3_stmt *held, struct errinfo *e)
{
    char id[STORE_SUBJECT_MAX + 1];
    sqlite3_stmt *stmt;
    int64_t row;
    enum status st = store_sqlite_prepare(r->c, SQL_ERASED_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    for (int k = 0; k < 3; k++)
        if (sqlite3_bind_value(stmt, k + 1, sqlite3_column_value(held, k)) != SQLITE_OK)
            return store_sqlite_fail(r->c, "cannot erase a subject", e);
    if ((st = store_sqlite_run(r->c, stmt, e)) == ST_OK &&
        (st = find(r, held, &row, id, e)) == ST_OK && row != 0)
        st = erase(r, row, id, e);
    sodium_memzero(id, sizeof id);
    return st;
}

static enum status is_there(struct restoring *r, sqlite3_stmt *held, struct errinfo *e)
{
    char id[STORE_SUBJECT_MAX + 1];
    int64_t row;
    const enum status st = find(r, held, &row, id, e);

    r->out->had_subjects++;
    if (st == ST_OK && row == 0)
        r->out->lost++;
    sodium_memzero(id, sizeof id);
    return st;
}

/* ---- tokens */

/* One that was revoked stays so, and a secret that was replaced stays replaced.  What else
 * is proved of it never changes, so that its proof is as good here. */
static enum status token(struct restoring *r, sqlite3_stmt *row, struct errinfo *e)
{
    static const char revoke[] = "UPDATE tokens SET revoked = ?2 WHERE id = ?1 AND "
                                 "revoked IS NULL AND ?2 IS NOT NULL",
                      rotate[] = "UPDATE tokens SET hash = ?3, old_hash = ?4, "
                                 "old_until = ?5, expires = ?6, mac = ?7 WHERE id = ?1";
    static const char *const sql[] = {revoke, rotate};
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;

    for (int i = 0; i < 2 && st == ST_OK; i++) {
        if (sqlite3_prepare_v2(r->c->db, sql[i], -1, &stmt, NULL) != SQLITE_OK)
            st = store_sqlite_fail(r->c, "cannot change a token", e);
        for (int k = 1; st == ST_OK && k <= sqlite3_bind_parameter_count(stmt); k++)
            if (sqlite3_bind_value(stmt, k, sqlite3_column_value(row, k - 1)) !=
                SQLITE_OK)
                st = store_sqlite_fail(r->c, "cannot change a token", e);
        if (st == ST_OK && sqlite3_step(stmt) != SQLITE_DONE)
            st = store_sqlite_fail(r->c, "cannot change a token", e);
        if (st == ST_OK && i == 0)
            r->out->revoked += (uint64_t)sqlite3_changes(r->c->db);
        (void)sqlite3_finalize(stmt);
        stmt = NULL;
    }
    return st;
}

/* ---- all of it */

static enum status public_key(struct store_sqlite_conn *c, unsigned char out[VAULT_KEY],
                              struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;

    if (sqlite3_prepare_v2(c->db, "SELECT public FROM root", -1, &stmt, NULL) !=
            SQLITE_OK ||
        sqlite3_step(stmt) != SQLITE_ROW || !store_sqlite_bytes(stmt, 0, out, VAULT_KEY))
        st = errinfo_set(e, ST_ECORRUPT, "the key record cannot be read");
    (void)sqlite3_finalize(stmt);
    return st;
}

static enum status need_same(struct restoring *r, const char *path, struct errinfo *e)
{
    unsigned char now[VAULT_KEY], then[VAULT_KEY];
    enum status st;

    if ((st = public_key(r->held, now, e)) != ST_OK ||
        (st = public_key(r->c, then, e)) != ST_OK)
        return st;
    if (memcmp(now, then, sizeof now) != 0)
        return errinfo_set(e, ST_EMISMATCH,
                           "it is a backup of another database than %.160s: move that "
                           "away first",
                           path);
    return ST_OK;
}

static enum status count_templates(struct restoring *r, sqlite3_stmt *row,
                                   struct errinfo *e)
{
    (void)e;
    r->out->had_templates = (uint64_t)sqlite3_column_int64(row, 0);
    return ST_OK;
}

static enum status carry(struct restoring *r, const char *path, struct errinfo *e)
{
    enum status st;

    if ((st = need_same(r, path, e)) != ST_OK ||
        (st = each(r, "SELECT count(*) FROM templates", count_templates, e)) != ST_OK ||
        (st = each(r, "SELECT uid, lookup, at FROM erased", was_erased, e)) != ST_OK ||
        (st = each(r, "SELECT uid FROM subjects", is_there, e)) != ST_OK)
        return st;
    return each(r,
                "SELECT id, revoked, hash, old_hash, old_until, expires, mac FROM tokens",
                token, e);
}

/* What the copy has to take over, in one transaction. */
static enum status amend(struct restoring *r, const char *path, const char *part,
                         const struct store_key *key, struct errinfo *e)
{
    struct store *s;
    enum status st;

    if ((st = store_sqlite_open(part, STORE_WRITE, key, &s, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_write(s, true, &r->c, e)) == ST_OK) {
        if (r->held != NULL)
            st = carry(r, path, e);
        if (st == ST_OK)
            st = store_sqlite_event_add(r->c, r->by, "restore", "", "", "restored", e);
        st = store_sqlite_written(s, st, e);
    }
    s->engine->close(s);
    return st;
}

/* The database that is there, which nobody else has open, or for a dry run may have. */
static enum status hold(const char *path, bool dry, struct store_sqlite_conn **held,
                        struct errinfo *e)
{
    struct errinfo why;
    int version = 0;
    enum status st;

    *held = NULL;
    if (access(path, F_OK) != 0 && errno == ENOENT) {
        if (store_sqlite_has_log(path)) /* SQLite would take it for the new one's */
            return errinfo_set(e, ST_EEXISTS,
                               "there is a %.160s-wal without its database: move it away "
                               "first",
                               path);
        return ST_OK;
    }
    st = store_sqlite_connect(path, SQLITE_OPEN_READWRITE, !dry, held, &why);
    if (st == ST_OK)
        st = store_sqlite_schema_version(*held, path, &version, &why);
    if (st == ST_OK && version < STORE_SQLITE_SCHEMA)
        st =
            errinfo_set(&why, ST_EVERSION, "%.120s has schema version %d", path, version);
    if (st == ST_ECORRUPT || st == ST_EVERSION)
        return errinfo_set(e, st,
                           "%.150s: move it away first; then those who were erased since "
                           "the backup are back",
                           why.msg);
    return st == ST_OK ? st : errinfo_set(e, st, "%s", why.msg);
}

static enum status is_other(const char *path, const char *from, struct errinfo *e)
{
    struct stat a, b;

    if (stat(path, &a) == 0 && stat(from, &b) == 0 && a.st_dev == b.st_dev &&
        a.st_ino == b.st_ino)
        return errinfo_set(e, ST_EINVAL, "%.160s is the database itself", from);
    return ST_OK;
}

/* SQLite takes what is missing of the last page for zeros, which is not noticed where they
 * were zeros. */
static enum status is_whole(struct store_sqlite_conn *c, const char *from,
                            struct errinfo *e)
{
    struct stat sb;
    uint64_t bytes;
    const enum status st = store_sqlite_size(c, &bytes, e);

    if (st != ST_OK || store_sqlite_has_log(from))
        return st;
    if (stat(from, &sb) != 0 || (uint64_t)sb.st_size < bytes)
        return errinfo_set(e, ST_ECORRUPT,
                           "%.160s is cut short: it should have %llu bytes", from,
                           (unsigned long long)bytes);
    return ST_OK;
}

static enum status copy_backup(const char *from, const struct store_key *key,
                               const struct newfile *n, struct store_copied *found,
                               struct errinfo *e)
{
    struct store_sqlite_conn *c;
    struct store *s;
    enum status st;

    if ((st = store_sqlite_open(from, STORE_READ, key, &s, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_read(s, &c, e)) == ST_OK) {
        if ((st = is_whole(c, from, e)) == ST_OK)
            st = store_sqlite_copy(c, n, e);
        store_sqlite_done(s, c);
    }
    s->engine->close(s);
    return st == ST_OK ? store_sqlite_verify(n->part, key, found, e) : st;
}

/* The pages of the part in the database that is there, which is kept aside first. */
static enum status replace(struct store_sqlite_conn *held, const char *part,
                           const char *aside, struct errinfo *e)
{
    struct newfile old = NEWFILE_NONE;
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = newfile_open(aside, &old, e)) == ST_OK &&
        (st = store_sqlite_copy(held, &old, e)) == ST_OK)
        st = newfile_keep(&old, e);
    newfile_close(&old);
    if (st != ST_OK)
        return st;
    if ((st = store_sqlite_connect(part, SQLITE_OPEN_READWRITE, true, &c, e)) == ST_OK) {
        st = store_sqlite_pages(c, held, e);
        store_sqlite_disconnect(c);
    }
    if (st != ST_OK)
        (void)unlink(aside);
    return st;
}

/* Where nothing is in the way: the part as the database. */
static enum status place(struct newfile *n, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st = store_sqlite_connect(n->part, SQLITE_OPEN_READWRITE, true, &c, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_exec(c->db, "PRAGMA journal_mode=DELETE", NULL, NULL, NULL) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot write", e);
    store_sqlite_disconnect(c);
    return st == ST_OK ? newfile_keep(n, e) : st;
}

/* Does the database tell all that the copy aside does, and perhaps more?  Then the last event
 * of that is among its own, whose hashes depend on all before. */
static enum status goes_on_from(struct store_sqlite_conn *held, const char *aside,
                                bool *yes, struct errinfo *e)
{
    static const char end[] = "SELECT seq, hash FROM events_end",
                      same[] = "SELECT 1 FROM events WHERE seq = ?1 AND hash = ?2";
    struct store_sqlite_conn *c = NULL;
    sqlite3_stmt *last = NULL, *mine = NULL;
    enum status st;

    *yes = false;
    if ((st = store_sqlite_connect(aside, SQLITE_OPEN_READONLY, false, &c, e)) != ST_OK)
        return st;
    if (sqlite3_prepare_v2(c->db, end, -1, &last, NULL) == SQLITE_OK &&
        sqlite3_step(last) == SQLITE_ROW) {
        if (sqlite3_prepare_v2(held->db, same, -1, &mine, NULL) != SQLITE_OK ||
            sqlite3_bind_value(mine, 1, sqlite3_column_value(last, 0)) != SQLITE_OK ||
            sqlite3_bind_value(mine, 2, sqlite3_column_value(last, 1)) != SQLITE_OK)
            st = store_sqlite_fail(held, "cannot read the events", e);
        else
            *yes = sqlite3_step(mine) == SQLITE_ROW;
    }
    (void)sqlite3_finalize(last);
    (void)sqlite3_finalize(mine);
    store_sqlite_disconnect(c);
    return st;
}

/* A restore that was killed before it replaced anything has left a copy of the database that
 * is there: nobody needs it.  What one that came to its end has put aside may be needed. */
static enum status clear_aside(struct store_sqlite_conn *held, const char *aside,
                               struct errinfo *e)
{
    bool superfluous = false;
    enum status st;

    if (access(aside, F_OK) != 0)
        return ST_OK;
    if (held != NULL && (st = goes_on_from(held, aside, &superfluous, e)) != ST_OK)
        return st;
    if (!superfluous)
        return errinfo_set(
            e, ST_EEXISTS,
            "%.160s is what an earlier restore has put aside: delete it when "
            "all is well, or move it",
            aside);
    return unlink(aside) == 0 ? ST_OK
                              : errinfo_set(e, ST_EIO, "cannot remove %.160s: %s", aside,
                                            strerror(errno));
}

enum status store_sqlite_restore(const char *path, const char *from,
                                 const struct store_key *key, const struct store_act *by,
                                 bool dry, struct store_restored *out, struct errinfo *e)
{
    struct restoring r = {.by = by, .out = out};
    struct newfile n = NEWFILE_NONE;
    const size_t len = strlen(path) + sizeof ".before-restore";
    char *aside = malloc(len);
    enum status st;

    memset(out, 0, sizeof *out);
    if (aside == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(aside, len, "%s.before-restore", path);
    if ((st = is_other(path, from, e)) != ST_OK ||
        (st = newfile_open(path, &n, e)) != ST_OK ||
        (st = hold(path, dry, &r.held, e)) != ST_OK ||
        (!dry && (st = clear_aside(r.held, aside, e)) != ST_OK) ||
        (st = copy_backup(from, key, &n, &out->backup, e)) != ST_OK ||
        (st = amend(&r, path, n.part, key, e)) != ST_OK)
        goto out;
    out->was_there = r.held != NULL;
    if (!dry)
        st = r.held != NULL ? replace(r.held, n.part, aside, e) : place(&n, e);
out:
    store_sqlite_disconnect(r.held); /* NULL is allowed; brings in the log */
    newfile_close(&n);
    free(aside);
    return st;
}
