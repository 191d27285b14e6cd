#include "rows_table.h"

#include <assert.h>
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

/* Its type, and its value or length and bytes: no two different values give the same. */
static bool put_value(struct text *p, const struct sql_value *v)
{
    unsigned char *to = p->bytes + p->n;

    if (p->n + 9 + v->n > sizeof p->bytes)
        return false;
    bytes_put_number(&to, (uint64_t)v->type, 1);
    if (v->type == SQL_INT)
        bytes_put_number(&to, (uint64_t)v->i, 8);
    else if (v->type == SQL_REAL)
        bytes_put_real(&to, v->r);
    else if (v->type != SQL_NULL) {
        bytes_put_number(&to, v->n, 4);
        bytes_put(&to, v->data, v->n);
    }
    p->n = (size_t)(to - p->bytes);
    return true;
}

/* A text or a blob stays where it is. */
static bool get_value(struct bytes *b, struct sql_value *v)
{
    uint64_t type, n;

    *v = sql_null();
    if (!bytes_get_number(b, 1, &type) || type > SQL_BLOB)
        return false;
    v->type = (enum sql_type)type;
    if (v->type == SQL_NULL)
        return true;
    if (v->type == SQL_REAL)
        return bytes_get_finite(b, &v->r);
    if (!bytes_get_number(b, v->type == SQL_INT ? 8 : 4, &n))
        return false;
    if (v->type == SQL_INT) {
        v->i = (int64_t)n;
        return true;
    }
    v->data = b->at;
    v->n = (size_t)n;
    b->at += n <= (uint64_t)(b->end - b->at) ? n : 0;
    return b->at == (const unsigned char *)v->data + n;
}

/* False: more bytes than any row of this program's has. */
static bool mac_of(const struct log_txn *t, const struct rows_table *table,
                   const struct sql_value *v, unsigned char out[CRYPT_HASH])
{
    const size_t name = strlen(table->name) + 1;
    struct text p = {.n = 16 + name};
    bool fits = true;

    memcpy(p.bytes, "surface row   2", 16);
    memcpy(p.bytes + 16, table->name, name);
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

enum status rows_table_missing(const struct rows_table *table, const char *id,
                               struct errinfo *e)
{
    return errinfo_set(e, ST_ENOTFOUND, "there is no %s%s", table->noun, id);
}

enum status rows_table_find(struct log_txn *t, const struct rows_table *table,
                            const char *text, int by, struct sql_value value,
                            const char *id, void *row, struct errinfo *e)
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
    if (st == ST_ENOTFOUND)
        st = rows_table_missing(table, id, e);
    return sql_done(r, st, e);
}

struct rows_table_listing {
    const struct log_txn *t;
    const struct rows_table *table;
    size_t size;
};

static enum status list_row(void *arg, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    _Alignas(max_align_t) unsigned char row[ROWS_SIZE];
    const struct rows_table_listing *l = arg;
    const enum status st = rows_table_read(l->t, l->table, r, 0, row, e);

    memcpy(out, row, l->size);
    sodium_memzero(row, l->table->size);
    return st;
}

enum status rows_table_list(struct log_txn *t, const struct rows_table *table,
                            const char *text, const struct sql_value *value, size_t nv,
                            size_t size, void **list, size_t *n, struct errinfo *e)
{
    struct rows_table_listing l = {t, table, size};
    struct sql_rows *r;
    const enum status st = sql_query(t->sql, text, value, nv, &r, e);

    assert(size <= table->size && table->size <= ROWS_SIZE);
    return sql_read_list(r, st, list_row, &l, size, list, n, e);
}

enum status rows_table_all(struct log_txn *t, const struct rows_table *table, size_t size,
                           void **list, size_t *n, struct errinfo *e)
{
    return rows_table_list(t, table, table->all, NULL, 0, size, list, n, e);
}

/* ---- changes */

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
    st = sql_run_one(t->sql, text, v, n + (old != NULL ? 2 : 1), e);
    return st == ST_OK ? log_txn_count(t, old, mac, e) : st;
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
    st = sql_run_one(t->sql, table->remove, v, 2, e);
    return st == ST_OK ? log_txn_count(t, mac, NULL, e) : st;
}

/* ---- what is encrypted */

void rows_table_encrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const void *row, struct sql_field_blob *out)
{
    struct text p = {.n = 0};

    for (size_t i = 0; i < n; i++) {
        const struct sql_value v =
            sql_field_value(&field[i], (const char *)row + field[i].at);

        (void)put_value(&p, &v);
    }
    out->n = p.n + CRYPT_OVER;
    assert(out->n <= sizeof out->bytes);
    crypt_encrypt(key, label->bytes, label->n, p.bytes, p.n, out->bytes);
    sodium_memzero(p.bytes, p.n);
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
    for (size_t i = 0; ok && i < n; i++) {
        struct sql_value v;

        ok = get_value(&b, &v) && sql_field_set(&field[i], &v, (char *)row + field[i].at);
    }
    sodium_memzero(plain, sizeof plain);
    return ok && b.at == b.end;
}
