/* sql_read.h -- checked reading of columns: one by one, by a table of fields, or as arrays of rows.  The file
 * may come from anyone: the schema's checks hold only for rows that this program wrote. */
#ifndef DB_SQL_READ_H
#define DB_SQL_READ_H
#include <float.h>
#include "sql.h"

/* sql_read_text(r, col, out, size): Reads a text of at most size - 1 bytes without NUL.  Returns false if the
 * column is something else. */
bool sql_read_text(const struct sql_rows *r, int col, char *out, size_t size);

/* sql_read_bytes(r, col, out, n): Reads a blob of n bytes.  Returns false if the column is something else. */
bool sql_read_bytes(const struct sql_rows *r, int col, void *out, size_t n);

/* sql_read_count(r, col, max, out): Reads a whole number from 0 to max.  Returns false if the column is something
 * else. */
bool sql_read_count(const struct sql_rows *r, int col, int64_t max, uint32_t *out);

/* sql_read_int(r, col, min, out): Reads a whole number, min or more.  Returns false if the column is something
 * else. */
bool sql_read_int(const struct sql_rows *r, int col, int64_t min, int64_t *out);

/* ---- a struct's members as columns */

enum sql_field_kind {
    SQL_FIELD_TEXT,          /* char[], without NUL */
    SQL_FIELD_TEXT_OR_NULL,  /* "" is NULL */
    SQL_FIELD_BYTES,         /* unsigned char[], all of it */
    SQL_FIELD_BYTES_OR_NULL, /* zeros are NULL */
    SQL_FIELD_BYTES_OR_NONE, /* zeros are a blob of no bytes */
    SQL_FIELD_BLOB,          /* struct sql_field_blob, of one byte or more */
    SQL_FIELD_NUMBER,        /* int64_t or uint64_t, from 0 on */
    SQL_FIELD_COUNT,         /* uint32_t */
    SQL_FIELD_BOOL,          /* bool */
    SQL_FIELD_REAL           /* double */
};

struct sql_field {
    enum sql_field_kind kind;
    size_t at, size; /* offset and size of the member */
    double min, max; /* range of a number */
};

#define SQL_FIELD_MAX 1024 /* most bytes of a SQL_FIELD_BLOB */
struct sql_field_blob {
    size_t n;
    unsigned char bytes[SQL_FIELD_MAX];
};

#define SQL_FIELD_IN(kind, type, member, min, max)                                       \
    {                                                                                    \
        SQL_FIELD_##kind, offsetof(type, member), sizeof((type *)NULL)->member, min, max \
    }
#define SQL_FIELD(kind, type, member) SQL_FIELD_IN(kind, type, member, 0, DBL_MAX)

/* sql_field_set(f, v, to): Sets the member at `to` to the value v.  Returns false if the member cannot have it. */
bool sql_field_set(const struct sql_field *f, const struct sql_value *v, void *to);

/* sql_field_value(f, from): Returns the value of the member at `from`, from which it may borrow bytes. */
struct sql_value sql_field_value(const struct sql_field *f, const void *from);

/* sql_read_fields(r, col, field, n, out): Reads n columns, from col on, into the members of *out.  Returns false
 * if a member cannot have its column's value. */
bool sql_read_fields(const struct sql_rows *r, int col, const struct sql_field *field,
                     size_t n, void *out);

/* sql_field_values(field, n, from, v): Sets v[0..n-1] to the values of the members of *from. */
void sql_field_values(const struct sql_field *field, size_t n, const void *from,
                      struct sql_value *v);

/* ---- all rows of a query */

/* Turns the current row into the object at out. */
typedef enum status sql_read_row(void *arg, const struct sql_rows *r, void *out,
                                 struct errinfo *e);

/* sql_read_list(r, st, row, arg, size, out, n, e): Reads all rows of a query that returned st, and calls
 * sql_done().
 *   size  bytes of an object
 *   out   a new array of *n objects, to be released by free(); NULL if *n is 0, and after a failure */
enum status sql_read_list(struct sql_rows *r, enum status st, sql_read_row *row,
                          void *arg, size_t size, void **out, size_t *n,
                          struct errinfo *e);

#endif
