#include "row_template.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "mesh.h"
#include "row_table.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_txn.h"

/* What the audit log leaves of a row; the model is authenticated with the digest, which is in
 * about, and the engine. */
#define LEFT    "t.id, s.uid, t.same, t.created, t.engine, t.points, t.triangles, t.about"
#define COLUMNS "t.template_key, " LEFT ", " ROW_SUBJECT_WHO
#define FROM    " FROM templates t JOIN subjects s USING (subject_key)"

enum { /* the columns of COLUMNS */
       COL_ROW,
       COL_ID,
       COL_UID,
       COL_SAME,
       COL_CREATED,
       COL_ENGINE,
       COL_POINTS,
       COL_TRIANGLES,
       COL_ABOUT,
       COL_WHO, /* of the subject */
       COL_MODEL = COL_WHO + ROW_SUBJECT_WHO_N
};

static const struct row_table templates = {
    .label = "surface face",
    .word = "template",
    .columns = COL_WHO - COL_ID,
    .name = 0, /* the id */
    .all = "SELECT " LEFT " FROM templates t LEFT JOIN subjects s USING (subject_key)",
    .of = "SELECT " LEFT FROM " WHERE t.id = $1",
};

/* ---- rows */

static bool read_about(const struct sql_rows *r, struct store_template *t,
                       const struct row_crypt_key *k)
{
    size_t n;
    const void *about = store_column_blob(r, COL_ABOUT, 1, ROW_CRYPT_ABOUT, &n);

    return store_column_text(r, COL_CREATED, t->created, sizeof t->created) &&
           store_column_text(r, COL_ENGINE, t->engine, sizeof t->engine) &&
           store_column_count(r, COL_POINTS, MESH_MAX_POINTS, &t->points) &&
           store_column_count(r, COL_TRIANGLES, 2 * (int64_t)t->points, &t->triangles) &&
           about != NULL && row_crypt_decrypt_template(k, about, n, t);
}

/* Nothing of the row is trusted but what its subject's key authenticates, and that not unless
 * it was written last; *k is that key. */
static enum status read_row(struct store_txn *x, const struct sql_rows *r,
                            struct store_template *t, struct row_crypt_key *k,
                            struct errinfo *e)
{
    struct store_subject who;
    struct errinfo why;
    enum status st;

    memset(t, 0, sizeof *t);
    if (!store_column_text(r, COL_ID, t->id, sizeof t->id) || !store_id_valid(t->id))
        return errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged");
    if ((st = row_subject_who(x, r, COL_WHO, &who, k, &why)) != ST_OK)
        return errinfo_set(e, st, "template %s: %s", t->id, why.msg);
    if (!read_about(r, t, k))
        return errinfo_set(e, ST_ECORRUPT, "template %s: its row is damaged", t->id);
    st = row_table_is(x, &templates, r, COL_ID, t->id, e);
    if (st == ST_OK)
        memcpy(t->subject, who.id, sizeof t->subject);
    return st;
}

static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct row_crypt_key k;
    const enum status st = read_row(x, r, out, &k, e);

    sodium_memzero(&k, sizeof k);
    return st;
}

static enum status use_model(const struct sql_rows *r, const struct store_template *t,
                             const struct row_crypt_key *k, row_template_use *use,
                             void *arg, struct errinfo *e)
{
    size_t len;
    const void *stored = store_column_blob(r, COL_MODEL, VAULT_OVER + 1, SIZE_MAX, &len);
    unsigned char *model;
    enum status st;

    if (stored == NULL)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its model is missing", t->id);
    if ((model = malloc(len)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if (row_crypt_decrypt_model(k, t, stored, len, model))
        st = use(arg, t, model, len - VAULT_OVER, e);
    else
        st = errinfo_set(e, ST_ECORRUPT, "template %s: its model is damaged", t->id);
    sodium_memzero(model, len);
    free(model);
    return st;
}

/* ---- one */

/* Nobody deleted one that is not found but should be there. */
static enum status not_found(struct store_txn *x, const char *id, struct errinfo *e)
{
    unsigned char object[STORE_CHAIN_OBJECT];
    struct row_event_row row;
    enum status st;

    store_rules_raw(id, object);
    if ((st = row_event_latest(x, object, &row, e)) != ST_OK)
        return st;
    return row.gone
               ? errinfo_set(e, ST_ENOTFOUND, "there is no template %s", id)
               : errinfo_set(
                     e, ST_ECORRUPT,
                     "template %s: its row is missing, although nobody deleted it", id);
}

enum status row_template_key(struct store_txn *x, const char *id,
                             struct store_template *t, struct row_crypt_key *k,
                             struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st =
        SQL_QUERY(x->sql, &r, e, "SELECT " COLUMNS FROM " WHERE t.id = $1", sql_text(id));

    memset(t, 0, sizeof *t);
    if ((found = st == ST_OK && sql_next(r)))
        st = read_row(x, r, t, k, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st : not_found(x, id, e);
}

enum status row_template_get(struct store_txn *x, const char *id,
                             struct store_template *t, struct errinfo *e)
{
    struct row_crypt_key k;
    const enum status st = row_template_key(x, id, t, &k, e);

    sodium_memzero(&k, sizeof k);
    return st;
}

enum status row_template_load(struct store_txn *x, const char *id,
                              struct store_template *t, row_template_use *use, void *arg,
                              struct errinfo *e)
{
    struct row_crypt_key k = {0};
    struct sql_rows *r;
    bool found;
    enum status st =
        SQL_QUERY(x->sql, &r, e, "SELECT " COLUMNS ", t.model" FROM " WHERE t.id = $1",
                  sql_text(id));

    if ((found = st == ST_OK && sql_next(r)) && (st = read_row(x, r, t, &k, e)) == ST_OK)
        st = use_model(r, t, &k, use, arg, e);
    sodium_memzero(&k, sizeof k);
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st : not_found(x, id, e);
}

/* ---- of a subject */

enum status row_template_list(struct store_txn *x, int64_t subject, uint32_t count,
                              struct store_template **out, size_t *n, struct errinfo *e)
{
    void *list;
    struct sql_rows *r;
    enum status st = SQL_QUERY(x->sql, &r, e,
                               "SELECT " COLUMNS FROM
                               " WHERE t.subject_key = $1 ORDER BY t.template_key",
                               sql_int(subject));

    st = store_column_list(r, st, list_row, x, sizeof **out, &list, n, e);
    *out = list;
    if (st != ST_OK || *n == count)
        return st;
    free(list);
    *out = NULL;
    st = errinfo_set(e, ST_ECORRUPT,
                     "a subject has %zu templates, and its row says %u (row %lld)", *n,
                     count, (long long)subject);
    *n = 0;
    return st;
}

static enum status list_id(void *x, const struct sql_rows *r, void *out,
                           struct errinfo *e)
{
    char *id = out;

    (void)x;
    (void)e;
    if (!store_column_text(r, 0, id, STORE_ID_LEN + 1) || !store_id_valid(id)) {
        memset(id, '?', STORE_ID_LEN); /* no reason to keep it */
        id[STORE_ID_LEN] = '\0';
    }
    return ST_OK;
}

enum status row_template_ids(struct store_txn *x, int64_t subject,
                             char (**out)[STORE_ID_LEN + 1], size_t *n, struct errinfo *e)
{
    void *list;
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(x->sql, &r, e,
                  "SELECT id FROM templates WHERE subject_key = $1 ORDER BY template_key",
                  sql_int(subject));

    st = store_column_list(r, st, list_id, NULL, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

enum status row_template_newest(struct store_txn *x, int64_t subject,
                                char id[STORE_ID_LEN + 1], struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = SQL_QUERY(x->sql, &r, e,
                               "SELECT id FROM templates WHERE subject_key = $1 "
                               "ORDER BY template_key DESC LIMIT 1",
                               sql_int(subject));

    id[0] = '\0';
    if (st == ST_OK && sql_next(r) && !store_column_text(r, 0, id, STORE_ID_LEN + 1))
        st = errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged (id)");
    return sql_done(r, st, e);
}

enum status row_template_same(struct store_txn *x, const struct row_subject *p,
                              const char *digest, struct store_template *t, bool *found,
                              struct errinfo *e)
{
    unsigned char same[VAULT_HASH];
    struct sql_rows *r;
    enum status st;

    row_crypt_same(x->vault, p->key.uid, digest, same);
    st = SQL_QUERY(x->sql, &r, e,
                   "SELECT " COLUMNS FROM " WHERE t.subject_key = $1 AND t.same = $2",
                   sql_int(p->row), sql_blob(same, sizeof same));
    if ((*found = st == ST_OK && sql_next(r)))
        st = list_row(x, r, t, e);
    return sql_done(r, st, e);
}

enum status row_template_see(struct store_txn *x, row_event_see *see, void *arg,
                             struct errinfo *e)
{
    return row_table_see(x, &templates, see, arg, e);
}

/* ---- changes */

enum status row_template_tell(struct store_txn *x, const struct store_act *by,
                              const char *kind, const char *subject, const char *id,
                              const char *outcome, struct errinfo *e)
{
    return row_table_tell(x, &templates, id, by, kind, subject, id, outcome, e);
}

enum status row_template_add(struct store_txn *x, const struct row_subject *p,
                             const struct store_template *t, const void *model,
                             size_t len, struct errinfo *e)
{
    unsigned char about[ROW_CRYPT_ABOUT], same[VAULT_HASH];
    const size_t n = row_crypt_encrypt_template(&p->key, t, about);
    unsigned char *stored = malloc(len + VAULT_OVER);
    enum status st;

    if (stored == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    row_crypt_encrypt_model(&p->key, t, model, len, stored);
    row_crypt_same(x->vault, p->key.uid, t->digest, same);
    st = SQL_RUN(x->sql, e,
                 "INSERT INTO templates (id, subject_key, same, created, engine, points, "
                 "triangles, about, model) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
                 sql_text(t->id), sql_int(p->row), sql_blob(same, sizeof same),
                 sql_text(t->created), sql_text(t->engine), sql_int(t->points),
                 sql_int(t->triangles), sql_blob(about, n),
                 sql_blob(stored, len + VAULT_OVER));
    free(stored);
    return st;
}

enum status row_template_write(struct store_txn *x, const struct row_crypt_key *k,
                               const struct store_template *t, const void *model,
                               size_t len, struct errinfo *e)
{
    unsigned char about[ROW_CRYPT_ABOUT], *stored = malloc(len + VAULT_OVER);
    const size_t n = row_crypt_encrypt_template(k, t, about);
    enum status st;

    if (stored == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    row_crypt_encrypt_model(k, t, model, len, stored);
    st = SQL_RUN(x->sql, e,
                 "UPDATE templates SET engine = $2, triangles = $3, about = $4, "
                 "model = $5 WHERE id = $1",
                 sql_text(t->id), sql_text(t->engine), sql_int(t->triangles),
                 sql_blob(about, n), sql_blob(stored, len + VAULT_OVER));
    free(stored);
    return st;
}

enum status row_template_found(struct store_txn *x, const struct row_subject *p,
                               const struct store_template *t, struct errinfo *e)
{
    unsigned char same[VAULT_HASH];

    row_crypt_same(x->vault, p->key.uid, t->digest, same);
    return SQL_RUN(x->sql, e, "UPDATE templates SET same = $2 WHERE id = $1",
                   sql_text(t->id), sql_blob(same, sizeof same));
}

enum status row_template_delete(struct store_txn *x, const char *id, struct errinfo *e)
{
    return SQL_RUN(x->sql, e, "DELETE FROM templates WHERE id = $1", sql_text(id));
}

/* ---- all */

static void report_row(const struct sql_rows *r, const char *why,
                       void (*report)(void *arg, const char *line), void *arg)
{
    char line[sizeof((struct errinfo *)0)->msg + 64];

    (void)snprintf(line, sizeof line, "%s (row %lld)", why,
                   (long long)sql_column(r, COL_ROW).i);
    report(arg, line);
}

/* Of so many shares the one that a row is in: by its key, so that no writer moves it into
 * another meanwhile, and 64 that lie together at a time.  A negative key has one too. */
#define SHARE "(t.template_key >> 6 & 9223372036854775807) % $2"

enum status row_template_each(struct store *s, unsigned part, unsigned parts,
                              row_template_use *use,
                              void (*report)(void *arg, const char *line), void *arg,
                              struct errinfo *e)
{
    struct row_crypt_key k = {0};
    struct store_template t;
    struct store_txn x;
    struct errinfo why;
    struct sql_rows *r;
    enum status st;

    if ((st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = SQL_QUERY(x.sql, &r, e,
                   "SELECT " COLUMNS ", t.model FROM templates t LEFT JOIN subjects s "
                   "USING (subject_key) WHERE " SHARE " = $1 ORDER BY t.template_key",
                   sql_int(part), sql_int(parts));
    while (st == ST_OK && sql_next(r)) {
        enum status row = read_row(&x, r, &t, &k, &why);

        if (row == ST_OK)
            row = use_model(r, &t, &k, use, arg, &why);
        if (row == ST_ECORRUPT)
            report_row(r, why.msg, report, arg);
        else if (row != ST_OK)
            st = errinfo_set(e, row, "%s", why.msg);
    }
    st = sql_done(r, st, e);
    sodium_memzero(&k, sizeof k);
    return store_txn_end(&x, st, e);
}
