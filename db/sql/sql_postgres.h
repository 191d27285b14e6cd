/* sql_postgres.h -- the PostgreSQL driver, over libpq in pipeline mode, for its own files: a statement
 * is sent and not waited for until its rows are asked for, or the transaction commits.  A connection a
 * transaction, kept for the next one; never through a pooler, where another program's statement could
 * have the name of one of ours.
 *
 * Each statement of a transaction that writes sees what is committed by then (READ COMMITTED): what
 * must not change meanwhile is read after sql_lock().  A transaction that reads sees one moment
 * (REPEATABLE READ).  Of an error there is the first line that the server gave, without its detail,
 * which may have values; a connection that is lost is ST_EBUSY.
 *
 * Connections are nonblocking, and each wait for the server has a limit.  A server that does not answer
 * in time counts as lost.  libpq waits by itself only to connect: up to connect_timeout for each address
 * of a host, and for the resolver. */
#ifndef DB_SQL_POSTGRES_H
#define DB_SQL_POSTGRES_H
#include <libpq-fe.h>
#include <pthread.h>
#include "errinfo.h"
#include "sql.h"

#define SQL_POSTGRES_SLOTS 256 /* more than there are statements; a power of 2 */
#define SQL_POSTGRES_SENT  128 /* on their way at a time */
#define SQL_POSTGRES_PROOF 4   /* values of a sql_prove() */

struct sql_postgres_rows {
    struct sql_rows base;
    struct sql_postgres_conn *conn;
    const char *text;
    struct sql_postgres_rows *next; /* of those sent ahead */
    size_t key_len;                 /* of the values of those */
    unsigned char *key;
    PGresult *result; /* NULL: not here yet, or none came */
    bool here;
    int at;          /* the current row, -1 before the first */
    unsigned cursor; /* its number; 0: all rows come at once */
    int batch;       /* rows that were asked for of it */
};

enum sql_postgres_kind {
    SQL_POSTGRES_PREPARE,
    SQL_POSTGRES_RUN,
    SQL_POSTGRES_RUN_ONE,
    SQL_POSTGRES_COMMIT,
    SQL_POSTGRES_QUERY,
    SQL_POSTGRES_SYNC
};

struct sql_postgres_sent {
    enum sql_postgres_kind kind;
    struct sql_postgres_slot *slot; /* of PREPARE */
    struct sql_postgres_rows *rows; /* of QUERY; NULL: nobody waits for them any more */
};

struct sql_postgres_slot { /* a statement by its text */
    const char *text;
    bool prepared;
};

struct sql_postgres_conn { /* a connection, and its transaction */
    struct sql_txn base;
    struct sql_postgres *of;
    PGconn *pg;
    struct sql_postgres_conn *next; /* of those at rest */
    struct sql_postgres_sent sent[SQL_POSTGRES_SENT];
    unsigned first, n; /* a ring */
    bool unsynced;     /* something was sent since the last SYNC */
    bool unproved;     /* a RUN_ONE is on its way */
    bool lost;
    bool closing;  /* an error was one that a rollback does not repair: closed after it */
    int wait_ms;   /* limit of the wait for each result */
    int64_t until; /* limit of all waits, by sql_postgres_wait_clock(); INT64_MAX: none */
    bool writes, committing, committed;
    bool warned; /* while committing */
    unsigned cursors;
    uint64_t changed;                 /* by the last RUN */
    struct sql_postgres_rows *parked; /* sent ahead, and not asked for yet */
    struct errinfo error;             /* the first of the transaction; code ST_OK: none */
    uint32_t lock;                    /* key + 1; 0: none */
    const char *proof;
    struct sql_value proof_value[SQL_POSTGRES_PROOF];
    size_t proof_n;
    unsigned char proof_bytes[64];
    struct sql_postgres_slot slot[SQL_POSTGRES_SLOTS];
};

struct sql_postgres {
    struct sql base;
    char *url;
    bool read_only;
    struct sql_postgres_conn
        *alone;           /* has the database for this process; NULL: others may use it */
    pthread_mutex_t lock; /* of idle */
    struct sql_postgres_conn *idle;
};

extern const struct sql_driver sql_postgres_driver;
enum status sql_postgres_open(const char *url, enum sql_open how, struct sql **out,
                              struct errinfo *e);

/* sql_postgres_wait_clock(): Returns the monotonic clock, in ms. */
int64_t sql_postgres_wait_clock(void);

/* sql_postgres_wait(pg, until): Sends what libpq has not sent yet, and waits until PQgetResult(pg)
 * returns without waiting.
 *   pg      nonblocking (PQsetnonblocking())
 *   until   latest end of the wait, by sql_postgres_wait_clock(), at most INT_MAX ms from now
 * Returns false if the server did not answer until then, or if the connection is lost. */
bool sql_postgres_wait(PGconn *pg, int64_t until);

/* sql_postgres_wait_sent(pg, until): Waits until libpq has sent everything.  Arguments and result are
 * those of sql_postgres_wait(). */
bool sql_postgres_wait_sent(PGconn *pg, int64_t until);

/* sql_postgres_conn_say(e, st, what, text): st, and what the server or libpq says of it.
 * sql_postgres_conn_lost(c): is the connection of no use any more?
 * sql_postgres_conn_good(c): is one at rest still good, as far as is known without waiting?
 * sql_postgres_conn_error(c, r): the transaction has failed, as r says, or (NULL) the connection.
 * sql_postgres_conn_failed(c, e): it has, for the first of these. */
enum status sql_postgres_conn_say(struct errinfo *e, enum status st, const char *what,
                                  const char *text);
bool sql_postgres_conn_lost(const struct sql_postgres_conn *c);
bool sql_postgres_conn_good(struct sql_postgres_conn *c);
void sql_postgres_conn_error(struct sql_postgres_conn *c, const PGresult *r);
enum status sql_postgres_conn_failed(const struct sql_postgres_conn *c,
                                     struct errinfo *e);

/* sql_postgres_conn_settle(c, r): wait until these rows are here, or (NULL) everything.
 * sql_postgres_conn_commit(c, e): wait for all before, where that may still fail, and commit.
 * sql_postgres_conn_rollback(c): sent, and not waited for. */
void sql_postgres_conn_settle(struct sql_postgres_conn *c,
                              const struct sql_postgres_rows *r);
enum status sql_postgres_conn_commit(struct sql_postgres_conn *c, struct errinfo *e);
void sql_postgres_conn_rollback(struct sql_postgres_conn *c);

/* sql_postgres_conn_exec(c, text): Runs statements without parameters, outside pipeline mode, within
 * c->wait_ms in all.  c->error is their first error.
 * Returns the last result, for PQclear(); NULL if there is none. */
PGresult *sql_postgres_conn_exec(struct sql_postgres_conn *c, const char *text);

/* The functions of the driver's table for statements and rows. */
enum status sql_postgres_conn_run(struct sql_txn *t, const char *text,
                                  const struct sql_value *value, size_t n, bool one,
                                  struct errinfo *e);
enum status sql_postgres_conn_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e);
enum status sql_postgres_conn_query(struct sql_txn *t, const char *text,
                                    const struct sql_value *value, size_t n, bool stream,
                                    struct sql_rows **out, struct errinfo *e);
bool sql_postgres_conn_next(struct sql_rows *r);
struct sql_value sql_postgres_conn_column(const struct sql_rows *r, int i);
enum status sql_postgres_conn_done(struct sql_rows *r, enum status st, struct errinfo *e);

#endif
