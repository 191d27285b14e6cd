#include "store_reencode.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "mesh.h"
#include "rows_template.h"
#include "sql_read.h"
#include "store_template.h"
#include "store_txn.h"

/* ---- one template */

static enum status write_row(struct log_txn *x, const struct log_act *by,
                             const struct store_template *t, const void *face, size_t len,
                             bool *done, struct errinfo *e)
{
    struct rows_template row;
    struct rows_subject of;
    enum status st = rows_template_get(x, t->id, &row, &of, e);

    if (st == ST_OK && strcmp(row.one.engine, t->engine) != 0) {
        *done = true;
        memcpy(row.one.engine, t->engine, sizeof row.one.engine);
        row.one.triangles = t->triangles;
        row.one.quality = t->quality;
        if ((st = rows_template_write(x, &of, &row, face, len, e)) == ST_OK)
            st = log_change(x, by, "reencode", of.one.uid, t->id, "reencoded", e);
    }
    sodium_memzero(&of, sizeof of);
    return st;
}

enum status store_reencode(struct store *s, const char *actor, const char *id,
                           struct face_work *w, struct face *f, struct store_template *t,
                           bool *done, struct errinfo *e)
{
    unsigned char *face;
    struct log_act by;
    struct log_txn x;
    size_t len;
    enum status st;

    *done = false;
    if ((st = store_template_load(s, id, t, w, f, e)) != ST_OK ||
        !store_template_outdated(s, t))
        return st;
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->triangles = mesh_real(&f->surface.mesh);
    t->quality = f->quality;
    len = codec_size(f);
    if ((face = malloc(len)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    codec_encode(f, face);
    if ((st = store_act_begin(s, actor, SQL_WRITE, &by, &x, e)) == ST_OK)
        st = store_end(s, &x, write_row(&x, &by, t, face, len, done, e), e);
    *done = *done && st == ST_OK;
    rows_template_wipe(face, len);
    return st;
}

/* ---- all that are outdated */

/* $1: an engine from its first space on, as face_same_engine() compares them. */
#define OUTDATED                                                                         \
    "substr(engine, length(engine) - length(CAST($1 AS text)) + 1) <> CAST($1 AS text)"

static enum status list_id(void *x, const struct sql_rows *r, void *out,
                           struct errinfo *e)
{
    (void)x;
    if (sql_read_text(r, 0, out, STORE_ID_LEN + 1) && ident_id_valid(out))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged (id)");
}

enum status store_reencode_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                               struct errinfo *e)
{
    struct sql_rows *r;
    struct log_txn x;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = SQL_QUERY(x.sql, &r, e,
                   "SELECT id FROM templates WHERE " OUTDATED " ORDER BY template_key",
                   sql_text(strchr(s->made_by, ' ')));
    st = sql_read_list(r, st, list_id, NULL, sizeof **out, &list, n, e);
    *out = list;
    return store_end(s, &x, st, e);
}

enum status store_reencode_count(struct store *s, uint64_t *n, struct errinfo *e)
{
    struct sql_rows *r;
    struct log_txn x;
    enum status st;

    *n = 0;
    if ((st = store_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = SQL_QUERY(x.sql, &r, e, "SELECT count(*) FROM templates WHERE " OUTDATED,
                   sql_text(strchr(s->made_by, ' ')));
    if (st == ST_OK && sql_next(r))
        *n = (uint64_t)sql_column(r, 0).i;
    return store_end(s, &x, sql_done(r, st, e), e);
}
