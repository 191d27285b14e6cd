#include "store_reencode.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "row_event.h"
#include "row_template.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_template.h"
#include "store_txn.h"

/* ---- one template */

static enum status write_row(struct store_txn *x, const struct store_act *by,
                             const struct store_template *t, const void *model,
                             size_t len, bool *done, struct errinfo *e)
{
    struct row_crypt_key k = {0};
    struct store_template now;
    enum status st = row_template_key(x, t->id, &now, &k, e);

    if (st == ST_OK && strcmp(now.engine, t->engine) != 0) {
        *done = true;
        if ((st = row_template_write(x, &k, t, model, len, e)) == ST_OK)
            st = row_template_tell(x, by, "reencode", now.subject, t->id, "reencoded", e);
    }
    sodium_memzero(&k, sizeof k);
    return st;
}

enum status store_reencode(struct store *s, const char *actor, const char *id,
                           struct face_work *w, struct face *f, struct store_template *t,
                           bool *done, struct errinfo *e)
{
    struct store_act by;
    struct store_txn x;
    unsigned char *model;
    size_t len;
    enum status st;

    *done = false;
    if ((st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_template_load(s, id, t, w, f, e)) != ST_OK ||
        !store_template_outdated(s, t))
        return st;
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->triangles = mesh_real(&f->surface.mesh);
    t->quality = f->quality;
    len = codec_size(f);
    if ((model = malloc(len)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    codec_encode(f, model);
    if ((st = store_txn_begin(s, SQL_LAZY, &x, e)) == ST_OK)
        st = store_txn_end(&x, write_row(&x, &by, t, model, len, done, e), e);
    *done = *done && st == ST_OK;
    sodium_memzero(model, len);
    free(model);
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
    if (store_column_text(r, 0, out, STORE_ID_LEN + 1) && store_id_valid(out))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged (id)");
}

enum status store_reencode_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                               struct errinfo *e)
{
    struct sql_rows *r;
    struct store_txn x;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = SQL_QUERY(x.sql, &r, e,
                   "SELECT id FROM templates WHERE " OUTDATED " ORDER BY template_key",
                   sql_text(strchr(s->made_by, ' ')));
    st = store_column_list(r, st, list_id, NULL, sizeof **out, &list, n, e);
    *out = list;
    return store_txn_end(&x, st, e);
}

enum status store_reencode_count(struct store *s, uint64_t *n, struct errinfo *e)
{
    struct sql_rows *r;
    struct store_txn x;
    enum status st;

    *n = 0;
    if ((st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = SQL_QUERY(x.sql, &r, e, "SELECT count(*) FROM templates WHERE " OUTDATED,
                   sql_text(strchr(s->made_by, ' ')));
    if (st == ST_OK && sql_next(r))
        *n = (uint64_t)sql_column(r, 0).i;
    return store_txn_end(&x, sql_done(r, st, e), e);
}
