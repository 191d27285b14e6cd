#include "rows_template.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "ident.h"
#include "sql_read.h"

#define COLUMNS                                                                          \
    "t.id, t.revision, t.uid, t.used, t.read, t.created, t.engine, t.points, "           \
    "t.triangles, t.about, t.descriptor, t.mac, t.template_key"

enum { COL_ID, COL_MAC = 11, COLS = 13 };

#define F(kind, member)        SQL_FIELD(kind, struct rows_template, member)
#define REAL(member, min, max) SQL_FIELD_IN(REAL, struct rows_template, member, min, max)

static const struct sql_field columns[COL_MAC] = {
    F(TEXT, one.id),
    F(NUMBER, revision),
    F(BYTES, uid),
    F(BYTES, by_used),
    F(BYTES, by_read),
    F(TEXT, one.created),
    F(TEXT, one.engine),
    SQL_FIELD_IN(COUNT, struct rows_template, one.points, 0, SURFACE_MAX_POINTS),
    F(COUNT, one.triangles),
    F(BLOB, about),
    F(BYTES, descriptor),
};

/* What is encrypted in `about`. */
static const struct sql_field about[] = {
    F(TEXT, one.label),
    F(TEXT, one.digest),
    F(TEXT, one.read),
    F(NUMBER, number),
    F(BOOL, one.manager),
    REAL(one.first_score, -DBL_MAX, DBL_MAX),
    REAL(one.quality.score, 0, 1),
    REAL(one.quality.coverage, 0, 1),
    REAL(one.quality.density_mm, 0, 1e6),
    REAL(one.quality.noise_mm, 0, 1e6),
};

#define ABOUT (sizeof about / sizeof *about)

static bool rows_template_complete(const struct log_txn *t, const struct sql_rows *r,
                                   int col, void *row)
{
    const struct store_template *one = &((struct rows_template *)row)->one;

    (void)t, (void)r, (void)col;
    return ident_id_valid(one->id) && one->triangles <= 2 * (uint64_t)one->points;
}

const struct rows_table rows_templates = {
    .name = "templates",
    .noun = "template ",
    .all = "SELECT " COLUMNS " FROM templates t ORDER BY t.template_key",
    .insert = "INSERT INTO templates (id, revision, uid, used, read, created, engine, "
              "points, triangles, about, descriptor, mac) "
              "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)",
    .update = "UPDATE templates SET (revision, uid, used, read, created, engine, points, "
              "triangles, about, descriptor, mac) = "
              "($2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12) "
              "WHERE id = $1 AND mac = $13",
    .remove = "DELETE FROM templates WHERE id = $1 AND mac = $2",
    .drop = {"DELETE FROM templates WHERE template_key = $1"},
    .columns = COL_MAC,
    .field = columns,
    .mac = offsetof(struct rows_template, mac),
    .size = sizeof(struct rows_template),
    .id = COL_ID,
    .complete = rows_template_complete,
};

/* ---- what is encrypted, under the subject's key */

enum part { ABOUT_IT, DESCRIPTOR, HEAD, MESH };

/* The label of the description, of the descriptor, and of the parts of the face.  The latter are bound to the row's revision: the
 * row, with its MAC, says nothing else about them. */
static struct sql_field_blob label_of(const struct rows_template *row,
                                      const struct rows_subject *of, enum part part)
{
    static const char name[][16] = {"surface about 2", "surface search1",
                                    "surface face  3", "surface mesh  1"};
    struct sql_field_blob label;
    unsigned char *to = label.bytes;

    bytes_put(&to, name[part], 16);
    bytes_put(&to, of->one.uid, STORE_UID);
    bytes_put_text(&to, row->one.id);
    if (part >= HEAD)
        bytes_put_number(&to, (uint64_t)row->revision, 8);
    label.n = (size_t)(to - label.bytes);
    return label;
}

/* Decrypts the column of a part to *to, which moves behind it. */
static bool decrypt_part(const struct rows_template *row, const struct rows_subject *of,
                         const struct sql_value *v, enum part part, unsigned char **to)
{
    const struct sql_field_blob label = label_of(row, of, part);

    if (!crypt_decrypt(of->key, label.bytes, label.n, v->data, v->n, *to))
        return false;
    *to += v->n - CRYPT_OVER;
    return true;
}

/* The head in column col and, with whole, the mesh in the next one. */
static enum status decrypt_face(const struct rows_template *row,
                                const struct rows_subject *of, const struct sql_rows *r,
                                int col, bool whole, unsigned char **face, size_t *len,
                                struct errinfo *e)
{
    const struct sql_value head = sql_column(r, col);
    const struct sql_value mesh = whole ? sql_column(r, col + 1) : head;
    unsigned char *to;

    *face = NULL;
    *len = 0;
    if (head.type != SQL_BLOB || head.n <= CRYPT_OVER || mesh.type != SQL_BLOB ||
        mesh.n <= CRYPT_OVER)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its face is missing",
                           row->one.id);
    if ((to = *face = malloc(head.n + mesh.n)) == NULL)
        return errinfo_memory(e);
    if (decrypt_part(row, of, &head, HEAD, &to) &&
        (!whole || decrypt_part(row, of, &mesh, MESH, &to))) {
        *len = (size_t)(to - *face);
        return ST_OK;
    }
    rows_template_wipe(*face, (size_t)(to - *face));
    *face = NULL;
    return errinfo_set(e, ST_ECORRUPT, "template %s: its face is not authentic",
                       row->one.id);
}

/* ---- reading */

/* What a row of the subject `of` has encrypted. */
static enum status describe(const struct rows_subject *of, struct rows_template *row,
                            struct errinfo *e)
{
    const struct sql_field_blob label = label_of(row, of, ABOUT_IT);

    if (memcmp(row->uid, of->one.uid, STORE_UID) != 0 ||
        !rows_table_decrypt(of->key, &label, about, ABOUT, &row->about, row))
        return errinfo_set(e, ST_ECORRUPT, "templates: the row %s is not authentic",
                           row->one.id);
    memcpy(row->one.subject, of->one.id, sizeof row->one.subject);
    return ST_OK;
}

enum status rows_template_get(struct log_txn *t, const char *id,
                              struct rows_template *out, struct rows_subject *of,
                              struct errinfo *e)
{
    enum status st = rows_table_find(
        t, &rows_templates, "SELECT " COLUMNS " FROM templates t WHERE t.id = $1", COL_ID,
        sql_text(id), id, out, e);

    memset(of, 0, sizeof *of);
    if (st != ST_OK)
        return st;
    if ((st = rows_subject_get(t, out->uid, of, e)) == ST_ENOTFOUND)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its subject is missing", id);
    if (st == ST_OK && !groups_meet(t->groups, of->one.groups)) {
        sodium_memzero(of, sizeof *of);
        st = rows_table_missing(&rows_templates, id, e);
    }
    return st == ST_OK ? describe(of, out, e) : st;
}

enum status rows_template_descriptor(const struct rows_template *row,
                                     const struct rows_subject *of,
                                     unsigned char out[SURFACE_DESCRIPTOR],
                                     struct errinfo *e)
{
    const struct sql_field_blob label = label_of(row, of, DESCRIPTOR);

    if (crypt_decrypt(of->key, label.bytes, label.n, row->descriptor,
                      sizeof row->descriptor, out))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "template %s: its descriptor is not authentic",
                       row->one.id);
}

struct rows_template_listing {
    const struct log_txn *t;
    const struct rows_subject *of;
};

static enum status list_row(void *arg, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    const struct rows_template_listing *l = arg;
    const enum status st = rows_table_read(l->t, &rows_templates, r, 0, out, e);

    return st == ST_OK ? describe(l->of, out, e) : st;
}

/* Neither the rows' keys, which nothing authenticates, nor the clock say which is the oldest. */
static int by_number(const void *a, const void *b)
{
    const struct rows_template *p = a, *q = b;

    return (p->number > q->number) - (p->number < q->number);
}

/* Those that there are, and the sum of their rows. */
static enum status rows_template_list_rows(struct log_txn *t,
                                           const struct rows_subject *of,
                                           struct rows_template **out, size_t *n,
                                           unsigned char sum[LOG_DIGEST],
                                           struct errinfo *e)
{
    struct rows_template_listing l = {t, of};
    struct sql_rows *r;
    void *rows = NULL;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT " COLUMNS " FROM templates t "
                  "WHERE t.uid = (SELECT s.uid FROM subjects s WHERE s.lookup = $1)",
                  sql_blob(of->lookup, sizeof of->lookup));

    st = sql_read_list(r, st, list_row, &l, sizeof **out, &rows, n, e);
    *out = rows;
    if (*n > 1)
        qsort(*out, *n, sizeof **out, by_number);
    memset(sum, 0, LOG_DIGEST);
    for (size_t i = 0; i < *n; i++)
        log_txn_sum(t->crypt, NULL, (*out)[i].mac, sum);
    return st;
}

enum status rows_template_list(struct log_txn *t, const struct rows_subject *of,
                               struct rows_template **out, size_t *n, struct errinfo *e)
{
    unsigned char sum[LOG_DIGEST];
    const enum status st = rows_template_list_rows(t, of, out, n, sum, e);

    if (st != ST_OK || sodium_memcmp(sum, of->templates, sizeof sum) == 0)
        return st;
    free(*out);
    *out = NULL;
    *n = 0;
    return errinfo_set(e, ST_ECORRUPT,
                       "subject %s: its templates are not those that it has: one was "
                       "removed, hidden, doubled or put back",
                       of->one.id);
}

/* ---- by what the scan was */

#define DIGITS 64

/* A keyed hash of the digest, for this subject alone. */
static void hash_digest(const struct log_txn *t, const char *what,
                        const unsigned char uid[STORE_UID], const char *digest,
                        unsigned char out[CRYPT_HASH])
{
    unsigned char data[STORE_UID + DIGITS] = {0};

    memcpy(data, uid, STORE_UID);
    memcpy(data + STORE_UID, digest, strnlen(digest, DIGITS));
    crypt_lookup(t->crypt, what, data, sizeof data, out);
}

enum status rows_template_same(struct log_txn *t, const unsigned char uid[STORE_UID],
                               const char *used, const char *read,
                               char id[STORE_ID_LEN + 1], struct errinfo *e)
{
    unsigned char by_used[CRYPT_HASH], by_read[CRYPT_HASH];
    struct sql_rows *r;
    enum status st;

    hash_digest(t, "used", uid, used, by_used);
    hash_digest(t, "read", uid, read[0] != '\0' ? read : "unknown", by_read);
    id[0] = '\0';
    st = SQL_FIRST(t->sql, &r, e,
                   "SELECT (SELECT t.id FROM templates t WHERE t.uid = s.uid "
                   "AND (t.used = $2 OR t.read = $3) LIMIT 1) "
                   "FROM subjects s WHERE s.uid = $1",
                   sql_blob(uid, STORE_UID), sql_blob(by_used, sizeof by_used),
                   sql_blob(by_read, sizeof by_read));
    if (st == ST_OK && sql_column(r, 0).type != SQL_NULL &&
        (!sql_read_text(r, 0, id, STORE_ID_LEN + 1) || !ident_id_valid(id)))
        st = errinfo_set(e, ST_ECORRUPT, "a template's row is not authentic");
    else if (st == ST_ENOTFOUND)
        (void)errinfo_set(e, st, "there is no subject of this uid");
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
    enum status st = SQL_FIRST(
        t->sql, &r, e,
        "SELECT f.face, f.mesh FROM templates t JOIN faces f USING (template_key) "
        "WHERE t.id = $1",
        sql_text(row->one.id));

    *face = NULL;
    *len = 0;
    if (st == ST_OK)
        st = decrypt_face(row, of, r, 0, true, face, len, e);
    else if (st == ST_ENOTFOUND)
        st = errinfo_set(e, ST_ECORRUPT, "template %s: its face is missing", row->one.id);
    return sql_done(r, st, e);
}

/* The template that the row of a head names; NULL: none of these. */
static const struct rows_template *named(const struct sql_rows *r,
                                         const struct rows_template *row, size_t n)
{
    char id[STORE_ID_LEN + 1];

    if (!sql_read_text(r, 0, id, sizeof id))
        return NULL;
    for (size_t i = 0; i < n; i++)
        if (strcmp(row[i].one.id, id) == 0)
            return &row[i];
    return NULL;
}

enum status rows_template_heads(struct log_txn *t, const struct rows_subject *of,
                                const struct rows_template *row, size_t n, bool mesh,
                                unsigned char **face, size_t *len, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st;

    for (size_t i = 0; i < n; i++)
        face[i] = NULL;
    st = SQL_QUERY(t->sql, &r, e,
                   "SELECT t.id, f.face, CASE WHEN (SELECT count(*) FROM templates x "
                   "WHERE x.uid = t.uid) = $2 THEN f.mesh END "
                   "FROM templates t JOIN faces f USING (template_key) "
                   "WHERE t.uid = (SELECT s.uid FROM subjects s WHERE s.lookup = $1)",
                   sql_blob(of->lookup, sizeof of->lookup), sql_int(mesh ? 1 : 0));
    while (st == ST_OK && sql_next(r)) {
        const struct rows_template *one = named(r, row, n);

        if (one != NULL && face[one - row] == NULL)
            st = decrypt_face(one, of, r, 1, sql_column(r, 2).type == SQL_BLOB,
                              &face[one - row], &len[one - row], e);
    }
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    for (size_t i = 0; i < n; i++)
        if (face[i] == NULL)
            return errinfo_set(e, ST_ECORRUPT, "template %s: its face is missing",
                               row[i].one.id);
    return ST_OK;
}

/* Of so many shares the one that a row is in: by its key, so that no writer moves it into
 * another meanwhile, and 64 that lie together at a time.  A negative key has one too. */
#define SHARE "(t.template_key >> 6 & 9223372036854775807) % $2"

#define EACH(faces, join)                                                                \
    "SELECT " COLUMNS ", " ROWS_SUBJECT faces " FROM templates t "                       \
    "LEFT JOIN subjects s ON s.uid = t.uid " join "WHERE " SHARE                         \
    " = $1 ORDER BY t.template_key"

enum status rows_template_each(struct log_txn *t, unsigned part, unsigned parts,
                               bool faces, rows_template_use *use, store_report *report,
                               void *arg, struct errinfo *e)
{
    struct rows_template row;
    struct rows_subject of;
    struct errinfo why;
    struct sql_rows *r;
    enum status st =
        sql_stream(t->sql,
                   faces ? EACH(", f.face, f.mesh",
                                "LEFT JOIN faces f ON f.template_key = t.template_key ")
                         : EACH("", ""),
                   SQL_VALUES(sql_int(part), sql_int(parts)), 2, &r, e);

    while (st == ST_OK && sql_next(r)) {
        unsigned char *face = NULL;
        size_t len = 0;
        enum status one = rows_table_read(t, &rows_subjects, r, COLS, &of, &why);

        if (one == ST_OK &&
            (one = rows_table_read(t, &rows_templates, r, 0, &row, &why)) == ST_OK &&
            (one = describe(&of, &row, &why)) == ST_OK &&
            (!faces || (one = decrypt_face(&row, &of, r, COLS + ROWS_SUBJECT_N, true,
                                           &face, &len, &why)) == ST_OK))
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

static void encrypt(const struct log_txn *t, struct rows_template *row,
                    const struct rows_subject *of, const unsigned char *descriptor)
{
    const struct sql_field_blob label = label_of(row, of, ABOUT_IT),
                                search = label_of(row, of, DESCRIPTOR);

    memcpy(row->uid, of->one.uid, STORE_UID);
    hash_digest(t, "used", of->one.uid, row->one.digest, row->by_used);
    hash_digest(t, "read", of->one.uid, row->one.read, row->by_read);
    rows_table_encrypt(of->key, &label, about, ABOUT, row, &row->about);
    crypt_encrypt(of->key, search.bytes, search.n, descriptor, SURFACE_DESCRIPTOR,
                  row->descriptor);
}

static enum status put_face(struct log_txn *t, const struct rows_template *row,
                            const struct rows_subject *of, const struct rows_face *plain,
                            struct errinfo *e)
{
    const unsigned char *face = plain->face;
    const size_t len = plain->len;
    const struct sql_field_blob head = label_of(row, of, HEAD),
                                mesh = label_of(row, of, MESH);
    const size_t cut = surface_encoded_head(face, len);
    unsigned char *stored = malloc(len + 2 * CRYPT_OVER), *behind;
    enum status st;

    if (stored == NULL)
        return errinfo_memory(e);
    behind = stored + cut + CRYPT_OVER;
    crypt_encrypt(of->key, head.bytes, head.n, face, cut, stored);
    crypt_encrypt(of->key, mesh.bytes, mesh.n, face + cut, len - cut, behind);
    st = SQL_RUN(t->sql, e,
                 "INSERT INTO faces (template_key, face, mesh) VALUES "
                 "((SELECT template_key FROM templates WHERE id = $1), $2, $3) "
                 "ON CONFLICT (template_key) DO UPDATE "
                 "SET (face, mesh) = (excluded.face, excluded.mesh)",
                 sql_text(row->one.id), sql_blob(stored, cut + CRYPT_OVER),
                 sql_blob(behind, len - cut + CRYPT_OVER));
    free(stored);
    return st;
}

/* A template's row of one MAC is gone, one of another is there; NULL for neither. */
static enum status recount(struct log_txn *t, struct rows_subject *of,
                           const unsigned char *minus, const unsigned char *plus,
                           struct errinfo *e)
{
    log_txn_sum(t->crypt, minus, plus, of->templates);
    return rows_subject_write(t, of, e);
}

enum status rows_template_add(struct log_txn *t, struct rows_subject *of,
                              struct rows_template *row, const struct rows_face *face,
                              struct errinfo *e)
{
    enum status st;

    row->number = ++of->added;
    encrypt(t, row, of, face->descriptor);
    if ((st = rows_table_insert(t, &rows_templates, row, e)) != ST_OK ||
        (st = put_face(t, row, of, face, e)) != ST_OK)
        return st;
    return recount(t, of, NULL, row->mac, e);
}

enum status rows_template_write(struct log_txn *t, struct rows_subject *of,
                                struct rows_template *row, const struct rows_face *face,
                                struct errinfo *e)
{
    const struct rows_template old = *row;
    enum status st;

    encrypt(t, row, of, face->descriptor);
    if ((st = rows_table_update(t, &rows_templates, row, e)) != ST_OK ||
        (st = put_face(t, row, of, face, e)) != ST_OK)
        return st;
    return recount(t, of, old.mac, row->mac, e);
}

enum status rows_template_delete(struct log_txn *t, struct rows_subject *of,
                                 const struct rows_template *row, struct errinfo *e)
{
    const enum status st = rows_table_delete(t, &rows_templates, row, e);

    return st == ST_OK ? recount(t, of, row->mac, NULL, e) : st;
}

enum status rows_template_accept(struct log_txn *t, struct rows_subject *of,
                                 struct errinfo *e)
{
    struct rows_template *row = NULL;
    unsigned char sum[LOG_DIGEST];
    size_t n;
    const enum status st = rows_template_list_rows(t, of, &row, &n, sum, e);

    free(row);
    if (st != ST_OK || memcmp(sum, of->templates, sizeof sum) == 0)
        return st;
    memcpy(of->templates, sum, sizeof sum);
    return rows_subject_write(t, of, e);
}
