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
       COL_OLD_UNTIL,
       COL_HASH,
       COL_OLD_HASH,
       COL_MAC, /* of all before it */
       COL_USED,
       COL_OLD /* SQL_TOKEN_FIND alone */
};

static const char proof[16] = "surface token";

static enum status read_token(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              void *out, struct errinfo *e)
{
    struct store_token *t = out;
    char scopes[STORE_SCOPES_MAX];

    memset(t, 0, sizeof *t);
    if (!store_sqlite_text(stmt, COL_ID, t->id, sizeof t->id) || !store_id_valid(t->id) ||
        !store_sqlite_text(stmt, COL_NAME, t->name, sizeof t->name) ||
        !store_sqlite_text(stmt, COL_CREATED, t->created, sizeof t->created) ||
        !store_sqlite_text(stmt, COL_SCOPES, scopes, sizeof scopes) ||
        !store_scopes_read(scopes, &t->scopes) ||
        !store_sqlite_text_or(stmt, COL_EXPIRES, t->expires, sizeof t->expires) ||
        !store_sqlite_text_or(stmt, COL_USED, t->used, sizeof t->used) ||
        !store_sqlite_text_or(stmt, COL_OLD_UNTIL, t->old_until, sizeof t->old_until) ||
        !store_sqlite_proved(c, proof, stmt, COL_MAC))
        return errinfo_set(e, ST_ECORRUPT, "token %s: its row is damaged",
                           store_id_valid(t->id) ? t->id : "?");
    t->revoked = sqlite3_column_type(stmt, COL_REVOKED) != SQLITE_NULL;
    return ST_OK;
}

static int bind_hash(sqlite3_stmt *stmt, int at, const unsigned char hash[STORE_HASH_LEN])
{
    return sqlite3_bind_blob(stmt, at, hash, STORE_HASH_LEN, SQLITE_TRANSIENT);
}

/* ---- proofs */

/* Step to the token with this id. */
static enum status seek(struct store_sqlite_conn *c, const char *id, sqlite3_stmt **stmt,
                        struct errinfo *e)
{
    enum status st = store_sqlite_prepare(c, SQL_TOKEN_GET, stmt, e);
    int rc = SQLITE_ERROR;

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind(*stmt, 1, id) != SQLITE_OK ||
        ((rc = sqlite3_step(*stmt)) != SQLITE_ROW && rc != SQLITE_DONE))
        return store_sqlite_fail(c, "cannot read a token", e);
    return rc == SQLITE_ROW ? ST_OK
                            : errinfo_set(e, ST_ENOTFOUND, "there is no token %s", id);
}

static enum status read_one(struct store_sqlite_conn *c, const char *id,
                            struct store_token *t, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = seek(c, id, &stmt, e);

    if (st == ST_OK)
        st = read_token(c, stmt, t, e);
    (void)sqlite3_reset(stmt);
    return st;
}

static enum status prove_one(struct store_sqlite_conn *c, const char *id,
                             struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = seek(c, id, &stmt, e);

    if (st == ST_OK)
        st = store_sqlite_prove(c, proof, stmt, COL_MAC, SQL_TOKEN_PROVE, e);
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_token_prove(struct store_sqlite_conn *c, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TOKEN_LIST, &stmt, e);
    int rc = SQLITE_DONE;

    if (st != ST_OK)
        return st;
    while (st == ST_OK && (rc = sqlite3_step(stmt)) == SQLITE_ROW)
        st = store_sqlite_prove(c, proof, stmt, COL_MAC, SQL_TOKEN_PROVE, e);
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot prove the tokens", e);
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_token_check(struct store_sqlite_conn *c, store_report *report,
                                     void *arg, struct errinfo *e)
{
    struct store_token t;
    struct errinfo row;
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TOKEN_LIST, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW)
        if (read_token(c, stmt, &t, &row) != ST_OK)
            report(arg, row.msg);
    if (rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the tokens", e);
    (void)sqlite3_reset(stmt);
    return st;
}

/* ---- what store.h promises */

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
        store_sqlite_bind_or(stmt, 6, t->expires) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot add a token", e);
    else if ((st = store_sqlite_run(c, stmt, e)) == ST_OK &&
             (st = prove_one(c, t->id, e)) == ST_OK)
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
    if (st == ST_OK)
        st = prove_one(c, id, e);
    return st != ST_OK ? st : store_sqlite_event_add(c, by, kind, "", "", id, e);
}

/* A damaged one too: it is good for nothing then, whatever its row says. */
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
    struct store_token before; /* is not proved anew unless it was proved */
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = read_one(c, t->id, &before, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_TOKEN_ROTATE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK ||
        bind_hash(stmt, 2, hash) != SQLITE_OK ||
        store_sqlite_bind_or(stmt, 3, t->old_until) != SQLITE_OK ||
        store_sqlite_bind_or(stmt, 4, t->expires) != SQLITE_OK)
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
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    st = read_one(c, id, t, e);
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
        if (!store_sqlite_bytes(stmt, *old ? COL_OLD_HASH : COL_HASH, kept,
                                STORE_HASH_LEN))
            st = errinfo_set(e, ST_ECORRUPT, "token %s: its row is damaged", t->id);
    }
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}
