/* store_column.h -- columns as they should be, or false, and rows as arrays.  The file may have
 * been written by anyone: the schema's checks hold for what this program wrote. */
#ifndef DB_STORE_COLUMN_H
#define DB_STORE_COLUMN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct sql_rows; /* sql.h */

/* A text of 0..size-1 bytes without NUL (*_or: NULL reads as ""); exactly n bytes, or min to
 * max of them; a whole number from 0 to max, or from min on; a real one from min to max. */
bool store_column_text(const struct sql_rows *r, int col, char *out, size_t size);
bool store_column_text_or(const struct sql_rows *r, int col, char *out, size_t size);
bool store_column_bytes(const struct sql_rows *r, int col, void *out, size_t n);
const void *store_column_blob(const struct sql_rows *r, int col, size_t min, size_t max,
                              size_t *n);
bool store_column_count(const struct sql_rows *r, int col, int64_t max, uint32_t *out);
bool store_column_int(const struct sql_rows *r, int col, int64_t min, int64_t *out);
bool store_column_real(const struct sql_rows *r, int col, double min, double max,
                       double *out);

/* Turn the current row into the object at out. */
typedef enum status store_column_row(void *arg, const struct sql_rows *r, void *out,
                                     struct errinfo *e);

/* store_column_list(r, st, row, arg, size, out, n, e): the rows of a query that returned st,
 * to their end; *n objects of size bytes as a new array, released by free(), NULL where there
 * are none or on failure. */
enum status store_column_list(struct sql_rows *r, enum status st, store_column_row *row,
                              void *arg, size_t size, void **out, size_t *n,
                              struct errinfo *e);

#endif
