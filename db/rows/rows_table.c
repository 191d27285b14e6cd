#include "rows_table.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"

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

static void *mac_in(const struct rows_table *table, void *row)
{
    return (unsigned char *)row + table->mac;
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

enum status rows_table_damaged(const struct rows_table *table, const struct sql_rows *r,
                               int col, struct errinfo *e)
{
    const int at =
        table->id >= 0 ? col + table->id : col + table->columns + 1; /* its key */
    char id[64] = "?";

    if (sql_column(r, at).type == SQL_INT)
        (void)snprintf(id, sizeof id, "%lld", (long long)sql_column(r, at).i);
    else if (!sql_read_text(r, at, id, sizeof id))
        (void)snprintf(id, sizeof id, "?");
    for (char *p = id; *p != '\0'; p++)
        if (*p < ' ' || *p > '~')
            *p = '?';
    return errinfo_set(e, ST_ECORRUPT, "%s: the row %s is not authentic", table->name,
                       id);
}

enum status rows_table_read(const struct log_txn *t, const struct rows_table *table,
                            const struct sql_rows *r, int col, void *row,
                            struct errinfo *e)
{
    memset(row, 0, table->size);
    if (rows_table_is(t, table, r, col, mac_in(table, row)) &&
        sql_read_fields(r, col, table->field, (size_t)table->columns, row) &&
        (table->complete == NULL || table->complete(t, r, col, row)))
        return ST_OK;
    sodium_memzero(row, table->size);
    return rows_table_damaged(table, r, col, e);
}

/* ---- queries */

static bool is_value(const struct sql_value *a, const struct sql_value *b)
{
    return a->type == b->type && a->i == b->i && a->n == b->n &&
           (a->n == 0 || memcmp(a->data, b->data, a->n) == 0);
}

enum status rows_table_find(struct log_txn *t, const struct rows_table *table,
                            const char *text, int by, struct sql_value value, void *row,
                            struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = sql_first(t->sql, text, &value, 1, &r, e);

    memset(row, 0, table->size);
    if (st == ST_OK && (st = rows_table_read(t, table, r, 0, row, e)) == ST_OK &&
        by >= 0) {
        const struct sql_value got = sql_column(r, by);

        if (!is_value(&got, &value)) {
            sodium_memzero(row, table->size);
            st = errinfo_set(e, ST_ECORRUPT, "an index of the %s leads to another row",
                             table->name);
        }
    }
    return sql_done(r, st, e);
}

struct listing {
    const struct log_txn *t;
    const struct rows_table *table;
};

static enum status list_row(void *arg, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    const struct listing *l = arg;

    return rows_table_read(l->t, l->table, r, 0, out, e);
}

enum status rows_table_list(struct log_txn *t, const struct rows_table *table,
                            void **list, size_t *n, struct errinfo *e)
{
    struct listing l = {t, table};
    struct sql_rows *r;
    const enum status st = sql_query(t->sql, table->all, NULL, 0, &r, e);

    return sql_read_list(r, st, list_row, &l, table->size, list, n, e);
}

/* ---- changes */

static enum status one_row(struct log_txn *t, const unsigned char *minus,
                           const unsigned char *plus, struct errinfo *e)
{
    const uint64_t n = sql_changed(t->sql);

    if (n != 1)
        return errinfo_set(e, ST_ECORRUPT,
                           "a change of one row changed %llu: the database is damaged",
                           (unsigned long long)n);
    return log_txn_count(t, minus, plus, e);
}

/* old: the MAC of the row before, the last parameter; NULL: there is none. */
static enum status write_row(struct log_txn *t, const struct rows_table *table,
                             const char *text, const unsigned char *old, void *row,
                             struct errinfo *e)
{
    const size_t n = (size_t)table->columns;
    struct sql_value v[ROWS_COLUMNS + 2];
    unsigned char *mac = mac_in(table, row);
    enum status st;

    *(int64_t *)(void *)((unsigned char *)row + table->field[1].at) += 1;
    sql_field_values(table->field, n, row, v);
    if (!mac_of(t, table, v, mac))
        return errinfo_set(e, ST_EINVAL, "a row of more than %d bytes", BYTES_MAX);
    v[n] = sql_blob(mac, CRYPT_HASH);
    if (old != NULL)
        v[n + 1] = sql_blob(old, CRYPT_HASH);
    st = sql_run(t->sql, text, v, n + (old != NULL ? 2 : 1), e);
    return st == ST_OK ? one_row(t, old, mac, e) : st;
}

enum status rows_table_insert(struct log_txn *t, const struct rows_table *table,
                              void *row, struct errinfo *e)
{
    *(int64_t *)(void *)((unsigned char *)row + table->field[1].at) = 0;
    return write_row(t, table, table->insert, NULL, row, e);
}

enum status rows_table_update(struct log_txn *t, const struct rows_table *table,
                              void *row, struct errinfo *e)
{
    unsigned char old[CRYPT_HASH];

    memcpy(old, mac_in(table, row), sizeof old);
    return write_row(t, table, table->update, old, row, e);
}

enum status rows_table_delete(struct log_txn *t, const struct rows_table *table,
                              const void *row, struct errinfo *e)
{
    const unsigned char *mac = (const unsigned char *)row + table->mac;
    struct sql_value v[2];
    enum status st;

    sql_field_values(table->field, 1, row, v);
    v[1] = sql_blob(mac, CRYPT_HASH);
    st = sql_run(t->sql, table->remove, v, 2, e);
    return st == ST_OK ? one_row(t, mac, NULL, e) : st;
}

/* ---- what is encrypted */

#define DIGEST 32

static void put_field(unsigned char **to, const struct sql_field *f,
                      const unsigned char *from)
{
    unsigned char digest[DIGEST] = {0};

    switch (f->kind) {
    case SQL_FIELD_TEXT:
        bytes_put_text(to, (const char *)from);
        break;
    case SQL_FIELD_NUMBER:
        bytes_put_number(to, *(const uint64_t *)(const void *)from, 8);
        break;
    case SQL_FIELD_BOOL:
        bytes_put_number(to, *(const bool *)from, 1);
        break;
    case SQL_FIELD_REAL:
        bytes_put_real(to, *(const double *)(const void *)from);
        break;
    case SQL_FIELD_HEX:
        (void)sodium_hex2bin(digest, sizeof digest, (const char *)from,
                             strlen((const char *)from), NULL, NULL, NULL);
        bytes_put(to, digest, sizeof digest);
        break;
    default:
        bytes_put(to, from, f->size);
    }
}

static bool get_field(struct bytes *b, const struct sql_field *f, unsigned char *to)
{
    unsigned char digest[DIGEST];
    double *real = (void *)to;
    uint64_t yes = 2;

    switch (f->kind) {
    case SQL_FIELD_TEXT:
        return bytes_get_text(b, (char *)to, f->size);
    case SQL_FIELD_NUMBER:
        return bytes_get_number(b, 8, (void *)to);
    case SQL_FIELD_BOOL:
        if (!bytes_get_number(b, 1, &yes) || yes > 1)
            return false;
        *(bool *)to = yes != 0;
        return true;
    case SQL_FIELD_REAL:
        return bytes_get_finite(b, real) && *real >= f->min && *real <= f->max;
    case SQL_FIELD_HEX:
        to[0] = '\0';
        if (!bytes_get(b, digest, sizeof digest))
            return false;
        if (!sodium_is_zero(digest, sizeof digest))
            (void)sodium_bin2hex((char *)to, f->size, digest, sizeof digest);
        return true;
    default:
        return bytes_get(b, to, f->size);
    }
}

void rows_table_encrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const void *row, struct sql_field_blob *out)
{
    unsigned char plain[SQL_FIELD_MAX], *to = plain;

    for (size_t i = 0; i < n; i++)
        put_field(&to, &field[i], (const unsigned char *)row + field[i].at);
    out->n = (size_t)(to - plain) + CRYPT_OVER;
    crypt_encrypt(key, label->bytes, label->n, plain, out->n - CRYPT_OVER, out->bytes);
    sodium_memzero(plain, sizeof plain);
}

bool rows_table_decrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const struct sql_field_blob *in, void *row)
{
    unsigned char plain[SQL_FIELD_MAX];
    struct bytes b = {plain, plain};
    bool ok = crypt_decrypt(key, label->bytes, label->n, in->bytes, in->n, plain);

    if (ok)
        b.end += in->n - CRYPT_OVER;
    for (size_t i = 0; ok && i < n; i++)
        ok = get_field(&b, &field[i], (unsigned char *)row + field[i].at);
    sodium_memzero(plain, sizeof plain);
    return ok && b.at == b.end;
}
