/* sql_sqlite.h -- the SQLite driver of sql.h, for its own files: one connection writes, under a lock;
 * readers have a connection each while they read, and in WAL mode neither waits for the other. */
#ifndef DB_SQL_SQLITE_H
#define DB_SQL_SQLITE_H
#include <pthread.h>
#include <stdatomic.h>
#include "sql_sqlite_conn.h"

struct sql {
    char *path;
    int flags; /* of the readers' connections */
    int version;
    bool made;   /* the file is new, and nothing is in it */
    bool single; /* the writer's connection is the only one */

    pthread_mutex_t lock;      /* of `writing` and `idle`, held but a moment */
    pthread_cond_t write_free; /* by the monotonic clock */
    bool writing;              /* a thread has the writer's connection */
    struct sql_txn *writer;    /* NULL: opened for reading */
    atomic_bool scrub;    /* erased bytes may be in the WAL: a reader was in the way */
    struct sql_txn *idle; /* readers' connections at rest */
};

/* sql_sqlite_lock(d, ms, e): wait up to ms for the writer's connection, and what is left of
 * that is what SQLite may then wait for other processes.  ST_EDENIED, ST_EBUSY. */
enum status sql_sqlite_lock(struct sql *d, long ms, struct errinfo *e);
void sql_sqlite_unlock(struct sql *d);

/* sql_sqlite_truncate(d, ms): the WAL into the file and empty, on the disk, where no reader is
 * in the way for longer than ms.  The writer's connection is locked. */
void sql_sqlite_truncate(struct sql *d, int ms);

#endif
