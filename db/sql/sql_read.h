/* sql_read.h -- columns as they should be, or false, and rows as arrays.  The file may have
 * been written by anyone: the schema's checks hold for what this program wrote. */
#ifndef DB_SQL_READ_H
#define DB_SQL_READ_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct sql_rows; /* sql.h */

/* A text of 0..size-1 bytes without NUL (*_or: NULL reads as ""); exactly n bytes, or min to
 * max of them; a whole number from 0 to max, or from min on; a real one from min to max. */
bool sql_read_text(const struct sql_rows *r, int col, char *out, size_t size);
bool sql_read_text_or(const struct sql_rows *r, int col, char *out, size_t size);
bool sql_read_bytes(const struct sql_rows *r, int col, void *out, size_t n);
const void *sql_read_blob(const struct sql_rows *r, int col, size_t min, size_t max,
                          size_t *n);
bool sql_read_count(const struct sql_rows *r, int col, int64_t max, uint32_t *out);
bool sql_read_int(const struct sql_rows *r, int col, int64_t min, int64_t *out);
bool sql_read_real(const struct sql_rows *r, int col, double min, double max,
                   double *out);

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
