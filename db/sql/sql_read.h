/* sql_read.h -- columns as they should be, or false, singly, by a table of fields, or as arrays of
 * rows.  The file may have been written by anyone: the schema's checks hold for what this program
 * wrote. */
#ifndef DB_SQL_READ_H
#define DB_SQL_READ_H
#include <float.h>
#include "sql.h"

/* A text of 0..size-1 bytes without NUL; exactly n bytes; a whole number from 0 to max, or
 * from min on. */
bool sql_read_text(const struct sql_rows *r, int col, char *out, size_t size);
bool sql_read_bytes(const struct sql_rows *r, int col, void *out, size_t n);
bool sql_read_count(const struct sql_rows *r, int col, int64_t max, uint32_t *out);
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
    size_t at, size;
    double min, max; /* of numbers */
};

#define SQL_FIELD_MAX 1024 /* bytes of a SQL_FIELD_BLOB */
struct sql_field_blob {
    size_t n;
    unsigned char bytes[SQL_FIELD_MAX];
};

#define SQL_FIELD_IN(kind, type, member, min, max)                                       \
    {                                                                                    \
        SQL_FIELD_##kind, offsetof(type, member), sizeof((type *)NULL)->member, min, max \
    }
#define SQL_FIELD(kind, type, member) SQL_FIELD_IN(kind, type, member, 0, DBL_MAX)

/* sql_field_set(f, v, to): the member at `to`; false: it cannot have this value.
 * sql_field_value(f, from): the value of the member at `from`, which it may point to.
 * sql_read_fields(r, col, field, n, out): n columns from col on, in their order, until one is not as
 * its field says (false).
 * sql_field_values(field, n, from, v): the same members as values. */
bool sql_field_set(const struct sql_field *f, const struct sql_value *v, void *to);
struct sql_value sql_field_value(const struct sql_field *f, const void *from);
bool sql_read_fields(const struct sql_rows *r, int col, const struct sql_field *field,
                     size_t n, void *out);
void sql_field_values(const struct sql_field *field, size_t n, const void *from,
                      struct sql_value *v);

/* ---- all rows of a query */

/* Turn the current row into the object at out. */
typedef enum status sql_read_row(void *arg, const struct sql_rows *r, void *out,
                                 struct errinfo *e);

/* sql_read_list(r, st, row, arg, size, out, n, e): the rows of a query that returned st,
 * to their end; *n objects of size bytes as a new array, released by free(), NULL where there
 * are none or on failure. */
enum status sql_read_list(struct sql_rows *r, enum status st, sql_read_row *row,
                          void *arg, size_t size, void **out, size_t *n,
                          struct errinfo *e);

#endif
