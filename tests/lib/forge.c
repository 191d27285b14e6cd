#include "forge.h"

#include <string.h>

#include "bytes.h"
#include "rawdb.h"
#include "rows_calibration.h"
#include "rows_device.h"
#include "rows_digest.h"
#include "rows_template.h"
#include "rows_token.h"
#include "store_open.h"
#include "store_txn.h"

static enum status run(const char *path, const char *sql, struct errinfo *e)
{
    struct rawdb *d;
    enum status st = rawdb_open(path, &d, e);

    if (st == ST_OK)
        st = rawdb_run(d, sql, e);
    rawdb_close(d);
    return st;
}

/* A row's MAC by db/FORMAT.md, not by the code that is tested. */
static void mac_of(const struct crypt *c, const struct rows_table *table,
                   const struct sql_rows *r, unsigned char mac[CRYPT_HASH])
{
    static unsigned char text[8192];
    unsigned char *to = text;

    bytes_put(&to, "surface row   2", 16);
    bytes_put(&to, table->name, strlen(table->name) + 1);
    for (int i = 0; i < table->columns; i++) {
        const struct sql_value v = sql_column(r, i);
        uint64_t bits;

        switch (v.type) {
        case SQL_NULL:
            bytes_put_number(&to, 0, 1);
            break;
        case SQL_INT:
            bytes_put_number(&to, 1, 1);
            bytes_put_number(&to, (uint64_t)v.i, 8);
            break;
        case SQL_REAL:
            memcpy(&bits, &v.r, sizeof bits);
            bytes_put_number(&to, 2, 1);
            bytes_put_number(&to, bits, 8);
            break;
        default:
            bytes_put_number(&to, v.type == SQL_TEXT ? 3 : 4, 1);
            bytes_put_number(&to, v.n, 4);
            bytes_put(&to, v.data, v.n);
        }
    }
    crypt_mac(c, text, (size_t)(to - text), mac);
}

static enum status forge_table(struct log_txn *t, const struct rows_table *table,
                               const char *update, struct errinfo *e)
{
    unsigned char mac[CRYPT_HASH];
    struct sql_rows *r;
    enum status st = sql_query(t->sql, table->all, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        mac_of(t->crypt, table, r, mac);
        st = SQL_RUN(t->sql, e, update, sql_blob(mac, sizeof mac),
                     sql_column(r, table->columns + 1));
    }
    return sql_done(r, st, e);
}

static enum status forge(struct log_txn *t, struct errinfo *e)
{
#define OF(noun, key)                                                                    \
    {                                                                                    \
        &rows_##noun, "UPDATE " #noun " SET mac = $1 WHERE " #key " = $2"                \
    }
    static const struct {
        const struct rows_table *table;
        const char *update;
    } all[] = {OF(subjects, subject_key), OF(templates, template_key),
               OF(tokens, token_key), OF(devices, device_key),
               OF(calibrations, calibration_key)};
    unsigned char sum[LOG_DIGEST];
    uint64_t bad;
    enum status st = ST_OK;

    for (size_t i = 0; i < sizeof all / sizeof *all && st == ST_OK; i++)
        st = forge_table(t, all[i].table, all[i].update, e);
    if (st != ST_OK || (st = rows_digest(t, false, NULL, NULL, sum, &bad, e)) != ST_OK)
        return st;
    log_txn_accept(t, sum);
    return log_change(t, "forge", NULL, "", "", e);
}

enum status forge_sql(const char *path, const struct store_key *key, const char *sql,
                      struct errinfo *e)
{
    struct log_txn t;
    struct store *s;
    enum status st;

    if ((st = run(path, sql, e)) != ST_OK ||
        (st = store_open(path, STORE_WRITE, key, &s, e)) != ST_OK)
        return st;
    atomic_store(&s->verified, true);
    if ((st = store_act_begin(s, "forge", SQL_WRITE, &t, e)) == ST_OK)
        st = store_end(s, &t, forge(&t, e), e);
    store_close(s);
    return st;
}
