#include "rows_calibration.h"

#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "sql_read.h"

#define COLUMNS                                                                          \
    "calibration_key, revision, created, actor, engine, shipped, fmr, threshold, low, "  \
    "high, subjects, impostors, genuine, knots, mac"

enum { /* of COLUMNS */
       COL_KEY,
       COL_REVISION,
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
       COL_MAC
};

#define KNOT_BYTES 16
#define MAX_SCORE  1e4

const struct rows_table rows_calibrations = {
    .name = "calibrations",
    .all =
        "SELECT " COLUMNS ", calibration_key FROM calibrations ORDER BY calibration_key",
    .remove = {"DELETE FROM calibrations WHERE calibration_key = $1"},
    .columns = COL_MAC,
    .id = COL_KEY,
};

static bool read_knots(const struct sql_rows *r, struct calibration *c)
{
    size_t len;
    const unsigned char *bytes =
        sql_read_blob(r, COL_KNOTS, 0, (size_t)CALIBRATION_KNOTS * KNOT_BYTES, &len);

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
    const bool ok = sql_read_int(r, col, 0, &v);

    *out = ok ? (uint64_t)v : 0;
    return ok;
}

/* A wrong threshold would open the door: all of it is looked at, also of an authentic row. */
static enum status read_row(void *t, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct store_calibration *k = out;
    struct calibration *c = &k->table;
    unsigned char mac[CRYPT_HASH];
    const char *bad = NULL;

    memset(k, 0, sizeof *k);
    k->shipped = sql_column(r, COL_SHIPPED).i != 0;
    if (!sql_read_int(r, COL_KEY, 1, &k->version))
        bad = "version";
    else if (!rows_table_is(t, &rows_calibrations, r, 0, mac))
        bad = "MAC";
    else if (!sql_read_text(r, COL_CREATED, k->created, sizeof k->created) ||
             !sql_read_text(r, COL_ACTOR, k->actor, sizeof k->actor) ||
             !sql_read_text(r, COL_ENGINE, k->engine, sizeof k->engine))
        bad = "texts";
    else if (!read_count(r, COL_SUBJECTS, &k->subjects) ||
             !read_count(r, COL_IMPOSTORS, &k->impostors) ||
             !read_count(r, COL_GENUINE, &k->genuine))
        bad = "counts";
    else if (!sql_read_real(r, COL_FMR, 0, 1, &k->fmr) || k->fmr <= 0 || k->fmr >= 1)
        bad = "fmr";
    else if (!sql_read_real(r, COL_THRESHOLD, -MAX_SCORE, MAX_SCORE, &c->threshold) ||
             !read_knots(r, c) || !calibration_valid(c))
        bad = "table";
    else if (!sql_read_real(r, COL_LOW, -MAX_SCORE, c->threshold, &k->low) ||
             !sql_read_real(r, COL_HIGH, c->threshold, MAX_SCORE, &k->high))
        bad = "interval";
    return bad == NULL ? ST_OK
                       : errinfo_set(e, ST_ECORRUPT,
                                     "calibration %lld: its row is not authentic (%s)",
                                     (long long)k->version, bad);
}

enum status rows_calibration_get(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = sql_query(t->sql,
                               "SELECT " COLUMNS " FROM calibrations "
                               "ORDER BY calibration_key DESC LIMIT 1",
                               NULL, 0, &r, e);

    if ((found = st == ST_OK && sql_next(r)))
        st = read_row(t, r, k, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found ? st
                                : errinfo_set(e, ST_ENOTFOUND, "there is no calibration");
}

static enum status next_version(struct log_txn *t, int64_t *version, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        sql_query(t->sql, "SELECT coalesce(max(calibration_key), 0) FROM calibrations",
                  NULL, 0, &r, e);

    *version = 0;
    if (st == ST_OK && sql_next(r) && sql_column(r, 0).i < INT64_MAX)
        *version = sql_column(r, 0).i + 1;
    else if (st == ST_OK)
        st = errinfo_set(e, ST_ECORRUPT, "calibrations: their numbers are used up");
    return sql_done(r, st, e);
}

enum status rows_calibration_add(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e)
{
    const struct calibration *c = &k->table;
    unsigned char knots[CALIBRATION_KNOTS * KNOT_BYTES], mac[CRYPT_HASH], *to = knots;
    enum status st;

    if (k->version == 0 && (st = next_version(t, &k->version, e)) != ST_OK)
        return st;
    for (uint32_t i = 0; i < c->n; i++) {
        bytes_put_real(&to, c->knot[i].score);
        bytes_put_real(&to, c->knot[i].rate);
    }
    {
        struct sql_value v[COL_MAC + 1] = {
            [COL_KEY] = sql_int(k->version),
            [COL_REVISION] = sql_int(1),
            [COL_CREATED] = sql_text(k->created),
            [COL_ACTOR] = sql_text(k->actor),
            [COL_ENGINE] = sql_text(k->engine),
            [COL_SHIPPED] = sql_int(k->shipped),
            [COL_FMR] = sql_real(k->fmr),
            [COL_THRESHOLD] = sql_real(c->threshold),
            [COL_LOW] = sql_real(k->low),
            [COL_HIGH] = sql_real(k->high),
            [COL_SUBJECTS] = sql_int((int64_t)k->subjects),
            [COL_IMPOSTORS] = sql_int((int64_t)k->impostors),
            [COL_GENUINE] = sql_int((int64_t)k->genuine),
            [COL_KNOTS] = sql_blob(knots, (size_t)c->n * KNOT_BYTES),
        };

        return rows_table_insert(t, &rows_calibrations,
                                 "INSERT INTO calibrations (" COLUMNS
                                 ") VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, "
                                 "$11, $12, $13, $14, $15)",
                                 v, mac, e);
    }
}

enum status rows_calibration_list(struct log_txn *t, struct store_calibration **out,
                                  size_t *n, struct errinfo *e)
{
    void *list = NULL;
    struct sql_rows *r;
    enum status st = sql_query(t->sql, rows_calibrations.all, NULL, 0, &r, e);

    st = sql_read_list(r, st, read_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}
