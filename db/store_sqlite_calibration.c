#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "store_sqlite.h"

enum { /* the columns of CALIBRATION_COLUMNS */
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
       COL_MAC
};

#define KNOT_BYTES 16

static const char proof[16] = "surface measure", proof_end[16] = "surface newest";

/* ---- the knots' bytes */

static bool read_knots(sqlite3_stmt *stmt, struct decision *d)
{
    const unsigned char *bytes = sqlite3_column_blob(stmt, COL_KNOTS);
    const int len = sqlite3_column_bytes(stmt, COL_KNOTS);

    if (bytes == NULL || sqlite3_column_type(stmt, COL_KNOTS) != SQLITE_BLOB ||
        len % KNOT_BYTES != 0 || len > DECISION_KNOTS * KNOT_BYTES)
        return false;
    d->n = (uint32_t)len / KNOT_BYTES;
    for (uint32_t i = 0; i < d->n; i++) {
        d->knot[i].mm = bytes_real(bytes + KNOT_BYTES * i);
        d->knot[i].rate = bytes_real(bytes + KNOT_BYTES * i + 8);
    }
    return true;
}

/* ---- rows */

static bool column_number(sqlite3_stmt *stmt, int col, double low, double high,
                          double *out)
{
    *out = sqlite3_column_double(stmt, col);
    return sqlite3_column_type(stmt, col) == SQLITE_FLOAT && *out >= low && *out <= high;
}

static bool column_count(sqlite3_stmt *stmt, int col, uint64_t *out)
{
    const int64_t v = sqlite3_column_int64(stmt, col);

    *out = v < 0 ? 0 : (uint64_t)v;
    return sqlite3_column_type(stmt, col) == SQLITE_INTEGER && v >= 0;
}

/* The schema's checks hold for what this program wrote; the file may have been written by
 * anyone, and a forged threshold would open the door: all of it is looked at. */
static enum status read_calibration(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                    void *out, struct errinfo *e)
{
    struct store_calibration *k = out;
    struct decision *d = &k->decision;
    const char *bad = NULL;

    memset(k, 0, sizeof *k);
    k->version = sqlite3_column_int64(stmt, COL_KEY);
    k->shipped = sqlite3_column_int(stmt, COL_SHIPPED) != 0;
    if (k->version < 1)
        bad = "version";
    else if (!store_sqlite_text(stmt, COL_CREATED, k->created, sizeof k->created) ||
             !store_sqlite_text(stmt, COL_ACTOR, k->actor, sizeof k->actor) ||
             !store_sqlite_text(stmt, COL_ENGINE, k->engine, sizeof k->engine))
        bad = "texts";
    else if (!column_count(stmt, COL_SUBJECTS, &k->subjects) ||
             !column_count(stmt, COL_IMPOSTORS, &k->impostors) ||
             !column_count(stmt, COL_GENUINE, &k->genuine))
        bad = "counts";
    else if (!column_number(stmt, COL_FMR, 0, 1, &k->fmr) || k->fmr <= 0 || k->fmr >= 1)
        bad = "fmr";
    else if (!column_number(stmt, COL_LOW, 0, 1e3, &k->low_mm) ||
             !column_number(stmt, COL_HIGH, k->low_mm, 1e3, &k->high_mm))
        bad = "interval";
    else if (!column_number(stmt, COL_THRESHOLD, 0, 1e3, &d->threshold_mm) ||
             !column_number(stmt, COL_HALVING, 0, 1e3, &d->halving_mm) ||
             !read_knots(stmt, d) || !decision_valid(d))
        bad = "table";
    else if (!store_sqlite_proved(c, proof, stmt, COL_MAC))
        bad = "proof";
    if (bad != NULL)
        return errinfo_set(e, ST_ECORRUPT, "calibration %lld: its row is damaged (%s)",
                           (long long)k->version, bad);
    return ST_OK;
}

static enum status insert(struct store_sqlite_conn *c, const struct store_calibration *k,
                          struct errinfo *e)
{
    const struct decision *d = &k->decision;
    unsigned char knots[DECISION_KNOTS * KNOT_BYTES], *to = knots;
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_CALIBRATION_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    for (uint32_t i = 0; i < d->n; i++) {
        bytes_put_real(&to, d->knot[i].mm);
        bytes_put_real(&to, d->knot[i].rate);
    }
    if (store_sqlite_bind(stmt, 1, k->created) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, k->actor) != SQLITE_OK ||
        store_sqlite_bind(stmt, 3, k->engine) != SQLITE_OK ||
        sqlite3_bind_int(stmt, 4, k->shipped) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 5, k->fmr) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 6, d->threshold_mm) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 7, k->low_mm) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 8, k->high_mm) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 9, (int64_t)k->subjects) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 10, (int64_t)k->impostors) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 11, (int64_t)k->genuine) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 12, d->halving_mm) != SQLITE_OK ||
        sqlite3_bind_blob(stmt, 13, knots, (int)d->n * KNOT_BYTES, SQLITE_TRANSIENT) !=
            SQLITE_OK)
        st = store_sqlite_fail(c, "cannot add a calibration", e);
    else
        st = store_sqlite_run(c, stmt, e);
    (void)sqlite3_reset(stmt);
    return st;
}

/* Prove the rows of a statement, one after the other. */
static enum status prove_rows(struct store_sqlite_conn *c, enum store_sqlite_sql rows,
                              const char what[16], int n, enum store_sqlite_sql set,
                              struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, rows, &stmt, e);
    int rc = SQLITE_DONE;

    if (st != ST_OK)
        return st;
    while (st == ST_OK && (rc = sqlite3_step(stmt)) == SQLITE_ROW)
        st = store_sqlite_prove(c, what, stmt, n, set, e);
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot prove the calibrations", e);
    (void)sqlite3_reset(stmt);
    return st;
}

/* The newest one is the newest. */
static enum status prove_end(struct store_sqlite_conn *c, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_CALIBRATION_END, &stmt, e);

    if (st != ST_OK || (st = store_sqlite_run(c, stmt, e)) != ST_OK)
        return st;
    return prove_rows(c, SQL_CALIBRATION_VERSION, proof_end, 1, SQL_CALIBRATION_END_PROVE,
                      e);
}

static enum status prove_newest(struct store_sqlite_conn *c, struct errinfo *e)
{
    enum status st =
        prove_rows(c, SQL_CALIBRATION_GET, proof, COL_MAC, SQL_CALIBRATION_PROVE, e);

    return st != ST_OK ? st : prove_end(c, e);
}

enum status store_sqlite_calibration_prove(struct store_sqlite_conn *c, struct errinfo *e)
{
    enum status st =
        prove_rows(c, SQL_CALIBRATION_LIST, proof, COL_MAC, SQL_CALIBRATION_PROVE, e);

    return st != ST_OK ? st : prove_end(c, e);
}

enum status store_sqlite_calibration_add(struct store *s, const struct store_act *by,
                                         struct store_calibration *k, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    char outcome[32];
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = insert(c, k, e)) == ST_OK) {
        k->version = sqlite3_last_insert_rowid(c->db);
        st = prove_newest(c, e);
    }
    if (st == ST_OK) {
        (void)sqlite3_snprintf(sizeof outcome, outcome, "version %lld", k->version);
        st = store_sqlite_event_add(c, by, "calibrate", "", "", outcome, e);
    }
    return store_sqlite_written(s, st, e);
}

/* The number of the newest one, as proved: 0 where there never was one. */
static enum status read_end(struct store_sqlite_conn *c, int64_t *version,
                            struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_CALIBRATION_VERSION, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    if ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the calibrations", e);
    else if (rc == SQLITE_DONE || !store_sqlite_proved(c, proof_end, stmt, 1))
        st = errinfo_set(e, ST_ECORRUPT,
                         "calibrations: the record of the newest is damaged");
    else
        *version = sqlite3_column_int64(stmt, 0);
    (void)sqlite3_reset(stmt);
    return st;
}

static enum status not_newest(int64_t newest, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT, "calibration %lld, the newest, is not there",
                       (long long)newest);
}

enum status store_sqlite_calibration_get(struct store *s, struct store_calibration *k,
                                         struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    int64_t newest;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = read_end(c, &newest, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_CALIBRATION_GET, &stmt, e)) != ST_OK)
        goto out;
    switch (sqlite3_step(stmt)) {
    case SQLITE_ROW:
        if ((st = read_calibration(c, stmt, k, e)) == ST_OK && k->version != newest)
            st = not_newest(newest, e);
        break;
    case SQLITE_DONE:
        st = newest == 0 ? errinfo_set(e, ST_ENOTFOUND, "there is no calibration")
                         : not_newest(newest, e);
        break;
    default:
        st = store_sqlite_fail(c, "cannot read a calibration", e);
    }
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_calibration_version(struct store *s, int64_t *version,
                                             struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    st = read_end(c, version, e);
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_calibration_list(struct store *s, struct store_calibration **out,
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
    if ((st = store_sqlite_prepare(c, SQL_CALIBRATION_LIST, &stmt, e)) == ST_OK)
        st = store_sqlite_rows(c, stmt, read_calibration, sizeof **out,
                               "cannot read the calibrations", &list, n, e);
    store_sqlite_done(s, c);
    *out = list;
    return st;
}

enum status store_sqlite_calibration_check(struct store_sqlite_conn *c,
                                           store_report *report, void *arg,
                                           struct errinfo *e)
{
    struct store_calibration k = {0};
    struct errinfo row;
    sqlite3_stmt *stmt;
    int64_t newest;
    enum status st = store_sqlite_prepare(c, SQL_CALIBRATION_LIST, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW)
        if (read_calibration(c, stmt, &k, &row) != ST_OK)
            report(arg, row.msg);
    if (rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the calibrations", e);
    (void)sqlite3_reset(stmt);
    if (st != ST_OK)
        return st;
    if ((st = read_end(c, &newest, &row)) == ST_OK && k.version != newest)
        st = not_newest(newest, &row);
    if (st != ST_OK && st != ST_ECORRUPT)
        return errinfo_set(e, st, "%s", row.msg);
    if (st != ST_OK)
        report(arg, row.msg);
    return ST_OK;
}
