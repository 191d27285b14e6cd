/* sql_sqlite.h -- the SQLite driver.  One connection writes, under a lock; each reader has a connection of its own
 * while it reads.  In WAL mode neither waits for the other.  Each connection is hardened against a hostile
 * file, and prepares each statement once. */
#ifndef DB_SQL_SQLITE_H
#define DB_SQL_SQLITE_H
#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include "sql.h"

/* A small page cache: a template is read once, and kept decoded elsewhere.  The usual 2 MB for each connection
 * would not be used again. */
#define SQL_SQLITE_CACHE "PRAGMA cache_size=-256"

#define SQL_SQLITE_VERSION 1 /* user_version in schema.sql */
#define SQL_SQLITE_BUSY_MS                                                               \
    5000                     /* longest wait for other threads and processes together */
#define SQL_SQLITE_SLOTS 256 /* more than there are statements */

struct sql_sqlite_rows {
    struct sql_rows base;
    const char *text; /* NULL: no statement is in this slot */
    sqlite3_stmt *stmt;
    struct sql_sqlite_conn *conn;
    int rc; /* result of the last step */
    bool open;
};

struct sql_sqlite_conn { /* a connection and its transaction */
    struct sql_txn base;
    sqlite3 *db;
    struct sql_sqlite *of;
    struct sql_sqlite_conn *next; /* next idle connection */
    bool writes, makes;           /* the transaction writes; creates tables */
    unsigned fresh; /* sql_sqlite.fresh at the last sql_sqlite_conn_forget() */
    uint64_t changed;
    struct sql_sqlite_rows slot[SQL_SQLITE_SLOTS];
};

extern const struct sql_driver sql_sqlite_driver;
enum status sql_sqlite_open(const char *path, enum sql_open how, struct sql **out,
                            struct errinfo *e);

/* sql_sqlite_conn_open(path, flags, alone, out, e): Opens a connection.
 *   alone  as SQL_OPEN_ALONE
 *   out    to be released by sql_sqlite_conn_close() */
enum status sql_sqlite_conn_open(const char *path, int flags, bool alone,
                                 struct sql_sqlite_conn **out, struct errinfo *e);

/* sql_sqlite_conn_close(c): Closes c; NULL is allowed. */
void sql_sqlite_conn_close(struct sql_sqlite_conn *c);

/* sql_sqlite_conn_forget(c): Discards the pages and the schema that c remembers, if sql_file_forget() was called
 * since the last time.  SQLite by itself rereads the schema only if the file's schema cookie has changed. */
void sql_sqlite_conn_forget(struct sql_sqlite_conn *c);

/* sql_sqlite_conn_fail(c, what, e): Returns the status of the last error of c, and fills *e. */
enum status sql_sqlite_conn_fail(const struct sql_sqlite_conn *c, const char *what,
                                 struct errinfo *e);

/* sql_sqlite_conn_exec(c, sql, what, e): Runs statements of the driver itself. */
enum status sql_sqlite_conn_exec(struct sql_sqlite_conn *c, const char *sql,
                                 const char *what, struct errinfo *e);

/* sql_sqlite_conn_int(c, sql, out, e): Runs a statement of the driver itself that gives a number. */
enum status sql_sqlite_conn_int(struct sql_sqlite_conn *c, const char *sql, int64_t *out,
                                struct errinfo *e);

/* sql_sqlite_conn_version(c, version, e): Sets *version to the version of the schema; 0: there are no tables.
 * ST_ECORRUPT: it is another program's; ST_EVERSION: it is newer than this program. */
enum status sql_sqlite_conn_version(struct sql_sqlite_conn *c, int *version,
                                    struct errinfo *e);

struct sql_sqlite {
    struct sql base;
    char *path;
    int flags;   /* flags of the readers' connections */
    bool made;   /* the file is new and has no tables */
    bool single; /* the writer's connection is the only one */

    pthread_mutex_t lock;           /* held briefly, for `writing` and `idle` */
    pthread_cond_t write_free;      /* signal that writing is false; monotonic clock */
    bool writing;                   /* a thread has the writer's connection */
    struct sql_sqlite_conn *writer; /* NULL: opened for reading */
    atomic_uint fresh;              /* number of calls of sql_file_forget() */
    atomic_bool scrub; /* erased bytes may be in the WAL: a reader was in the way */
    struct sql_sqlite_conn *idle; /* idle connections of readers */
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

/* sql_sqlite_lock(d, ms, e): Waits up to ms for the writer's connection.  The remaining time becomes SQLite's
 * busy timeout, for locks of other processes.  ST_EDENIED, ST_EBUSY. */
enum status sql_sqlite_lock(struct sql_sqlite *d, long ms, struct errinfo *e);

/* sql_sqlite_unlock(d): Releases the writer's connection. */
void sql_sqlite_unlock(struct sql_sqlite *d);

/* sql_sqlite_truncate(d, ms): Runs a checkpoint, truncates the WAL and flushes both files.  Gives up if readers
 * block it for longer than ms.  The caller holds the writer's connection (sql_sqlite_lock()). */
void sql_sqlite_truncate(struct sql_sqlite *d, int ms);

#endif
