#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "store_sqlite.h"

/* ---- columns */

bool store_sqlite_text(sqlite3_stmt *stmt, int col, char *out, size_t size)
{
    const unsigned char *text;
    size_t n;

    out[0] = '\0';
    if (sqlite3_column_type(stmt, col) != SQLITE_TEXT ||
        (text = sqlite3_column_text(stmt, col)) == NULL)
        return false;
    n = (size_t)sqlite3_column_bytes(stmt, col);
    if (n >= size || memchr(text, '\0', n) != NULL)
        return false;
    memcpy(out, text, n);
    out[n] = '\0';
    return true;
}

bool store_sqlite_text_or(sqlite3_stmt *stmt, int col, char *out, size_t size)
{
    out[0] = '\0';
    return sqlite3_column_type(stmt, col) == SQLITE_NULL ||
           store_sqlite_text(stmt, col, out, size);
}

const void *store_sqlite_blob(sqlite3_stmt *stmt, int col, size_t min, size_t max,
                              size_t *n)
{
    const void *data;

    *n = 0;
    if (sqlite3_column_type(stmt, col) != SQLITE_BLOB ||
        (data = sqlite3_column_blob(stmt, col)) == NULL)
        return NULL;
    *n = (size_t)sqlite3_column_bytes(stmt, col);
    return *n >= min && *n <= max ? data : NULL;
}

bool store_sqlite_bytes(sqlite3_stmt *stmt, int col, void *out, size_t n)
{
    size_t len;
    const void *data = store_sqlite_blob(stmt, col, n, n, &len);

    if (data == NULL)
        return false;
    memcpy(out, data, n);
    return true;
}

bool store_sqlite_count(sqlite3_stmt *stmt, int col, int64_t max, uint32_t *out)
{
    const int64_t v = sqlite3_column_int64(stmt, col);

    *out = 0;
    if (sqlite3_column_type(stmt, col) != SQLITE_INTEGER || v < 0 || v > max)
        return false;
    *out = (uint32_t)v;
    return true;
}

int store_sqlite_bind(sqlite3_stmt *stmt, int at, const char *text)
{
    return sqlite3_bind_text(stmt, at, text, -1, SQLITE_TRANSIENT);
}

int store_sqlite_bind_or(sqlite3_stmt *stmt, int at, const char *text)
{
    return text[0] == '\0' ? sqlite3_bind_null(stmt, at)
                           : store_sqlite_bind(stmt, at, text);
}

/* No bytes are a BLOB of none, not NULL. */
int store_sqlite_bind_bytes(sqlite3_stmt *stmt, int at, const void *data, size_t n)
{
    return n == 0 ? sqlite3_bind_zeroblob(stmt, at, 0)
                  : sqlite3_bind_blob64(stmt, at, data, n, SQLITE_TRANSIENT);
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

enum status store_sqlite_rows(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              store_sqlite_row *row, size_t size, const char *what,
                              void **out, size_t *n, struct errinfo *e)
{
    unsigned char *list = NULL;
    size_t room = 0, count = 0;
    enum status st = ST_OK;
    int rc = SQLITE_DONE;

    while (st == ST_OK && (rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        if ((st = grow(&list, count, &room, size, e)) == ST_OK)
            st = row(c, stmt, list + count++ * size, e);
    }
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, what, e);
    (void)sqlite3_reset(stmt);
    if (st != ST_OK) {
        free(list);
        return st;
    }
    *out = list;
    *n = count;
    return ST_OK;
}
