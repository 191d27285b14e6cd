#include "rows_table.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "sql_read.h"

#define BYTES_MAX 4096 /* no row that this program wrote has more */

struct text {
    size_t n;
    unsigned char bytes[BYTES_MAX];
};

static bool put(struct text *p, const void *from, size_t n)
{
    if (n > sizeof p->bytes - p->n)
        return false;
    if (n > 0)
        memcpy(p->bytes + p->n, from, n);
    p->n += n;
    return true;
}

static bool put_number(struct text *p, uint64_t v, size_t n)
{
    unsigned char bytes[8];

    bytes_set(bytes, v, n);
    return put(p, bytes, n);
}

/* Its type, and its value or length and bytes: no two different columns give the same. */
static bool put_value(struct text *p, const struct sql_value *v)
{
    uint64_t bits;

    switch (v->type) {
    case SQL_NULL:
        return put_number(p, 0, 1);
    case SQL_INT:
        return put_number(p, 1, 1) && put_number(p, (uint64_t)v->i, 8);
    case SQL_REAL:
        memcpy(&bits, &v->r, sizeof bits);
        return put_number(p, 2, 1) && put_number(p, bits, 8);
    case SQL_TEXT:
    case SQL_BLOB:
        break;
    }
    return put_number(p, v->type == SQL_TEXT ? 3 : 4, 1) && put_number(p, v->n, 4) &&
           put(p, v->data, v->n);
}

/* False: more bytes than any row of this program's has. */
static bool mac_of(const struct log_txn *t, const struct rows_table *table,
                   const struct sql_value *v, unsigned char out[CRYPT_HASH])
{
    struct text p = {.n = 0};
    bool fits =
        put(&p, "surface row   2", 16) && put(&p, table->name, strlen(table->name) + 1);

    for (int i = 0; i < table->columns; i++)
        fits = fits && put_value(&p, &v[i]);
    if (fits)
        crypt_mac(t->crypt, p.bytes, p.n, out);
    return fits;
}

bool rows_table_is(const struct log_txn *t, const struct rows_table *table,
                   const struct sql_rows *r, int col, unsigned char mac[CRYPT_HASH])
{
    unsigned char wanted[CRYPT_HASH];
    struct sql_value v[ROWS_COLUMNS];

    for (int i = 0; i < table->columns; i++)
        v[i] = sql_column(r, col + i);
    return sql_read_bytes(r, col + table->columns, mac, CRYPT_HASH) &&
           mac_of(t, table, v, wanted) && sodium_memcmp(mac, wanted, CRYPT_HASH) == 0;
}

static enum status one_row(const struct log_txn *t, struct errinfo *e)
{
    const uint64_t n = sql_changed(t->sql);

    return n == 1
               ? ST_OK
               : errinfo_set(e, ST_ECORRUPT,
                             "a change of one row changed %llu: the database is damaged",
                             (unsigned long long)n);
}

enum status rows_table_insert(struct log_txn *t, const struct rows_table *table,
                              const char *text, struct sql_value *v,
                              unsigned char mac[CRYPT_HASH], struct errinfo *e)
{
    enum status st;

    if (!mac_of(t, table, v, mac))
        return errinfo_set(e, ST_EINVAL, "a row of more than %d bytes", BYTES_MAX);
    v[table->columns] = sql_blob(mac, CRYPT_HASH);
    if ((st = sql_run(t->sql, text, v, (size_t)table->columns + 1, e)) != ST_OK ||
        (st = one_row(t, e)) != ST_OK)
        return st;
    return log_txn_count(t, NULL, mac, e);
}

enum status rows_table_update(struct log_txn *t, const struct rows_table *table,
                              const char *text, struct sql_value *v,
                              unsigned char mac[CRYPT_HASH], struct errinfo *e)
{
    unsigned char old[CRYPT_HASH];
    enum status st;

    memcpy(old, mac, sizeof old);
    if (!mac_of(t, table, v, mac))
        return errinfo_set(e, ST_EINVAL, "a row of more than %d bytes", BYTES_MAX);
    v[table->columns] = sql_blob(mac, CRYPT_HASH);
    v[table->columns + 1] = sql_blob(old, sizeof old);
    if ((st = sql_run(t->sql, text, v, (size_t)table->columns + 2, e)) != ST_OK ||
        (st = one_row(t, e)) != ST_OK)
        return st;
    return log_txn_count(t, old, mac, e);
}

enum status rows_table_delete(struct log_txn *t, const char *text, struct sql_value id,
                              const unsigned char mac[CRYPT_HASH], struct errinfo *e)
{
    enum status st;

    if ((st = SQL_RUN(t->sql, e, text, id, sql_blob(mac, CRYPT_HASH))) != ST_OK ||
        (st = one_row(t, e)) != ST_OK)
        return st;
    return log_txn_count(t, mac, NULL, e);
}
