#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
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

/* ---- proofs */

#define PROVED_MAX 4096 /* bytes: no row that this program wrote has more */

struct proved {
    size_t n;
    unsigned char bytes[PROVED_MAX];
};

static bool put(struct proved *p, const void *from, size_t n)
{
    if (n > sizeof p->bytes - p->n)
        return false;
    if (n > 0)
        memcpy(p->bytes + p->n, from, n);
    p->n += n;
    return true;
}

static bool put_number(struct proved *p, uint64_t v, size_t n)
{
    unsigned char bytes[8];

    bytes_set(bytes, v, n);
    return put(p, bytes, n);
}

/* Its type, and its value or length and bytes: no two different columns give the same. */
static bool put_column(struct proved *p, sqlite3_stmt *stmt, int col)
{
    const void *data = NULL;
    uint64_t bits;
    double real;
    int n;

    switch (sqlite3_column_type(stmt, col)) {
    case SQLITE_NULL:
        return put_number(p, 0, 1);
    case SQLITE_INTEGER:
        return put_number(p, 1, 1) &&
               put_number(p, (uint64_t)sqlite3_column_int64(stmt, col), 8);
    case SQLITE_FLOAT:
        real = sqlite3_column_double(stmt, col);
        memcpy(&bits, &real, sizeof bits);
        return put_number(p, 2, 1) && put_number(p, bits, 8);
    case SQLITE_TEXT:
        data = sqlite3_column_text(stmt, col);
        n = sqlite3_column_bytes(stmt, col);
        return data != NULL && put_number(p, 3, 1) && put_number(p, (uint64_t)n, 4) &&
               put(p, data, (size_t)n);
    default:
        data = sqlite3_column_blob(stmt, col); /* NULL where it is empty */
        n = sqlite3_column_bytes(stmt, col);
        return put_number(p, 4, 1) && put_number(p, (uint64_t)n, 4) &&
               put(p, data, data != NULL ? (size_t)n : 0);
    }
}

static bool prove(const struct store_sqlite_conn *c, const char what[16],
                  sqlite3_stmt *stmt, int n, unsigned char mac[VAULT_HASH])
{
    struct proved p = {.n = 0};

    if (!put(&p, what, 16))
        return false;
    for (int i = 0; i < n; i++)
        if (!put_column(&p, stmt, i))
            return false;
    vault_mac(c->vault, p.bytes, p.n, mac);
    return true;
}

bool store_sqlite_proved(const struct store_sqlite_conn *c, const char what[16],
                         sqlite3_stmt *stmt, int n)
{
    unsigned char mac[VAULT_HASH], stored[VAULT_HASH];

    return store_sqlite_bytes(stmt, n, stored, sizeof stored) &&
           prove(c, what, stmt, n, mac) && sodium_memcmp(mac, stored, sizeof mac) == 0;
}

enum status store_sqlite_prove(struct store_sqlite_conn *c, const char what[16],
                               sqlite3_stmt *stmt, int n, enum store_sqlite_sql set,
                               struct errinfo *e)
{
    unsigned char mac[VAULT_HASH];
    sqlite3_stmt *update;
    enum status st = store_sqlite_prepare(c, set, &update, e);

    if (st != ST_OK)
        return st;
    if (!prove(c, what, stmt, n, mac))
        return errinfo_set(e, ST_ECORRUPT, "a row that is too long");
    if (sqlite3_bind_value(update, 1, sqlite3_column_value(stmt, 0)) != SQLITE_OK ||
        store_sqlite_bind_bytes(update, 2, mac, sizeof mac) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot prove a row", e);
    return store_sqlite_run(c, update, e);
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
