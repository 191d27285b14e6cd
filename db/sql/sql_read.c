#include "sql_read.h"

#include <stdlib.h>
#include <string.h>

#include "errinfo.h"

bool sql_read_text(const struct sql_rows *r, int col, char *out, size_t size)
{
    const struct sql_value v = sql_column(r, col);

    out[0] = '\0';
    if (v.type != SQL_TEXT || v.n >= size || memchr(v.data, '\0', v.n) != NULL)
        return false;
    memcpy(out, v.data, v.n);
    out[v.n] = '\0';
    return true;
}

const void *sql_read_blob(const struct sql_rows *r, int col, size_t min, size_t max,
                          size_t *n)
{
    const struct sql_value v = sql_column(r, col);

    *n = v.type == SQL_BLOB ? v.n : 0;
    return v.type == SQL_BLOB && v.n >= min && v.n <= max ? v.data : NULL;
}

bool sql_read_bytes(const struct sql_rows *r, int col, void *out, size_t n)
{
    size_t len;
    const void *data = sql_read_blob(r, col, n, n, &len);

    if (data == NULL)
        return false;
    memcpy(out, data, n);
    return true;
}

bool sql_read_int(const struct sql_rows *r, int col, int64_t min, int64_t *out)
{
    const struct sql_value v = sql_column(r, col);

    *out = v.type == SQL_INT ? v.i : 0;
    return v.type == SQL_INT && v.i >= min;
}

bool sql_read_count(const struct sql_rows *r, int col, int64_t max, uint32_t *out)
{
    int64_t v;

    *out = 0;
    if (!sql_read_int(r, col, 0, &v) || v > max)
        return false;
    *out = (uint32_t)v;
    return true;
}

/* ---- fields */

static bool is_zero(const unsigned char *bytes, size_t n)
{
    while (n > 0 && bytes[n - 1] == 0)
        n--;
    return n == 0;
}

static bool read_blob(const struct sql_rows *r, int col, struct sql_field_blob *out)
{
    const void *data = sql_read_blob(r, col, 1, sizeof out->bytes, &out->n);

    if (data != NULL)
        memcpy(out->bytes, data, out->n);
    return data != NULL;
}

static bool read_real(const struct sql_value *v, const struct sql_field *f, double *out)
{
    *out = v->type == SQL_REAL ? v->r : 0;
    return v->type == SQL_REAL && v->r >= f->min && v->r <= f->max;
}

static bool read_field(const struct sql_rows *r, int col, const struct sql_field *f,
                       unsigned char *to)
{
    const struct sql_value v = sql_column(r, col);
    uint32_t yes = 0;

    switch (f->kind) {
    case SQL_FIELD_TEXT_OR_NULL:
        to[0] = '\0';
        return v.type == SQL_NULL || sql_read_text(r, col, (char *)to, f->size);
    case SQL_FIELD_TEXT:
        return sql_read_text(r, col, (char *)to, f->size);
    case SQL_FIELD_BYTES_OR_NULL:
        return v.type == SQL_NULL || sql_read_bytes(r, col, to, f->size);
    case SQL_FIELD_BYTES_OR_NONE:
        return (v.type == SQL_BLOB && v.n == 0) || sql_read_bytes(r, col, to, f->size);
    case SQL_FIELD_BYTES:
        return sql_read_bytes(r, col, to, f->size);
    case SQL_FIELD_BLOB:
        return read_blob(r, col, (void *)to);
    case SQL_FIELD_NUMBER:
        return sql_read_int(r, col, (int64_t)f->min, (void *)to);
    case SQL_FIELD_COUNT:
        return sql_read_count(r, col, f->max < UINT32_MAX ? (int64_t)f->max : UINT32_MAX,
                              (void *)to);
    case SQL_FIELD_BOOL:
        if (!sql_read_count(r, col, 1, &yes))
            return false;
        *(bool *)to = yes != 0;
        return true;
    case SQL_FIELD_REAL:
        return read_real(&v, f, (void *)to);
    case SQL_FIELD_HEX:
        break;
    }
    return false;
}

bool sql_read_fields(const struct sql_rows *r, int col, const struct sql_field *field,
                     size_t n, void *out)
{
    for (size_t i = 0; i < n; i++)
        if (!read_field(r, col + (int)i, &field[i], (unsigned char *)out + field[i].at))
            return false;
    return true;
}

static struct sql_value value_of(const struct sql_field *f, const unsigned char *from)
{
    const struct sql_field_blob *blob = (const void *)from;

    switch (f->kind) {
    case SQL_FIELD_TEXT:
        return sql_text((const char *)from);
    case SQL_FIELD_TEXT_OR_NULL:
        return sql_text_or_null((const char *)from);
    case SQL_FIELD_BYTES_OR_NULL:
        return is_zero(from, f->size) ? sql_null() : sql_blob(from, f->size);
    case SQL_FIELD_BYTES_OR_NONE:
        return sql_blob(from, is_zero(from, f->size) ? 0 : f->size);
    case SQL_FIELD_BYTES:
        return sql_blob(from, f->size);
    case SQL_FIELD_BLOB:
        return sql_blob(blob->bytes, blob->n);
    case SQL_FIELD_NUMBER:
        return sql_int(*(const int64_t *)(const void *)from);
    case SQL_FIELD_COUNT:
        return sql_int(*(const uint32_t *)(const void *)from);
    case SQL_FIELD_BOOL:
        return sql_int(*(const bool *)from);
    case SQL_FIELD_REAL:
        return sql_real(*(const double *)(const void *)from);
    case SQL_FIELD_HEX:
        break;
    }
    return sql_null();
}

void sql_field_values(const struct sql_field *field, size_t n, const void *from,
                      struct sql_value *v)
{
    for (size_t i = 0; i < n; i++)
        v[i] = value_of(&field[i], (const unsigned char *)from + field[i].at);
}

/* ---- lists */

/* Room for one more object of size bytes in *list, doubling. */
static enum status grow(unsigned char **list, size_t n, size_t *room, size_t size,
                        struct errinfo *e)
{
    unsigned char *larger;

    if (n < *room)
        return ST_OK;
    *room = *room != 0 ? 2 * *room : 16;
    if ((larger = realloc(*list, *room * size)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    *list = larger;
    return ST_OK;
}

enum status sql_read_list(struct sql_rows *r, enum status st, sql_read_row *row,
                          void *arg, size_t size, void **out, size_t *n,
                          struct errinfo *e)
{
    unsigned char *list = NULL;
    size_t room = 0, count = 0;

    *out = NULL;
    *n = 0;
    while (st == ST_OK && sql_next(r))
        if ((st = grow(&list, count, &room, size, e)) == ST_OK)
            st = row(arg, r, list + count++ * size, e);
    if ((st = sql_done(r, st, e)) != ST_OK) {
        free(list);
        return st;
    }
    *out = list;
    *n = count;
    return ST_OK;
}
