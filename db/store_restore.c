/* A backup in the place of the database.  It is copied and verified beside it first; what
 * must not be undone by going back in time is carried over from the database that is there:
 * who was erased, and which secrets of tokens are accepted.  Then its pages replace the others'
 * in one transaction, in the same file: a process that waits for it does not end up with the
 * old one. */
#include "store_restore.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "newfile.h"
#include "row_device.h"
#include "row_event.h"
#include "row_subject.h"
#include "row_token.h"
#include "sql_file.h"
#include "store_backup.h"
#include "store_column.h"
#include "store_erase.h"
#include "store_open.h"
#include "store_rules.h"
#include "store_txn.h"

struct restoring {
    struct sql *held;      /* the database that is there; NULL: there is none */
    struct sql_txn *there; /* in a transaction */
    struct store_txn t;    /* the backup's copy */
    const struct store_act *by;
    struct store_restored *out;
};

typedef enum status restore_row(struct restoring *r, const struct sql_rows *row,
                                struct errinfo *e);

/* Use each row of the database that is there. */
static enum status each(struct restoring *r, const char *text, restore_row *use,
                        struct errinfo *e)
{
    struct sql_rows *row;
    enum status st = sql_query(r->there, text, NULL, 0, &row, e);

    while (st == ST_OK && sql_next(row))
        st = use(r, row, e);
    return sql_done(row, st, e);
}

/* ---- who was erased */

/* The subject of the copy with the uid of the first column, under its id, "" where the row is
 * damaged, which does not keep it from being erased; row 0: there is none. */
static enum status find(struct restoring *r, const struct sql_rows *held,
                        struct row_subject *p, char id[STORE_SUBJECT_MAX + 1],
                        struct errinfo *e)
{
    struct store_subject who = {0};
    unsigned char uid[STORE_UID];
    enum status st;

    memset(p, 0, sizeof *p);
    id[0] = '\0';
    if (!store_column_bytes(held, 0, uid, sizeof uid))
        return errinfo_set(e, ST_ECORRUPT, "the database that is there is damaged");
    st = row_subject_same(&r->t, uid, p, &who, e);
    memcpy(p->key.uid, uid, sizeof uid);
    memcpy(id, who.id, sizeof who.id);
    sodium_memzero(p->key.key, sizeof p->key.key);
    sodium_memzero(&who, sizeof who);
    return st == ST_ENOTFOUND || (st == ST_ECORRUPT && p->row != 0) ? ST_OK : st;
}

/* The copy knows of the erasure too, and has no subject that it names. */
static enum status was_erased(struct restoring *r, const struct sql_rows *held,
                              struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct row_event_row gone = {.gone = true};
    char id[STORE_SUBJECT_MAX + 1], (*ids)[STORE_ID_LEN + 1] = NULL;
    struct row_subject p;
    bool erased = false;
    size_t n = 0;
    enum status st;

    if ((st = find(r, held, &p, id, e)) != ST_OK ||
        (st = row_event_erased(&r->t, p.key.uid, NULL, &erased, e)) != ST_OK || erased)
        return st;
    memcpy(gone.object, p.key.uid, sizeof gone.object);
    if (store_column_bytes(held, 1, ref, sizeof ref))
        gone.ref = ref;
    if (p.row == 0) {
        st = row_event_leave(&r->t, r->by, "delete_subject", "", "", "erased before",
                             &gone, e);
    } else {
        r->out->erased++;
        st = store_erase_row(&r->t, r->by, id, "erased again", p.row, &gone, &ids, &n, e);
        free(ids);
    }
    sodium_memzero(id, sizeof id);
    return st;
}

static enum status is_there(struct restoring *r, const struct sql_rows *held,
                            struct errinfo *e)
{
    char id[STORE_SUBJECT_MAX + 1];
    struct row_subject p;
    const enum status st = find(r, held, &p, id, e);

    r->out->had_subjects++;
    if (st == ST_OK && p.row == 0)
        r->out->lost++;
    sodium_memzero(id, sizeof id);
    return st;
}

/* ---- tokens */

/* One that was revoked stays so, and a secret that was replaced stays replaced.  One whose row
 * is not what was written last is good for nothing any more. */
static enum status token(struct restoring *r, const struct sql_rows *held,
                         struct errinfo *e)
{
    struct store_txn there = {.store = r->t.store, .sql = r->there, .vault = r->t.vault};
    char id[STORE_ID_LEN + 1];
    struct row_token now, then;
    bool rotated, revoked;
    enum status st;

    if (!store_column_text(held, 0, id, sizeof id))
        return errinfo_set(e, ST_ECORRUPT, "the database that is there is damaged");
    if ((st = row_token_get(&r->t, id, &then, e)) != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st;
    if ((st = row_token_get(&there, id, &now, e)) != ST_OK && st != ST_ECORRUPT)
        return st;
    revoked = (st != ST_OK || now.token.revoked) && !then.token.revoked;
    rotated = st == ST_OK && sodium_memcmp(now.hash, then.hash, sizeof now.hash) != 0;
    st = ST_OK;
    if (rotated)
        st = row_token_rotate(&r->t, &now, e);
    if (revoked && st == ST_OK)
        st = row_token_revoke(&r->t, id, r->by->at, e);
    r->out->revoked += revoked;
    if (st == ST_OK && (rotated || revoked))
        st = row_token_tell(&r->t, r->by, revoked ? "revoke_token" : "rotate_token", id,
                            e);
    return st;
}

/* ---- devices */

/* One that was removed stays so. */
static enum status devices(struct restoring *r, struct errinfo *e)
{
    struct store_txn there = {.store = r->t.store, .sql = r->there, .vault = r->t.vault};
    struct store_device *then, now;
    size_t n;
    enum status st = row_device_list(&r->t, &then, &n, e);

    for (size_t i = 0; st == ST_OK && i < n; i++) {
        st = row_device_find(&there, then[i].name, &now, e);
        if (st == ST_OK && strcmp(now.id, then[i].id) == 0)
            continue;
        if (st == ST_OK || st == ST_ENOTFOUND || st == ST_ECORRUPT)
            st = row_device_remove(&r->t, r->by, then[i].name, e);
    }
    free(then);
    return st;
}

/* ---- all of it */

static enum status need_same(struct restoring *r, const char *path, struct errinfo *e)
{
    struct vault_root now, then;
    enum status st;

    if ((st = store_vault_read(r->there, &now, e)) != ST_OK ||
        (st = store_vault_read(r->t.sql, &then, e)) != ST_OK)
        return st;
    if (memcmp(now.public, then.public, sizeof now.public) != 0)
        return errinfo_set(e, ST_EMISMATCH,
                           "it is a backup of another database than %.160s: move that "
                           "away first",
                           path);
    return ST_OK;
}

static enum status count_templates(struct restoring *r, const struct sql_rows *row,
                                   struct errinfo *e)
{
    (void)e;
    r->out->had_templates = (uint64_t)sql_column(row, 0).i;
    return ST_OK;
}

static enum status carry(struct restoring *r, const char *path, struct errinfo *e)
{
    enum status st = sql_begin(r->held, SQL_READ, &r->there, e);

    if (st != ST_OK)
        return st;
    if ((st = need_same(r, path, e)) == ST_OK &&
        (st = each(r, "SELECT count(*) FROM templates", count_templates, e)) == ST_OK &&
        (st = each(r,
                   "SELECT object, subject FROM events WHERE chain = 0 "
                   "AND kind = 'delete_subject' ORDER BY seq",
                   was_erased, e)) == ST_OK &&
        (st = each(r, "SELECT uid FROM subjects", is_there, e)) == ST_OK)
        st = each(r, "SELECT id FROM tokens", token, e);
    if (st == ST_OK)
        st = devices(r, e);
    return sql_end(r->there, st, e);
}

/* Before the copy takes the database's place its anchor takes either. */
static enum status announce(struct restoring *r, const char *path,
                            const struct store_key *key, struct errinfo *e)
{
    struct store_anchor a;
    struct anchor_end end;
    enum status st = store_anchor_init(&a, key, r->t.store->vaults.path, path, e);

    if (st == ST_OK && (st = store_anchor_end(r->t.sql, r->t.vault, &end, e)) == ST_OK)
        st = anchor_announce(a.path, r->t.vault, &end, e);
    store_anchor_free(&a);
    return st;
}

/* What the copy has to take over, in one transaction. */
static enum status amend(struct restoring *r, const char *path, const char *part,
                         const struct store_key *key, bool dry, struct errinfo *e)
{
    struct store_key by = *key;
    struct store *s;
    enum status st;

    by.copy = true;
    if ((st = store_open(part, STORE_WRITE, &by, &s, e)) != ST_OK)
        return st;
    if ((st = store_txn_begin(s, SQL_WRITE, &r->t, e)) == ST_OK) {
        if (r->held != NULL)
            st = carry(r, path, e);
        if (st == ST_OK)
            st = row_event_add(&r->t, r->by, "restore", "", "", "restored", e);
        if (st == ST_OK && !dry)
            st = announce(r, path, key, e);
        st = store_txn_end(&r->t, st, e);
    }
    store_close(s);
    return st;
}

/* The database that is there, which no other process has open, or for a dry run may have. */
static enum status hold(const char *path, bool dry, struct sql **held, struct errinfo *e)
{
    struct errinfo why;
    enum status st;

    *held = NULL;
    if (access(path, F_OK) != 0 && errno == ENOENT) {
        if (sql_file_has_wal(path)) /* SQLite would take it for the new one's */
            return errinfo_set(e, ST_EEXISTS,
                               "there is a %.160s-wal without its database: move it away "
                               "first",
                               path);
        return ST_OK;
    }
    st = sql_open(path, dry ? SQL_OPEN_LOOK : SQL_OPEN_ALONE, held, &why);
    if (st == ST_OK && sql_version(*held) < sql_newest())
        st = errinfo_set(&why, ST_EVERSION, "%.120s has schema version %d", path,
                         sql_version(*held));
    if (st == ST_ECORRUPT || st == ST_EVERSION)
        return errinfo_set(e, st,
                           "%.150s: move it away first; then those who were erased since "
                           "the backup are back",
                           why.msg);
    return st == ST_OK ? st : errinfo_set(e, st, "%s", why.msg);
}

/* SQLite takes what is missing of the last page for zeros, which is not noticed where they
 * were zeros. */
static enum status is_whole(struct sql_txn *t, const char *from, struct errinfo *e)
{
    struct stat sb;
    uint64_t bytes = 0;
    const enum status st = sql_file_bytes(t, &bytes, e);

    if (st != ST_OK || sql_file_has_wal(from))
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
    struct store_key by = *key;
    struct store_txn t;
    struct store *s;
    enum status st;

    by.copy = true;
    if ((st = store_open(from, STORE_READ, &by, &s, e)) != ST_OK)
        return st;
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) == ST_OK) {
        if ((st = is_whole(t.sql, from, e)) == ST_OK)
            st = sql_file_copy(t.sql, n->part, e);
        st = store_txn_end(&t, st, e);
    }
    store_close(s);
    return st == ST_OK ? store_backup_verify(n->part, key, found, e) : st;
}

/* The pages of the part in the database that is there, which is kept aside first. */
static enum status replace(struct sql *held, const char *part, const char *aside,
                           struct errinfo *e)
{
    struct newfile old = NEWFILE_NONE;
    struct sql_txn *t;
    struct sql *d;
    enum status st;

    if ((st = newfile_open(aside, &old, e)) == ST_OK &&
        (st = sql_begin(held, SQL_READ, &t, e)) == ST_OK &&
        (st = sql_end(t, sql_file_copy(t, old.part, e), e)) == ST_OK)
        st = newfile_keep(&old, e);
    newfile_close(&old);
    if (st != ST_OK)
        return st;
    if ((st = sql_open(part, SQL_OPEN_ALONE, &d, e)) == ST_OK) {
        st = sql_file_replace(held, d, e);
        sql_close(d);
    }
    if (st != ST_OK)
        (void)unlink(aside);
    return st;
}

/* Where nothing is in the way: the part as the database. */
static enum status place(struct newfile *n, struct errinfo *e)
{
    struct sql *d;
    enum status st = sql_open(n->part, SQL_OPEN_ALONE, &d, e);

    if (st != ST_OK)
        return st;
    st = sql_file_fold(d, e);
    sql_close(d);
    return st == ST_OK ? newfile_keep(n, e) : st;
}

/* The last event of a copy, 0 where it has none to tell. */
static enum status last_event(const char *path, int64_t *seq,
                              unsigned char hash[VAULT_HASH], struct errinfo *e)
{
    struct sql_rows *r;
    struct sql_txn *t;
    struct sql *d;
    enum status st = sql_open(path, SQL_OPEN_LOOK, &d, e);

    *seq = 0;
    if (st != ST_OK)
        return st;
    if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK) {
        if (sql_version(d) > 0 && (st = sql_query(t,
                                                  "SELECT seq, hash FROM events_end "
                                                  "WHERE chain = 0",
                                                  NULL, 0, &r, e)) == ST_OK) {
            if (sql_next(r) && store_column_bytes(r, 1, hash, VAULT_HASH))
                *seq = sql_column(r, 0).i;
            st = sql_done(r, st, e);
        }
        st = sql_end(t, st, e);
    }
    sql_close(d);
    return st;
}

/* Does the database tell all that the copy aside does, and perhaps more?  Then the last event
 * of that is among its own, whose hashes depend on all before. */
static enum status goes_on_from(struct sql *held, const char *aside, bool *yes,
                                struct errinfo *e)
{
    unsigned char hash[VAULT_HASH];
    struct sql_rows *r;
    struct sql_txn *t;
    int64_t seq;
    enum status st;

    *yes = false;
    if ((st = last_event(aside, &seq, hash, e)) != ST_OK || seq == 0 ||
        (st = sql_begin(held, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = SQL_QUERY(t, &r, e,
                   "SELECT 1 FROM events WHERE chain = 0 AND seq = $1 AND hash = $2",
                   sql_int(seq), sql_blob(hash, sizeof hash));
    *yes = st == ST_OK && sql_next(r);
    return sql_end(t, sql_done(r, st, e), e);
}

/* A restore that was killed before it replaced anything has left a copy of the database that
 * is there, which is not needed.  What one that came to its end has put aside may be needed. */
static enum status clear_aside(struct sql *held, const char *aside, struct errinfo *e)
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

enum status store_restore(const char *path, const char *from, const struct store_key *key,
                          const char *actor, bool dry, struct store_restored *out,
                          struct errinfo *e)
{
    const size_t len = strlen(path) + sizeof ".before-restore";
    struct restoring r = {.out = out};
    struct newfile n = NEWFILE_NONE;
    struct store_act by;
    struct store *s;
    bool placed = false;
    char *aside;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    if ((aside = malloc(len)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    r.by = &by;
    (void)snprintf(aside, len, "%s.before-restore", path);
    if (sql_file_same(path, from))
        st = errinfo_set(e, ST_EINVAL, "%.160s is the database itself", from);
    if (st != ST_OK || (st = newfile_open(path, &n, e)) != ST_OK ||
        (st = hold(path, dry, &r.held, e)) != ST_OK ||
        (!dry && (st = clear_aside(r.held, aside, e)) != ST_OK) ||
        (st = copy_backup(from, key, &n, &out->backup, e)) != ST_OK ||
        (st = amend(&r, path, n.part, key, dry, e)) != ST_OK)
        goto out;
    out->was_there = r.held != NULL;
    if (!dry)
        st = r.held != NULL ? replace(r.held, n.part, aside, e) : place(&n, e);
    placed = !dry && st == ST_OK;
out:
    sql_close(r.held); /* NULL is allowed; brings in the WAL */
    newfile_close(&n);
    free(aside);
    if (placed && (st = store_open(path, STORE_WRITE, key, &s, e)) == ST_OK)
        store_close(s); /* its anchor knows now that it is in its place */
    return st;
}
