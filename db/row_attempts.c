#include "row_attempts.h"

#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "row_subject.h"
#include "store_column.h"
#include "store_txn.h"
#include "utc.h"

static enum status read_counts(const struct sql_rows *r, struct store_attempts *out,
                               int64_t *at_ms, struct errinfo *e)
{
    if (store_column_count(r, 0, UINT32_MAX, &out->failures) &&
        store_column_int(r, 1, 0, at_ms))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "attempts of %s: their row is damaged",
                       out->subject);
}

enum status row_attempts_get(struct store_txn *t, const char *subject, int64_t now,
                             struct store_attempts *out, bool *future, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    struct sql_rows *r;
    int64_t at = 0;
    bool found;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT coalesce(failures, 0), coalesce(at_ms, 0) FROM subjects "
                  "LEFT JOIN attempts USING (subject_key) WHERE lookup = $1",
                  row_subject_lookup(t, subject, lookup));

    memset(out, 0, sizeof *out);
    memcpy(out->subject, subject, strlen(subject) + 1);
    if ((found = st == ST_OK && sql_next(r)))
        st = read_counts(r, out, &at, e);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    if (!found)
        return errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    *future = out->failures > 0 && at > now;
    if (*future)
        at = now;
    if (out->failures > 0) {
        utc_print(at, out->at);
        out->age_ms = now - at;
    }
    return ST_OK;
}

enum status row_attempts_fail(struct store_txn *t, const char *subject, int64_t now,
                              struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    const enum status st =
        SQL_RUN(t->sql, e,
                "INSERT INTO attempts (subject_key, failures, at_ms) "
                "SELECT subject_key, 1, CAST($2 AS bigint) FROM subjects "
                "WHERE lookup = $1 ON CONFLICT (subject_key) DO UPDATE SET "
                "failures = CASE WHEN attempts.failures < 1000000 "
                "THEN attempts.failures + 1 ELSE 1000000 END, at_ms = excluded.at_ms",
                row_subject_lookup(t, subject, lookup), sql_int(now));

    if (st == ST_OK && sql_changed(t->sql) == 0)
        return errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    return st;
}

#define OF "(SELECT subject_key FROM subjects WHERE lookup = $1)"

enum status row_attempts_not_after(struct store_txn *t, const char *subject, int64_t now,
                                   struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];

    return SQL_RUN(t->sql, e,
                   "UPDATE attempts SET at_ms = $2 WHERE at_ms > $2 "
                   "AND subject_key = " OF,
                   row_subject_lookup(t, subject, lookup), sql_int(now));
}

enum status row_attempts_clear(struct store_txn *t, const char *subject,
                               struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];

    return SQL_RUN(t->sql, e, "DELETE FROM attempts WHERE subject_key = " OF,
                   row_subject_lookup(t, subject, lookup));
}

static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct store_attempts *a = out;
    struct row_crypt_key k = {0};
    struct store_subject who;
    enum status st = row_subject_who(x, r, 2, &who, &k, e);
    int64_t at;

    memset(a, 0, sizeof *a);
    sodium_memzero(&k, sizeof k);
    if (st != ST_OK)
        return st;
    memcpy(a->subject, who.id, sizeof a->subject);
    if ((st = read_counts(r, a, &at, e)) == ST_OK)
        utc_print(at, a->at);
    return st;
}

enum status row_attempts_list(struct store_txn *t, struct store_attempts **out, size_t *n,
                              struct errinfo *e)
{
    void *list;
    struct sql_rows *r;
    enum status st = sql_query(
        t->sql,
        "SELECT a.failures, a.at_ms, " ROW_SUBJECT_WHO
        " FROM attempts a JOIN subjects s USING (subject_key) ORDER BY subject_key",
        NULL, 0, &r, e);

    st = store_column_list(r, st, list_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}
