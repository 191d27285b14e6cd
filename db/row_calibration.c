#include "row_calibration.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "row_event.h"
#include "store_column.h"
#include "store_mac.h"
#include "store_txn.h"

#define COLUMNS                                                                          \
    "calibration_key, created, actor, engine, shipped, fmr, threshold, low, high, "      \
    "subjects, impostors, genuine, knots"

enum { /* the columns of COLUMNS */
       COL_KEY,
       COL_CREATED,
       COL_ACTOR,
       COL_ENGINE,
       COL_SHIPPED,
       COL_FMR,
       COL_THRESHOLD,
       COL_LOW,
       COL_HIGH,
       COL_SUBJECTS,
       COL_IMPOSTORS,
       COL_GENUINE,
       COL_KNOTS,
       COLS
};

#define KNOT_BYTES 16
#define MAX_SCORE  1e4

static const char label[16] = "surface measure";

/* They are one object, whose latest row is in force; the others are rows that it had. */
static const unsigned char object[STORE_CHAIN_OBJECT] = "calibrations";

/* ---- rows */

static bool read_knots(const struct sql_rows *r, struct calibration *c)
{
    size_t len;
    const unsigned char *bytes =
        store_column_blob(r, COL_KNOTS, 0, (size_t)CALIBRATION_KNOTS * KNOT_BYTES, &len);

    if (bytes == NULL || len % KNOT_BYTES != 0)
        return false;
    c->n = (uint32_t)len / KNOT_BYTES;
    for (uint32_t i = 0; i < c->n; i++) {
        c->knot[i].score = bytes_real(bytes + KNOT_BYTES * i);
        c->knot[i].rate = bytes_real(bytes + KNOT_BYTES * i + 8);
    }
    return true;
}

static bool read_count(const struct sql_rows *r, int col, uint64_t *out)
{
    int64_t v;
    const bool ok = store_column_int(r, col, 0, &v);

    *out = ok ? (uint64_t)v : 0;
    return ok;
}

static void left_of(const struct store_txn *t, const struct sql_rows *r,
                    struct row_event_row *left)
{
    memcpy(left->object, object, sizeof object);
    left->gone = false;
    store_mac_row(t->vault, label, r, 0, COLS, left->mac);
}

static bool was_written(struct store_txn *t, const struct sql_rows *r)
{
    struct row_event_row row;
    bool written = false;

    left_of(t, r, &row);
    return row_event_was(t, &row, &written, NULL) == ST_OK && written;
}

/* A forged threshold would open the door: all of it is looked at. */
static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct store_calibration *k = out;
    struct calibration *c = &k->table;
    const char *bad = NULL;

    memset(k, 0, sizeof *k);
    k->shipped = sql_column(r, COL_SHIPPED).i != 0;
    if (!store_column_int(r, COL_KEY, 1, &k->version))
        bad = "version";
    else if (!store_column_text(r, COL_CREATED, k->created, sizeof k->created) ||
             !store_column_text(r, COL_ACTOR, k->actor, sizeof k->actor) ||
             !store_column_text(r, COL_ENGINE, k->engine, sizeof k->engine))
        bad = "texts";
    else if (!read_count(r, COL_SUBJECTS, &k->subjects) ||
             !read_count(r, COL_IMPOSTORS, &k->impostors) ||
             !read_count(r, COL_GENUINE, &k->genuine))
        bad = "counts";
    else if (!store_column_real(r, COL_FMR, 0, 1, &k->fmr) || k->fmr <= 0 || k->fmr >= 1)
        bad = "fmr";
    else if (!store_column_real(r, COL_THRESHOLD, -MAX_SCORE, MAX_SCORE, &c->threshold) ||
             !read_knots(r, c) || !calibration_valid(c))
        bad = "table";
    else if (!store_column_real(r, COL_LOW, -MAX_SCORE, c->threshold, &k->low) ||
             !store_column_real(r, COL_HIGH, c->threshold, MAX_SCORE, &k->high))
        bad = "interval";
    else if (!was_written(x, r))
        bad = "MAC";
    if (bad != NULL)
        return errinfo_set(e, ST_ECORRUPT, "calibration %lld: its row is damaged (%s)",
                           (long long)k->version, bad);
    return ST_OK;
}

/* ---- the newest */

static enum status read_newest(struct store_txn *t, const struct sql_rows *r,
                               struct store_calibration *k, struct errinfo *e)
{
    struct row_event_row now;
    enum status st = list_row(t, r, k, e);

    if (st != ST_OK)
        return st;
    left_of(t, r, &now);
    if ((st = row_event_is(t, &now, e)) == ST_ECORRUPT)
        (void)errinfo_set(e, st, "calibration %lld is not the one that was made last",
                          (long long)k->version);
    return st;
}

enum status row_calibration_get(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e)
{
    struct row_event_row latest;
    struct sql_rows *r;
    bool found;
    enum status st = sql_query(t->sql,
                               "SELECT " COLUMNS " FROM calibrations "
                               "ORDER BY calibration_key DESC LIMIT 1",
                               NULL, 0, &r, e);

    if ((found = st == ST_OK && sql_next(r)))
        st = read_newest(t, r, k, e);
    if ((st = sql_done(r, st, e)) != ST_OK || found ||
        (st = row_event_latest(t, object, &latest, e)) != ST_OK)
        return st;
    return latest.gone ? errinfo_set(e, ST_ENOTFOUND, "there is no calibration")
                       : errinfo_set(e, ST_ECORRUPT,
                                     "the calibration that was made last is missing");
}

enum status row_calibration_version(struct store_txn *t, int64_t *version,
                                    struct errinfo *e)
{
    struct store_calibration k;
    struct errinfo why;
    const enum status st = row_calibration_get(t, &k, &why);

    *version = st == ST_OK ? k.version : 0;
    return st == ST_OK || st == ST_ENOTFOUND ? ST_OK : errinfo_set(e, st, "%s", why.msg);
}

enum status row_calibration_tell(struct store_txn *t, const struct store_act *by,
                                 int64_t version, struct errinfo *e)
{
    struct row_event_row left = {.gone = true};
    char outcome[32];
    struct sql_rows *r;
    enum status st = SQL_QUERY(
        t->sql, &r, e, "SELECT " COLUMNS " FROM calibrations WHERE calibration_key = $1",
        sql_int(version));

    if (st == ST_OK && sql_next(r))
        left_of(t, r, &left);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    (void)snprintf(outcome, sizeof outcome, "version %" PRId64, version);
    return row_event_leave(t, by, "calibrate", "", "", outcome, &left, e);
}

/* ---- what the others do with them */

/* The number of the next one: greater than any that was given, also where rows are missing. */
static enum status next_version(struct store_txn *t, int64_t *version, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT (SELECT coalesce(max(calibration_key), 0) FROM calibrations), "
                  "(SELECT count(*) FROM events WHERE chain = 0 AND object = $1)",
                  sql_blob(object, sizeof object));

    *version = 0;
    if (st == ST_OK && sql_next(r))
        *version = sql_column(r, 0).i > sql_column(r, 1).i ? sql_column(r, 0).i
                                                           : sql_column(r, 1).i;
    if ((st = sql_done(r, st, e)) == ST_OK && *version == INT64_MAX)
        return errinfo_set(e, ST_ECORRUPT, "calibrations: their numbers are used up");
    *version += st == ST_OK;
    return st;
}

enum status row_calibration_add(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e)
{
    const struct calibration *c = &k->table;
    unsigned char knots[CALIBRATION_KNOTS * KNOT_BYTES], *to = knots;
    enum status st = next_version(t, &k->version, e);

    if (st != ST_OK)
        return st;
    for (uint32_t i = 0; i < c->n; i++) {
        bytes_put_real(&to, c->knot[i].score);
        bytes_put_real(&to, c->knot[i].rate);
    }
    {
        const struct sql_value v[COLS] = {sql_int(k->version),
                                          sql_text(k->created),
                                          sql_text(k->actor),
                                          sql_text(k->engine),
                                          sql_int(k->shipped),
                                          sql_real(k->fmr),
                                          sql_real(c->threshold),
                                          sql_real(k->low),
                                          sql_real(k->high),
                                          sql_int((int64_t)k->subjects),
                                          sql_int((int64_t)k->impostors),
                                          sql_int((int64_t)k->genuine),
                                          sql_blob(knots, (size_t)c->n * KNOT_BYTES)};

        return sql_run(t->sql,
                       "INSERT INTO calibrations (" COLUMNS ") VALUES ($1, $2, $3, $4, "
                       "$5, $6, $7, $8, $9, $10, $11, $12, $13)",
                       v, COLS, e);
    }
}

enum status row_calibration_list(struct store_txn *t, struct store_calibration **out,
                                 size_t *n, struct errinfo *e)
{
    void *list;
    struct sql_rows *r;
    enum status st =
        sql_query(t->sql, "SELECT " COLUMNS " FROM calibrations ORDER BY calibration_key",
                  NULL, 0, &r, e);

    st = store_column_list(r, st, list_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

enum status row_calibration_each(struct store_txn *t, row_event_see *see, void *arg,
                                 struct errinfo *e)
{
    struct row_event_row now = {.gone = false};
    struct sql_rows *r;
    char name[48];
    enum status st =
        sql_query(t->sql, "SELECT " COLUMNS " FROM calibrations ORDER BY calibration_key",
                  NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        left_of(t, r, &now);
        (void)snprintf(name, sizeof name, "calibration %lld",
                       (long long)sql_column(r, COL_KEY).i);
        st = see(arg, &now, name, e);
    }
    return sql_done(r, st, e);
}
