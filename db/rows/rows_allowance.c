#include "rows_allowance.h"

#include "errinfo.h"
#include "sql_read.h"

#define HOUR_US INT64_C(3600000000)
/* In a row: a form of 20 uses 20 of them where one an hour is allowed. */
#define MOST_US (24 * HOUR_US)

/* In which one comes back.  All of them may take some microseconds less than an hour. */
static int64_t one_us(const struct store_allowance *a)
{
    return HOUR_US / a->per_hour;
}

/* A time that is ahead by more than another daemon's clock is from before the clock was set back: it
 * cannot be said what has come back since, and nobody shall wait until it is that time again. */
static int64_t left(int64_t used_us, int64_t at_ms, int64_t now_ms)
{
    const int64_t age_ms = at_ms > now_ms ? 0 : now_ms - at_ms;

    return at_ms > now_ms + STORE_AHEAD_MS || age_ms >= used_us / 1000
               ? 0
               : used_us - 1000 * age_ms;
}

enum status rows_allowance_get(struct log_txn *t, const struct log_act *by,
                               struct store_allowance *a, struct errinfo *e)
{
    int64_t used_us = 0, at_ms = 0, over_us;
    struct sql_rows *r;
    enum status st;

    if (a == NULL || a->per_hour == 0)
        return ST_OK;
    st =
        SQL_QUERY(t->sql, &r, e, "SELECT used_us, at_ms FROM allowances WHERE token = $1",
                  sql_text(by->actor));
    if (st == ST_OK && sql_next(r) &&
        !(sql_read_int(r, 0, 0, &used_us) && used_us <= MOST_US &&
          sql_read_int(r, 1, 0, &at_ms)))
        st = errinfo_set(e, ST_ECORRUPT, "allowance of token %s: its row is damaged",
                         by->actor);
    a->used_us = left(used_us, at_ms, by->ms);
    over_us = a->used_us - (a->per_hour - 1) * one_us(a);
    a->wait_ms = over_us > 0 ? (over_us + 999) / 1000 : 0;
    return sql_done(r, st, e);
}

enum status rows_allowance_need(const struct store_allowance *a, struct errinfo *e)
{
    if (a == NULL || a->wait_ms == 0)
        return ST_OK;
    return errinfo_set(e, ST_EDENIED,
                       "this token has added %u templates and subjects within an hour, "
                       "which is its limit",
                       a->per_hour);
}

enum status rows_allowance_use(struct log_txn *t, const struct log_act *by,
                               const struct store_allowance *a, size_t n,
                               struct errinfo *e)
{
    if (a == NULL || a->per_hour == 0 || n == 0)
        return ST_OK;
    return SQL_RUN(t->sql, e,
                   "INSERT INTO allowances (token, used_us, at_ms) VALUES ($1, $2, $3) "
                   "ON CONFLICT (token) DO UPDATE SET used_us = excluded.used_us, "
                   "at_ms = excluded.at_ms",
                   sql_text(by->actor), sql_int(a->used_us + (int64_t)n * one_us(a)),
                   sql_int(by->ms));
}
