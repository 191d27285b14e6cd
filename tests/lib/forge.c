#include "forge.h"

#include <sqlite3.h>

#include "errinfo.h"
#include "sql.h"
#include "store_mac.h"
#include "store_open.h"
#include "store_txn.h"

#define COLUMNS_MAX 16

static enum status fail(sqlite3 *db, const char *what, struct errinfo *e)
{
    return errinfo_set(e, ST_EDB, "%.120s: %s", what, sqlite3_errmsg(db));
}

static struct sql_value value_of(sqlite3_stmt *stmt, int i)
{
    const size_t n = (size_t)sqlite3_column_bytes(stmt, i);

    switch (sqlite3_column_type(stmt, i)) {
    case SQLITE_INTEGER:
        return sql_int(sqlite3_column_int64(stmt, i));
    case SQLITE_FLOAT:
        return sql_real(sqlite3_column_double(stmt, i));
    case SQLITE_TEXT:
        return (struct sql_value){
            .type = SQL_TEXT, .data = sqlite3_column_text(stmt, i), .n = n};
    case SQLITE_BLOB:
        return sql_blob(n > 0 ? sqlite3_column_blob(stmt, i) : "", n);
    default:
        return sql_null();
    }
}

/* The MAC of each row of a query's columns, set by a statement that takes the first of them and
 * the MAC. */
static enum status authenticate(sqlite3 *db, const struct vault *v, const char label[16],
                                const char *rows, const char *set, struct errinfo *e)
{
    struct sql_value value[COLUMNS_MAX];
    unsigned char mac[VAULT_HASH];
    sqlite3_stmt *from = NULL, *to = NULL;
    enum status st = ST_OK;

    if (sqlite3_prepare_v2(db, rows, -1, &from, NULL) != SQLITE_OK ||
        sqlite3_prepare_v2(db, set, -1, &to, NULL) != SQLITE_OK)
        st = fail(db, rows, e);
    while (st == ST_OK && sqlite3_step(from) == SQLITE_ROW) {
        const int n = sqlite3_column_count(from);

        for (int i = 0; i < n; i++)
            value[i] = value_of(from, i);
        store_mac(v, label, value, (size_t)n, mac);
        if (sqlite3_bind_value(to, 1, sqlite3_column_value(from, 0)) != SQLITE_OK ||
            sqlite3_bind_blob(to, 2, mac, sizeof mac, SQLITE_TRANSIENT) != SQLITE_OK ||
            sqlite3_step(to) != SQLITE_DONE)
            st = fail(db, set, e);
        (void)sqlite3_reset(to);
    }
    (void)sqlite3_finalize(from);
    (void)sqlite3_finalize(to);
    return st;
}

static enum status forge(sqlite3 *db, const struct vault *v, const char *sql,
                         struct errinfo *e)
{
    enum status st;

    if (sqlite3_exec(db, "BEGIN IMMEDIATE", NULL, NULL, NULL) != SQLITE_OK ||
        sqlite3_exec(db, sql, NULL, NULL, NULL) != SQLITE_OK)
        return fail(db, sql, e);
    if ((st = authenticate(db, v, "surface token\0\0",
                           "SELECT id, name, created, revoked, scopes, expires, "
                           "old_until, hash, old_hash FROM tokens",
                           "UPDATE tokens SET mac = ?2 WHERE id = ?1", e)) != ST_OK ||
        (st = authenticate(
             db, v, "surface measure",
             "SELECT calibration_key, created, actor, engine, shipped, fmr, "
             "threshold_mm, low_mm, high_mm, subjects, impostors, genuine, halving_mm, "
             "knots FROM calibrations",
             "UPDATE calibrations SET mac = ?2 WHERE calibration_key = ?1", e)) != ST_OK)
        return st;
    if (sqlite3_exec(db,
                     "UPDATE calibrations_end SET version = "
                     "(SELECT coalesce(max(calibration_key), 0) FROM calibrations)",
                     NULL, NULL, NULL) != SQLITE_OK)
        return fail(db, sql, e);
    if ((st = authenticate(
             db, v, "surface newest\0", "SELECT version FROM calibrations_end",
             "UPDATE calibrations_end SET mac = ?2 WHERE version = ?1", e)) == ST_OK &&
        sqlite3_exec(db, "COMMIT", NULL, NULL, NULL) != SQLITE_OK)
        st = fail(db, "COMMIT", e);
    return st;
}

enum status forge_sql(const char *path, const char *sql, struct errinfo *e)
{
    struct store_txn t;
    struct store *s;
    sqlite3 *db = NULL;
    enum status st;

    if ((st = store_open(path, STORE_READ, NULL, &s, e)) != ST_OK)
        return st;
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) == ST_OK) {
        const struct vault *v = t.vault; /* as long as the store is open */

        st = store_txn_end(&t, ST_OK, e);
        if (sqlite3_open(path, &db) != SQLITE_OK)
            st = fail(db, path, e);
        (void)sqlite3_busy_timeout(db, 5000);
        if (st == ST_OK)
            st = forge(db, v, sql, e);
        (void)sqlite3_close(db);
    }
    store_close(s);
    return st;
}
