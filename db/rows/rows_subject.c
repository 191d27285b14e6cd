#include "rows_subject.h"

#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "ident.h"

enum { COL_UID, COL_LOOKUP = 2, COL_MAC = 9, COL_ROW, COL_SEEN, COL_TEMPLATES };

#define F(kind, member) SQL_FIELD(kind, struct rows_subject, member)

static const struct sql_field columns[COL_MAC] = {
    F(BYTES, one.uid),
    F(NUMBER, revision),
    F(BYTES, lookup),
    F(BYTES, wrapped),
    F(BLOB, about),
    F(TEXT, one.created),
    F(TEXT_OR_NULL, one.expires),
    F(BOOL, one.hold),
    F(BOOL, one.disabled),
};

/* What is encrypted in `about`, with the digest of the templates. */
static const struct sql_field about[] = {
    F(TEXT, one.id),  F(TEXT, one.reference), F(TEXT, one.purpose),  F(BYTES, templates),
    F(NUMBER, added), F(TEXT, one.groups),    F(BOOL, one.identify),
};

#define ABOUT (sizeof about / sizeof *about)

static const char key_label[16] = "surface key   2";

static struct sql_field_blob label_of(const struct rows_subject *p)
{
    struct sql_field_blob label = {.n = 16 + STORE_UID};

    memcpy(label.bytes, "surface who   2", 16);
    memcpy(label.bytes + 16, p->one.uid, STORE_UID);
    return label;
}

static bool rows_subject_complete(const struct log_txn *t, const struct sql_rows *r,
                                  int col, void *row)
{
    struct rows_subject *p = row;
    const struct sql_field_blob label = label_of(p);

    if (!crypt_unwrap(t->crypt, key_label, p->one.uid, p->wrapped, p->key) ||
        !rows_table_decrypt(p->key, &label, about, ABOUT, &p->about, p) ||
        !ident_subject_valid(p->one.id) || !groups_valid(p->one.groups))
        return false;
    /* Not authenticated: what is no time is none, and a row is there or not. */
    (void)sql_read_text(r, col + COL_SEEN, p->one.seen, sizeof p->one.seen);
    (void)sql_read_int(r, col + COL_ROW, 0, &p->one.key);
    (void)sql_read_count(r, col + COL_TEMPLATES, UINT32_MAX, &p->one.templates);
    return true;
}

#define REST        "revision, lookup, key, about, created, expires, hold, disabled, mac"
#define REST_VALUES "$2, $3, $4, $5, $6, $7, $8, $9, $10"

const struct rows_table rows_subjects = {
    .name = "subjects",
    .noun = "subject ",
    .all = "SELECT uid, " REST ", subject_key, seen FROM subjects ORDER BY subject_key",
    .insert = "INSERT INTO subjects (uid, " REST ") VALUES ($1, " REST_VALUES ")",
    .update = "UPDATE subjects SET (" REST ") = (" REST_VALUES ") "
              "WHERE uid = $1 AND mac = $11",
    .remove = "DELETE FROM subjects WHERE uid = $1 AND mac = $2",
    .drop = {"DELETE FROM templates WHERE uid = "
             "(SELECT uid FROM subjects WHERE subject_key = $1)",
             "DELETE FROM subjects WHERE subject_key = $1"},
    .columns = COL_MAC,
    .field = columns,
    .mac = offsetof(struct rows_subject, mac),
    .size = sizeof(struct rows_subject),
    .id = -1,
    .complete = rows_subject_complete,
};

/* ---- reading */

static void set_lookup(const struct log_txn *t, const char *subject,
                       unsigned char out[CRYPT_HASH])
{
    crypt_lookup(t->crypt, "subject", subject, strlen(subject), out);
}

enum status rows_subject_find(struct log_txn *t, const char *subject,
                              struct rows_subject *out, struct errinfo *e)
{
    unsigned char lookup[CRYPT_HASH];
    enum status st;

    set_lookup(t, subject, lookup);
    st = rows_table_find(t, &rows_subjects,
                         "SELECT " ROWS_SUBJECT " FROM subjects s WHERE s.lookup = $1",
                         COL_LOOKUP, sql_blob(lookup, sizeof lookup), subject, out, e);
    if (st == ST_OK && !groups_meet(t->groups, out->one.groups)) {
        sodium_memzero(out, sizeof *out);
        st = rows_table_missing(&rows_subjects, subject, e);
    }
    memcpy(out->lookup, lookup, sizeof lookup);
    return st;
}

enum status rows_subject_free(struct log_txn *t, const char *subject, struct errinfo *e)
{
    unsigned char lookup[CRYPT_HASH];
    struct sql_rows *r;
    enum status st;

    set_lookup(t, subject, lookup);
    st = SQL_FIRST(t->sql, &r, e, "SELECT subject_key FROM subjects WHERE lookup = $1",
                   sql_blob(lookup, sizeof lookup));
    if (st == ST_OK)
        st = errinfo_set(e, ST_EEXISTS, "there is a subject %s already", subject);
    st = sql_done(r, st, e);
    return st == ST_ENOTFOUND ? ST_OK : st;
}

enum status rows_subject_get(struct log_txn *t, const unsigned char uid[STORE_UID],
                             struct rows_subject *out, struct errinfo *e)
{
    return rows_table_find(t, &rows_subjects,
                           "SELECT " ROWS_SUBJECT " FROM subjects s WHERE s.uid = $1",
                           COL_UID, sql_blob(uid, STORE_UID), "of this uid", out, e);
}

static enum status rows_subject_list_all(struct log_txn *t, const char *text,
                                         const struct sql_value *v, size_t nv,
                                         struct store_subject **out, size_t *n,
                                         struct errinfo *e)
{
    void *rows;
    const enum status st =
        rows_table_list(t, &rows_subjects, text, v, nv, sizeof **out, &rows, n, e);

    *out = rows;
    return st;
}

enum status rows_subject_list(struct log_txn *t, int64_t after, size_t limit,
                              struct store_subject **out, size_t *n, struct errinfo *e)
{
    const struct sql_value v[] = {
        sql_int(after), sql_int(limit < INT64_MAX ? (int64_t)limit : INT64_MAX)};

    return rows_subject_list_all(t,
                                 "SELECT " ROWS_SUBJECT
                                 " FROM subjects s WHERE s.subject_key > $1 "
                                 "ORDER BY s.subject_key LIMIT $2",
                                 v, 2, out, n, e);
}

enum status rows_subject_due(struct log_txn *t, const char *now,
                             struct store_subject **out, size_t *n, struct errinfo *e)
{
    const struct sql_value v = sql_text(now);

    return rows_subject_list_all(t,
                                 "SELECT " ROWS_SUBJECT
                                 " FROM subjects s WHERE s.expires <= $1 "
                                 "ORDER BY s.expires, s.subject_key",
                                 &v, 1, out, n, e);
}

/* ---- writing */

static void encrypt(const struct log_txn *t, struct rows_subject *p)
{
    const struct sql_field_blob label = label_of(p);

    set_lookup(t, p->one.id, p->lookup);
    rows_table_encrypt(p->key, &label, about, ABOUT, p, &p->about);
}

enum status rows_subject_add(struct log_txn *t, const struct store_subject *one,
                             struct rows_subject *out, struct errinfo *e)
{
    enum status st;

    *out = (struct rows_subject){.one = *one};
    if (sodium_is_zero(out->one.uid, sizeof out->one.uid))
        randombytes_buf(out->one.uid, sizeof out->one.uid);
    randombytes_buf(out->key, sizeof out->key);
    crypt_wrap(t->crypt, key_label, out->one.uid, out->key, out->wrapped);
    encrypt(t, out);
    st = rows_table_insert(t, &rows_subjects, out, e);
    return st != ST_OK || one->seen[0] == '\0'
               ? st
               : rows_subject_seen(t, out->one.uid, one->seen, e);
}

enum status rows_subject_write(struct log_txn *t, struct rows_subject *p,
                               struct errinfo *e)
{
    encrypt(t, p);
    return rows_table_update(t, &rows_subjects, p, e);
}

enum status rows_subject_seen(struct log_txn *t, const unsigned char uid[STORE_UID],
                              const char *at, struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "UPDATE subjects SET seen = $2 WHERE uid = $1",
                   sql_blob(uid, STORE_UID), sql_text(at));
}
