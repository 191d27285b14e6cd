#include "rawdb.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>
#ifdef WITH_POSTGRES
#include <libpq-fe.h>
#else
typedef void PGconn;
#endif

#include "errinfo.h"
#include "sql_open.h"

struct rawdb { /* one of them */
    sqlite3 *file;
    PGconn *server;
};

#ifdef WITH_POSTGRES
static enum status server_open(struct rawdb *d, const char *where, struct errinfo *e)
{
    d->server = PQconnectdb(where);
    if (PQstatus(d->server) != CONNECTION_OK)
        return errinfo_set(e, ST_EDB, "%s", PQerrorMessage(d->server));
    return rawdb_run(d,
                     "SET client_min_messages = error; SET lock_timeout = '5s';"
                     "SET session_replication_role = replica",
                     e);
}

static enum status server_each(struct rawdb *d, const char *sql, rawdb_use *use,
                               void *arg, struct errinfo *e)
{
    PGresult *r = PQexec(d->server, sql);
    const bool good = PQresultStatus(r) == PGRES_COMMAND_OK ||
                      PQresultStatus(r) == PGRES_TUPLES_OK ||
                      PQresultStatus(r) == PGRES_EMPTY_QUERY;

    for (int i = 0; use != NULL && i < PQntuples(r); i++) {
        const char *text = PQgetvalue(r, i, 0);
        size_t n = strlen(text);
        unsigned char *bytes = NULL;

        if (strncmp(text, "\\x", 2) == 0)
            bytes = PQunescapeBytea((const unsigned char *)text, &n);
        use(arg, bytes != NULL ? (const char *)bytes : text, n);
        PQfreemem(bytes);
    }
    if (!good)
        (void)errinfo_set(e, ST_EDB, "%.60s: %s", sql, PQresultErrorMessage(r));
    PQclear(r);
    return good ? ST_OK : ST_EDB;
}

static void server_close(struct rawdb *d)
{
    PQclear(
        PQexec(d->server, "ROLLBACK")); /* done, and not only begun, when it returns */
    PQfinish(d->server);
}
#else
static enum status server_open(struct rawdb *d, const char *where, struct errinfo *e)
{
    (void)d;
    return errinfo_set(e, ST_EDB, "%s: built without PostgreSQL", where);
}

static enum status server_each(struct rawdb *d, const char *sql, rawdb_use *use,
                               void *arg, struct errinfo *e)
{
    (void)d, (void)use, (void)arg;
    return errinfo_set(e, ST_EDB, "%s", sql);
}

static void server_close(struct rawdb *d)
{
    (void)d;
}
#endif

enum status rawdb_open(const char *where, struct rawdb **out, struct errinfo *e)
{
    struct rawdb *d = *out = calloc(1, sizeof *d);

    if (d == NULL)
        return errinfo_memory(e);
    if (sql_open_is_url(where))
        return server_open(d, where, e);
    if (sqlite3_open(where, &d->file) != SQLITE_OK ||
        sqlite3_busy_timeout(d->file, 5000) != SQLITE_OK ||
        sqlite3_exec(d->file, "PRAGMA ignore_check_constraints = ON", NULL, NULL, NULL) !=
            SQLITE_OK)
        return errinfo_set(e, ST_EDB, "%.120s: %s", where, sqlite3_errmsg(d->file));
    return ST_OK;
}

enum status rawdb_run(struct rawdb *d, const char *sql, struct errinfo *e)
{
    if (d->file == NULL)
        return server_each(d, sql, NULL, NULL, e);
    return sqlite3_exec(d->file, sql, NULL, NULL, NULL) == SQLITE_OK
               ? ST_OK
               : errinfo_set(e, ST_EDB, "%.60s: %s", sql, sqlite3_errmsg(d->file));
}

enum status rawdb_each(struct rawdb *d, const char *sql, rawdb_use *use, void *arg,
                       struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;
    int rc = SQLITE_ERROR;

    if (d->file == NULL)
        return server_each(d, sql, use, arg, e);
    if (sqlite3_prepare_v2(d->file, sql, -1, &stmt, NULL) == SQLITE_OK)
        while ((rc = sqlite3_step(stmt)) == SQLITE_ROW) {
            const bool blob = sqlite3_column_type(stmt, 0) == SQLITE_BLOB;
            const void *data = blob ? sqlite3_column_blob(stmt, 0)
                                    : (const void *)sqlite3_column_text(stmt, 0);

            use(arg, data != NULL ? data : "", (size_t)sqlite3_column_bytes(stmt, 0));
        }
    if (rc != SQLITE_DONE)
        st = errinfo_set(e, ST_EDB, "%.60s: %s", sql, sqlite3_errmsg(d->file));
    (void)sqlite3_finalize(stmt);
    return st;
}

void rawdb_close(struct rawdb *d)
{
    if (d == NULL)
        return;
    if (d->file != NULL)
        (void)sqlite3_close(d->file);
    if (d->server != NULL)
        server_close(d);
    free(d);
}
