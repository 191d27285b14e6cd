#include "row_token.h"

#include <string.h>

#include "errinfo.h"
#include "row_table.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_scopes.h"
#include "store_txn.h"

#define COLUMNS                                                                          \
    "id, name, created, revoked, scopes, expires, old_until, hash, old_hash, used"

enum { /* the columns of COLUMNS */
       COL_ID,
       COL_NAME,
       COL_CREATED,
       COL_REVOKED,
       COL_SCOPES,
       COL_EXPIRES,
       COL_OLD_UNTIL,
       COL_HASH,
       COL_OLD_HASH,
       COL_USED, /* the MAC is of all before it */
       COL_OLD   /* row_token_find() alone */
};

static const struct row_table tokens = {
    .label = "surface token",
    .word = "token",
    .columns = COL_USED,
    .name = COL_ID,
    .all = "SELECT " COLUMNS " FROM tokens ORDER BY token_key",
    .of = "SELECT " COLUMNS " FROM tokens WHERE id = $1",
};

/* ---- reading */

enum status row_token_tell(struct store_txn *t, const struct store_act *by,
                           const char *kind, const char *id, struct errinfo *e)
{
    return row_table_tell(t, &tokens, id, by, kind, "", "", id, e);
}

static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct store_txn *t = x;
    struct store_token *k = out;
    char scopes[STORE_SCOPES_MAX];
    enum status st;

    memset(k, 0, sizeof *k);
    if (!store_column_text(r, COL_ID, k->id, sizeof k->id) || !store_id_valid(k->id) ||
        !store_column_text(r, COL_NAME, k->name, sizeof k->name) ||
        !store_column_text(r, COL_CREATED, k->created, sizeof k->created) ||
        !store_column_text(r, COL_SCOPES, scopes, sizeof scopes) ||
        !store_scopes_read(scopes, &k->scopes) ||
        !store_column_text_or(r, COL_EXPIRES, k->expires, sizeof k->expires) ||
        !store_column_text_or(r, COL_USED, k->used, sizeof k->used) ||
        !store_column_text_or(r, COL_OLD_UNTIL, k->old_until, sizeof k->old_until))
        return errinfo_set(e, ST_ECORRUPT, "token %s: its row is damaged",
                           store_id_valid(k->id) ? k->id : "?");
    if ((st = row_table_is(t, &tokens, r, 0, k->id, e)) != ST_OK)
        return st;
    k->revoked = sql_column(r, COL_REVOKED).type != SQL_NULL;
    return ST_OK;
}

static enum status read_row(struct store_txn *t, const struct sql_rows *r,
                            struct row_token *out, struct errinfo *e)
{
    const enum status st = list_row(t, r, &out->token, e);

    if (st != ST_OK)
        return st;
    if (!store_column_bytes(r, COL_HASH, out->hash, sizeof out->hash) ||
        (sql_column(r, COL_OLD_HASH).type != SQL_NULL &&
         !store_column_bytes(r, COL_OLD_HASH, out->old_hash, sizeof out->old_hash)))
        return errinfo_set(e, ST_ECORRUPT, "token %s: its row is damaged", out->token.id);
    return ST_OK;
}

static enum status not_found(const char *id, struct errinfo *e)
{
    return errinfo_set(e, ST_ENOTFOUND, "there is no token %s", id);
}

enum status row_token_get(struct store_txn *t, const char *id, struct row_token *out,
                          struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(t->sql, &r, e, tokens.of, sql_text(id));

    memset(out, 0, sizeof *out);
    if ((found = st == ST_OK && sql_next(r)))
        st = read_row(t, r, out, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st : not_found(id, e);
}

enum status row_token_find(struct store_txn *t, const unsigned char hash[ROW_TOKEN_HASH],
                           struct row_token *out, struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT " COLUMNS ", 0 FROM tokens WHERE hash = $1 "
                               "UNION ALL "
                               "SELECT " COLUMNS ", 1 FROM tokens WHERE old_hash = $1",
                               sql_blob(hash, ROW_TOKEN_HASH));

    memset(out, 0, sizeof *out);
    if ((found = st == ST_OK && sql_next(r)) && (st = read_row(t, r, out, e)) == ST_OK)
        out->old = sql_column(r, COL_OLD).i != 0;
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st
                                : errinfo_set(e, ST_ENOTFOUND, "there is no such token");
}

enum status row_token_list(struct store_txn *t, struct store_token **out, size_t *n,
                           struct errinfo *e)
{
    void *list;
    struct sql_rows *r;
    enum status st = sql_query(t->sql, tokens.all, NULL, 0, &r, e);

    st = store_column_list(r, st, list_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

enum status row_token_each(struct store_txn *t, row_event_see *see, void *arg,
                           struct errinfo *e)
{
    return row_table_see(t, &tokens, see, arg, e);
}

/* ---- writing */

/* The values point into *one and scopes. */
static void set_values(const struct row_token *one, char scopes[STORE_SCOPES_MAX],
                       struct sql_value v[COL_USED])
{
    const bool keep = one->token.old_until[0] != '\0';

    store_scopes_write(one->token.scopes, scopes);
    v[COL_ID] = sql_text(one->token.id);
    v[COL_NAME] = sql_text(one->token.name);
    v[COL_CREATED] = sql_text(one->token.created);
    v[COL_REVOKED] = sql_null();
    v[COL_SCOPES] = sql_text(scopes);
    v[COL_EXPIRES] = sql_text_or_null(one->token.expires);
    v[COL_OLD_UNTIL] = sql_text_or_null(one->token.old_until);
    v[COL_HASH] = sql_blob(one->hash, sizeof one->hash);
    v[COL_OLD_HASH] = keep ? sql_blob(one->old_hash, sizeof one->old_hash) : sql_null();
}

enum status row_token_add(struct store_txn *t, const struct row_token *one,
                          struct errinfo *e)
{
    char scopes[STORE_SCOPES_MAX];
    struct sql_value v[COL_USED];

    set_values(one, scopes, v);
    return SQL_RUN(t->sql, e,
                   "INSERT INTO tokens (id, name, hash, created, scopes, expires) "
                   "VALUES ($1, $2, $3, $4, $5, $6)",
                   v[COL_ID], v[COL_NAME], v[COL_HASH], v[COL_CREATED], v[COL_SCOPES],
                   v[COL_EXPIRES]);
}

enum status row_token_rotate(struct store_txn *t, const struct row_token *one,
                             struct errinfo *e)
{
    char scopes[STORE_SCOPES_MAX];
    struct sql_value v[COL_USED];

    set_values(one, scopes, v);
    return SQL_RUN(t->sql, e,
                   "UPDATE tokens SET hash = $2, old_hash = $3, old_until = $4, "
                   "expires = $5, scopes = $6 WHERE id = $1",
                   v[COL_ID], v[COL_HASH], v[COL_OLD_HASH], v[COL_OLD_UNTIL],
                   v[COL_EXPIRES], v[COL_SCOPES]);
}

enum status row_token_revoke(struct store_txn *t, const char *id, const char *at,
                             struct errinfo *e)
{
    enum status st = SQL_RUN(t->sql, e,
                             "UPDATE tokens SET revoked = coalesce(revoked, $2) "
                             "WHERE id = $1",
                             sql_text(id), sql_text(at));

    return st != ST_OK || sql_changed(t->sql) > 0 ? st : not_found(id, e);
}

enum status row_token_used(struct store_txn *t, const char *id, const char *at,
                           struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "UPDATE tokens SET used = $2 WHERE id = $1", sql_text(id),
                   sql_text(at));
}
