#include "store_open.h"

#include "errinfo.h"
#include "sql_file.h"
#include "sql_open.h"
#include "sql_read.h"
#include "utc.h"

static const char text[] =
    "SELECT current_setting('server_version'), "
    "coalesce((SELECT ssl FROM pg_stat_ssl WHERE pid = pg_backend_pid()), false), "
    "inet_server_addr() IS NULL, "
    "current_setting('fsync') = 'on' AND current_setting('full_page_writes') = 'on', "
    "has_schema_privilege(current_schema(), 'CREATE'), "
    "(SELECT count(DISTINCT pid) FROM pg_locks WHERE locktype = 'advisory' AND database = "
    "(SELECT oid FROM pg_database WHERE datname = current_database()) AND "
    "CAST(classid AS bigint) << 32 | CAST(objid AS bigint) = " SQL_IN_USE
    " AND pid <> pg_backend_pid()), "
    "current_setting('synchronous_standby_names') <> '', "
    "CAST(extract(epoch FROM clock_timestamp()) * 1000 AS bigint)";

static enum status store_server_look(struct sql_txn *t, struct store_server *out,
                                     struct errinfo *e)
{
    int64_t now = 0, at = 0;
    struct sql_rows *r;
    enum status st;

    if (sql_file_is(t))
        return errinfo_set(e, ST_EINVAL, "the database is in a file");
    st = sql_first(t, text, NULL, 0, &r, e);
    if (st == ST_OK && (!sql_read_text(r, 0, out->version, sizeof out->version) ||
                        !sql_read_count(r, 5, UINT32_MAX, &out->others) ||
                        !sql_read_int(r, 7, 0, &at) || !utc_now(&now)))
        st = errinfo_set(e, ST_EDB, "the server does not say what it is");
    if (st == ST_OK) {
        out->encrypted = sql_column(r, 1).i != 0;
        out->local = sql_column(r, 2).i != 0;
        out->keeps = sql_column(r, 3).i != 0;
        out->may_define = sql_column(r, 4).i != 0;
        out->waits = sql_column(r, 6).i != 0;
        out->ahead_ms = at - now;
    }
    return sql_done(r, st, e);
}

enum status store_server(const char *path, struct store_server *out, struct errinfo *e)
{
    struct sql_txn *t;
    struct sql *d;
    enum status st;

    *out = (struct store_server){.local = false};
    if ((st = sql_open(path, SQL_OPEN_READ, &d, e)) != ST_OK)
        return st;
    if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK)
        st = sql_end(t, store_server_look(t, out, e), e);
    sql_close(d);
    return st;
}
