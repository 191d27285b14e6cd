#include "rows_scan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sql_read.h"
#include "utc.h"

#define DAY_MS INT64_C(86400000)

/* The most that one daemon counts for a token and a day; the sums of the noise and of the quality are of as many scans. */
#define COUNT_MAX INT64_C(1000000000)
#define ROWS_MAX  1000000

/* value in units of 1/1000; of no scan it is more than 100,000. */
static int64_t thousandths(double value)
{
    return !(value > 0) ? 0 : (int64_t)lround(fmin(value, 100) * 1000);
}

enum status rows_scan_count(struct log_txn *t, const struct store_scan *scan,
                            struct errinfo *e)
{
    char day[STORE_DAY + 1];

    (void)snprintf(day, sizeof day, "%.*s", STORE_DAY, t->by.at);
    return SQL_RUN(
        t->sql, e,
        "INSERT INTO scans (day, token, daemon, n, unusable, noise_um, quality) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7) "
        "ON CONFLICT (token, day, daemon) DO UPDATE SET n = scans.n + excluded.n, "
        "unusable = scans.unusable + excluded.unusable, "
        "noise_um = scans.noise_um + excluded.noise_um, "
        "quality = scans.quality + excluded.quality",
        sql_text(day), sql_text(t->by.actor), sql_int(t->log->daemon),
        sql_int(!scan->unusable), sql_int(scan->unusable),
        sql_int(scan->unusable ? 0 : thousandths(scan->noise_mm)),
        sql_int(scan->unusable ? 0 : thousandths(scan->quality)));
}

static bool read_sums(const struct sql_rows *r, struct store_scans *one)
{
    int64_t *const sum[] = {&one->n, &one->unusable, &one->noise_um, &one->quality};
    char day[STORE_DAY + 1];
    int64_t ms;

    if (!sql_read_text(r, 0, one->token, sizeof one->token) ||
        !sql_read_text(r, 1, day, sizeof day) || !utc_read(day, &ms))
        return false;
    one->day = ms / DAY_MS;
    for (int i = 0; i < 4; i++)
        if (!sql_read_int(r, 2 + i, 0, sum[i]) ||
            *sum[i] > COUNT_MAX * (i < 2 ? 1 : 100000))
            return false;
    return true;
}

static enum status rows_scan_read_row(void *arg, const struct sql_rows *r, void *out,
                                      struct errinfo *e)
{
    struct store_scans *one = out;

    (void)arg;
    (void)e;
    *one = (struct store_scans){.n = 0};
    if (!read_sums(r, one))
        *one = (struct store_scans){.n = 0};
    return ST_OK;
}

/* Each daemon has a row of its own; they follow one another.  Drops the empty ones. */
static size_t rows_scan_add_up(struct store_scans *all, size_t n)
{
    size_t to = 0;

    for (size_t i = 0; i < n; i++) {
        const struct store_scans one = all[i];
        struct store_scans *last = to > 0 ? &all[to - 1] : NULL;

        if (one.n == 0 && one.unusable == 0)
            continue;
        if (last == NULL || last->day != one.day || strcmp(last->token, one.token) != 0) {
            all[to++] = one;
            continue;
        }
        last->n += one.n;
        last->unusable += one.unusable;
        last->noise_um += one.noise_um;
        last->quality += one.quality;
    }
    return to;
}

enum status rows_scan_list(struct log_txn *t, const char *since, struct store_scans **out,
                           size_t *n, struct errinfo *e)
{
    void *list = NULL;
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT token, day, n, unusable, noise_um, quality FROM scans "
                  "WHERE day >= $1 ORDER BY token, day, daemon LIMIT $2",
                  sql_text(since), sql_int(ROWS_MAX));

    st = sql_read_list(r, st, rows_scan_read_row, NULL, sizeof **out, &list, n, e);
    *out = list;
    *n = rows_scan_add_up(*out, *n);
    return st;
}
