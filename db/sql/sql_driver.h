/* sql_driver.h -- a driver of sql.h: a table of functions, as sql.h says of each, and what its objects
 * begin with. */
#ifndef DB_SQL_DRIVER_H
#define DB_SQL_DRIVER_H
#include "sql.h"

struct sql_driver {
    bool file; /* what sql_file.h does is possible */
    enum status (*open)(const char *where, enum sql_open how, struct sql **out,
                        struct errinfo *e);
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

/* sql_driver_one_row(n, e): a change that has to be of one row was of n. */
enum status sql_driver_one_row(uint64_t n, struct errinfo *e);

#endif
