#include "rows_subject.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "ident.h"
#include "sql_read.h"

enum { /* the columns of ROWS_SUBJECT */
       COL_UID,
       COL_REVISION,
       COL_LOOKUP,
       COL_KEY,
       COL_ABOUT,
       COL_CREATED,
       COL_EXPIRES,
       COL_HOLD,
       COL_DISABLED,
       COL_MAC,
       COL_SEEN,
       COL_ROW,
       COL_TEMPLATES
};

const struct rows_table rows_subjects = {
    .name = "subjects",
    .all = "SELECT uid, revision, lookup, key, about, created, expires, hold, disabled, "
           "mac, subject_key FROM subjects ORDER BY subject_key",
    .remove = {"DELETE FROM templates WHERE uid = "
               "(SELECT uid FROM subjects WHERE subject_key = $1)",
               "DELETE FROM subjects WHERE subject_key = $1"},
    .columns = COL_MAC,
    .id = -1,
};

static const char key_label[16] = "surface key   2";

/* ---- what is encrypted: id, reference, purpose, and the digest of the templates */

#define LABEL_ABOUT (16 + STORE_UID)

static void about_label(const unsigned char uid[STORE_UID],
                        unsigned char out[LABEL_ABOUT])
{
    memcpy(out, "surface who   2", 16);
    memcpy(out + 16, uid, STORE_UID);
}

static size_t encrypt(const struct rows_subject *p, unsigned char out[ROWS_ABOUT])
{
    unsigned char label[LABEL_ABOUT], plain[ROWS_ABOUT], *to = plain;
    size_t n;

    about_label(p->one.uid, label);
    bytes_put_text(&to, p->one.id);
    bytes_put_text(&to, p->one.reference);
    bytes_put_text(&to, p->one.purpose);
    bytes_put(&to, p->templates, sizeof p->templates);
    bytes_put_number(&to, p->added, 8);
    n = (size_t)(to - plain);
    crypt_encrypt(p->key, label, sizeof label, plain, n, out);
    sodium_memzero(plain, n);
    return n + CRYPT_OVER;
}

static bool decrypt(struct rows_subject *p, const void *in, size_t n)
{
    unsigned char label[LABEL_ABOUT], plain[ROWS_ABOUT];
    struct bytes b = {plain, plain};
    bool ok;

    about_label(p->one.uid, label);
    if (n < CRYPT_OVER || n > ROWS_ABOUT ||
        !crypt_decrypt(p->key, label, sizeof label, in, n, plain))
        return false;
    b.end += n - CRYPT_OVER;
    ok = bytes_get_text(&b, p->one.id, sizeof p->one.id) &&
         ident_subject_valid(p->one.id) &&
         bytes_get_text(&b, p->one.reference, sizeof p->one.reference) &&
         bytes_get_text(&b, p->one.purpose, sizeof p->one.purpose) &&
         bytes_get(&b, p->templates, sizeof p->templates) &&
         bytes_get_number(&b, 8, &p->added) && b.at == b.end;
    sodium_memzero(plain, n - CRYPT_OVER);
    return ok;
}

/* ---- reading */

static bool read_row(const struct log_txn *t, const struct sql_rows *r, int col,
                     struct rows_subject *out)
{
    uint32_t hold = 0, disabled = 0;
    struct store_subject *s = &out->one;
    const void *about;
    size_t n;

    if (!rows_table_is(t, &rows_subjects, r, col, out->mac) ||
        !sql_read_bytes(r, col + COL_UID, s->uid, sizeof s->uid) ||
        !sql_read_int(r, col + COL_REVISION, 1, &out->revision) ||
        !sql_read_bytes(r, col + COL_KEY, out->wrapped, sizeof out->wrapped) ||
        !sql_read_text(r, col + COL_CREATED, s->created, sizeof s->created) ||
        !sql_read_text_or(r, col + COL_EXPIRES, s->expires, sizeof s->expires) ||
        !sql_read_count(r, col + COL_HOLD, 1, &hold) ||
        !sql_read_count(r, col + COL_DISABLED, 1, &disabled) ||
        (about = sql_read_blob(r, col + COL_ABOUT, 1, ROWS_ABOUT, &n)) == NULL ||
        !crypt_unwrap(t->crypt, key_label, s->uid, out->wrapped, out->key) ||
        !decrypt(out, about, n))
        return false;
    s->hold = hold != 0;
    s->disabled = disabled != 0;
    /* Not authenticated: what is no time is none, and a row is there or not. */
    (void)sql_read_text_or(r, col + COL_SEEN, s->seen, sizeof s->seen);
    (void)sql_read_int(r, col + COL_ROW, 0, &s->key);
    (void)sql_read_count(r, col + COL_TEMPLATES, UINT32_MAX, &s->templates);
    return true;
}

enum status rows_subject_read(const struct log_txn *t, const struct sql_rows *r, int col,
                              struct rows_subject *out, struct errinfo *e)
{
    memset(out, 0, sizeof *out);
    if (read_row(t, r, col, out))
        return ST_OK;
    sodium_memzero(out, sizeof *out);
    return errinfo_set(e, ST_ECORRUPT, "a subject's row is not authentic (row %lld)",
                       (long long)sql_column(r, col + COL_ROW).i);
}

struct sql_value rows_subject_lookup(const struct log_txn *t, const char *subject,
                                     unsigned char out[CRYPT_HASH])
{
    crypt_lookup(t->crypt, "subject", subject, strlen(subject), out);
    return sql_blob(out, CRYPT_HASH);
}

/* The one row of a query; ST_ENOTFOUND without a text. */
static enum status only(struct log_txn *t, struct sql_rows *r, enum status st,
                        struct rows_subject *out, bool *found, struct errinfo *e)
{
    if ((*found = st == ST_OK && sql_next(r)))
        st = rows_subject_read(t, r, 0, out, e);
    return sql_done(r, st, e);
}

/* An index is not authenticated: it may lead to another row. */
static enum status misled(struct rows_subject *out, struct errinfo *e)
{
    sodium_memzero(out, sizeof *out);
    return errinfo_set(e, ST_ECORRUPT, "an index of the subjects leads to another one");
}

enum status rows_subject_find(struct log_txn *t, const char *subject,
                              struct rows_subject *out, struct errinfo *e)
{
    unsigned char lookup[CRYPT_HASH];
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(
        t->sql, &r, e, "SELECT " ROWS_SUBJECT " FROM subjects s WHERE s.lookup = $1",
        rows_subject_lookup(t, subject, lookup));

    memset(out, 0, sizeof *out);
    if ((st = only(t, r, st, out, &found, e)) != ST_OK)
        return st;
    if (!found)
        return errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    return strcmp(out->one.id, subject) == 0 ? ST_OK : misled(out, e);
}

enum status rows_subject_get(struct log_txn *t, const unsigned char uid[STORE_UID],
                             struct rows_subject *out, struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT " ROWS_SUBJECT " FROM subjects s WHERE s.uid = $1",
                               sql_blob(uid, STORE_UID));

    memset(out, 0, sizeof *out);
    if ((st = only(t, r, st, out, &found, e)) != ST_OK)
        return st;
    if (!found)
        return errinfo_set(e, ST_ENOTFOUND, "there is no such subject");
    return memcmp(out->one.uid, uid, STORE_UID) == 0 ? ST_OK : misled(out, e);
}

static enum status list_row(void *t, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct rows_subject p;
    const enum status st = rows_subject_read(t, r, 0, &p, e);

    if (st == ST_OK)
        memcpy(out, &p.one, sizeof p.one);
    sodium_memzero(&p, sizeof p);
    return st;
}

static enum status list(struct log_txn *t, struct sql_rows *r, enum status st,
                        struct store_subject **out, size_t *n, struct errinfo *e)
{
    void *rows = NULL;

    st = sql_read_list(r, st, list_row, t, sizeof **out, &rows, n, e);
    *out = rows;
    return st;
}

enum status rows_subject_list(struct log_txn *t, int64_t after, size_t limit,
                              struct store_subject **out, size_t *n, struct errinfo *e)
{
    const int64_t most = limit < INT64_MAX ? (int64_t)limit : INT64_MAX;
    struct sql_rows *r;
    const enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT " ROWS_SUBJECT " FROM subjects s WHERE s.subject_key > $1 "
                  "ORDER BY s.subject_key LIMIT $2",
                  sql_int(after), sql_int(most));

    return list(t, r, st, out, n, e);
}

enum status rows_subject_due(struct log_txn *t, const char *now,
                             struct store_subject **out, size_t *n, struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT " ROWS_SUBJECT " FROM subjects s WHERE s.expires <= $1 "
                  "ORDER BY s.expires, s.subject_key",
                  sql_text(now));

    return list(t, r, st, out, n, e);
}

/* ---- writing */

struct columns { /* what the values point into */
    unsigned char lookup[CRYPT_HASH], about[ROWS_ABOUT];
    struct sql_value v[COL_MAC + 2];
};

static void set_values(const struct log_txn *t, const struct rows_subject *p,
                       struct columns *c)
{
    const size_t n = encrypt(p, c->about);

    c->v[COL_UID] = sql_blob(p->one.uid, sizeof p->one.uid);
    c->v[COL_REVISION] = sql_int(p->revision);
    c->v[COL_LOOKUP] = rows_subject_lookup(t, p->one.id, c->lookup);
    c->v[COL_KEY] = sql_blob(p->wrapped, sizeof p->wrapped);
    c->v[COL_ABOUT] = sql_blob(c->about, n);
    c->v[COL_CREATED] = sql_text(p->one.created);
    c->v[COL_EXPIRES] = sql_text_or_null(p->one.expires);
    c->v[COL_HOLD] = sql_int(p->one.hold);
    c->v[COL_DISABLED] = sql_int(p->one.disabled);
}

enum status rows_subject_add(struct log_txn *t, const struct store_subject *one,
                             struct rows_subject *out, struct errinfo *e)
{
    struct columns c;
    enum status st;

    *out = (struct rows_subject){.one = *one, .revision = 1};
    if (sodium_is_zero(out->one.uid, sizeof out->one.uid))
        randombytes_buf(out->one.uid, sizeof out->one.uid);
    randombytes_buf(out->key, sizeof out->key);
    crypt_wrap(t->crypt, key_label, out->one.uid, out->key, out->wrapped);
    set_values(t, out, &c);
    st = rows_table_insert(t, &rows_subjects,
                           "INSERT INTO subjects (uid, revision, lookup, key, about, "
                           "created, expires, hold, disabled, mac) "
                           "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)",
                           c.v, out->mac, e);
    return st != ST_OK || one->seen[0] == '\0'
               ? st
               : rows_subject_seen(t, out->one.uid, one->seen, e);
}

enum status rows_subject_write(struct log_txn *t, struct rows_subject *p,
                               struct errinfo *e)
{
    struct columns c;

    p->revision++;
    set_values(t, p, &c);
    return rows_table_update(
        t, &rows_subjects,
        "UPDATE subjects SET revision = $2, lookup = $3, key = $4, about = $5, "
        "created = $6, expires = $7, hold = $8, disabled = $9, mac = $10 "
        "WHERE uid = $1 AND mac = $11",
        c.v, p->mac, e);
}

enum status rows_subject_seen(struct log_txn *t, const unsigned char uid[STORE_UID],
                              const char *at, struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "UPDATE subjects SET seen = $2 WHERE uid = $1",
                   sql_blob(uid, STORE_UID), sql_text(at));
}

enum status rows_subject_delete(struct log_txn *t, const struct rows_subject *p,
                                struct errinfo *e)
{
    return rows_table_delete(t, "DELETE FROM subjects WHERE uid = $1 AND mac = $2",
                             sql_blob(p->one.uid, sizeof p->one.uid), p->mac, e);
}
