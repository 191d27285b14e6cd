/* sql.h -- a narrow layer over SQL: connections, transactions, statements, rows.
 * The callers write the statements, in the subset that SQLite 3.40 and PostgreSQL 15 both know
 * (scripts/check_statements.sh has both prepare every statement).  A driver executes them (sql_open.h
 * opens a database): sql_sqlite.c for a file, sql_postgres.c for a URL.  Functions for databases in files
 * only are in sql_file.h.
 *
 * Each call returns ST_OK, or an error and fills *e (may be NULL).  A driver may report the error of a
 * change only at a later call or at the commit.  After an error the caller may call only sql_end().
 *   ST_ECORRUPT   the file is damaged, or no database
 *   ST_EBUSY      a lock was held for longer than 5 s; or the server cannot be reached, or was lost
 *   ST_EIO        the disk is full or not writable
 *   ST_ELIMIT, ST_ENOMEM, ST_EDB */
#ifndef DB_SQL_H
#define DB_SQL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include "status.h"

struct errinfo;
struct sql; /* a database: one writing connection, and one for each reader.  Any thread */
struct sql_txn;  /* a transaction.  One thread at a time */
struct sql_rows; /* the rows of a query */
struct sql_value;

/* Receives a problem, as a line of text. */
typedef void sql_report(void *arg, const char *line);

/* How sql_open() (sql_open.h) opens a database. */
enum sql_open {
    SQL_OPEN_READ,   /* read only; the database need not be writable */
    SQL_OPEN_WRITE,  /* the database must exist */
    SQL_OPEN_CREATE, /* a missing database is created, readable only by its owner */
    SQL_OPEN_ALONE /* one connection; no other process has the database open or can open it */
};

/* sql_close(d): Closes d; NULL is allowed.  No transaction may be open.  Removes a file that sql_open()
 * has created, unless a SQL_SCHEMA transaction was committed or another process has it open. */
void sql_close(struct sql *d);

/* sql_version(d): Returns the version of the schema when d was opened, or since sql_create(); 0: the
 * database has no tables. */
int sql_version(const struct sql *d);

enum sql_begin {
    SQL_READ,   /* read only; all reads see the database at one moment */
    SQL_WRITE,  /* durable after its commit */
    SQL_LAZY,   /* asynchronous commit: survives a crash; a power failure may lose it */
    SQL_TRY,    /* as SQL_LAZY; ST_EBUSY at once if it would have to wait */
    SQL_SCHEMA, /* as SQL_WRITE; may create tables */
    SQL_COPY /* as SQL_SCHEMA, in a file that is valid only once it is renamed: its commit is
                   not durable, and makes no other file beside it */
};

/* sql_begin(d, how, t, e): Begins a transaction, to be ended by sql_end().  ST_EDENIED: d was opened for
 * reading. */
enum status sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                      struct errinfo *e);

/* sql_end(t, st, e): Ends t: commits it if st is ST_OK, else rolls it back.  No rows may be open.
 * Returns st, or the error of the commit. */
enum status sql_end(struct sql_txn *t, enum status st, struct errinfo *e);

/* PostgreSQL identifies advisory locks by numbers, which other programs may use too: ours begin with
 * "SRFD".  Each connection to a database holds the last of them, shared. */
#define SQL_LOCKS  (INT64_C(0x53524644) << 32)
#define SQL_IN_USE "6003938515404980223" /* SQL_LOCKS + 0xffffffff */

/* sql_lock(t, key, e): Takes a lock, which no other transaction can have until t ends.  If several processes
 * write to one database, call it before reading anything that must not change meanwhile.  Reads after
 * it see the commit of the lock's previous holder.  Does nothing if the database has one writer at a
 * time.  ST_EBUSY: not within 5 s; perhaps reported by a later call. */
enum status sql_lock(struct sql_txn *t, uint32_t key, struct errinfo *e);

/* sql_prove(t, text, value, n): Sets the commit probe of t: a query that gives a row if t was committed, and
 * none if it was not.  If the connection is lost during the commit, sql_end() uses it to find out.
 *   value  [n], copied; n is at most 4 */
void sql_prove(struct sql_txn *t, const char *text, const struct sql_value *value,
               size_t n);

/* sql_settle(t, e): Makes the commit of t, a SQL_WRITE without changes, wait until everything that t has read
 * is as durable as a change of t would be. */
enum status sql_settle(struct sql_txn *t, struct errinfo *e);

/* sql_ahead(t, on): Switches pipelining on or off.  While it is on, a query is only sent and gives no rows;
 * the same query with the same values later in t gives them.  So several queries cost one round trip
 * to a server.  A change meanwhile fails (ST_EINTERNAL).  After the first change queries are sent again.
 * A function that reads is called twice, first while it is on, and asks sql_goes_on() before each query
 * but the first.
 * Returns false if the driver has no round trips to save; queries then work as usual. */
bool sql_ahead(struct sql_txn *t, bool on);

/* sql_bytes(t, bytes, e): Sets *bytes to the size of the database; the WAL of a file is not counted. */
enum status sql_bytes(struct sql_txn *t, uint64_t *bytes, struct errinfo *e);

/* sql_version_now(t, version, e): Sets *version to the version of the schema that t sees. */
enum status sql_version_now(struct sql_txn *t, int *version, struct errinfo *e);

/* sql_create(t, e): Creates the tables.  t is a SQL_SCHEMA transaction on a database without tables. */
enum status sql_create(struct sql_txn *t, struct errinfo *e);

enum sql_type { SQL_NULL, SQL_INT, SQL_REAL, SQL_TEXT, SQL_BLOB };

struct sql_value {
    enum sql_type type;
    int64_t i;
    double r;
    const void *data; /* bytes of a text or blob; not NULL for an empty blob */
    size_t n;         /* number of bytes at data */
};

static inline struct sql_value sql_int(int64_t i)
{
    return (struct sql_value){.type = SQL_INT, .i = i};
}

static inline struct sql_value sql_real(double r)
{
    return (struct sql_value){.type = SQL_REAL, .r = r};
}

static inline struct sql_value sql_text(const char *text)
{
    return (struct sql_value){.type = SQL_TEXT, .data = text, .n = strlen(text)};
}

static inline struct sql_value sql_blob(const void *data, size_t n)
{
    return (struct sql_value){.type = SQL_BLOB, .data = data, .n = n};
}

static inline struct sql_value sql_null(void)
{
    return (struct sql_value){.type = SQL_NULL};
}

/* sql_run(t, text, value, n, e): Runs a statement that gives no rows.
 *   text   a literal; each connection prepares it once and finds it by its text
 *   value  [n], the values of $1 to $n */
enum status sql_run(struct sql_txn *t, const char *text, const struct sql_value *value,
                    size_t n, struct errinfo *e);

/* sql_run_one(t, text, value, n, e): Like sql_run(), for a statement that changes exactly one row.
 * ST_ECORRUPT: it changed another number of rows. */
enum status sql_run_one(struct sql_txn *t, const char *text,
                        const struct sql_value *value, size_t n, struct errinfo *e);

/* sql_changed(t, n, e): Sets *n to the number of rows that the last sql_run() inserted, changed or
 * deleted. */
enum status sql_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e);

/* sql_query(t, text, value, n, out, e): Runs a statement that gives rows.  sql_done() ends it in any case:
 *   st = sql_query(t, ..., &r, e);
 *   while (st == ST_OK && sql_next(r))
 *       st = use(r, ...);
 *   return sql_done(r, st, e);
 * While rows are open other statements may run in t, but not this one again.  If they change or delete
 * a row of the result, the query gives it once, old or new, or no more.
 *   text, value  as in sql_run(); the values are copied
 *   out          the rows, to be released by sql_done(); NULL after a failure */
enum status sql_query(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n, struct sql_rows **out, struct errinfo *e);

/* sql_stream(t, text, value, n, out, e): Like sql_query(), but fetches the rows in batches: for a result
 * that may not fit into memory. */
enum status sql_stream(struct sql_txn *t, const char *text, const struct sql_value *value,
                       size_t n, struct sql_rows **out, struct errinfo *e);

/* sql_next(r): Moves to the next row.  Returns true if there is one; false also if reading fails (then
 * sql_done() returns the error) or r is NULL. */
bool sql_next(struct sql_rows *r);

/* sql_column(r, i): Returns the value of column i, from 0 on, of the current row.  Its bytes are borrowed
 * until the next call on r. */
struct sql_value sql_column(const struct sql_rows *r, int i);

/* sql_done(r, st, e): Releases r.  Returns st if it is not ST_OK, else the result of the last sql_next():
 * ST_OK at the end of the rows, or the error. */
enum status sql_done(struct sql_rows *r, enum status st, struct errinfo *e);

/* sql_first(t, text, value, n, out, e): Runs sql_query() and sql_next(), for one row.  The caller calls
 * sql_done() in any case.  ST_ENOTFOUND, without an error text: there is no row. */
enum status sql_first(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n, struct sql_rows **out, struct errinfo *e);

/* SQL_RUN(t, e, text, value...), SQL_QUERY(t, out, e, text, value...), SQL_FIRST(t, out, e, text,
 * value...): Call the functions with the given values, at least one. */
#define SQL_VALUES(...) ((const struct sql_value[]){__VA_ARGS__})
#define SQL_COUNT(...)  (sizeof SQL_VALUES(__VA_ARGS__) / sizeof(struct sql_value))
#define SQL_RUN(t, e, text, ...)                                                         \
    sql_run(t, text, SQL_VALUES(__VA_ARGS__), SQL_COUNT(__VA_ARGS__), e)
#define SQL_QUERY(t, out, e, text, ...)                                                  \
    sql_query(t, text, SQL_VALUES(__VA_ARGS__), SQL_COUNT(__VA_ARGS__), out, e)
#define SQL_FIRST(t, out, e, text, ...)                                                  \
    sql_first(t, text, SQL_VALUES(__VA_ARGS__), SQL_COUNT(__VA_ARGS__), out, e)

/* ---- a driver: a table of the functions above, and the head of each of its objects */

struct sql_driver {
    bool file;      /* the database is a file: sql_file.h can be used */
    bool pipelines; /* a statement costs a round trip: sql_ahead() saves some */
    void (*close)(struct sql *d);
    enum status (*begin)(struct sql *d, enum sql_begin how, struct sql_txn **t,
                         struct errinfo *e);
    enum status (*end)(struct sql_txn *t, enum status st, struct errinfo *e);
    enum status (*version)(struct sql_txn *t, int *version, struct errinfo *e);
    enum status (*create)(struct sql_txn *t, struct errinfo *e);
    enum status (*bytes)(struct sql_txn *t, uint64_t *bytes, struct errinfo *e);
    /* lock, prove, settle: NULL if one process writes at a time. */
    enum status (*lock)(struct sql_txn *t, uint32_t key, struct errinfo *e);
    void (*prove)(struct sql_txn *t, const char *text, const struct sql_value *value,
                  size_t n);
    enum status (*settle)(struct sql_txn *t, struct errinfo *e);
    /* one: the statement must change exactly one row, as sql_run_one(). */
    enum status (*run)(struct sql_txn *t, const char *text, const struct sql_value *value,
                       size_t n, bool one, struct errinfo *e);
    enum status (*changed)(struct sql_txn *t, uint64_t *n, struct errinfo *e);
    enum status (*query)(struct sql_txn *t, const char *text,
                         const struct sql_value *value, size_t n, bool stream,
                         struct sql_rows **out, struct errinfo *e);
    bool (*next)(struct sql_rows *r);
    struct sql_value (*column)(const struct sql_rows *r, int i);
    enum status (*done)(struct sql_rows *r, enum status st, struct errinfo *e);
};

struct sql {
    const struct sql_driver *driver;
    int version;
};

struct sql_txn {
    const struct sql_driver *driver;
    bool ahead; /* queries are only sent */
};

struct sql_rows {
    const struct sql_driver *driver;
};

/* sql_goes_on(t, st): Returns true if a function that reads makes its next query: st, the status of the
 * query before, is ST_OK, or queries are only sent. */
static inline bool sql_goes_on(const struct sql_txn *t, enum status st)
{
    return st == ST_OK || t->ahead;
}

/* sql_one_row(n, e): Returns ST_ECORRUPT, for a change that must be of one row and was of n rows. */
enum status sql_one_row(uint64_t n, struct errinfo *e);

#endif
