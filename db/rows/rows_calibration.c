#include "rows_calibration.h"

#include "bytes.h"
#include "errinfo.h"
#include "sql_read.h"

#define COLUMNS                                                                          \
    "calibration_key, revision, created, actor, engine, shipped, fmr, threshold, low, "  \
    "high, subjects, impostors, genuine, knots, det, mac"

enum { COL_KEY, COL_MAC = 15 };

#define KNOT_BYTES 16
#define DET_BYTES  40 /* of a point */
#define PEOPLE     4  /* bytes of their number */
#define MAX_SCORE  1e4

struct row {
    struct store_calibration one;
    int64_t revision;
    struct sql_field_blob knots, det;
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
    F(BLOB, det),
};

static void put_point(unsigned char **to, const struct det_point *p)
{
    bytes_put_real(to, p->score);
    bytes_put_real(to, p->fmr);
    bytes_put_real(to, p->fnmr);
    bytes_put_real(to, p->low);
    bytes_put_real(to, p->high);
}

static struct det_point get_point(const unsigned char *from)
{
    return (struct det_point){.score = bytes_real(from),
                              .fmr = bytes_real(from + 8),
                              .fnmr = bytes_real(from + 16),
                              .low = bytes_real(from + 24),
                              .high = bytes_real(from + 32)};
}

/* The number of people; then, if there is a curve, both thresholds and its points. */
static void put_det(const struct det *d, struct sql_field_blob *b)
{
    unsigned char *to = b->bytes;

    bytes_put_number(&to, d->people, PEOPLE);
    if (d->n > 0) {
        put_point(&to, &d->own);
        put_point(&to, &d->shipped);
    }
    for (uint32_t i = 0; i < d->n; i++)
        put_point(&to, &d->point[i]);
    b->n = (size_t)(to - b->bytes);
}

static bool get_det(const struct sql_field_blob *b, struct det *d)
{
    const unsigned char *from = b->bytes + PEOPLE;
    const size_t n = b->n < PEOPLE ? 0 : (b->n - PEOPLE) / DET_BYTES;

    if (b->n != PEOPLE + n * DET_BYTES || n > DET_POINTS + 2 || n == 1 || n == 2)
        return false;
    d->people = (uint32_t)bytes_number(b->bytes, PEOPLE);
    d->n = n > 0 ? (uint32_t)n - 2 : 0;
    if (n > 0) {
        d->own = get_point(from);
        d->shipped = get_point(from + DET_BYTES);
    }
    for (uint32_t i = 0; i < d->n; i++)
        d->point[i] = get_point(from + (size_t)DET_BYTES * (i + 2));
    return det_valid(d);
}

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
    return surface_calibration_valid(c) && get_det(&((struct row *)row)->det, &k->det) &&
           k->low <= c->threshold && k->high >= c->threshold;
}

const struct rows_table rows_calibrations = {
    .name = "calibrations",
    .all =
        "SELECT " COLUMNS ", calibration_key FROM calibrations ORDER BY calibration_key",
    .insert =
        "INSERT INTO calibrations (" COLUMNS ") VALUES ($1, $2, $3, $4, $5, $6, $7, "
        "$8, $9, $10, $11, $12, $13, $14, $15, $16)",
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
    put_det(&k->det, &row.det);
    return rows_table_insert(t, &rows_calibrations, &row, e);
}
