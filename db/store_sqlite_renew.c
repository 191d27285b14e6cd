#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "store_sqlite.h"

/* ---- one template */

/* The row as it is now, and its subject's key. */
static enum status read_now(struct store_sqlite_conn *c, const char *id,
                            struct store_template *t, struct store_seal_key *k,
                            struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_GET, &stmt, e);
    int rc = SQLITE_ERROR;

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind(stmt, 1, id) == SQLITE_OK)
        rc = sqlite3_step(stmt);
    if (rc == SQLITE_ROW)
        st = store_sqlite_face_key(c, stmt, t, k, e);
    else if (rc == SQLITE_DONE)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no template %s", id);
    else
        st = store_sqlite_fail(c, "cannot read a template", e);
    (void)sqlite3_reset(stmt);
    return st;
}

static enum status write_now(struct store_sqlite_conn *c, const struct store_seal_key *k,
                             const struct store_template *t, const void *model,
                             size_t len, struct errinfo *e)
{
    unsigned char about[STORE_SEAL_ABOUT], *sealed = malloc(len + VAULT_OVER);
    const size_t n = store_seal_template(k, t, about);
    sqlite3_stmt *stmt;
    enum status st;

    if (sealed == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    store_seal_model(k, t, model, len, sealed);
    if ((st = store_sqlite_prepare(c, SQL_TEMPLATE_RENEW, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, t->engine) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 3, t->triangles) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 4, about, n) != SQLITE_OK ||
        sqlite3_bind_blob64(stmt, 5, sealed, len + VAULT_OVER, SQLITE_STATIC) !=
            SQLITE_OK)
        st = store_sqlite_fail(c, "cannot change a template", e);
    else
        st = store_sqlite_run(c, stmt, e);
    (void)sqlite3_reset(stmt);
    (void)sqlite3_clear_bindings(stmt); /* the model is freed here */
out:
    free(sealed);
    return st;
}

enum status store_sqlite_renew(struct store *s, const struct store_act *by,
                               const struct store_template *t, const void *model,
                               size_t len, bool *done, struct errinfo *e)
{
    struct store_seal_key k = {0};
    struct store_template now;
    struct store_sqlite_conn *c;
    enum status st;

    *done = false;
    if ((st = store_sqlite_write(s, false, &c, e)) != ST_OK)
        return st;
    st = read_now(c, t->id, &now, &k, e);
    if (st == ST_OK && strcmp(now.engine, t->engine) != 0) {
        *done = true;
        if ((st = write_now(c, &k, t, model, len, e)) == ST_OK)
            st = store_sqlite_event_add(c, by, "reprocess", now.subject, t->id, "renewed",
                                        e);
    }
    sodium_memzero(&k, sizeof k);
    st = store_sqlite_written(s, st, e);
    *done = *done && st == ST_OK;
    return st;
}

/* ---- all that are stale */

static enum status read_id(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                           void *out, struct errinfo *e)
{
    (void)c;
    if (store_sqlite_text(stmt, 0, out, STORE_ID_LEN + 1) && store_id_valid(out))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged (id)");
}

static enum status count(struct store_sqlite_conn *c, sqlite3_stmt *stmt, size_t *n,
                         struct errinfo *e)
{
    enum status st = ST_OK;

    if (sqlite3_step(stmt) == SQLITE_ROW)
        *n = (size_t)sqlite3_column_int64(stmt, 0);
    else
        st = store_sqlite_fail(c, "cannot count the templates", e);
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_renew_due(struct store *s, const char *engine,
                                   char (**out)[STORE_ID_LEN + 1], size_t *n,
                                   struct errinfo *e)
{
    const enum store_sqlite_sql sql =
        out != NULL ? SQL_TEMPLATE_STALE : SQL_TEMPLATE_STALE_COUNT;
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, sql, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, strchr(engine, ' ')) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the templates", e);
    else if (out == NULL)
        st = count(c, stmt, n, e);
    else
        st = store_sqlite_rows(c, stmt, read_id, sizeof **out,
                               "cannot read the templates", &list, n, e);
out:
    if (out != NULL)
        *out = list;
    store_sqlite_done(s, c);
    return st;
}
