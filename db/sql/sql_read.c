#include "sql_read.h"

#include <stdlib.h>
#include <string.h>

#include "errinfo.h"

/* ---- values */

static bool get_text(const struct sql_value *v, char *out, size_t size)
{
    out[0] = '\0';
    if (v->type != SQL_TEXT || v->n >= size || memchr(v->data, '\0', v->n) != NULL)
        return false;
    memcpy(out, v->data, v->n);
    out[v->n] = '\0';
    return true;
}

static bool get_bytes(const struct sql_value *v, void *out, size_t n)
{
    if (v->type != SQL_BLOB || v->n != n)
        return false;
    memcpy(out, v->data, n);
    return true;
}

static bool get_number(const struct sql_value *v, double min, double max, int64_t *out)
{
    *out = v->type == SQL_INT ? v->i : 0;
    return v->type == SQL_INT && (double)v->i >= min && (double)v->i <= max;
}

static bool get_blob(const struct sql_value *v, struct sql_field_blob *out)
{
    out->n = v->n;
    return v->n >= 1 && v->n <= sizeof out->bytes && get_bytes(v, out->bytes, v->n);
}

bool sql_field_set(const struct sql_field *f, const struct sql_value *v, void *to)
{
    int64_t i = 0;
    bool ok;

    switch (f->kind) {
    case SQL_FIELD_TEXT:
        return get_text(v, to, f->size);
    case SQL_FIELD_TEXT_OR_NULL:
        return v->type == SQL_NULL || get_text(v, to, f->size);
    case SQL_FIELD_BYTES:
        return get_bytes(v, to, f->size);
    case SQL_FIELD_BYTES_OR_NULL:
        return v->type == SQL_NULL || get_bytes(v, to, f->size);
    case SQL_FIELD_BYTES_OR_NONE:
        return get_bytes(v, to, v->n == 0 ? 0 : f->size);
    case SQL_FIELD_BLOB:
        return get_blob(v, to);
    case SQL_FIELD_NUMBER:
        return get_number(v, f->min, f->max, to);
    case SQL_FIELD_COUNT:
        ok = get_number(v, f->min, f->max < UINT32_MAX ? f->max : UINT32_MAX, &i);
        *(uint32_t *)to = ok ? (uint32_t)i : 0;
        return ok;
    case SQL_FIELD_BOOL:
        ok = get_number(v, 0, 1, &i);
        *(bool *)to = i != 0;
        return ok;
    case SQL_FIELD_REAL:
        *(double *)to = v->r;
        break;
    }
    return v->type == SQL_REAL && v->r >= f->min && v->r <= f->max;
}

static bool is_zero(const unsigned char *bytes, size_t n)
{
    while (n > 0 && bytes[n - 1] == 0)
        n--;
    return n == 0;
}

struct sql_value sql_field_value(const struct sql_field *f, const void *from)
{
    const struct sql_field_blob *blob = from;

    switch (f->kind) {
    case SQL_FIELD_TEXT:
        return sql_text(from);
    case SQL_FIELD_TEXT_OR_NULL:
        return *(const char *)from != '\0' ? sql_text(from) : sql_null();
    case SQL_FIELD_BYTES:
        return sql_blob(from, f->size);
    case SQL_FIELD_BYTES_OR_NULL:
        return is_zero(from, f->size) ? sql_null() : sql_blob(from, f->size);
    case SQL_FIELD_BYTES_OR_NONE:
        return sql_blob(from, is_zero(from, f->size) ? 0 : f->size);
    case SQL_FIELD_BLOB:
        return sql_blob(blob->bytes, blob->n);
    case SQL_FIELD_NUMBER:
        return sql_int(*(const int64_t *)from);
    case SQL_FIELD_COUNT:
        return sql_int(*(const uint32_t *)from);
    case SQL_FIELD_BOOL:
        return sql_int(*(const bool *)from);
    case SQL_FIELD_REAL:
        break;
    }
    return sql_real(*(const double *)from);
}

void sql_field_values(const struct sql_field *field, size_t n, const void *from,
                      struct sql_value *v)
{
    for (size_t i = 0; i < n; i++)
        v[i] = sql_field_value(&field[i], (const char *)from + field[i].at);
}

/* ---- columns */

bool sql_read_fields(const struct sql_rows *r, int col, const struct sql_field *field,
                     size_t n, void *out)
{
    for (size_t i = 0; i < n; i++) {
        const struct sql_value v = sql_column(r, col + (int)i);

        if (!sql_field_set(&field[i], &v, (char *)out + field[i].at))
            return false;
    }
    return true;
}

bool sql_read_text(const struct sql_rows *r, int col, char *out, size_t size)
{
    const struct sql_value v = sql_column(r, col);

    return get_text(&v, out, size);
}

bool sql_read_bytes(const struct sql_rows *r, int col, void *out, size_t n)
{
    const struct sql_value v = sql_column(r, col);

    return get_bytes(&v, out, n);
}

bool sql_read_int(const struct sql_rows *r, int col, int64_t min, int64_t *out)
{
    const struct sql_value v = sql_column(r, col);

    *out = v.type == SQL_INT ? v.i : 0;
    return v.type == SQL_INT && v.i >= min;
}

bool sql_read_count(const struct sql_rows *r, int col, int64_t max, uint32_t *out)
{
    const struct sql_field count = {SQL_FIELD_COUNT, 0, sizeof *out, 0, (double)max};
    const struct sql_value v = sql_column(r, col);

    return sql_field_set(&count, &v, out);
}

/* ---- lists */

/* Room for one more object of size bytes in *list, doubling. */
static enum status sql_read_grow(unsigned char **list, size_t n, size_t *room,
                                 size_t size, struct errinfo *e)
{
    unsigned char *larger;

    if (n < *room)
        return ST_OK;
    *room = *room != 0 ? 2 * *room : 16;
    if ((larger = realloc(*list, *room * size)) == NULL)
        return errinfo_memory(e);
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
        if ((st = sql_read_grow(&list, count, &room, size, e)) == ST_OK)
            st = row(arg, r, list + count++ * size, e);
    if ((st = sql_done(r, st, e)) != ST_OK) {
        free(list);
        return st;
    }
    *out = list;
    *n = count;
    return ST_OK;
}
