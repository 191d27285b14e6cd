#include <stdlib.h>

#include "errinfo.h"
#include "store_sqlite.h"

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
            st = row(stmt, list + count++ * size, e);
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
