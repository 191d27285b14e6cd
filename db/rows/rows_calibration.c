#include "rows_calibration.h"

#include "bytes.h"
#include "errinfo.h"
#include "sql_read.h"

#define COLUMNS                                                                          \
    "calibration_key, revision, created, actor, engine, shipped, fmr, threshold, low, "  \
    "high, subjects, impostors, genuine, knots, mac"

enum { COL_KEY, COL_MAC = 14 };

#define KNOT_BYTES 16
#define MAX_SCORE  1e4

struct row {
    struct store_calibration one;
    int64_t revision;
    struct sql_field_blob knots;
    unsigned char mac[CRYPT_HASH];
};

#define F(kind, member)                 SQL_FIELD(kind, struct row, member)
#define FROM_TO(kind, member, min, max) SQL_FIELD_IN(kind, struct row, member, min, max)

static const struct sql_field columns[COL_MAC] = {
    FROM_TO(NUMBER, one.version, 1, DBL_MAX),
    F(NUMBER, revision),
    F(TEXT, one.created),
    F(TEXT, one.actor),
    F(TEXT, one.engine),
    F(BOOL, one.shipped),
    FROM_TO(REAL, one.fmr, DBL_MIN, 1 - DBL_EPSILON / 2),
    FROM_TO(REAL, one.table.threshold, -MAX_SCORE, MAX_SCORE),
    FROM_TO(REAL, one.low, -MAX_SCORE, MAX_SCORE),
    FROM_TO(REAL, one.high, -MAX_SCORE, MAX_SCORE),
    F(NUMBER, one.subjects),
    F(NUMBER, one.impostors),
    F(NUMBER, one.genuine),
    F(BLOB, knots),
};

/* A wrong threshold would open the door: all of it is looked at, also of an authentic row. */
static bool rows_calibration_complete(const struct log_txn *t, const struct sql_rows *r,
                                      int col, void *row)
{
    const struct sql_field_blob *knots = &((struct row *)row)->knots;
    struct store_calibration *k = &((struct row *)row)->one;
    struct surface_calibration *c = &k->table;

    (void)t, (void)r, (void)col;
    if (knots->n % KNOT_BYTES != 0 || knots->n > (size_t)SURFACE_KNOTS * KNOT_BYTES)
        return false;
    c->n = (uint32_t)knots->n / KNOT_BYTES;
    for (uint32_t i = 0; i < c->n; i++) {
        c->knot[i].score = bytes_real(knots->bytes + KNOT_BYTES * i);
        c->knot[i].rate = bytes_real(knots->bytes + KNOT_BYTES * i + 8);
    }
    return surface_calibration_valid(c) && k->low <= c->threshold &&
           k->high >= c->threshold;
}

const struct rows_table rows_calibrations = {
    .name = "calibrations",
    .all =
        "SELECT " COLUMNS ", calibration_key FROM calibrations ORDER BY calibration_key",
    .insert =
        "INSERT INTO calibrations (" COLUMNS ") VALUES ($1, $2, $3, $4, $5, $6, $7, "
        "$8, $9, $10, $11, $12, $13, $14, $15)",
    .drop = {"DELETE FROM calibrations WHERE calibration_key = $1"},
    .columns = COL_MAC,
    .field = columns,
    .mac = offsetof(struct row, mac),
    .size = sizeof(struct row),
    .id = COL_KEY,
    .complete = rows_calibration_complete,
};

enum status rows_calibration_get(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e)
{
    struct sql_rows *r;
    struct row row;
    enum status st = sql_first(t->sql,
                               "SELECT " COLUMNS " FROM calibrations "
                               "ORDER BY calibration_key DESC LIMIT 1",
                               NULL, 0, &r, e);

    if (st == ST_OK) {
        st = rows_table_read(t, &rows_calibrations, r, 0, &row, e);
        *k = row.one;
    } else if (st == ST_ENOTFOUND) {
        st = errinfo_set(e, st, "there is no calibration");
    }
    return sql_done(r, st, e);
}

enum status rows_calibration_add(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e)
{
    const struct surface_calibration *c = &k->table;
    struct row row = {.revision = 0};
    unsigned char *to = row.knots.bytes;
    enum status st = ST_OK;

    if (k->version == 0) {
        st = rows_calibration_get(t, &row.one, e);
        k->version = st == ST_OK ? row.one.version + 1 : 1;
    }
    if (st != ST_OK && st != ST_ENOTFOUND)
        return st;
    row.one = *k;
    for (uint32_t i = 0; i < c->n; i++) {
        bytes_put_real(&to, c->knot[i].score);
        bytes_put_real(&to, c->knot[i].rate);
    }
    row.knots.n = (size_t)(to - row.knots.bytes);
    return rows_table_insert(t, &rows_calibrations, &row, e);
}
