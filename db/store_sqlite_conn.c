#include "store_sqlite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "errinfo.h"

#define MAX_BYTES (256 << 20) /* no row is larger: 2^21 points are 84 MB */

/* ---- errors */

static enum status status_of(int rc)
{
    if (rc == SQLITE_IOERR_NOMEM)
        return ST_ENOMEM;
    switch (rc & 0xff) {
    case SQLITE_OK:
    case SQLITE_ROW:
    case SQLITE_DONE:
        return ST_OK;
    case SQLITE_NOMEM:
        return ST_ENOMEM;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return ST_EBUSY;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
        return ST_ECORRUPT;
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
        return ST_EIO;
    case SQLITE_TOOBIG:
        return ST_ELIMIT;
    default:
        return ST_EDB;
    }
}

enum status store_sqlite_fail(const struct store_sqlite_conn *c, const char *what,
                              struct errinfo *e)
{
    const int rc = sqlite3_extended_errcode(c->db), sys = sqlite3_system_errno(c->db);
    enum status st = status_of(rc);
    const char *path = sqlite3_db_filename(c->db, "main");

    if (st == ST_OK) /* a call failed without leaving an error behind */
        st = ST_EDB;
    if ((rc & 0xff) == SQLITE_NOTADB)
        return errinfo_set(e, st, "%s is not a database", path);
    if (st == ST_EBUSY)
        return errinfo_set(e, st, "%s: %s: locked by another process", path, what);
    return errinfo_set(e, st, "%s: %s: %s%s%s", path, what, sqlite3_errmsg(c->db),
                       st == ST_EIO && sys != 0 ? ": " : "",
                       st == ST_EIO && sys != 0 ? strerror(sys) : "");
}

/* ---- statements */

enum status store_sqlite_prepare(struct store_sqlite_conn *c, enum store_sqlite_sql sql,
                                 sqlite3_stmt **stmt, struct errinfo *e)
{
    *stmt = NULL;
    if (c->stmt[sql] == NULL &&
        sqlite3_prepare_v3(c->db, store_sqlite_sql[sql], -1, SQLITE_PREPARE_PERSISTENT,
                           &c->stmt[sql], NULL) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot prepare a statement", e);
    *stmt = c->stmt[sql];
    return ST_OK;
}

enum status store_sqlite_run(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                             struct errinfo *e)
{
    enum status st = ST_OK;

    if (sqlite3_step(stmt) != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot write", e);
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_exec(struct store_sqlite_conn *c, enum store_sqlite_sql sql,
                              struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, sql, &stmt, e);

    return st != ST_OK ? st : store_sqlite_run(c, stmt, e);
}

/* ---- connections */

void store_sqlite_disconnect(struct store_sqlite_conn *c)
{
    if (c == NULL)
        return;
    for (int i = 0; i < SQL_COUNT; i++)
        (void)sqlite3_finalize(c->stmt[i]);
    (void)sqlite3_close(c->db);
    free(c);
}

/* Nothing in the file is trusted: no triggers or views, no functions from its schema, no
 * writing to the schema; cells are checked as they are read. */
static enum status conn_harden(struct store_sqlite_conn *c, struct errinfo *e)
{
    static const struct {
        int option, value;
    } config[] = {
        {SQLITE_DBCONFIG_DEFENSIVE, 1},      {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
        {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
        {SQLITE_DBCONFIG_DQS_DML, 0},        {SQLITE_DBCONFIG_DQS_DDL, 0},
        {SQLITE_DBCONFIG_ENABLE_FKEY, 1},
    };

    for (size_t i = 0; i < sizeof config / sizeof *config; i++)
        if (sqlite3_db_config(c->db, config[i].option, config[i].value, NULL) !=
            SQLITE_OK)
            return store_sqlite_fail(c, "cannot configure", e);
    (void)sqlite3_limit(c->db, SQLITE_LIMIT_LENGTH, MAX_BYTES);
    (void)sqlite3_limit(c->db, SQLITE_LIMIT_ATTACHED, 0);
    (void)sqlite3_busy_timeout(c->db, STORE_SQLITE_BUSY_MS);
    /* A small cache of pages: a template is read once and then kept decoded elsewhere; the
     * usual 2 MB of each connection would only be memory that fills. */
    if (sqlite3_exec(c->db, "PRAGMA cell_size_check=ON; PRAGMA cache_size=-256", NULL,
                     NULL, NULL) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot configure", e);
    return ST_OK;
}

/* Before anything is read: a log that is opened for sharing stays shared.  Who has opened
 * the database holds a lock on its file, also at rest. */
static enum status lock_out(struct store_sqlite_conn *c, const char *path,
                            struct errinfo *e)
{
    enum status st;

    if (sqlite3_exec(c->db, "PRAGMA locking_mode=EXCLUSIVE; BEGIN EXCLUSIVE; COMMIT",
                     NULL, NULL, NULL) == SQLITE_OK)
        return ST_OK;
    st = store_sqlite_fail(c, "cannot lock", e);
    return st == ST_EBUSY ? errinfo_set(e, st,
                                        "%s is open in another process: stop surfaced "
                                        "first",
                                        path)
                          : st;
}

enum status store_sqlite_connect(const char *path, int flags, bool alone,
                                 struct store_sqlite_conn **out, struct errinfo *e)
{
    struct store_sqlite_conn *c = calloc(1, sizeof *c);
    enum status st;

    *out = NULL;
    if (c == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if (sqlite3_open_v2(path, &c->db, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE,
                        NULL) != SQLITE_OK) {
        st = c->db == NULL ? errinfo_set(e, ST_ENOMEM, "out of memory")
                           : store_sqlite_fail(c, "cannot open", e);
        goto out;
    }
    if (alone && (st = lock_out(c, path, e)) != ST_OK)
        goto out;
    if ((st = conn_harden(c, e)) != ST_OK)
        goto out;
    *out = c;
    c = NULL;
out:
    store_sqlite_disconnect(c);
    return st;
}

bool store_sqlite_has_log(const char *path)
{
    char log[4096];
    struct stat sb;

    return snprintf(log, sizeof log, "%s-wal", path) < (int)sizeof log &&
           stat(log, &sb) == 0 && sb.st_size > 0;
}
