#include "row_attempts.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "row_subject.h"
#include "store_column.h"
#include "store_txn.h"
#include "utc.h"

#define DAY INT64_C(86400000)

/* The age of a time; one in the future is from before the clock was set back. */
static int64_t age(int64_t at, int64_t now, bool *future)
{
    *future |= at > now;
    return at > now ? 0 : now - at;
}

static enum status damaged(const struct store_attempts *a, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT, "attempts of %s: their row is damaged",
                       a->subject);
}

static void set_own(struct store_attempts *out, int64_t at, int64_t now, bool *future)
{
    if (out->failures == 0)
        return;
    out->age_ms = age(at, now, future);
    utc_print(now - out->age_ms, out->at);
}

/* The failures for one subject: of the token, and of the others. */
static enum status get_of_subject(struct store_txn *t, int64_t now,
                                  struct store_attempts *out, bool *future,
                                  struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    struct sql_rows *r;
    int64_t at = 0, others_at = 0;
    bool found;
    enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT CAST(coalesce(sum(CASE WHEN token = $2 THEN failures END), 0) AS bigint), "
        "coalesce(max(CASE WHEN token = $2 THEN at_ms END), 0), "
        "CAST(coalesce(sum(CASE WHEN token <> $2 AND at_ms > $3 THEN failures END), 0) "
        "AS bigint), coalesce(max(CASE WHEN token <> $2 THEN at_ms END), 0) "
        "FROM subjects s LEFT JOIN attempts a ON a.subject_key = s.subject_key "
        "WHERE lookup = $1 GROUP BY s.subject_key",
        row_subject_lookup(t, out->subject, lookup), sql_text(out->token),
        sql_int(now - STORE_TRIED_MS));

    if ((found = st == ST_OK && sql_next(r)) &&
        !(store_column_count(r, 0, UINT32_MAX, &out->failures) &&
          store_column_int(r, 1, 0, &at) &&
          store_column_count(r, 2, UINT32_MAX, &out->others) &&
          store_column_int(r, 3, 0, &others_at)))
        st = damaged(out, e);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    if (!found)
        return errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", out->subject);
    set_own(out, at, now, future);
    if (out->others > 0)
        out->others_age_ms = age(others_at, now, future);
    return ST_OK;
}

/* The other subjects that the token failed for. */
static enum status get_of_token(struct store_txn *t, int64_t now,
                                struct store_attempts *out, bool *future,
                                struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    struct sql_rows *r;
    int64_t first = 0, last = 0;
    bool ahead = false;
    enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT CAST(coalesce(sum(CASE WHEN at_ms > $4 THEN 1 END), 0) AS bigint), "
        "coalesce(min(CASE WHEN at_ms > $4 THEN at_ms END), 0), "
        "coalesce(max(at_ms), 0), count(*) FROM attempts WHERE token = $1 AND at_ms > $2 "
        "AND subject_key <> (SELECT subject_key FROM subjects WHERE lookup = $3)",
        sql_text(out->token), sql_int(now - STORE_TRIED_WARN_MS),
        row_subject_lookup(t, out->subject, lookup), sql_int(now - STORE_TRIED_MS));

    if (st == ST_OK && sql_next(r) &&
        !(store_column_count(r, 0, UINT32_MAX, &out->tried) &&
          store_column_int(r, 1, 0, &first) && store_column_int(r, 2, 0, &last) &&
          store_column_count(r, 3, UINT32_MAX, &out->tried_warn)))
        st = damaged(out, e);
    if (out->tried > 0) {
        (void)age(last, now, future);
        out->tried_age_ms = age(first, now, &ahead);
    }
    return sql_done(r, st, e);
}

enum status row_attempts_get(struct store_txn *t, const char *subject, const char *token,
                             int64_t now, struct store_attempts *out, bool *future,
                             struct errinfo *e)
{
    enum status st;

    *future = false;
    memset(out, 0, sizeof *out);
    (void)snprintf(out->subject, sizeof out->subject, "%s", subject);
    (void)snprintf(out->token, sizeof out->token, "%s", token);
    if ((st = get_of_subject(t, now, out, future, e)) != ST_OK)
        return st;
    return get_of_token(t, now, out, future, e);
}

enum status row_attempts_fail(struct store_txn *t, const char *subject, const char *token,
                              int64_t now, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    const enum status st =
        SQL_RUN(t->sql, e,
                "INSERT INTO attempts (subject_key, token, failures, at_ms) "
                "SELECT subject_key, CAST($2 AS text), 1, CAST($3 AS bigint) "
                "FROM subjects WHERE lookup = $1 "
                "ON CONFLICT (subject_key, token) DO UPDATE SET "
                "failures = CASE WHEN attempts.failures < 1000000 "
                "THEN attempts.failures + 1 ELSE 1000000 END, at_ms = excluded.at_ms",
                row_subject_lookup(t, subject, lookup), sql_text(token), sql_int(now));

    if (st != ST_OK)
        return st;
    if (sql_changed(t->sql) == 0)
        return errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE token = $1 AND at_ms < $2",
                   sql_text(token), sql_int(now - STORE_ATTEMPTS_DAYS * DAY));
}

#define OF "(SELECT subject_key FROM subjects WHERE lookup = $1)"

enum status row_attempts_not_after(struct store_txn *t, const char *subject,
                                   const char *token, int64_t now, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];

    return SQL_RUN(t->sql, e,
                   "UPDATE attempts SET at_ms = $2 WHERE at_ms > $2 "
                   "AND (subject_key = " OF " OR token = $3)",
                   row_subject_lookup(t, subject, lookup), sql_int(now), sql_text(token));
}

enum status row_attempts_match(struct store_txn *t, const char *subject,
                               const char *token, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];

    return SQL_RUN(t->sql, e,
                   "DELETE FROM attempts WHERE subject_key = " OF " AND token = $2",
                   row_subject_lookup(t, subject, lookup), sql_text(token));
}

enum status row_attempts_clear(struct store_txn *t, const char *subject,
                               struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];

    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE subject_key = " OF,
                   row_subject_lookup(t, subject, lookup));
}

enum status row_attempts_revoke(struct store_txn *t, const char *token, struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE token = $1", sql_text(token));
}

struct listing {
    struct store_txn *t;
    int64_t now;
};

static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    const struct listing *l = x;
    struct store_attempts *a = out;
    struct row_crypt_key k = {0};
    struct store_subject who;
    enum status st = row_subject_who(l->t, r, 3, &who, &k, e);
    int64_t at;
    bool future = false;

    memset(a, 0, sizeof *a);
    sodium_memzero(&k, sizeof k);
    if (st != ST_OK)
        return st;
    memcpy(a->subject, who.id, sizeof a->subject);
    if (!store_column_text(r, 0, a->token, sizeof a->token) ||
        !store_column_count(r, 1, UINT32_MAX, &a->failures) ||
        !store_column_int(r, 2, 0, &at))
        return damaged(a, e);
    set_own(a, at, l->now, &future);
    return ST_OK;
}

enum status row_attempts_list(struct store_txn *t, int64_t now,
                              struct store_attempts **out, size_t *n, struct errinfo *e)
{
    struct listing l = {t, now};
    void *list;
    struct sql_rows *r;
    enum status st = sql_query(
        t->sql,
        "SELECT a.token, a.failures, a.at_ms, " ROW_SUBJECT_WHO
        " FROM attempts a JOIN subjects s USING (subject_key) ORDER BY subject_key, token",
        NULL, 0, &r, e);

    st = store_column_list(r, st, list_row, &l, sizeof **out, &list, n, e);
    *out = list;
    return st;
}
