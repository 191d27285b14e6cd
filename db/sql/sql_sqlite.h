/* sql_sqlite.h -- the SQLite driver: one connection writes, under a lock;
 * readers have a connection each while they read, and in WAL mode neither waits for the other.  Each
 * connection is hardened against the file that it reads; its statements are prepared once. */
#ifndef DB_SQL_SQLITE_H
#define DB_SQL_SQLITE_H
#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include "sql.h"

/* A small cache of pages: a template is read once and then kept decoded elsewhere; the usual 2 MB of
 * each connection would only be memory that fills. */
#define SQL_SQLITE_CACHE "PRAGMA cache_size=-256"

#define SQL_SQLITE_VERSION 1    /* user_version in schema.sql */
#define SQL_SQLITE_BUSY_MS 5000 /* waited for other threads and processes together */
#define SQL_SQLITE_SLOTS   256  /* more than there are statements */

struct sql_sqlite_rows {
    struct sql_rows base;
    const char *text; /* NULL: no statement is in this slot */
    sqlite3_stmt *stmt;
    struct sql_sqlite_conn *conn;
    int rc; /* of the last step */
    bool open;
};

struct sql_sqlite_conn { /* a connection, and the transaction that it has */
    struct sql_txn base;
    sqlite3 *db;
    struct sql_sqlite *of;
    struct sql_sqlite_conn *next; /* in the list of those at rest */
    bool writes, makes;           /* the transaction */
    unsigned fresh;               /* sql_sqlite.fresh when it last forgot */
    uint64_t changed;
    struct sql_sqlite_rows slot[SQL_SQLITE_SLOTS];
};

extern const struct sql_driver sql_sqlite_driver;
enum status sql_sqlite_open(const char *path, enum sql_open how, struct sql **out,
                            struct errinfo *e);

/* sql_sqlite_conn_open(path, flags, alone, out, e): as SQL_OPEN_ALONE, or not.
 * sql_sqlite_conn_close(c): NULL is allowed. */
enum status sql_sqlite_conn_open(const char *path, int flags, bool alone,
                                 struct sql_sqlite_conn **out, struct errinfo *e);
void sql_sqlite_conn_close(struct sql_sqlite_conn *c);

/* sql_sqlite_conn_forget(c): what it knows of the file, where sql_file_forget() was called since; its
 * schema too, which SQLite reads again only where the file's schema cookie has changed. */
void sql_sqlite_conn_forget(struct sql_sqlite_conn *c);

/* sql_sqlite_conn_fail(c, what, e): the status and text of its last error.
 * sql_sqlite_conn_exec(c, sql, what, e): statements that are the driver's own.
 * sql_sqlite_conn_int(c, sql, out, e): the same with one that gives a number. */
enum status sql_sqlite_conn_fail(const struct sql_sqlite_conn *c, const char *what,
                                 struct errinfo *e);
enum status sql_sqlite_conn_exec(struct sql_sqlite_conn *c, const char *sql,
                                 const char *what, struct errinfo *e);
enum status sql_sqlite_conn_int(struct sql_sqlite_conn *c, const char *sql, int64_t *out,
                                struct errinfo *e);

/* sql_sqlite_conn_version(c, version, e): 0: it holds nothing; else 1 to the newest.
 * ST_ECORRUPT: another program's; ST_EVERSION: a newer one. */
enum status sql_sqlite_conn_version(struct sql_sqlite_conn *c, int *version,
                                    struct errinfo *e);

struct sql_sqlite {
    struct sql base;
    char *path;
    int flags;   /* of the readers' connections */
    bool made;   /* the file is new, and nothing is in it */
    bool single; /* the writer's connection is the only one */

    pthread_mutex_t lock;           /* of `writing` and `idle`, held but a moment */
    pthread_cond_t write_free;      /* by the monotonic clock */
    bool writing;                   /* a thread has the writer's connection */
    struct sql_sqlite_conn *writer; /* NULL: opened for reading */
    atomic_uint fresh;              /* how often what connections know was forgotten */
    atomic_bool scrub; /* erased bytes may be in the WAL: a reader was in the way */
    struct sql_sqlite_conn *idle; /* readers' connections at rest */
};

/* The functions of the driver's table for statements and rows. */
enum status sql_sqlite_conn_run(struct sql_txn *t, const char *text,
                                const struct sql_value *value, size_t n, bool one,
                                struct errinfo *e);
enum status sql_sqlite_conn_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e);
enum status sql_sqlite_conn_query(struct sql_txn *t, const char *text,
                                  const struct sql_value *value, size_t n, bool stream,
                                  struct sql_rows **out, struct errinfo *e);
bool sql_sqlite_conn_next(struct sql_rows *r);
struct sql_value sql_sqlite_conn_column(const struct sql_rows *r, int i);
enum status sql_sqlite_conn_done(struct sql_rows *r, enum status st, struct errinfo *e);

/* sql_sqlite_lock(d, ms, e): wait up to ms for the writer's connection, and what is left of
 * that is what SQLite may then wait for other processes.  ST_EDENIED, ST_EBUSY. */
enum status sql_sqlite_lock(struct sql_sqlite *d, long ms, struct errinfo *e);
void sql_sqlite_unlock(struct sql_sqlite *d);

/* sql_sqlite_truncate(d, ms): the WAL into the file and empty, on the disk, where no reader is
 * in the way for longer than ms.  The writer's connection is locked. */
void sql_sqlite_truncate(struct sql_sqlite *d, int ms);

#endif
