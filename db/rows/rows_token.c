#include "rows_token.h"

#include <string.h>

#include "errinfo.h"
#include "ident.h"

#define REST                                                                             \
    "revision, name, hash, created, revoked, scopes, groups, expires, old_hash, "        \
    "old_until, mac"
#define REST_VALUES "$2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12"
#define COLUMNS     "id, " REST ", token_key, used"

#define F(kind, member) SQL_FIELD(kind, struct rows_token, member)

enum { COL_ID, COL_MAC = 11, COL_USED = 13 };

static const struct sql_field columns[COL_MAC] = {
    F(TEXT, token.id),
    F(NUMBER, revision),
    F(TEXT, token.name),
    F(BYTES, hash),
    F(TEXT, token.created),
    F(TEXT_OR_NULL, token.revoked),
    F(TEXT, scopes),
    F(TEXT, token.groups),
    F(TEXT_OR_NULL, token.expires),
    F(BYTES_OR_NULL, old_hash),
    F(TEXT_OR_NULL, token.old_until),
};

bool rows_token_may_have(unsigned scopes, const char *groups)
{
    return groups_valid(groups) &&
           (groups[0] == '\0' || (scopes & STORE_SCOPE_AUDIT) == 0);
}

static bool rows_token_complete(const struct log_txn *t, const struct sql_rows *r,
                                int col, void *row)
{
    struct rows_token *one = row;
    struct store_token *k = &one->token;

    (void)t;
    (void)sql_read_text(r, col + COL_USED, k->used,
                        sizeof k->used); /* not authenticated */
    return ident_id_valid(k->id) && rows_scopes_read(one->scopes, &k->scopes) &&
           rows_token_may_have(k->scopes, k->groups);
}

const struct rows_table rows_tokens = {
    .name = "tokens",
    .noun = "token ",
    .all = "SELECT " COLUMNS " FROM tokens ORDER BY token_key",
    .insert = "INSERT INTO tokens (id, " REST ") VALUES ($1, " REST_VALUES ")",
    .update =
        "UPDATE tokens SET (" REST ") = (" REST_VALUES ") WHERE id = $1 AND mac = $13",
    .drop = {"DELETE FROM tokens WHERE token_key = $1"},
    .columns = COL_MAC,
    .field = columns,
    .mac = offsetof(struct rows_token, mac),
    .size = sizeof(struct rows_token),
    .id = COL_ID,
    .complete = rows_token_complete,
};

enum status rows_token_get(struct log_txn *t, const char *id, struct rows_token *out,
                           struct errinfo *e)
{
    const enum status st =
        rows_table_find(t, &rows_tokens, "SELECT " COLUMNS " FROM tokens WHERE id = $1",
                        COL_ID, sql_text(id), id, out, e);

    if (st != ST_OK || groups_within(t->groups, out->token.groups))
        return st;
    *out = (struct rows_token){.revision = 0};
    return rows_table_missing(&rows_tokens, id, e);
}

enum status rows_token_find(struct log_txn *t, const unsigned char hash[ROWS_TOKEN_HASH],
                            struct rows_token *out, struct errinfo *e)
{
    return rows_table_find(t, &rows_tokens,
                           "SELECT " COLUMNS " FROM tokens WHERE hash = $1 UNION ALL "
                           "SELECT " COLUMNS " FROM tokens WHERE old_hash = $1",
                           -1, sql_blob(hash, ROWS_TOKEN_HASH), "of this secret", out, e);
}

static void rows_token_prepare(struct rows_token *one)
{
    rows_scopes_write(one->token.scopes, one->scopes);
    if (one->token.old_until[0] == '\0')
        memset(one->old_hash, 0, sizeof one->old_hash);
}

enum status rows_token_add(struct log_txn *t, struct rows_token *one, struct errinfo *e)
{
    rows_token_prepare(one);
    return rows_table_insert(t, &rows_tokens, one, e);
}

enum status rows_token_write(struct log_txn *t, struct rows_token *one, struct errinfo *e)
{
    rows_token_prepare(one);
    return rows_table_update(t, &rows_tokens, one, e);
}

enum status rows_token_used(struct log_txn *t, const char *id, const char *at,
                            struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "UPDATE tokens SET used = $2 WHERE id = $1", sql_text(id),
                   sql_text(at));
}
