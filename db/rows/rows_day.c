#include "rows_day.h"

#include <stdio.h>
#include <string.h>

#include "bytes.h"
#include "sql_read.h"

#define BINS_BYTES (4 * STORE_DAY_BINS)

static void read_bins(const struct sql_rows *r, int col, uint32_t bin[STORE_DAY_BINS])
{
    unsigned char bytes[BINS_BYTES] = {0};
    struct bytes from = {bytes, bytes + sizeof bytes};
    uint64_t n;

    (void)sql_read_bytes(r, col, bytes, sizeof bytes);
    for (int i = 0; i < STORE_DAY_BINS; i++)
        bin[i] = bytes_get_number(&from, 4, &n) ? (uint32_t)n : 0;
}

static int bin_of(double score)
{
    const double at = (score - STORE_DAY_FROM) / STORE_DAY_STEP;

    return !(at > 0) ? 0 : at >= STORE_DAY_BINS ? STORE_DAY_BINS - 1 : (int)at;
}

enum status rows_day_get(struct log_txn *t, const char *at, const char *decision,
                         struct store_day *out, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st;

    memset(out, 0, sizeof *out);
    (void)snprintf(out->day, sizeof out->day, "%s", at);
    (void)snprintf(out->decision, sizeof out->decision, "%s", decision);
    if ((st = SQL_QUERY(t->sql, &r, e,
                        "SELECT bins FROM days WHERE day = $1 AND decision = $2 "
                        "AND daemon = $3",
                        sql_text(out->day), sql_text(decision),
                        sql_int(t->log->daemon))) == ST_OK &&
        sql_next(r))
        read_bins(r, 0, out->bin);
    return sql_done(r, st, e);
}

enum status rows_day_count(struct log_txn *t, struct store_day *day, double score,
                           struct errinfo *e)
{
    unsigned char bytes[BINS_BYTES], *to = bytes;

    day->bin[bin_of(score)]++;
    for (int i = 0; i < STORE_DAY_BINS; i++)
        bytes_put_number(&to, day->bin[i], 4);
    return SQL_RUN(
        t->sql, e,
        "INSERT INTO days (day, decision, daemon, bins) VALUES ($1, $2, $3, $4) "
        "ON CONFLICT (day, decision, daemon) DO UPDATE SET bins = excluded.bins",
        sql_text(day->day), sql_text(day->decision), sql_int(t->log->daemon),
        sql_blob(bytes, sizeof bytes));
}

static enum status rows_day_read_row(void *arg, const struct sql_rows *r, void *out,
                                     struct errinfo *e)
{
    struct store_day *one = out;

    (void)arg;
    (void)e;
    memset(one, 0, sizeof *one);
    (void)sql_read_text(r, 0, one->day, sizeof one->day);
    (void)sql_read_text(r, 1, one->decision, sizeof one->decision);
    read_bins(r, 2, one->bin);
    return ST_OK;
}

/* Each daemon has its own; one behind the other. */
static size_t add_up(struct store_day *day, size_t n)
{
    size_t to = 0;

    for (size_t i = 0; i < n; i++) {
        if (i == 0 || strcmp(day[to - 1].day, day[i].day) != 0 ||
            strcmp(day[to - 1].decision, day[i].decision) != 0)
            day[to++] = day[i];
        else
            for (int k = 0; k < STORE_DAY_BINS; k++)
                day[to - 1].bin[k] += day[i].bin[k];
    }
    return to;
}

enum status rows_day_list(struct log_txn *t, const char *since, struct store_day **out,
                          size_t *n, struct errinfo *e)
{
    void *list = NULL;
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT day, decision, bins FROM days WHERE day >= $1 "
                  "AND decision IN ('match', 'no_match', 'inconclusive') "
                  "ORDER BY day, decision, daemon LIMIT $2",
                  sql_text(since), sql_int(3 * (STORE_DAYS + 1) * LOG_DAEMONS));

    st = sql_read_list(r, st, rows_day_read_row, NULL, sizeof **out, &list, n, e);
    *out = list;
    *n = add_up(*out, *n);
    return st;
}
