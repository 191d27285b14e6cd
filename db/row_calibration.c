#include "row_calibration.h"

#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "store_column.h"
#include "store_mac.h"
#include "store_txn.h"

#define COLUMNS                                                                          \
    "calibration_key, created, actor, engine, shipped, fmr, threshold_mm, low_mm, "      \
    "high_mm, subjects, impostors, genuine, halving_mm, knots, mac"

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
       COL_HALVING,
       COL_KNOTS,
       COL_MAC, /* of all before it */
       COLS
};

#define KNOT_BYTES 16
#define MAX_MM     1e3

static const char label[16] = "surface measure", label_end[16] = "surface newest";

/* ---- rows */

static bool read_knots(const struct sql_rows *r, struct decision *d)
{
    size_t len;
    const unsigned char *bytes =
        store_column_blob(r, COL_KNOTS, 0, (size_t)DECISION_KNOTS * KNOT_BYTES, &len);

    if (bytes == NULL || len % KNOT_BYTES != 0)
        return false;
    d->n = (uint32_t)len / KNOT_BYTES;
    for (uint32_t i = 0; i < d->n; i++) {
        d->knot[i].mm = bytes_real(bytes + KNOT_BYTES * i);
        d->knot[i].rate = bytes_real(bytes + KNOT_BYTES * i + 8);
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

/* A forged threshold would open the door: all of it is looked at. */
static enum status list_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    const struct store_txn *t = x;
    struct store_calibration *k = out;
    struct decision *d = &k->decision;
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
    else if (!store_column_real(r, COL_LOW, 0, MAX_MM, &k->low_mm) ||
             !store_column_real(r, COL_HIGH, k->low_mm, MAX_MM, &k->high_mm))
        bad = "interval";
    else if (!store_column_real(r, COL_THRESHOLD, 0, MAX_MM, &d->threshold_mm) ||
             !store_column_real(r, COL_HALVING, 0, MAX_MM, &d->halving_mm) ||
             !read_knots(r, d) || !decision_valid(d))
        bad = "table";
    else if (!store_mac_right(t->vault, label, r, COL_MAC))
        bad = "MAC";
    if (bad != NULL)
        return errinfo_set(e, ST_ECORRUPT, "calibration %lld: its row is damaged (%s)",
                           (long long)k->version, bad);
    return ST_OK;
}

/* ---- the end: the newest one is the newest */

static enum status set_end(struct store_txn *t, int64_t version, struct errinfo *e)
{
    const struct sql_value v = sql_int(version);
    unsigned char mac[VAULT_HASH];

    store_mac(t->vault, label_end, &v, 1, mac);
    return SQL_RUN(t->sql, e,
                   "INSERT INTO calibrations_end (calibrations_key, version, mac) "
                   "VALUES (1, $1, $2) ON CONFLICT (calibrations_key) DO UPDATE "
                   "SET version = excluded.version, mac = excluded.mac",
                   v, sql_blob(mac, sizeof mac));
}

enum status row_calibration_begin(struct store_txn *t, struct errinfo *e)
{
    return set_end(t, 0, e);
}

enum status row_calibration_version(struct store_txn *t, int64_t *version,
                                    struct errinfo *e)
{
    struct sql_rows *r;
    bool sound;
    enum status st =
        sql_query(t->sql, "SELECT version, mac FROM calibrations_end", NULL, 0, &r, e);

    *version = 0;
    sound = st == ST_OK && sql_next(r) && store_column_int(r, 0, 0, version) &&
            store_mac_right(t->vault, label_end, r, 1);
    if ((st = sql_done(r, st, e)) == ST_OK && !sound) {
        *version = 0;
        st = errinfo_set(e, ST_ECORRUPT,
                         "calibrations: the record of the newest is damaged");
    }
    return st;
}

static enum status not_newest(int64_t newest, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT, "calibration %lld, the newest, is not there",
                       (long long)newest);
}

/* ---- what the others do with them */

/* The number of the next one: greater than any that was given, also where the record of the
 * newest is damaged, which a new one makes good. */
static enum status next_version(struct store_txn *t, int64_t *version, struct errinfo *e)
{
    struct errinfo why;
    struct sql_rows *r;
    enum status st = row_calibration_version(t, version, &why);

    if (st != ST_OK && st != ST_ECORRUPT)
        return errinfo_set(e, st, "%s", why.msg);
    st = sql_query(t->sql, "SELECT coalesce(max(calibration_key), 0) FROM calibrations",
                   NULL, 0, &r, e);
    if (st == ST_OK && sql_next(r) && sql_column(r, 0).i > *version)
        *version = sql_column(r, 0).i;
    if ((st = sql_done(r, st, e)) == ST_OK && *version == INT64_MAX)
        return errinfo_set(e, ST_ECORRUPT, "calibrations: their numbers are used up");
    *version += st == ST_OK;
    return st;
}

enum status row_calibration_add(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e)
{
    const struct decision *d = &k->decision;
    unsigned char knots[DECISION_KNOTS * KNOT_BYTES], *to = knots, mac[VAULT_HASH];
    enum status st = next_version(t, &k->version, e);

    if (st != ST_OK)
        return st;
    for (uint32_t i = 0; i < d->n; i++) {
        bytes_put_real(&to, d->knot[i].mm);
        bytes_put_real(&to, d->knot[i].rate);
    }
    {
        struct sql_value v[COLS] = {sql_int(k->version),
                                    sql_text(k->created),
                                    sql_text(k->actor),
                                    sql_text(k->engine),
                                    sql_int(k->shipped),
                                    sql_real(k->fmr),
                                    sql_real(d->threshold_mm),
                                    sql_real(k->low_mm),
                                    sql_real(k->high_mm),
                                    sql_int((int64_t)k->subjects),
                                    sql_int((int64_t)k->impostors),
                                    sql_int((int64_t)k->genuine),
                                    sql_real(d->halving_mm),
                                    sql_blob(knots, (size_t)d->n * KNOT_BYTES)};

        store_mac(t->vault, label, v, COL_MAC, mac);
        v[COL_MAC] = sql_blob(mac, sizeof mac);
        st = sql_run(t->sql,
                     "INSERT INTO calibrations (" COLUMNS ") VALUES ($1, $2, $3, $4, $5, "
                     "$6, $7, $8, $9, $10, $11, $12, $13, $14, $15)",
                     v, COLS, e);
    }
    return st == ST_OK ? set_end(t, k->version, e) : st;
}

enum status row_calibration_get(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e)
{
    struct sql_rows *r;
    int64_t newest;
    bool found;
    enum status st = row_calibration_version(t, &newest, e);

    if (st != ST_OK)
        return st;
    st = sql_query(t->sql,
                   "SELECT " COLUMNS
                   " FROM calibrations ORDER BY calibration_key DESC LIMIT 1",
                   NULL, 0, &r, e);
    if ((found = st == ST_OK && sql_next(r)))
        st = list_row(t, r, k, e);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    if (!found && newest == 0)
        return errinfo_set(e, ST_ENOTFOUND, "there is no calibration");
    return found && k->version == newest ? ST_OK : not_newest(newest, e);
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

enum status row_calibration_check(struct store_txn *t,
                                  void (*report)(void *arg, const char *line), void *arg,
                                  struct errinfo *e)
{
    struct store_calibration k = {0};
    struct errinfo why;
    struct sql_rows *r;
    int64_t newest;
    enum status st =
        sql_query(t->sql, "SELECT " COLUMNS " FROM calibrations ORDER BY calibration_key",
                  NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r))
        if (list_row(t, r, &k, &why) != ST_OK)
            report(arg, why.msg);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    if ((st = row_calibration_version(t, &newest, &why)) == ST_OK && k.version != newest)
        st = not_newest(newest, &why);
    if (st != ST_OK && st != ST_ECORRUPT)
        return errinfo_set(e, st, "%s", why.msg);
    if (st != ST_OK)
        report(arg, why.msg);
    return ST_OK;
}
