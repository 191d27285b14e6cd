#include "store_mac.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "sql.h"

#define BYTES_MAX   4096 /* no row that this program wrote has more */
#define COLUMNS_MAX 16

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

void store_mac(const struct vault *v, const char what[16], const struct sql_value *value,
               size_t n, unsigned char out[VAULT_HASH])
{
    struct text p = {.n = 0};
    bool fits = put(&p, what, 16);

    for (size_t i = 0; i < n; i++)
        fits = fits && put_value(&p, &value[i]);
    if (fits)
        vault_mac(v, p.bytes, p.n, out);
    else
        randombytes_buf(out, VAULT_HASH);
}

void store_mac_row(const struct vault *v, const char what[16], const struct sql_rows *r,
                   int col, int n, unsigned char out[VAULT_HASH])
{
    struct sql_value value[COLUMNS_MAX];

    for (int i = 0; i < n && i < COLUMNS_MAX; i++)
        value[i] = sql_column(r, col + i);
    store_mac(v, what, value, (size_t)(n < COLUMNS_MAX ? n : COLUMNS_MAX), out);
}
