#include "rows_template.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "ident.h"
#include "mesh.h"
#include "sql_read.h"

#define COLUMNS                                                                          \
    "t.id, t.revision, t.uid, t.used, t.read, t.created, t.engine, t.points, "           \
    "t.triangles, t.about, t.mac"

enum { /* of COLUMNS */
       COL_ID,
       COL_REVISION,
       COL_UID,
       COL_USED,
       COL_READ,
       COL_CREATED,
       COL_ENGINE,
       COL_POINTS,
       COL_TRIANGLES,
       COL_ABOUT,
       COL_MAC,
       COLS
};

const struct rows_table rows_templates = {
    .name = "templates",
    .all = "SELECT " COLUMNS ", t.template_key FROM templates t ORDER BY t.template_key",
    .remove = {"DELETE FROM templates WHERE template_key = $1"},
    .columns = COL_MAC,
    .id = COL_ID,
};

#define DIGEST 32

/* ---- what is encrypted, under the subject's key */

#define LABEL_MAX 128

/* Of the description, and of the face, which is bound to the row's revision: the row, with its MAC,
 * does not say anything else of it. */
static size_t label_of(const struct rows_template *row, const struct rows_subject *of,
                       bool face, unsigned char out[LABEL_MAX])
{
    unsigned char *to = out;

    bytes_put(&to, face ? "surface face  2" : "surface about 2", 16);
    bytes_put(&to, of->one.uid, STORE_UID);
    bytes_put_text(&to, row->one.id);
    if (face)
        bytes_put_number(&to, (uint64_t)row->revision, 8);
    return (size_t)(to - out);
}

static void put_digest(unsigned char **to, const char *hex)
{
    unsigned char digest[DIGEST] = {0};

    (void)sodium_hex2bin(digest, sizeof digest, hex, strlen(hex), NULL, NULL, NULL);
    bytes_put(to, digest, sizeof digest);
}

static bool get_digest(struct bytes *b, char hex[65])
{
    unsigned char digest[DIGEST];
    const bool ok = bytes_get(b, digest, sizeof digest);

    hex[0] = '\0';
    if (ok && !sodium_is_zero(digest, sizeof digest))
        (void)sodium_bin2hex(hex, 65, digest, sizeof digest);
    return ok;
}

static size_t encrypt(const struct rows_template *row, const struct rows_subject *of,
                      unsigned char out[ROWS_ABOUT])
{
    unsigned char label[LABEL_MAX], plain[ROWS_ABOUT], *to = plain;
    const size_t nlabel = label_of(row, of, false, label);
    const struct store_template *t = &row->one;
    size_t n;

    bytes_put_text(&to, t->label);
    put_digest(&to, t->digest);
    put_digest(&to, row->read);
    bytes_put_number(&to, row->number, 8);
    bytes_put_number(&to, t->manager, 1);
    bytes_put_real(&to, t->first_score);
    bytes_put_real(&to, t->quality.score);
    bytes_put_real(&to, t->quality.coverage);
    bytes_put_real(&to, t->quality.density_mm);
    bytes_put_real(&to, t->quality.noise_mm);
    n = (size_t)(to - plain);
    crypt_encrypt(of->key, label, nlabel, plain, n, out);
    sodium_memzero(plain, n);
    return n + CRYPT_OVER;
}

static bool decrypt(struct rows_template *row, const struct rows_subject *of,
                    const void *in, size_t n)
{
    unsigned char label[LABEL_MAX], plain[ROWS_ABOUT];
    const size_t nlabel = label_of(row, of, false, label);
    struct store_template *t = &row->one;
    struct bytes b = {plain, plain};
    uint64_t manager = 0;
    bool ok;

    if (n < CRYPT_OVER || n > ROWS_ABOUT ||
        !crypt_decrypt(of->key, label, nlabel, in, n, plain))
        return false;
    b.end += n - CRYPT_OVER;
    ok = bytes_get_text(&b, t->label, sizeof t->label) && get_digest(&b, t->digest) &&
         get_digest(&b, row->read) && bytes_get_number(&b, 8, &row->number) &&
         bytes_get_number(&b, 1, &manager) && manager <= 1 &&
         bytes_get_finite(&b, &t->first_score) &&
         bytes_get_real(&b, 1, &t->quality.score) &&
         bytes_get_real(&b, 1, &t->quality.coverage) &&
         bytes_get_real(&b, 1e6, &t->quality.density_mm) &&
         bytes_get_real(&b, 1e6, &t->quality.noise_mm) && b.at == b.end;
    t->manager = manager != 0;
    sodium_memzero(plain, n - CRYPT_OVER);
    return ok;
}

static enum status decrypt_face(const struct rows_template *row,
                                const struct rows_subject *of, const struct sql_rows *r,
                                int col, unsigned char **face, size_t *len,
                                struct errinfo *e)
{
    unsigned char label[LABEL_MAX];
    const size_t nlabel = label_of(row, of, true, label);
    size_t n;
    const void *stored = sql_read_blob(r, col, CRYPT_OVER + 1, SIZE_MAX, &n);

    *face = NULL;
    *len = 0;
    if (stored == NULL)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its face is missing",
                           row->one.id);
    if ((*face = malloc(n)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if (crypt_decrypt(of->key, label, nlabel, stored, n, *face)) {
        *len = n - CRYPT_OVER;
        return ST_OK;
    }
    free(*face);
    *face = NULL;
    return errinfo_set(e, ST_ECORRUPT, "template %s: its face is not authentic",
                       row->one.id);
}

/* ---- reading */

static bool read_plain(const struct log_txn *t, const struct sql_rows *r,
                       struct rows_template *out, unsigned char uid[STORE_UID])
{
    struct store_template *one = &out->one;

    memset(out, 0, sizeof *out);
    return rows_table_is(t, &rows_templates, r, 0, out->mac) &&
           sql_read_text(r, COL_ID, one->id, sizeof one->id) && ident_id_valid(one->id) &&
           sql_read_int(r, COL_REVISION, 1, &out->revision) &&
           sql_read_bytes(r, COL_UID, uid, STORE_UID) &&
           sql_read_text(r, COL_CREATED, one->created, sizeof one->created) &&
           sql_read_text(r, COL_ENGINE, one->engine, sizeof one->engine) &&
           sql_read_count(r, COL_POINTS, MESH_MAX_POINTS, &one->points) &&
           sql_read_count(r, COL_TRIANGLES, 2 * (int64_t)one->points, &one->triangles);
}

static enum status damaged(const struct sql_rows *r, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1];

    return errinfo_set(
        e, ST_ECORRUPT, "template %s: its row is not authentic",
        sql_read_text(r, COL_ID, id, sizeof id) && ident_id_valid(id) ? id : "?");
}

/* A row of the subject `of`. */
static enum status read_row(const struct log_txn *t, const struct sql_rows *r,
                            const struct rows_subject *of, struct rows_template *out,
                            struct errinfo *e)
{
    unsigned char uid[STORE_UID];
    const void *about;
    size_t n;

    if (!read_plain(t, r, out, uid) || memcmp(uid, of->one.uid, sizeof uid) != 0 ||
        (about = sql_read_blob(r, COL_ABOUT, 1, ROWS_ABOUT, &n)) == NULL ||
        !decrypt(out, of, about, n))
        return damaged(r, e);
    memcpy(out->one.subject, of->one.id, sizeof out->one.subject);
    return ST_OK;
}

enum status rows_template_get(struct log_txn *t, const char *id,
                              struct rows_template *out, struct rows_subject *of,
                              struct errinfo *e)
{
    unsigned char uid[STORE_UID];
    struct sql_rows *r;
    bool found;
    enum status st =
        SQL_QUERY(t->sql, &r, e, "SELECT " COLUMNS " FROM templates t WHERE t.id = $1",
                  sql_text(id));

    memset(out, 0, sizeof *out);
    memset(of, 0, sizeof *of);
    if ((found = st == ST_OK && sql_next(r))) {
        if (!sql_read_bytes(r, COL_UID, uid, sizeof uid))
            st = damaged(r, e);
        else if ((st = rows_subject_get(t, uid, of, e)) == ST_OK &&
                 (st = read_row(t, r, of, out, e)) == ST_OK &&
                 strcmp(out->one.id, id) != 0)
            st = damaged(r, e);
        else if (st == ST_ENOTFOUND)
            st = errinfo_set(e, ST_ECORRUPT, "template %s: its subject is missing", id);
    }
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ENOTFOUND, "there is no template %s", id);
}

struct listing {
    const struct log_txn *t;
    const struct rows_subject *of;
};

static enum status list_row(void *arg, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    const struct listing *l = arg;

    return read_row(l->t, r, l->of, out, e);
}

/* Neither the rows' keys, which nothing authenticates, nor the clock say which is the oldest. */
static int by_number(const void *a, const void *b)
{
    const struct rows_template *p = a, *q = b;

    return (p->number > q->number) - (p->number < q->number);
}

static enum status list(struct log_txn *t, const struct rows_subject *of,
                        struct rows_template **out, size_t *n, struct errinfo *e)
{
    struct listing l = {t, of};
    struct sql_rows *r;
    void *rows = NULL;
    enum status st =
        SQL_QUERY(t->sql, &r, e, "SELECT " COLUMNS " FROM templates t WHERE t.uid = $1",
                  sql_blob(of->one.uid, STORE_UID));

    st = sql_read_list(r, st, list_row, &l, sizeof **out, &rows, n, e);
    *out = rows;
    if (*n > 1)
        qsort(*out, *n, sizeof **out, by_number);
    return st;
}

static void sum_of(const struct log_txn *t, const struct rows_template *row, size_t n,
                   unsigned char sum[LOG_DIGEST])
{
    memset(sum, 0, LOG_DIGEST);
    for (size_t i = 0; i < n; i++)
        log_txn_add(t->crypt, row[i].mac, sum);
}

enum status rows_template_list(struct log_txn *t, const struct rows_subject *of,
                               struct rows_template **out, size_t *n, struct errinfo *e)
{
    unsigned char sum[LOG_DIGEST];
    const enum status st = list(t, of, out, n, e);

    if (st != ST_OK)
        return st;
    sum_of(t, *out, *n, sum);
    if (sodium_memcmp(sum, of->templates, sizeof sum) == 0)
        return ST_OK;
    free(*out);
    *out = NULL;
    *n = 0;
    return errinfo_set(e, ST_ECORRUPT,
                       "subject %s: its templates are not those that it has: one was "
                       "removed, hidden, doubled or put back",
                       of->one.id);
}

/* ---- by what the scan was */

/* A keyed hash of the digest, for this subject alone. */
static void hash_digest(const struct log_txn *t, const char *what,
                        const struct rows_subject *of, const char *digest,
                        unsigned char out[CRYPT_HASH])
{
    unsigned char data[STORE_UID + 2 * DIGEST] = {0};

    memcpy(data, of->one.uid, STORE_UID);
    memcpy(data + STORE_UID, digest, strnlen(digest, (size_t)2 * DIGEST));
    crypt_lookup(t->crypt, what, data, sizeof data, out);
}

enum status rows_template_same(struct log_txn *t, const struct rows_subject *of,
                               const char *used, const char *read,
                               char id[STORE_ID_LEN + 1], struct errinfo *e)
{
    unsigned char by_used[CRYPT_HASH], by_read[CRYPT_HASH];
    struct sql_rows *r;
    enum status st;

    hash_digest(t, "used", of, used, by_used);
    hash_digest(t, "read", of, read[0] != '\0' ? read : "unknown", by_read);
    id[0] = '\0';
    st = SQL_QUERY(t->sql, &r, e,
                   "SELECT t.id FROM templates t WHERE t.uid = $1 "
                   "AND (t.used = $2 OR t.read = $3) LIMIT 1",
                   sql_blob(of->one.uid, STORE_UID), sql_blob(by_used, sizeof by_used),
                   sql_blob(by_read, sizeof by_read));
    if (st == ST_OK && sql_next(r) &&
        (!sql_read_text(r, 0, id, STORE_ID_LEN + 1) || !ident_id_valid(id)))
        st = errinfo_set(e, ST_ECORRUPT, "a template's row is not authentic");
    return sql_done(r, st, e);
}

/* ---- faces */

void rows_template_wipe(unsigned char *face, size_t len)
{
    if (face != NULL)
        sodium_memzero(face, len);
    free(face);
}

enum status rows_template_face(struct log_txn *t, const struct rows_template *row,
                               const struct rows_subject *of, unsigned char **face,
                               size_t *len, struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT f.face FROM templates t JOIN faces f USING (template_key) "
                  "WHERE t.id = $1",
                  sql_text(row->one.id));

    *face = NULL;
    *len = 0;
    if ((found = st == ST_OK && sql_next(r)))
        st = decrypt_face(row, of, r, 0, face, len, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ECORRUPT, "template %s: its face is missing",
                             row->one.id);
}

/* Of so many shares the one that a row is in: by its key, so that no writer moves it into
 * another meanwhile, and 64 that lie together at a time.  A negative key has one too. */
#define SHARE "(t.template_key >> 6 & 9223372036854775807) % $2"

enum status rows_template_each(struct log_txn *t, unsigned part, unsigned parts,
                               rows_template_use *use,
                               void (*report)(void *arg, const char *line), void *arg,
                               struct errinfo *e)
{
    struct rows_template row;
    struct rows_subject of;
    struct errinfo why;
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT " COLUMNS ", " ROWS_SUBJECT ", f.face FROM templates t "
                  "LEFT JOIN subjects s ON s.uid = t.uid "
                  "LEFT JOIN faces f ON f.template_key = t.template_key "
                  "WHERE " SHARE " = $1 ORDER BY t.template_key",
                  sql_int(part), sql_int(parts));

    while (st == ST_OK && sql_next(r)) {
        unsigned char *face = NULL;
        size_t len = 0;
        enum status one = rows_subject_read(t, r, COLS, &of, &why);

        if (one == ST_OK && (one = read_row(t, r, &of, &row, &why)) == ST_OK &&
            (one = decrypt_face(&row, &of, r, COLS + ROWS_SUBJECT_N, &face, &len,
                                &why)) == ST_OK)
            one = use(arg, &row, &of, face, len, &why);
        rows_template_wipe(face, len);
        if (one == ST_ECORRUPT)
            report(arg, why.msg);
        else if (one != ST_OK)
            st = errinfo_set(e, one, "%s", why.msg);
    }
    sodium_memzero(&of, sizeof of);
    return sql_done(r, st, e);
}

/* ---- writing */

struct columns { /* what the values point into */
    unsigned char used[CRYPT_HASH], read[CRYPT_HASH], about[ROWS_ABOUT];
    struct sql_value v[COL_MAC + 2];
};

static void set_values(const struct log_txn *t, const struct rows_template *row,
                       const struct rows_subject *of, struct columns *c)
{
    const struct store_template *one = &row->one;
    const size_t n = encrypt(row, of, c->about);

    hash_digest(t, "used", of, one->digest, c->used);
    hash_digest(t, "read", of, row->read, c->read);
    c->v[COL_ID] = sql_text(one->id);
    c->v[COL_REVISION] = sql_int(row->revision);
    c->v[COL_UID] = sql_blob(of->one.uid, STORE_UID);
    c->v[COL_USED] = sql_blob(c->used, sizeof c->used);
    c->v[COL_READ] = sql_blob(c->read, sizeof c->read);
    c->v[COL_CREATED] = sql_text(one->created);
    c->v[COL_ENGINE] = sql_text(one->engine);
    c->v[COL_POINTS] = sql_int(one->points);
    c->v[COL_TRIANGLES] = sql_int(one->triangles);
    c->v[COL_ABOUT] = sql_blob(c->about, n);
}

static enum status put_face(struct log_txn *t, const struct rows_template *row,
                            const struct rows_subject *of, const void *face, size_t len,
                            const char *text, struct errinfo *e)
{
    unsigned char label[LABEL_MAX], *stored = malloc(len + CRYPT_OVER);
    enum status st;

    if (stored == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    crypt_encrypt(of->key, label, label_of(row, of, true, label), face, len, stored);
    st = SQL_RUN(t->sql, e, text, sql_text(row->one.id),
                 sql_blob(stored, len + CRYPT_OVER));
    free(stored);
    return st;
}

/* A template's row of one MAC is gone, one of another is there; NULL for neither. */
static enum status recount(struct log_txn *t, struct rows_subject *of,
                           const unsigned char *minus, const unsigned char *plus,
                           struct errinfo *e)
{
    if (minus != NULL)
        log_txn_subtract(t->crypt, minus, of->templates);
    if (plus != NULL)
        log_txn_add(t->crypt, plus, of->templates);
    return rows_subject_write(t, of, e);
}

enum status rows_template_add(struct log_txn *t, struct rows_subject *of,
                              struct rows_template *row, const void *face, size_t len,
                              struct errinfo *e)
{
    struct columns c;
    enum status st;

    row->revision = 1;
    row->number = ++of->added;
    set_values(t, row, of, &c);
    if ((st = rows_table_insert(
             t, &rows_templates,
             "INSERT INTO templates (id, revision, uid, used, read, created, "
             "engine, points, triangles, about, mac) "
             "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
             c.v, row->mac, e)) != ST_OK ||
        (st = put_face(t, row, of, face, len,
                       "INSERT INTO faces (template_key, face) VALUES "
                       "((SELECT template_key FROM templates WHERE id = $1), $2)",
                       e)) != ST_OK)
        return st;
    return recount(t, of, NULL, row->mac, e);
}

enum status rows_template_write(struct log_txn *t, struct rows_subject *of,
                                struct rows_template *row, const void *face, size_t len,
                                struct errinfo *e)
{
    unsigned char old[CRYPT_HASH];
    struct columns c;
    enum status st;

    memcpy(old, row->mac, sizeof old);
    row->revision++;
    set_values(t, row, of, &c);
    if ((st =
             rows_table_update(t, &rows_templates,
                               "UPDATE templates SET revision = $2, uid = $3, used = $4, "
                               "read = $5, created = $6, engine = $7, points = $8, "
                               "triangles = $9, about = $10, mac = $11 "
                               "WHERE id = $1 AND mac = $12",
                               c.v, row->mac, e)) != ST_OK ||
        (st = put_face(t, row, of, face, len,
                       "UPDATE faces SET face = $2 WHERE template_key = "
                       "(SELECT template_key FROM templates WHERE id = $1)",
                       e)) != ST_OK)
        return st;
    return recount(t, of, old, row->mac, e);
}

enum status rows_template_drop(struct log_txn *t, const struct rows_template *row,
                               struct errinfo *e)
{
    return rows_table_delete(t, "DELETE FROM templates WHERE id = $1 AND mac = $2",
                             sql_text(row->one.id), row->mac, e);
}

enum status rows_template_delete(struct log_txn *t, struct rows_subject *of,
                                 const struct rows_template *row, struct errinfo *e)
{
    const enum status st = rows_template_drop(t, row, e);

    return st == ST_OK ? recount(t, of, row->mac, NULL, e) : st;
}

enum status rows_template_accept(struct log_txn *t, struct rows_subject *of,
                                 struct errinfo *e)
{
    struct rows_template *row = NULL;
    unsigned char sum[LOG_DIGEST];
    size_t n;
    enum status st = list(t, of, &row, &n, e);

    if (st != ST_OK)
        return st;
    sum_of(t, row, n, sum);
    free(row);
    if (memcmp(sum, of->templates, sizeof sum) == 0)
        return ST_OK;
    memcpy(of->templates, sum, sizeof sum);
    return rows_subject_write(t, of, e);
}
