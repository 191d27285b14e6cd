#include "row_subject.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_column.h"
#include "store_mac.h"
#include "store_rules.h"
#include "store_txn.h"

enum { /* the columns of ROW_SUBJECT_WHO, from the first of them on */
       COL_UID,
       COL_LOOKUP,
       COL_ABOUT,
       COL_CREATED,
       COL_EXPIRES,
       COL_HOLD,
       COL_DISABLED,
       COL_TEMPLATES,
       COL_KEY, /* the MAC is of all before it */
       COL_SEEN
};

static const char label[16] = "surface subject";

static bool read_key(const struct store_txn *t, const struct sql_rows *r, int col,
                     struct row_crypt_key *k)
{
    unsigned char uid[ROW_CRYPT_UID], wrapped[VAULT_WRAPPED];

    return store_column_bytes(r, col + COL_UID, uid, sizeof uid) &&
           store_column_bytes(r, col + COL_KEY, wrapped, sizeof wrapped) &&
           row_crypt_key(t->vault, uid, wrapped, k);
}

static bool read_who(const struct store_txn *t, const struct sql_rows *r, int col,
                     struct store_subject *s, struct row_crypt_key *k)
{
    uint32_t hold = 0, disabled = 0;
    const void *about;
    size_t n;

    memset(s, 0, sizeof *s);
    if (!store_column_text(r, col + COL_CREATED, s->created, sizeof s->created) ||
        !store_column_text_or(r, col + COL_EXPIRES, s->expires, sizeof s->expires) ||
        !store_column_text_or(r, col + COL_SEEN, s->seen, sizeof s->seen) ||
        !store_column_count(r, col + COL_HOLD, 1, &hold) ||
        !store_column_count(r, col + COL_DISABLED, 1, &disabled) ||
        !store_column_count(r, col + COL_TEMPLATES, UINT32_MAX, &s->templates) ||
        (about = store_column_blob(r, col + COL_ABOUT, 1, ROW_CRYPT_ABOUT, &n)) == NULL ||
        !read_key(t, r, col, k))
        return false;
    s->hold = hold != 0;
    s->disabled = disabled != 0;
    memcpy(s->uid, k->uid, sizeof s->uid);
    return row_crypt_decrypt_subject(k, about, n, s);
}

static void left_of(const struct store_txn *t, const struct sql_rows *r, int col,
                    struct row_event_row *left)
{
    memset(left, 0, sizeof *left);
    left->gone = !store_column_bytes(r, col + COL_UID, left->object, sizeof left->object);
    store_mac_row(t->vault, label, r, col, COL_KEY, left->mac);
}

enum status row_subject_who(struct store_txn *t, const struct sql_rows *r, int col,
                            struct store_subject *s, struct row_crypt_key *k,
                            struct errinfo *e)
{
    struct row_event_row now;
    enum status st;

    if (!read_who(t, r, col, s, k))
        return errinfo_set(e, ST_ECORRUPT, "a subject's row is damaged");
    left_of(t, r, col, &now);
    if (t->how == SQL_READ && memcmp(now.mac, t->good, sizeof now.mac) == 0)
        return ST_OK; /* as for the template before, of the same moment */
    if ((st = row_event_is(t, &now, e)) == ST_ECORRUPT)
        (void)errinfo_set(e, st, "a subject's row is not the one that was written last");
    else if (st == ST_OK)
        memcpy(t->good, now.mac, sizeof now.mac);
    return st;
}

enum status row_subject_row(void *t, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct store_subject *s = out;
    struct row_crypt_key k = {0};
    const int64_t row = sql_column(r, 0).i;
    struct errinfo why;
    const enum status st = row_subject_who(t, r, 1, s, &k, &why);

    sodium_memzero(&k, sizeof k);
    if (st != ST_OK)
        return errinfo_set(e, st, "%s (row %lld)", why.msg, (long long)row);
    s->key = row;
    return ST_OK;
}

enum status row_subject_tell(struct store_txn *t, const struct store_act *by,
                             const char *kind, const char *subject,
                             const struct row_subject *p, const char *outcome,
                             struct errinfo *e)
{
    struct row_event_row left = {.gone = true};
    struct sql_rows *r;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT " ROW_SUBJECT_WHO " FROM subjects s "
                               "WHERE s.subject_key = $1",
                               sql_int(p->row));

    if (st == ST_OK && sql_next(r))
        left_of(t, r, 0, &left);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    return row_event_leave(t, by, kind, subject, "", outcome, &left, e);
}

enum status row_subject_each(struct store_txn *t, row_event_see *see, void *arg,
                             struct errinfo *e)
{
    struct row_event_row now;
    struct sql_rows *r;
    char name[48];
    enum status st =
        sql_query(t->sql, "SELECT s.subject_key, " ROW_SUBJECT_WHO " FROM subjects s",
                  NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        left_of(t, r, 1, &now);
        (void)snprintf(name, sizeof name, "a subject (row %lld)",
                       (long long)sql_column(r, 0).i);
        st = see(arg, &now, name, e);
    }
    return sql_done(r, st, e);
}

struct sql_value row_subject_lookup(const struct store_txn *t, const char *subject,
                                    unsigned char out[VAULT_HASH])
{
    row_crypt_lookup(t->vault, subject, out);
    return sql_blob(out, VAULT_HASH);
}

/* What a row is found by is not authenticated with it: two may have been exchanged. */
static enum status not_theirs(const char *subject, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT, "subject %s: the row found is another subject's",
                       subject);
}

/* Nobody erased one who is not found but should be there. */
static enum status not_found(struct store_txn *t, const char *subject, struct errinfo *e)
{
    struct row_event_row row;
    const enum status st = row_event_named(t, subject, &row, e);

    if (st != ST_OK)
        return st;
    return row.gone
               ? errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject)
               : errinfo_set(e, ST_ECORRUPT,
                             "subject %s: its row is missing, although nobody erased it",
                             subject);
}

enum status row_subject_find(struct store_txn *t, const char *subject,
                             struct row_subject *p, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    struct store_subject who;
    struct errinfo why;
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT s.subject_key, " ROW_SUBJECT_WHO
                               " FROM subjects s WHERE s.lookup = $1",
                               row_subject_lookup(t, subject, lookup));

    if ((found = st == ST_OK && sql_next(r))) {
        p->row = sql_column(r, 0).i;
        if ((st = row_subject_who(t, r, 1, &who, &p->key, &why)) != ST_OK) {
            st = errinfo_set(e, st, "subject %s: %s", subject, why.msg);
        } else if (strcmp(who.id, subject) != 0) {
            p->row = 0;
            st = not_theirs(subject, e);
        }
        p->templates = who.templates;
    }
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st : not_found(t, subject, e);
}

/* The one row of a query for "s.subject_key, " ROW_SUBJECT_WHO. */
static enum status only(struct store_txn *t, struct sql_rows *r, enum status st,
                        struct row_subject *p, struct store_subject *who,
                        struct errinfo *e)
{
    const bool found = st == ST_OK && sql_next(r);

    memset(who, 0, sizeof *who);
    if (found) {
        p->row = sql_column(r, 0).i;
        if ((st = row_subject_who(t, r, 1, who, &p->key, e)) != ST_OK)
            memset(who, 0, sizeof *who);
        p->templates = who->templates;
    }
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ENOTFOUND, "there is no such subject");
}

enum status row_subject_same(struct store_txn *t, const unsigned char uid[STORE_UID],
                             struct row_subject *p, struct store_subject *who,
                             struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = SQL_QUERY(t->sql, &r, e,
                                     "SELECT s.subject_key, " ROW_SUBJECT_WHO
                                     " FROM subjects s WHERE s.uid = $1",
                                     sql_blob(uid, STORE_UID));

    return only(t, r, st, p, who, e);
}

enum status row_subject_of(struct store_txn *t, const char *template_id,
                           struct row_subject *p, struct store_subject *who,
                           struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = SQL_QUERY(t->sql, &r, e,
                                     "SELECT s.subject_key, " ROW_SUBJECT_WHO
                                     " FROM subjects s JOIN templates t "
                                     "USING (subject_key) WHERE t.id = $1",
                                     sql_text(template_id));

    return only(t, r, st, p, who, e);
}

enum status row_subject_read(struct store_txn *t, const char *subject,
                             struct store_subject *out, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    struct sql_rows *r;
    bool found;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT " ROW_SUBJECT_COLUMNS " FROM subjects s WHERE s.lookup = $1",
                  row_subject_lookup(t, subject, lookup));

    if ((found = st == ST_OK && sql_next(r)) &&
        (st = row_subject_row(t, r, out, e)) == ST_OK && strcmp(out->id, subject) != 0)
        st = not_theirs(subject, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st : not_found(t, subject, e);
}

enum status row_subject_add(struct store_txn *t, const struct store_subject *about,
                            struct row_subject *p, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH], wrapped[VAULT_WRAPPED], about_it[ROW_CRYPT_ABOUT];
    struct sql_rows *r;
    size_t n;
    enum status st;

    row_crypt_new(t->vault,
                  sodium_is_zero(about->uid, sizeof about->uid) ? NULL : about->uid,
                  &p->key, wrapped);
    n = row_crypt_encrypt_subject(&p->key, about, about_it);
    st = SQL_QUERY(
        t->sql, &r, e,
        "INSERT INTO subjects (lookup, uid, key, about, created, expires, "
        "seen, hold, disabled, templates) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10) RETURNING subject_key",
        row_subject_lookup(t, about->id, lookup), sql_blob(p->key.uid, sizeof p->key.uid),
        sql_blob(wrapped, sizeof wrapped), sql_blob(about_it, n),
        sql_text(about->created), sql_text_or_null(about->expires),
        sql_text_or_null(about->seen), sql_int(about->hold), sql_int(about->disabled),
        sql_int(about->templates));
    p->templates = about->templates;
    while (st == ST_OK && sql_next(r))
        p->row = sql_column(r, 0).i;
    return sql_done(r, st, e);
}

enum status row_subject_write(struct store_txn *t, const struct row_subject *p,
                              const struct store_subject *one, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH], about[ROW_CRYPT_ABOUT];
    const size_t n = row_crypt_encrypt_subject(&p->key, one, about);

    return SQL_RUN(t->sql, e,
                   "UPDATE subjects SET lookup = $2, about = $3, expires = $4, "
                   "hold = $5, disabled = $6 WHERE subject_key = $1",
                   sql_int(p->row), row_subject_lookup(t, one->id, lookup),
                   sql_blob(about, n), sql_text_or_null(one->expires), sql_int(one->hold),
                   sql_int(one->disabled));
}

enum status row_subject_count(struct store_txn *t, const struct store_act *by,
                              const char *subject, const struct row_subject *p, int more,
                              struct errinfo *e)
{
    const int64_t now = (int64_t)p->templates + more;
    char outcome[24];
    const enum status st =
        SQL_RUN(t->sql, e, "UPDATE subjects SET templates = $2 WHERE subject_key = $1",
                sql_int(p->row), sql_int(now));

    (void)snprintf(outcome, sizeof outcome, "%lld", (long long)now);
    return st == ST_OK
               ? row_subject_tell(t, by, "count_templates", subject, p, outcome, e)
               : st;
}

enum status row_subject_renew(struct store_txn *t, const struct row_subject *p,
                              const struct store_subject *one,
                              const unsigned char wrapped[VAULT_WRAPPED],
                              struct errinfo *e)
{
    const enum status st = row_subject_write(t, p, one, e);

    return st == ST_OK
               ? SQL_RUN(t->sql, e, "UPDATE subjects SET key = $2 WHERE subject_key = $1",
                         sql_int(p->row), sql_blob(wrapped, VAULT_WRAPPED))
               : st;
}

enum status row_subject_seen(struct store_txn *t, const char *subject, const char *at,
                             struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];

    return SQL_RUN(t->sql, e, "UPDATE subjects SET seen = $2 WHERE lookup = $1",
                   row_subject_lookup(t, subject, lookup), sql_text(at));
}

enum status row_subject_delete(struct store_txn *t, int64_t row, struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "DELETE FROM subjects WHERE subject_key = $1",
                   sql_int(row));
}
