#include "rows_attempts.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "rows_subject.h"
#include "sql_read.h"
#include "utc.h"

#define DAY INT64_C(86400000)

static enum status damaged(const struct store_attempts *a, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT, "attempts of %s: their row is damaged",
                       a->subject);
}

/* A time in the future is from before the clock was set back, and is read as now. */
static int64_t age(int64_t at, int64_t now)
{
    return at > now ? 0 : now - at;
}

static void set_own(struct store_attempts *out, int64_t at, int64_t now)
{
    if (out->failures == 0)
        return;
    out->age_ms = age(at, now);
    utc_print(now - out->age_ms, out->at);
}

/* Of the subject whose key this is, and of the token $2 elsewhere.  They are counted here: on a
 * server the aggregates, twice, were a tenth of a verification. */
#define ATTEMPTS(KEY)                                                                    \
    "SELECT 1, token, failures, at_ms, suspicion FROM attempts WHERE subject_key = " KEY \
    " UNION ALL SELECT 0, token, failures, at_ms, suspicion FROM attempts "              \
    "WHERE token = $2 AND at_ms > $3 AND failures > 0 AND subject_key <> " KEY

struct counting {
    int64_t tried_since, others_since; /* begin of STORE_TRIED_MS, of STORE_FAILED_MS */
    int64_t own, others, tried, last;  /* times; 0: none */
};

static int64_t later(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static void rows_attempts_add(uint32_t *sum, uint32_t n)
{
    *sum += n < UINT32_MAX - *sum ? n : UINT32_MAX - *sum;
}

static bool count_row(const struct sql_rows *r, struct counting *c,
                      struct store_attempts *out)
{
    const bool here = sql_column(r, 0).i == 1;
    char token[STORE_NAME_MAX + 1];
    uint32_t failures, suspicion;
    int64_t at;

    if (!sql_read_text(r, 1, token, sizeof token) ||
        !sql_read_count(r, 2, UINT32_MAX, &failures) || !sql_read_int(r, 3, 0, &at) ||
        !sql_read_count(r, 4, 1000000, &suspicion))
        return false;
    c->last = later(at, c->last);
    if (here && strcmp(token, out->token) == 0) {
        out->failures = failures;
        out->suspicion = suspicion;
        c->own = at;
    } else if (here) {
        rows_attempts_add(&out->others_suspicion, suspicion);
        if (failures > 0 && at > c->others_since) {
            rows_attempts_add(&out->others, failures);
            c->others = later(at, c->others);
        }
    } else {
        out->tried_warn++;
        if (at > c->tried_since) {
            out->tried++;
            c->tried = later(at, c->tried);
        }
    }
    return true;
}

static enum status get(struct log_txn *t, const char *text, struct sql_value of,
                       const char *id, const char *token, int64_t now,
                       struct store_attempts *out, bool *future, struct errinfo *e)
{
    struct counting c = {.tried_since = now - STORE_TRIED_MS,
                         .others_since = now - STORE_FAILED_MS};
    struct sql_rows *r;
    const struct sql_value v[] = {of, sql_text(token), sql_int(c.others_since)};
    enum status st = sql_query(t->sql, text, v, 3, &r, e);

    memset(out, 0, sizeof *out);
    (void)snprintf(out->subject, sizeof out->subject, "%s", id);
    (void)snprintf(out->token, sizeof out->token, "%s", token);
    while (st == ST_OK && sql_next(r))
        if (!count_row(r, &c, out))
            st = damaged(out, e);
    *future = c.last > now;
    set_own(out, c.own, now);
    if (out->others > 0)
        out->others_age_ms = age(c.others, now);
    if (out->tried > 0)
        out->tried_age_ms = age(c.tried, now);
    return sql_done(r, st, e);
}

enum status rows_attempts_get(struct log_txn *t, const struct store_subject *subject,
                              const char *token, int64_t now, struct store_attempts *out,
                              bool *future, struct errinfo *e)
{
    return get(t, ATTEMPTS("$1"), sql_int(subject->key), subject->id, token, now, out,
               future, e);
}

enum status rows_attempts_find(struct log_txn *t, const struct rows_subject *of,
                               const char *token, int64_t now, struct store_attempts *out,
                               bool *future, struct errinfo *e)
{
    return get(t, ATTEMPTS("(SELECT s.subject_key FROM subjects s WHERE s.lookup = $1)"),
               sql_blob(of->lookup, sizeof of->lookup), of->one.id, token, now, out,
               future, e);
}

enum status rows_attempts_fail(struct log_txn *t, const struct store_subject *subject,
                               const char *token, int64_t now, uint32_t suspicion,
                               struct errinfo *e)
{
    uint64_t n = 0;
    enum status st =
        SQL_RUN(t->sql, e,
                "INSERT INTO attempts (subject_key, token, failures, at_ms, suspicion) "
                "SELECT subject_key, CAST($2 AS text), 1, CAST($3 AS bigint), "
                "CAST($4 AS bigint) FROM subjects WHERE subject_key = $1 "
                "ON CONFLICT (subject_key, token) DO UPDATE SET "
                "failures = CASE WHEN attempts.failures < 1000000 "
                "THEN attempts.failures + 1 ELSE 1000000 END, at_ms = excluded.at_ms, "
                "suspicion = excluded.suspicion",
                sql_int(subject->key), sql_text(token), sql_int(now), sql_int(suspicion));

    if (st != ST_OK || (st = sql_changed(t->sql, &n, e)) != ST_OK)
        return st;
    if (n == 0)
        return errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject->id);
    return ST_OK;
}

enum status rows_attempts_expire(struct log_txn *t, const char *token, int64_t now,
                                 struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE token = $1 AND at_ms < $2",
                   sql_text(token), sql_int(now - STORE_ATTEMPTS_DAYS * DAY));
}

enum status rows_attempts_not_after(struct log_txn *t,
                                    const struct store_subject *subject,
                                    const char *token, int64_t now, struct errinfo *e)
{
    return SQL_RUN(t->sql, e,
                   "UPDATE attempts SET at_ms = $2 WHERE at_ms > $2 "
                   "AND (subject_key = $1 OR token = $3)",
                   sql_int(subject->key), sql_int(now), sql_text(token));
}

enum status rows_attempts_match(struct log_txn *t, const struct store_subject *subject,
                                const char *token, uint32_t suspicion, struct errinfo *e)
{
    if (suspicion == 0)
        return SQL_RUN(t->sql, e,
                       "DELETE FROM attempts WHERE subject_key = $1 AND token = $2",
                       sql_int(subject->key), sql_text(token));
    return SQL_RUN(t->sql, e,
                   "UPDATE attempts SET failures = 0, suspicion = $3 "
                   "WHERE subject_key = $1 AND token = $2",
                   sql_int(subject->key), sql_text(token), sql_int(suspicion));
}

enum status rows_attempts_told(struct log_txn *t, const struct store_subject *subject,
                               struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "UPDATE attempts SET suspicion = 0 WHERE subject_key = $1",
                   sql_int(subject->key));
}

enum status rows_attempts_clear(struct log_txn *t, const struct store_subject *subject,
                                struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE subject_key = $1",
                   sql_int(subject->key));
}

enum status rows_attempts_revoke(struct log_txn *t, const char *token, struct errinfo *e)
{
    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE token = $1", sql_text(token));
}

enum status rows_attempts_each(struct log_txn *t, const struct store_subject *subject,
                               enum status (*visit)(void *arg, const char *token,
                                                    struct errinfo *e),
                               void *arg, struct errinfo *e)
{
    const struct store_attempts of = {.failures = 0};
    char token[STORE_NAME_MAX + 1];
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT token FROM attempts WHERE subject_key = $1 AND failures > 0",
                  sql_int(subject->key));

    while (st == ST_OK && sql_next(r))
        st = sql_read_text(r, 0, token, sizeof token) ? visit(arg, token, e)
                                                      : damaged(&of, e);
    return sql_done(r, st, e);
}

struct rows_attempts_listing {
    struct log_txn *t;
    int64_t now;
};

static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    const struct rows_attempts_listing *l = x;
    struct store_attempts *a = out;
    struct rows_subject of;
    enum status st = rows_table_read(l->t, &rows_subjects, r, 3, &of, e);
    int64_t at;

    memset(a, 0, sizeof *a);
    memcpy(a->subject, of.one.id, sizeof a->subject);
    sodium_memzero(&of, sizeof of);
    if (st != ST_OK)
        return st;
    if (!sql_read_text(r, 0, a->token, sizeof a->token) ||
        !sql_read_count(r, 1, UINT32_MAX, &a->failures) || !sql_read_int(r, 2, 0, &at))
        return damaged(a, e);
    set_own(a, at, l->now);
    return ST_OK;
}

enum status rows_attempts_list(struct log_txn *t, int64_t now,
                               struct store_attempts **out, size_t *n, struct errinfo *e)
{
    struct rows_attempts_listing l = {t, now};
    void *list = NULL;
    struct sql_rows *r;
    enum status st = sql_query(t->sql,
                               "SELECT a.token, a.failures, a.at_ms, " ROWS_SUBJECT
                               " FROM attempts a JOIN subjects s USING (subject_key) "
                               "WHERE a.failures > 0 ORDER BY a.subject_key, a.token",
                               NULL, 0, &r, e);

    st = sql_read_list(r, st, list_row, &l, sizeof **out, &list, n, e);
    *out = list;
    return st;
}
