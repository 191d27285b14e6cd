/* sql.h -- a narrow layer over SQL: connections, transactions, statements, rows.  What the
 * statements say is the caller's, in the subset that SQLite 3.40 and PostgreSQL 15 both know
 * (scripts/check_statements.sh has both prepare every one); how they get there is a driver's
 * (sql_open.h opens one): sql_sqlite.c of a file, sql_postgres.c of a URL.  What only a database in a
 * file can do is in sql_file.h.
 *
 * Calls return ST_OK or fill *e (may be NULL), an error of a change perhaps at a later call or at the
 * commit, after which only sql_end() is possible: ST_ECORRUPT (damaged, or no database),
 * ST_EBUSY (locked for longer than 5 s, the server cannot be reached, or was lost), ST_EIO (disk
 * full, not writable), ST_ELIMIT, ST_ENOMEM, ST_EDB. */
#ifndef DB_SQL_H
#define DB_SQL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include "status.h"

struct errinfo;
struct sql;      /* a database: one writing connection, and one a reader.  Any thread */
struct sql_txn;  /* a transaction.  One thread at a time */
struct sql_rows; /* what a query gives */
struct sql_value;

/* How sql_open.h opens one. */
enum sql_open {
    SQL_OPEN_READ,   /* nothing can be changed, nor does it have to be writable */
    SQL_OPEN_WRITE,  /* it must be there */
    SQL_OPEN_CREATE, /* made if it is missing, readable by its owner alone */
    SQL_OPEN_LOOK,   /* one connection, for a look at any version; not to be written to */
    SQL_OPEN_ALONE /* one connection, while no other process has it open or can open it */
};

/* sql_close(d): NULL is allowed; no transaction is open.  A file that sql_open() made is
 * removed unless a SQL_SCHEMA transaction was committed.
 * sql_version(d): of its schema when it was opened, or since sql_create(); 0: it holds
 * nothing. */
void sql_close(struct sql *d);
int sql_version(const struct sql *d);

enum sql_begin {
    SQL_READ,   /* all that is read is of one moment */
    SQL_WRITE,  /* durable when it is committed */
    SQL_LAZY,   /* the same, but a power failure may take it back; a crash does not */
    SQL_TRY,    /* lazy, and ST_EBUSY at once where it would have to wait */
    SQL_SCHEMA, /* a SQL_WRITE that may make tables */
    SQL_COPY /* the same, in a file that counts when it gets its name: nothing is on the disk
                   yet, and no other file is beside it */
};

/* sql_begin(d, how, t, e): ST_EDENIED: opened for reading.  After ST_OK sql_end() follows.
 * sql_end(t, st, e): commits where st is ST_OK, else rolls back; returns st, or why the
 * commit failed.  No rows are open. */
enum status sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                      struct errinfo *e);
enum status sql_end(struct sql_txn *t, enum status st, struct errinfo *e);

/* sql_lock(t, key, e): no other transaction has this lock until t ends.  Where several processes write
 * to one database, to be called before what must not change meanwhile is read; one that reads after
 * it sees what the one before has committed.  ST_EBUSY: not within 5 s, perhaps at a later call.
 * Advisory locks of PostgreSQL are numbers, which other programs may use too: ours begin with "SRFD",
 * and the last of them is held, shared, by each connection to a database.
 * sql_prove(t, text, value, n): a query of at most 4 values that gives a row where t was committed and
 * none where it was not: where the connection is lost amid the commit, sql_end() finds out by it.
 * sql_settle(t, e): of a SQL_WRITE that changes nothing: its commit waits until all that it has seen is
 * as durable as what it had changed would be. */
#define SQL_LOCKS  (INT64_C(0x53524644) << 32)
#define SQL_IN_USE "6003938515404980223" /* SQL_LOCKS + 0xffffffff */
enum status sql_lock(struct sql_txn *t, uint32_t key, struct errinfo *e);
void sql_prove(struct sql_txn *t, const char *text, const struct sql_value *value,
               size_t n);
enum status sql_settle(struct sql_txn *t, struct errinfo *e);

/* sql_ahead(t, on): from here to sql_ahead(t, false) a query is only sent, and gives no rows; the same
 * query with the same values later in t has them.  So several cost one round trip to a server.  Not
 * with changes (ST_EINTERNAL); after the first, queries are sent again.  false: there is
 * nothing to gain, and all is as ever. */
bool sql_ahead(struct sql_txn *t, bool on);

/* sql_bytes(t, bytes, e): the size of the database, of a file without its WAL.
 * sql_version_now(t, version, e): as t sees it.
 * sql_create(t, e): the tables, in a SQL_SCHEMA transaction on a database that holds nothing. */
enum status sql_bytes(struct sql_txn *t, uint64_t *bytes, struct errinfo *e);
enum status sql_version_now(struct sql_txn *t, int *version, struct errinfo *e);
enum status sql_create(struct sql_txn *t, struct errinfo *e);

enum sql_type { SQL_NULL, SQL_INT, SQL_REAL, SQL_TEXT, SQL_BLOB };

struct sql_value {
    enum sql_type type;
    int64_t i;
    double r;
    const void *data; /* of a text or a blob, n bytes; not NULL for a blob of none */
    size_t n;
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

static inline struct sql_value sql_text_or_null(const char *text) /* "" is NULL */
{
    return text[0] != '\0' ? sql_text(text) : sql_null();
}

/* sql_run(t, text, value, n, e): a statement that gives no rows.  Its text is a literal: it is
 * prepared once a connection and known by its text.  $1 is value[0], and so on, n of them.
 * sql_run_one(t, text, value, n, e): one that changes exactly one row.  ST_ECORRUPT: it was another
 * number.
 * sql_changed(t, n, e): rows that the last sql_run() inserted, changed or deleted. */
enum status sql_run(struct sql_txn *t, const char *text, const struct sql_value *value,
                    size_t n, struct errinfo *e);
enum status sql_run_one(struct sql_txn *t, const char *text,
                        const struct sql_value *value, size_t n, struct errinfo *e);
enum status sql_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e);

/* sql_query(t, text, value, n, out, e): a statement that gives rows; the values are copied.
 *   st = sql_query(t, ..., &r, e);
 *   while (st == ST_OK && sql_next(r))
 *       st = use(r, ...);
 *   return sql_done(r, st, e);
 * sql_next(r): is there another row?  false too where reading fails or r is NULL.
 * sql_column(r, i): of the current row, from 0 on; its bytes are good until the next call for
 * that row's rows.
 * sql_done(r, st, e): returns st where that is not ST_OK, else why there was no further row.
 * While rows are open other statements may run in the same transaction, but not this one
 * again.  A row that they change or delete is given once, as it was or as it is, or not any
 * more.
 * sql_stream(t, ...): the same of rows that may be more than fit into memory. */
enum status sql_query(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n, struct sql_rows **out, struct errinfo *e);
enum status sql_stream(struct sql_txn *t, const char *text, const struct sql_value *value,
                       size_t n, struct sql_rows **out, struct errinfo *e);
bool sql_next(struct sql_rows *r);
struct sql_value sql_column(const struct sql_rows *r, int i);
enum status sql_done(struct sql_rows *r, enum status st, struct errinfo *e);

/* sql_first(t, text, value, n, out, e): sql_query() and sql_next(), for one row; sql_done() follows in
 * any case.  ST_ENOTFOUND, without a text: there is none. */
enum status sql_first(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n, struct sql_rows **out, struct errinfo *e);

/* SQL_RUN(t, e, text, value...), SQL_QUERY(t, out, e, text, value...), SQL_FIRST(): with one value
 * or more. */
#define SQL_VALUES(...) ((const struct sql_value[]){__VA_ARGS__})
#define SQL_COUNT(...)  (sizeof SQL_VALUES(__VA_ARGS__) / sizeof(struct sql_value))
#define SQL_RUN(t, e, text, ...)                                                         \
    sql_run(t, text, SQL_VALUES(__VA_ARGS__), SQL_COUNT(__VA_ARGS__), e)
#define SQL_QUERY(t, out, e, text, ...)                                                  \
    sql_query(t, text, SQL_VALUES(__VA_ARGS__), SQL_COUNT(__VA_ARGS__), out, e)
#define SQL_FIRST(t, out, e, text, ...)                                                  \
    sql_first(t, text, SQL_VALUES(__VA_ARGS__), SQL_COUNT(__VA_ARGS__), out, e)

/* ---- a driver: a table of functions, as said above of each, and what its objects begin with */

struct sql_driver {
    bool file; /* what sql_file.h does is possible */
    void (*close)(struct sql *d);
    enum status (*begin)(struct sql *d, enum sql_begin how, struct sql_txn **t,
                         struct errinfo *e);
    enum status (*end)(struct sql_txn *t, enum status st, struct errinfo *e);
    enum status (*version)(struct sql_txn *t, int *version, struct errinfo *e);
    enum status (*create)(struct sql_txn *t, struct errinfo *e);
    enum status (*bytes)(struct sql_txn *t, uint64_t *bytes, struct errinfo *e);
    /* NULL where one process writes at a time, or where a statement costs no round trip. */
    enum status (*lock)(struct sql_txn *t, uint32_t key, struct errinfo *e);
    void (*ahead)(struct sql_txn *t, bool on);
    void (*prove)(struct sql_txn *t, const char *text, const struct sql_value *value,
                  size_t n);
    enum status (*settle)(struct sql_txn *t, struct errinfo *e);
    /* one: of exactly one row. */
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
};

struct sql_rows {
    const struct sql_driver *driver;
};

/* sql_one_row(n, e): a change that has to be of one row was of n. */
enum status sql_one_row(uint64_t n, struct errinfo *e);

#endif
