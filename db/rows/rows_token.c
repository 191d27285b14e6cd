#include "rows_token.h"

#include <string.h>

#include "errinfo.h"
#include "ident.h"
#include "rows_scopes.h"
#include "sql_read.h"

#define AUTHENTIC                                                                        \
    "id, revision, name, hash, created, revoked, scopes, expires, old_hash, old_until, mac"
#define COLUMNS AUTHENTIC ", used"

enum { /* of COLUMNS */
       COL_ID,
       COL_REVISION,
       COL_NAME,
       COL_HASH,
       COL_CREATED,
       COL_REVOKED,
       COL_SCOPES,
       COL_EXPIRES,
       COL_OLD_HASH,
       COL_OLD_UNTIL,
       COL_MAC,
       COL_USED
};

const struct rows_table rows_tokens = {
    .name = "tokens",
    .all = "SELECT " AUTHENTIC ", token_key FROM tokens ORDER BY token_key",
    .remove = {"DELETE FROM tokens WHERE token_key = $1"},
    .columns = COL_MAC,
    .id = COL_ID,
};

/* ---- reading */

static bool read_row(const struct log_txn *t, const struct sql_rows *r,
                     struct rows_token *out)
{
    struct store_token *k = &out->token;
    char scopes[STORE_SCOPES_MAX];

    memset(out, 0, sizeof *out);
    if (!rows_table_is(t, &rows_tokens, r, 0, out->mac) ||
        !sql_read_text(r, COL_ID, k->id, sizeof k->id) || !ident_id_valid(k->id) ||
        !sql_read_int(r, COL_REVISION, 1, &out->revision) ||
        !sql_read_text(r, COL_NAME, k->name, sizeof k->name) ||
        !sql_read_bytes(r, COL_HASH, out->hash, sizeof out->hash) ||
        !sql_read_text(r, COL_CREATED, k->created, sizeof k->created) ||
        !sql_read_text_or(r, COL_REVOKED, out->revoked, sizeof out->revoked) ||
        !sql_read_text(r, COL_SCOPES, scopes, sizeof scopes) ||
        !rows_scopes_read(scopes, &k->scopes) ||
        !sql_read_text_or(r, COL_EXPIRES, k->expires, sizeof k->expires) ||
        !sql_read_text_or(r, COL_OLD_UNTIL, k->old_until, sizeof k->old_until) ||
        (sql_column(r, COL_OLD_HASH).type != SQL_NULL &&
         !sql_read_bytes(r, COL_OLD_HASH, out->old_hash, sizeof out->old_hash)))
        return false;
    k->revoked = out->revoked[0] != '\0';
    (void)sql_read_text_or(r, COL_USED, k->used, sizeof k->used); /* not authenticated */
    return true;
}

static enum status list_row(void *t, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    char id[STORE_ID_LEN + 1];

    if (read_row(t, r, out))
        return ST_OK;
    return errinfo_set(
        e, ST_ECORRUPT, "token %s: its row is not authentic",
        sql_read_text(r, COL_ID, id, sizeof id) && ident_id_valid(id) ? id : "?");
}

static enum status only(struct log_txn *t, struct sql_rows *r, enum status st,
                        struct rows_token *out, bool *found, struct errinfo *e)
{
    memset(out, 0, sizeof *out);
    if ((*found = st == ST_OK && sql_next(r)))
        st = list_row(t, r, out, e);
    return sql_done(r, st, e);
}

enum status rows_token_get(struct log_txn *t, const char *id, struct rows_token *out,
                           struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(
        t->sql, &r, e, "SELECT " COLUMNS " FROM tokens WHERE id = $1", sql_text(id));

    if ((st = only(t, r, st, out, &found, e)) != ST_OK)
        return st;
    if (!found)
        return errinfo_set(e, ST_ENOTFOUND, "there is no token %s", id);
    return strcmp(out->token.id, id) == 0
               ? ST_OK
               : errinfo_set(e, ST_ECORRUPT,
                             "an index of the tokens leads to another one");
}

enum status rows_token_find(struct log_txn *t, const unsigned char hash[ROWS_TOKEN_HASH],
                            struct rows_token *out, struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT " COLUMNS " FROM tokens WHERE hash = $1 "
                               "UNION ALL "
                               "SELECT " COLUMNS " FROM tokens WHERE old_hash = $1",
                               sql_blob(hash, ROWS_TOKEN_HASH));

    if ((st = only(t, r, st, out, &found, e)) != ST_OK)
        return st;
    return found ? ST_OK : errinfo_set(e, ST_ENOTFOUND, "there is no such token");
}

enum status rows_token_list(struct log_txn *t, struct rows_token **out, size_t *n,
                            struct errinfo *e)
{
    void *list = NULL;
    struct sql_rows *r;
    enum status st = sql_query(
        t->sql, "SELECT " COLUMNS " FROM tokens ORDER BY token_key", NULL, 0, &r, e);

    st = sql_read_list(r, st, list_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

/* ---- writing */

struct columns { /* what the values point into */
    char scopes[STORE_SCOPES_MAX];
    struct sql_value v[COL_MAC + 2];
};

static void set_values(const struct rows_token *one, struct columns *c)
{
    const struct store_token *k = &one->token;

    rows_scopes_write(k->scopes, c->scopes);
    c->v[COL_ID] = sql_text(k->id);
    c->v[COL_REVISION] = sql_int(one->revision);
    c->v[COL_NAME] = sql_text(k->name);
    c->v[COL_HASH] = sql_blob(one->hash, sizeof one->hash);
    c->v[COL_CREATED] = sql_text(k->created);
    c->v[COL_REVOKED] = sql_text_or_null(one->revoked);
    c->v[COL_SCOPES] = sql_text(c->scopes);
    c->v[COL_EXPIRES] = sql_text_or_null(k->expires);
    c->v[COL_OLD_HASH] = k->old_until[0] != '\0'
                             ? sql_blob(one->old_hash, sizeof one->old_hash)
                             : sql_null();
    c->v[COL_OLD_UNTIL] = sql_text_or_null(k->old_until);
}

enum status rows_token_add(struct log_txn *t, struct rows_token *one, struct errinfo *e)
{
    struct columns c;

    one->revision = 1;
    set_values(one, &c);
    return rows_table_insert(t, &rows_tokens,
                             "INSERT INTO tokens (id, revision, name, hash, created, "
                             "revoked, scopes, expires, old_hash, old_until, mac) "
                             "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
                             c.v, one->mac, e);
}

enum status rows_token_write(struct log_txn *t, struct rows_token *one, struct errinfo *e)
{
    struct columns c;

    one->revision++;
    set_values(one, &c);
    return rows_table_update(t, &rows_tokens,
                             "UPDATE tokens SET revision = $2, name = $3, hash = $4, "
                             "created = $5, revoked = $6, scopes = $7, expires = $8, "
                             "old_hash = $9, old_until = $10, mac = $11 "
                             "WHERE id = $1 AND mac = $12",
                             c.v, one->mac, e);
}

enum status rows_token_used(struct log_txn *t, const char *id, const char *at,
                            struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "UPDATE tokens SET used = $2 WHERE id = $1", sql_text(id),
                   sql_text(at));
}
