/* sql_postgres.h -- the PostgreSQL driver, over libpq in pipeline mode; for the driver's own files.
 *
 * A statement is sent, and not waited for until its rows are needed or the transaction commits.  A
 * transaction has a connection, which is kept for the next one.  The driver must not go through a pooler,
 * where another program's prepared statement could have the name of one of ours.
 *
 * Each statement of a transaction that writes sees the commits before it (READ COMMITTED): rows that must
 * not change meanwhile are read after sql_lock().  A transaction that reads sees one moment (REPEATABLE
 * READ).  Errors have the server's first line, without its detail, which may have values.  A lost
 * connection is ST_EBUSY.
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
#define SQL_POSTGRES_SENT  128 /* most statements without a result yet */
#define SQL_POSTGRES_PROOF 4   /* most values of sql_prove() */

struct sql_postgres_rows {
    struct sql_rows base;
    struct sql_postgres_conn *conn;
    const char *text;
    struct sql_postgres_rows *next; /* next in the list `parked` */
    unsigned char *key;             /* values of a query that was sent ahead [key_len] */
    size_t key_len;
    PGresult *result; /* NULL: not here yet, or an error */
    bool here;        /* the result has come, or no longer can */
    int at;           /* the current row; -1: before the first */
    unsigned cursor;  /* number of the cursor; 0: all rows come at once */
    int batch;        /* number of rows of the last FETCH */
};

enum sql_postgres_kind {
    SQL_POSTGRES_PREPARE,
    SQL_POSTGRES_RUN,
    SQL_POSTGRES_RUN_ONE,
    SQL_POSTGRES_COMMIT,
    SQL_POSTGRES_QUERY,
    SQL_POSTGRES_SYNC
};

struct sql_postgres_sent { /* a statement without a result yet */
    enum sql_postgres_kind kind;
    struct sql_postgres_slot *slot; /* slot of a PREPARE */
    struct sql_postgres_rows *rows; /* rows of a QUERY; NULL: they were released */
};

struct sql_postgres_slot { /* a prepared statement */
    const char *text;
    bool prepared;
};

struct sql_postgres_conn { /* a connection and its transaction */
    struct sql_txn base;
    struct sql_postgres *of;
    PGconn *pg;
    struct sql_postgres_conn *next;                   /* next idle connection */
    struct sql_postgres_sent sent[SQL_POSTGRES_SENT]; /* a ring */
    unsigned first, n; /* first element of the ring, and number of elements */
    bool unsynced;     /* a statement was sent since the last SYNC */
    bool unproved;     /* a RUN_ONE has no result yet */
    bool lost;         /* the connection cannot be used any more */
    bool closing;      /* a rollback does not repair it: closed after the transaction */
    int wait_ms;       /* limit of the wait for each result */
    int64_t until; /* limit of all waits, by sql_postgres_wait_clock(); INT64_MAX: none */
    bool writes, committing, committed;
    bool warned;                      /* the server gave a notice during the commit */
    unsigned cursors;                 /* number of cursors so far */
    uint64_t changed;                 /* number of rows changed by the last RUN */
    struct sql_postgres_rows *parked; /* rows sent ahead and not used yet */
    struct errinfo error; /* first error of the transaction; code ST_OK: none */
    uint32_t lock;        /* key of the last sql_lock() + 1; 0: none */
    const char *proof;    /* arguments of sql_prove(); NULL: none */
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
        *alone;           /* holds the database for this process alone; NULL: shared */
    pthread_mutex_t lock; /* held for idle */
    struct sql_postgres_conn *idle; /* idle connections */
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

/* sql_postgres_conn_say(e, st, what, text): Returns st, and fills *e with what and the first line of text, which
 * is from the server or libpq. */
enum status sql_postgres_conn_say(struct errinfo *e, enum status st, const char *what,
                                  const char *text);

/* sql_postgres_conn_lost(c): Returns true if the connection cannot be used any more. */
bool sql_postgres_conn_lost(const struct sql_postgres_conn *c);

/* sql_postgres_conn_good(c): Returns true if an idle connection can be used, as far as is known without waiting. */
bool sql_postgres_conn_good(struct sql_postgres_conn *c);

/* sql_postgres_conn_error(c, r): Records that the transaction has failed with the error r; NULL: the connection
 * was lost. */
void sql_postgres_conn_error(struct sql_postgres_conn *c, const PGresult *r);

/* sql_postgres_conn_failed(c, e): Returns the first recorded error. */
enum status sql_postgres_conn_failed(const struct sql_postgres_conn *c,
                                     struct errinfo *e);

/* sql_postgres_conn_settle(c, r): Waits until the rows r are here; NULL: all results. */
void sql_postgres_conn_settle(struct sql_postgres_conn *c,
                              const struct sql_postgres_rows *r);

/* sql_postgres_conn_commit(c, e): Waits for the changes that must be of one row, and commits. */
enum status sql_postgres_conn_commit(struct sql_postgres_conn *c, struct errinfo *e);

/* sql_postgres_conn_rollback(c): Sends a rollback, and does not wait for it. */
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
