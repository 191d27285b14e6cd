#include "sql_read.h"

#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "sql.h"

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

bool sql_read_text_or(const struct sql_rows *r, int col, char *out, size_t size)
{
    out[0] = '\0';
    return sql_column(r, col).type == SQL_NULL || sql_read_text(r, col, out, size);
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

bool sql_read_real(const struct sql_rows *r, int col, double min, double max, double *out)
{
    const struct sql_value v = sql_column(r, col);

    *out = v.type == SQL_REAL ? v.r : 0;
    return v.type == SQL_REAL && v.r >= min && v.r <= max;
}

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
