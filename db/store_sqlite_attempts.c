#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "store_rules.h"
#include "store_sqlite.h"

/* The schema's checks hold for what this program wrote; the file may have been written by
 * anyone. */
static enum status read_counts(sqlite3_stmt *stmt, int col, const char *subject,
                               uint32_t *failures, int64_t *at_ms, struct errinfo *e)
{
    const int64_t n = sqlite3_column_int64(stmt, col);

    *failures = (uint32_t)n;
    *at_ms = sqlite3_column_int64(stmt, col + 1);
    if (n < 0 || n > UINT32_MAX || *at_ms < 0)
        return errinfo_set(e, ST_ECORRUPT, "attempts of %s: their row is damaged",
                           subject);
    return ST_OK;
}

enum status store_sqlite_attempts_get(struct store *s, const char *subject,
                                      uint32_t *failures, int64_t *at_ms,
                                      struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;
    int rc;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_ATTEMPTS_GET, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind_subject(c, stmt, 1, subject) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE))
        st = store_sqlite_fail(c, "cannot read the attempts", e);
    else if (rc == SQLITE_DONE)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    else
        st = read_counts(stmt, 0, subject, failures, at_ms, e);
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}

static enum status read_attempts(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                 void *out, struct errinfo *e)
{
    struct store_attempts *a = out;
    struct store_seal_key k = {0};
    struct store_subject who;
    const bool ok = store_sqlite_subject_who(c, stmt, 2, &who, &k);
    int64_t at_ms;
    enum status st;

    memset(a, 0, sizeof *a);
    sodium_memzero(&k, sizeof k);
    if (!ok)
        return errinfo_set(e, ST_ECORRUPT, "attempts: a subject's row is damaged");
    memcpy(a->subject, who.id, sizeof a->subject);
    if ((st = read_counts(stmt, 0, a->subject, &a->failures, &at_ms, e)) == ST_OK)
        store_rules_time(at_ms, a->at);
    return st;
}

enum status store_sqlite_attempts_list(struct store *s, struct store_attempts **out,
                                       size_t *n, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_ATTEMPTS_LIST, &stmt, e)) == ST_OK)
        st = store_sqlite_rows(c, stmt, read_attempts, sizeof **out,
                               "cannot read the attempts", &list, n, e);
    store_sqlite_done(s, c);
    *out = list;
    return st;
}

/* Run a statement on a subject's row, in a transaction. */
static enum status change(struct store_sqlite_conn *c, enum store_sqlite_sql sql,
                          const char *subject, int64_t at_ms, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, sql, &stmt, e);

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind_subject(c, stmt, 1, subject) != SQLITE_OK ||
        (sqlite3_bind_parameter_count(stmt) > 1 &&
         sqlite3_bind_int64(stmt, 2, at_ms) != SQLITE_OK))
        return store_sqlite_fail(c, "cannot count an attempt", e);
    return store_sqlite_run(c, stmt, e);
}

enum status store_sqlite_attempts_fail(struct store *s, const char *subject,
                                       int64_t at_ms, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_write(s, false, &c, e)) != ST_OK)
        return st;
    st = change(c, SQL_ATTEMPTS_FAIL, subject, at_ms, e);
    if (st == ST_OK && sqlite3_changes(c->db) == 0)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    return store_sqlite_written(s, st, e);
}

enum status store_sqlite_attempts_since(struct store *s, const char *subject,
                                        int64_t at_ms, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_write(s, false, &c, e)) != ST_OK)
        return st;
    st = change(c, SQL_ATTEMPTS_SINCE, subject, at_ms, e);
    return store_sqlite_written(s, st, e);
}

enum status store_sqlite_attempts_clear(struct store *s, const struct store_act *by,
                                        const char *subject, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_write(s, by != NULL, &c, e)) != ST_OK)
        return st;
    st = change(c, SQL_ATTEMPTS_CLEAR, subject, 0, e);
    if (st == ST_OK && by != NULL)
        st = store_sqlite_event_add(c, by, "reset_attempts", subject, "", "", e);
    return store_sqlite_written(s, st, e);
}
