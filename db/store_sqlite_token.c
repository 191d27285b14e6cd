#include <string.h>

#include "errinfo.h"
#include "store_sqlite.h"

enum { /* the columns of TOKEN_COLUMNS */
       COL_ID,
       COL_NAME,
       COL_CREATED,
       COL_REVOKED,
       COL_SCOPES,
       COL_EXPIRES,
       COL_USED,
       COL_OLD_UNTIL,
       COL_HASH, /* SQL_TOKEN_FIND alone */
       COL_OLD
};

/* A text, or "" for NULL. */
static bool text_or_null(sqlite3_stmt *stmt, int col, char *out, size_t size)
{
    out[0] = '\0';
    return sqlite3_column_type(stmt, col) == SQLITE_NULL ||
           store_sqlite_text(stmt, col, out, size);
}

static enum status read_token(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              void *out, struct errinfo *e)
{
    struct store_token *t = out;
    char scopes[STORE_SCOPES_MAX];

    (void)c; /* nothing of it is sealed */
    memset(t, 0, sizeof *t);
    if (!store_sqlite_text(stmt, COL_ID, t->id, sizeof t->id) || !store_id_valid(t->id) ||
        !store_sqlite_text(stmt, COL_NAME, t->name, sizeof t->name) ||
        !store_sqlite_text(stmt, COL_CREATED, t->created, sizeof t->created) ||
        !store_sqlite_text(stmt, COL_SCOPES, scopes, sizeof scopes) ||
        !store_scopes_read(scopes, &t->scopes) ||
        !text_or_null(stmt, COL_EXPIRES, t->expires, sizeof t->expires) ||
        !text_or_null(stmt, COL_USED, t->used, sizeof t->used) ||
        !text_or_null(stmt, COL_OLD_UNTIL, t->old_until, sizeof t->old_until))
        return errinfo_set(e, ST_ECORRUPT, "token %s: its row is damaged",
                           store_id_valid(t->id) ? t->id : "?");
    t->revoked = sqlite3_column_type(stmt, COL_REVOKED) != SQLITE_NULL;
    return ST_OK;
}

/* "" as NULL. */
static int bind_or_null(sqlite3_stmt *stmt, int at, const char *text)
{
    return text[0] == '\0' ? sqlite3_bind_null(stmt, at)
                           : store_sqlite_bind(stmt, at, text);
}

static int bind_hash(sqlite3_stmt *stmt, int at, const unsigned char hash[STORE_HASH_LEN])
{
    return sqlite3_bind_blob(stmt, at, hash, STORE_HASH_LEN, SQLITE_TRANSIENT);
}

enum status store_sqlite_token_add(struct store *s, const struct store_act *by,
                                   const struct store_token *t,
                                   const unsigned char hash[STORE_HASH_LEN],
                                   struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    char scopes[STORE_SCOPES_MAX];
    enum status st;

    store_scopes_write(t->scopes, scopes);
    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_ADD, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, t->name) != SQLITE_OK ||
        bind_hash(stmt, 3, hash) != SQLITE_OK ||
        store_sqlite_bind(stmt, 4, t->created) != SQLITE_OK ||
        store_sqlite_bind(stmt, 5, scopes) != SQLITE_OK ||
        bind_or_null(stmt, 6, t->expires) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot add a token", e);
    else if ((st = store_sqlite_run(c, stmt, e)) == ST_OK)
        st = store_sqlite_event_add(c, by, "create_token", "", "", t->id, e);
out:
    return store_sqlite_written(s, st, e);
}

enum status store_sqlite_token_list(struct store *s, struct store_token **out, size_t *n,
                                    struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_LIST, &stmt, e)) == ST_OK)
        st = store_sqlite_rows(c, stmt, read_token, sizeof **out,
                               "cannot read the tokens", &list, n, e);
    store_sqlite_done(s, c);
    *out = list;
    return st;
}

/* Run a change of one token, bound, and add its event; ST_ENOTFOUND where it changed none. */
static enum status change(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                          const struct store_act *by, const char *kind, const char *id,
                          struct errinfo *e)
{
    enum status st = store_sqlite_run(c, stmt, e);

    if (st == ST_OK && sqlite3_changes(c->db) == 0)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no token %s", id);
    return st != ST_OK ? st : store_sqlite_event_add(c, by, kind, "", "", id, e);
}

enum status store_sqlite_token_revoke(struct store *s, const struct store_act *by,
                                      const char *id, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_REVOKE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, by->at) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot revoke a token", e);
    else
        st = change(c, stmt, by, "revoke_token", id, e);
out:
    return store_sqlite_written(s, st, e);
}

enum status store_sqlite_token_rotate(struct store *s, const struct store_act *by,
                                      const struct store_token *t,
                                      const unsigned char hash[STORE_HASH_LEN],
                                      struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_ROTATE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK ||
        bind_hash(stmt, 2, hash) != SQLITE_OK ||
        bind_or_null(stmt, 3, t->old_until) != SQLITE_OK ||
        bind_or_null(stmt, 4, t->expires) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot rotate a token", e);
    else
        st = change(c, stmt, by, "rotate_token", t->id, e);
out:
    return store_sqlite_written(s, st, e);
}

enum status store_sqlite_token_use(struct store *s, const char *id, const char *at,
                                   struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_try(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_USE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, at) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot note a token's use", e);
    else
        st = store_sqlite_run(c, stmt, e);
out:
    return store_sqlite_written(s, st, e);
}

enum status store_sqlite_token_get(struct store *s, const char *id, struct store_token *t,
                                   struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;
    int rc;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_GET, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE))
        st = store_sqlite_fail(c, "cannot read a token", e);
    else if (rc == SQLITE_DONE)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no token %s", id);
    else
        st = read_token(c, stmt, t, e);
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_token_find(struct store *s,
                                    const unsigned char hash[STORE_HASH_LEN],
                                    struct store_token *t,
                                    unsigned char kept[STORE_HASH_LEN], bool *old,
                                    struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    const void *blob;
    enum status st;
    int rc;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TOKEN_FIND, &stmt, e)) != ST_OK)
        goto out;
    if (bind_hash(stmt, 1, hash) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE)) {
        st = store_sqlite_fail(c, "cannot read a token", e);
    } else if (rc == SQLITE_DONE) {
        st = errinfo_set(e, ST_ENOTFOUND, "there is no such token");
    } else if ((st = read_token(c, stmt, t, e)) == ST_OK) {
        *old = sqlite3_column_int(stmt, COL_OLD) != 0;
        blob = sqlite3_column_blob(stmt, COL_HASH);
        if (blob == NULL || sqlite3_column_bytes(stmt, COL_HASH) != STORE_HASH_LEN)
            st = errinfo_set(e, ST_ECORRUPT, "token %s: its row is damaged", t->id);
        else
            memcpy(kept, blob, STORE_HASH_LEN);
    }
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}
