#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "store_receipt.h"
#include "store_sqlite.h"

enum { /* the columns of SUBJECT_WHO, from the first of them on */
       COL_UID,
       COL_KEY,
       COL_ABOUT,
       COL_CREATED,
       COL_EXPIRES,
       COL_SEEN,
       COL_HOLD,
       COL_DISABLED
};

static bool read_key(const struct store_sqlite_conn *c, sqlite3_stmt *stmt, int col,
                     struct store_seal_key *k)
{
    unsigned char uid[STORE_SEAL_UID], wrapped[VAULT_WRAPPED];

    return store_sqlite_bytes(stmt, col + COL_UID, uid, sizeof uid) &&
           store_sqlite_bytes(stmt, col + COL_KEY, wrapped, sizeof wrapped) &&
           store_seal_key(c->vault, uid, wrapped, k);
}

bool store_sqlite_subject_who(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              int col, struct store_subject *s, struct store_seal_key *k)
{
    uint32_t hold = 0, disabled = 0;
    const void *about;
    size_t n;

    memset(s, 0, sizeof *s);
    if (!store_sqlite_text(stmt, col + COL_CREATED, s->created, sizeof s->created) ||
        !store_sqlite_text_or(stmt, col + COL_EXPIRES, s->expires, sizeof s->expires) ||
        !store_sqlite_text_or(stmt, col + COL_SEEN, s->seen, sizeof s->seen) ||
        !store_sqlite_count(stmt, col + COL_HOLD, 1, &hold) ||
        !store_sqlite_count(stmt, col + COL_DISABLED, 1, &disabled) ||
        (about = store_sqlite_blob(stmt, col + COL_ABOUT, 1, STORE_SEAL_ABOUT, &n)) ==
            NULL ||
        !read_key(c, stmt, col, k))
        return false;
    s->hold = hold != 0;
    s->disabled = disabled != 0;
    memcpy(s->uid, k->uid, sizeof s->uid);
    return store_seal_open_subject(k, about, n, s);
}

static enum status read_subject(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                void *out, struct errinfo *e)
{
    struct store_subject *s = out;
    struct store_seal_key k = {0};
    uint32_t templates;
    const int64_t row = sqlite3_column_int64(stmt, 0);
    const bool ok = store_sqlite_subject_who(c, stmt, 2, s, &k) &&
                    store_sqlite_count(stmt, 1, UINT32_MAX, &templates);

    sodium_memzero(&k, sizeof k);
    if (!ok)
        return errinfo_set(e, ST_ECORRUPT, "a subject's row is damaged (row %lld)",
                           (long long)row);
    s->key = row;
    s->templates = templates;
    return ST_OK;
}

int store_sqlite_bind_subject(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              int at, const char *subject)
{
    unsigned char lookup[VAULT_HASH];

    store_seal_lookup(c->vault, subject, lookup);
    return store_sqlite_bind_bytes(stmt, at, lookup, sizeof lookup);
}

static enum status bind_lookup(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                               const char *subject, struct errinfo *e)
{
    return store_sqlite_bind_subject(c, stmt, 1, subject) == SQLITE_OK
               ? ST_OK
               : store_sqlite_fail(c, "cannot look for a subject", e);
}

/* By what a row is found is not sealed with it: somebody may have exchanged two. */
static enum status not_theirs(const char *subject, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT, "subject %s: the row found is somebody else's",
                       subject);
}

enum status store_sqlite_subject_find(struct store_sqlite_conn *c, const char *subject,
                                      struct store_sqlite_person *p, struct errinfo *e)
{
    struct store_subject who;
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_FIND, &stmt, e);

    if (st != ST_OK)
        return st;
    if ((st = bind_lookup(c, stmt, subject, e)) == ST_OK) {
        switch (sqlite3_step(stmt)) {
        case SQLITE_ROW:
            p->row = sqlite3_column_int64(stmt, 0);
            if (!store_sqlite_subject_who(c, stmt, 1, &who, &p->key))
                st = errinfo_set(e, ST_ECORRUPT, "subject %s: its row is damaged",
                                 subject);
            else if (strcmp(who.id, subject) != 0) {
                p->row = 0;
                st = not_theirs(subject, e);
            }
            break;
        case SQLITE_DONE:
            st = errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
            break;
        default:
            st = store_sqlite_fail(c, "cannot read a subject", e);
        }
    }
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_subject_same(struct store_sqlite_conn *c,
                                      const unsigned char uid[STORE_UID],
                                      struct store_sqlite_person *p,
                                      struct store_subject *who, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_SAME, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    memset(who, 0, sizeof *who);
    if (store_sqlite_bind_bytes(stmt, 1, uid, STORE_UID) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE)) {
        st = store_sqlite_fail(c, "cannot read a subject", e);
    } else if (rc == SQLITE_DONE) {
        st = errinfo_set(e, ST_ENOTFOUND, "there is no such subject");
    } else {
        p->row = sqlite3_column_int64(stmt, 0);
        if (!store_sqlite_subject_who(c, stmt, 1, who, &p->key)) {
            memset(who, 0, sizeof *who);
            st = errinfo_set(e, ST_ECORRUPT, "a subject's row is damaged (row %lld)",
                             (long long)p->row);
        }
    }
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_subject_add(struct store_sqlite_conn *c,
                                     const struct store_subject *about,
                                     struct store_sqlite_person *p, struct errinfo *e)
{
    unsigned char wrapped[VAULT_WRAPPED], sealed[STORE_SEAL_ABOUT];
    sqlite3_stmt *stmt;
    size_t n;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    store_seal_new(c->vault,
                   sodium_is_zero(about->uid, sizeof about->uid) ? NULL : about->uid,
                   &p->key, wrapped);
    n = store_seal_subject(&p->key, about, sealed);
    if ((st = bind_lookup(c, stmt, about->id, e)) == ST_OK &&
        (store_sqlite_bind_bytes(stmt, 2, p->key.uid, sizeof p->key.uid) != SQLITE_OK ||
         store_sqlite_bind_bytes(stmt, 3, wrapped, sizeof wrapped) != SQLITE_OK ||
         store_sqlite_bind_bytes(stmt, 4, sealed, n) != SQLITE_OK ||
         store_sqlite_bind(stmt, 5, about->created) != SQLITE_OK ||
         store_sqlite_bind_or(stmt, 6, about->expires) != SQLITE_OK ||
         store_sqlite_bind_or(stmt, 7, about->seen) != SQLITE_OK ||
         sqlite3_bind_int(stmt, 8, about->hold) != SQLITE_OK ||
         sqlite3_bind_int(stmt, 9, about->disabled) != SQLITE_OK))
        st = store_sqlite_fail(c, "cannot add a subject", e);
    if (st == ST_OK)
        st = store_sqlite_run(c, stmt, e);
    p->row = sqlite3_last_insert_rowid(c->db);
    return st;
}

enum status store_sqlite_subject_enter(struct store *s, const struct store_act *by,
                                       const struct store_subject *about,
                                       struct errinfo *e)
{
    struct store_sqlite_person p = {0};
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_subject_find(c, about->id, &p, e)) == ST_OK)
        st = errinfo_set(e, ST_EEXISTS, "there is a subject %s already", about->id);
    else if (st == ST_ENOTFOUND &&
             (st = store_sqlite_subject_add(c, about, &p, e)) == ST_OK)
        st = store_sqlite_event_add(c, by, "add_subject", about->id, "", "created", e);
    sodium_memzero(&p, sizeof p);
    return store_sqlite_written(s, st, e);
}

/* ---- reading */

enum status store_sqlite_subject_read(struct store_sqlite_conn *c, const char *subject,
                                      struct store_subject *out, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_GET, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    if ((st = bind_lookup(c, stmt, subject, e)) == ST_OK) {
        if ((rc = sqlite3_step(stmt)) == SQLITE_ROW)
            st = read_subject(c, stmt, out, e);
        else if (rc == SQLITE_DONE)
            st = errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
        else
            st = store_sqlite_fail(c, "cannot read a subject", e);
    }
    if (st == ST_OK && strcmp(out->id, subject) != 0)
        st = not_theirs(subject, e);
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_subject_get(struct store *s, const char *subject,
                                     struct store_subject *out, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    st = store_sqlite_subject_read(c, subject, out, e);
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_subject_list(struct store *s, int64_t after, size_t limit,
                                      struct store_subject **out, size_t *n,
                                      struct errinfo *e)
{
    const int64_t most = limit < INT64_MAX ? (int64_t)limit : INT64_MAX;
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_SUBJECT_LIST, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, after) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 2, most) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the subjects", e);
    else
        st = store_sqlite_rows(c, stmt, read_subject, sizeof **out,
                               "cannot read the subjects", &list, n, e);
    *out = list;
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_subject_due(struct store *s, const char *at,
                                     struct store_subject **out, size_t *n,
                                     struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_SUBJECT_DUE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, at) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the subjects", e);
    else
        st = store_sqlite_rows(c, stmt, read_subject, sizeof **out,
                               "cannot read the subjects", &list, n, e);
    *out = list;
out:
    store_sqlite_done(s, c);
    return st;
}

/* ---- erasing */

/* May it be?  Who is damaged can be erased too, but not for being due. */
static enum status may_erase(struct store_sqlite_conn *c, const struct store_act *by,
                             const char *subject, bool due, struct errinfo *e)
{
    struct store_subject one;
    enum status st = store_sqlite_subject_read(c, subject, &one, e);

    if (st == ST_ECORRUPT && !due)
        return ST_OK;
    if (st != ST_OK)
        return st;
    if (one.hold)
        return errinfo_set(e, ST_EHELD, "subject %s is on hold", subject);
    if (due && (one.expires[0] == '\0' || strcmp(one.expires, by->at) > 0))
        return errinfo_set(e, ST_ENOTFOUND, "subject %s has not expired", subject);
    return ST_OK;
}

/* Of a row that is still there. */
static enum status remember_erased(struct store_sqlite_conn *c,
                                   const struct store_act *by, int64_t row,
                                   struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_ERASED_NOTE, &stmt, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, row) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, by->at) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot erase a subject", e);
    return store_sqlite_run(c, stmt, e);
}

static enum status read_id(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                           void *out, struct errinfo *e)
{
    char *id = out;

    (void)c;
    (void)e;
    if (!store_sqlite_text(stmt, 0, id, STORE_ID_LEN + 1) || !store_id_valid(id)) {
        memset(id, '?', STORE_ID_LEN); /* no reason to keep it */
        id[STORE_ID_LEN] = '\0';
    }
    return ST_OK;
}

static enum status list_templates(struct store_sqlite_conn *c, int64_t row,
                                  struct store_receipt *out, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    void *list = NULL;
    size_t n = 0;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_IDS, &stmt, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, row) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot read the templates", e);
    st = store_sqlite_rows(c, stmt, read_id, sizeof *out->template_id,
                           "cannot read the templates", &list, &n, e);
    out->template_id = list;
    out->templates = (uint32_t)n;
    return st;
}

/* The receipt of what has just been done, while the transaction is open. */
static enum status give_receipt(struct store_sqlite_conn *c, const struct store_act *by,
                                const char *subject, struct store_receipt *out,
                                struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    const enum status st = store_sqlite_event_end(c, &out->seq, hash, e);

    if (st != ST_OK)
        return st;
    (void)sodium_bin2hex(out->hash, sizeof out->hash, hash, sizeof hash);
    memcpy(out->subject, subject, strlen(subject) + 1);
    memcpy(out->at, by->at, sizeof out->at);
    store_receipt_sign(c->vault, out);
    return ST_OK;
}

enum status store_sqlite_subject_delete(struct store *s, const struct store_act *by,
                                        const char *subject, bool due,
                                        struct store_receipt *out, struct errinfo *e)
{
    struct store_sqlite_person p = {0};
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if (((st = store_sqlite_subject_find(c, subject, &p, e)) != ST_OK &&
         (st != ST_ECORRUPT || p.row == 0)) ||
        (st = may_erase(c, by, subject, due, e)) != ST_OK ||
        (st = list_templates(c, p.row, out, e)) != ST_OK ||
        (st = remember_erased(c, by, p.row, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_SUBJECT_DELETE, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, p.row) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot delete a subject", e);
    else if ((st = store_sqlite_run(c, stmt, e)) == ST_OK &&
             (st = store_sqlite_event_add(c, by, "delete_subject", subject, "", "deleted",
                                          e)) == ST_OK)
        st = give_receipt(c, by, subject, out, e);
out:
    sodium_memzero(&p, sizeof p);
    st = store_sqlite_written(s, st, e);
    if (st == ST_OK)
        store_sqlite_erase_log(s);
    return st;
}
