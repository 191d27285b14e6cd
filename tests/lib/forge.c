#include "forge.h"

#include "errinfo.h"
#include "store_sqlite.h"

enum status forge_sql(const char *path, const char *sql, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    struct store *s;
    enum status st;

    if ((st = store_open(path, STORE_WRITE, NULL, &s, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_write(s, true, &c, e)) == ST_OK) {
        if (sqlite3_exec(c->db, sql, NULL, NULL, NULL) != SQLITE_OK)
            st = store_sqlite_fail(c, sql, e);
        else if ((st = store_sqlite_token_prove(c, e)) == ST_OK)
            st = store_sqlite_calibration_prove(c, e);
        st = store_sqlite_written(s, st, e);
    }
    store_close(s);
    return st;
}
