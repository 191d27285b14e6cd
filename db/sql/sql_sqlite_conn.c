#include "sql_sqlite.h"

#include <stdlib.h>

#include "errinfo.h"

#define APPLICATION 0x53524644  /* application_id in schema.sql */
#define MAX_BYTES   (256 << 20) /* no row is larger: 2^21 points are 84 MB */

/* ---- errors */

static enum status status_of(int rc)
{
    if (rc == SQLITE_IOERR_NOMEM)
        return ST_ENOMEM;
    switch (rc & 0xff) {
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
    default: /* also if a call failed without an error */
        return ST_EDB;
    }
}

enum status sql_sqlite_conn_fail(const struct sql_sqlite_conn *c, const char *what,
                                 struct errinfo *e)
{
    const int rc = sqlite3_extended_errcode(c->db), sys = sqlite3_system_errno(c->db);
    const enum status st = status_of(rc);
    const char *path = sqlite3_db_filename(c->db, "main");

    if ((rc & 0xff) == SQLITE_NOTADB)
        return errinfo_set(e, st, "%s is not a database", path);
    if (st == ST_EBUSY)
        return errinfo_set(e, st, "%s: %s: locked by another process", path, what);
    return errinfo_set(e, st, "%s: %s: %s%s%s", path, what, sqlite3_errmsg(c->db),
                       st == ST_EIO && sys != 0 ? ": " : "",
                       st == ST_EIO && sys != 0 ? strerror(sys) : "");
}

enum status sql_sqlite_conn_exec(struct sql_sqlite_conn *c, const char *sql,
                                 const char *what, struct errinfo *e)
{
    return sqlite3_exec(c->db, sql, NULL, NULL, NULL) == SQLITE_OK
               ? ST_OK
               : sql_sqlite_conn_fail(c, what, e);
}

/* ---- connections */

void sql_sqlite_conn_close(struct sql_sqlite_conn *c)
{
    if (c == NULL)
        return;
    for (size_t i = 0; i < SQL_SQLITE_SLOTS; i++)
        (void)sqlite3_finalize(c->slot[i].stmt);
    (void)sqlite3_close(c->db);
    free(c);
}

void sql_sqlite_conn_forget(struct sql_sqlite_conn *c)
{
    const unsigned fresh = atomic_load(&c->of->fresh);

    if (c->fresh == fresh)
        return;
    c->fresh = fresh;
    (void)sqlite3_exec(c->db, "PRAGMA writable_schema=RESET", NULL, NULL, NULL);
    (void)sqlite3_db_release_memory(c->db);
}

/* Nothing in the file is trusted: no triggers or views, no functions from its schema, no
 * writing to the schema; cells are checked as they are read. */
static enum status harden(struct sql_sqlite_conn *c, struct errinfo *e)
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
            return sql_sqlite_conn_fail(c, "cannot configure", e);
    (void)sqlite3_limit(c->db, SQLITE_LIMIT_LENGTH, MAX_BYTES);
    (void)sqlite3_limit(c->db, SQLITE_LIMIT_ATTACHED, 0);
    (void)sqlite3_busy_timeout(c->db, SQL_SQLITE_BUSY_MS);
    return sql_sqlite_conn_exec(c, "PRAGMA cell_size_check=ON; " SQL_SQLITE_CACHE,
                                "cannot configure", e);
}

/* Before anything is read: a WAL that is opened for sharing stays shared.  A process that has
 * opened the database holds a lock on its file, also at rest. */
static enum status lock_out(struct sql_sqlite_conn *c, const char *path,
                            struct errinfo *e)
{
    const enum status st = sql_sqlite_conn_exec(
        c, "PRAGMA locking_mode=EXCLUSIVE; BEGIN EXCLUSIVE; COMMIT", "cannot lock", e);

    return st == ST_EBUSY ? errinfo_set(e, st,
                                        "%s is open in another process: stop surfaced "
                                        "first",
                                        path)
                          : st;
}

enum status sql_sqlite_conn_open(const char *path, int flags, bool alone,
                                 struct sql_sqlite_conn **out, struct errinfo *e)
{
    struct sql_sqlite_conn *c = calloc(1, sizeof *c);
    enum status st = ST_OK;

    *out = NULL;
    if (c == NULL)
        return errinfo_memory(e);
    c->base.driver = &sql_sqlite_driver;
    if (sqlite3_open_v2(path, &c->db, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE,
                        NULL) != SQLITE_OK)
        st =
            c->db == NULL ? errinfo_memory(e) : sql_sqlite_conn_fail(c, "cannot open", e);
    if (st == ST_OK && alone)
        st = lock_out(c, path, e);
    if (st == ST_OK)
        st = harden(c, e);
    if (st == ST_OK)
        *out = c;
    else
        sql_sqlite_conn_close(c);
    return st;
}

/* ---- the schema's version */

enum status sql_sqlite_conn_int(struct sql_sqlite_conn *c, const char *sql, int64_t *out,
                                struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;

    if (sqlite3_prepare_v2(c->db, sql, -1, &stmt, NULL) != SQLITE_OK ||
        sqlite3_step(stmt) != SQLITE_ROW)
        st = sql_sqlite_conn_fail(c, "cannot read", e);
    else
        *out = sqlite3_column_int64(stmt, 0);
    (void)sqlite3_finalize(stmt);
    return st;
}

enum status sql_sqlite_conn_version(struct sql_sqlite_conn *c, int *version,
                                    struct errinfo *e)
{
    const char *path = sqlite3_db_filename(c->db, "main");
    int64_t application = 0, user = 0, objects = 0;
    enum status st;

    *version = 0;
    if ((st = sql_sqlite_conn_int(c, "PRAGMA application_id", &application, e)) !=
            ST_OK ||
        (st = sql_sqlite_conn_int(c, "PRAGMA user_version", &user, e)) != ST_OK ||
        (st = sql_sqlite_conn_int(c, "SELECT count(*) FROM sqlite_schema", &objects,
                                  e)) != ST_OK)
        return st;
    if (application == 0 && user == 0 && objects == 0)
        return ST_OK;
    if (application != APPLICATION)
        return errinfo_set(e, ST_ECORRUPT, "%s is the database of another program", path);
    if (user > SQL_SQLITE_VERSION)
        return errinfo_set(e, ST_EVERSION,
                           "%s has schema version %lld, this program knows up to %d: "
                           "use a newer program",
                           path, (long long)user, SQL_SQLITE_VERSION);
    if (user < 1)
        return errinfo_set(e, ST_ECORRUPT, "%s has the impossible schema version %lld",
                           path, (long long)user);
    *version = (int)user;
    return ST_OK;
}

/* ---- statements */

/* The slot of this text, or an empty one for it; NULL: all are taken.  The highest bits of a
 * product depend on all bits of the address. */
static struct sql_sqlite_rows *find_slot(struct sql_sqlite_conn *c, const char *text)
{
    size_t at = (uint64_t)(uintptr_t)text * 0x9e3779b97f4a7c15U >> 56;

    for (size_t tries = 0; tries < SQL_SQLITE_SLOTS; tries++) {
        struct sql_sqlite_rows *r = &c->slot[(at + tries) % SQL_SQLITE_SLOTS];

        if (r->text == text || r->text == NULL)
            return r;
    }
    return NULL;
}

/* The statement of this text, ready to bind. */
static enum status sql_sqlite_conn_prepare(struct sql_sqlite_conn *c, const char *text,
                                           struct sql_sqlite_rows **out,
                                           struct errinfo *e)
{
    struct sql_sqlite_rows *r = *out = find_slot(c, text);

    if (r == NULL)
        return errinfo_set(e, ST_EINTERNAL, "too many statements: %.80s", text);
    if (r->open)
        return errinfo_set(e, ST_EINTERNAL, "a statement amid its own rows: %.80s", text);
    if (r->text != NULL)
        return ST_OK;
    if (sqlite3_prepare_v3(c->db, text, -1, SQLITE_PREPARE_PERSISTENT, &r->stmt, NULL) !=
        SQLITE_OK)
        return sql_sqlite_conn_fail(c, "cannot prepare a statement", e);
    r->base.driver = c->base.driver;
    r->text = text;
    r->conn = c;
    return ST_OK;
}

static int bind_value(sqlite3_stmt *stmt, int at, const struct sql_value *v,
                      sqlite3_destructor_type copied)
{
    switch (v->type) {
    case SQL_INT:
        return sqlite3_bind_int64(stmt, at, v->i);
    case SQL_REAL:
        return sqlite3_bind_double(stmt, at, v->r);
    case SQL_TEXT:
        return sqlite3_bind_text64(stmt, at, v->data, v->n, copied, SQLITE_UTF8);
    case SQL_BLOB: /* no bytes are a BLOB of none, not NULL */
        return v->n == 0 ? sqlite3_bind_zeroblob(stmt, at, 0)
                         : sqlite3_bind_blob64(stmt, at, v->data, v->n, copied);
    case SQL_NULL:
        break;
    }
    return sqlite3_bind_null(stmt, at);
}

static enum status sql_sqlite_conn_start(struct sql_sqlite_conn *c, const char *text,
                                         const struct sql_value *value, size_t n,
                                         sqlite3_destructor_type copied,
                                         struct sql_sqlite_rows **out, struct errinfo *e)
{
    const enum status st = sql_sqlite_conn_prepare(c, text, out, e);
    sqlite3_stmt *stmt = st == ST_OK ? (*out)->stmt : NULL;

    for (int i = 1; st == ST_OK && i <= sqlite3_bind_parameter_count(stmt); i++) {
        /* To SQLite their numbers follow their first use, and $2 is but a name. */
        const char *name = sqlite3_bind_parameter_name(stmt, i);
        const unsigned long number = name != NULL ? strtoul(name + 1, NULL, 10) : 0;

        if (number < 1 || number > n)
            return errinfo_set(e, ST_EINTERNAL, "a value too few for: %.80s", text);
        if (bind_value(stmt, i, &value[number - 1], copied) != SQLITE_OK)
            return sql_sqlite_conn_fail(c, "cannot bind a value", e);
    }
    return st;
}

enum status sql_sqlite_conn_run(struct sql_txn *t, const char *text,
                                const struct sql_value *value, size_t n, bool one,
                                struct errinfo *e)
{
    struct sql_sqlite_conn *c = (struct sql_sqlite_conn *)t;
    struct sql_sqlite_rows *r;
    enum status st = sql_sqlite_conn_start(c, text, value, n, SQLITE_STATIC, &r, e);

    c->changed = 0;
    if (st == ST_OK && sqlite3_step(r->stmt) != SQLITE_DONE)
        st = sql_sqlite_conn_fail(c, "cannot write", e);
    if (st == ST_OK)
        c->changed = (uint64_t)sqlite3_changes64(c->db);
    if (r != NULL && r->stmt != NULL && !r->open) {
        (void)sqlite3_reset(r->stmt);
        (void)sqlite3_clear_bindings(r->stmt); /* the values are the caller's */
    }
    return st == ST_OK && one && c->changed != 1 ? sql_one_row(c->changed, e) : st;
}

enum status sql_sqlite_conn_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e)
{
    (void)e;
    *n = ((struct sql_sqlite_conn *)t)->changed;
    return ST_OK;
}

/* ---- rows */

enum status sql_sqlite_conn_query(struct sql_txn *t, const char *text,
                                  const struct sql_value *value, size_t n, bool stream,
                                  struct sql_rows **out, struct errinfo *e)
{
    struct sql_sqlite_rows *r;
    const enum status st = sql_sqlite_conn_start((struct sql_sqlite_conn *)t, text, value,
                                                 n, SQLITE_TRANSIENT, &r, e);

    (void)stream; /* rows are read as they are asked for */
    *out = NULL;
    if (st != ST_OK)
        return st;
    r->open = true;
    r->rc = SQLITE_ROW;
    *out = &r->base;
    return ST_OK;
}

bool sql_sqlite_conn_next(struct sql_rows *rows)
{
    struct sql_sqlite_rows *r = (struct sql_sqlite_rows *)rows;

    return r->rc == SQLITE_ROW && (r->rc = sqlite3_step(r->stmt)) == SQLITE_ROW;
}

struct sql_value sql_sqlite_conn_column(const struct sql_rows *rows, int i)
{
    const struct sql_sqlite_rows *r = (const struct sql_sqlite_rows *)rows;
    struct sql_value v = {.type = SQL_NULL};

    switch (sqlite3_column_type(r->stmt, i)) {
    case SQLITE_INTEGER:
        return sql_int(sqlite3_column_int64(r->stmt, i));
    case SQLITE_FLOAT:
        return sql_real(sqlite3_column_double(r->stmt, i));
    case SQLITE_TEXT:
        v.type = SQL_TEXT;
        v.data = sqlite3_column_text(r->stmt, i);
        break;
    case SQLITE_BLOB:
        v.type = SQL_BLOB;
        v.data = sqlite3_column_blob(r->stmt, i); /* NULL if it is empty */
        break;
    default:
        return v;
    }
    v.n = (size_t)sqlite3_column_bytes(r->stmt, i);
    if (v.data == NULL) {
        if (v.n == 0 && sqlite3_errcode(r->conn->db) != SQLITE_NOMEM)
            v.data = "";
        else
            v = sql_null();
    }
    return v;
}

enum status sql_sqlite_conn_done(struct sql_rows *rows, enum status st, struct errinfo *e)
{
    struct sql_sqlite_rows *r = (struct sql_sqlite_rows *)rows;

    if (st == ST_OK && r->rc != SQLITE_ROW && r->rc != SQLITE_DONE)
        st = sql_sqlite_conn_fail(r->conn, "cannot read", e);
    (void)sqlite3_reset(r->stmt);
    r->open = false;
    return st;
}
