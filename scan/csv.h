/* csv.h -- tables in text files as spreadsheets write them (RFC 4180): a heading, then rows;
 * and lists without a heading.  Fields are separated by commas and may be quoted ("a, b",
 * "say ""yes"""); lines end with LF or CR LF; a byte order mark and empty lines are skipped.
 * Any bytes are safe. */
#ifndef SCAN_CSV_H
#define SCAN_CSV_H
#include <stdbool.h>
#include <stddef.h>
#include "errinfo.h"

#define CSV_MAX_FILE    ((size_t)64 << 20) /* bytes */
#define CSV_MAX_LINE    65536              /* bytes in a row */
#define CSV_MAX_COLUMNS 256

struct csv;

/* csv_open(path, list, out, e): Reads a file, and the heading of a table.
 *   list  a table without a heading.  Its fields are separated by commas or, if its first row has none, by
 *         spaces and tabs; lines that begin with # are skipped
 *   out   a new object, to be released by csv_close(); NULL on failure
 * Messages name the file and the line.
 * Returns ST_OK; ST_ENOTFOUND; ST_EIO; ST_EINVAL: malformed (a NUL byte, an open quotation, text after a
 * closing quotation mark), no heading, a column named twice; ST_ESIZE; ST_ELIMIT; ST_ENOMEM. */
enum status csv_open(const char *path, bool list, struct csv **out, struct errinfo *e);
void csv_close(struct csv *t); /* NULL is allowed */

/* csv_column(t, name): Returns the column of that name, in small or capital letters, or -1. */
int csv_column(const struct csv *t, const char *name);

/* csv_need(t, name, column, e): Finds the column of that name.  Returns ST_OK; ST_EINVAL: there is none. */
enum status csv_need(const struct csv *t, const char *name, int *column,
                     struct errinfo *e);

/* csv_next(t, more, e): Goes to the next row; *more is false after the last.
 * Returns ST_OK; ST_EINVAL: malformed, or not as many fields as the heading has; ST_ELIMIT. */
enum status csv_next(struct csv *t, bool *more, struct errinfo *e);

/* csv_fields(t): Returns the number of fields of the current row. */
int csv_fields(const struct csv *t);

/* csv_line(t): Returns the first line of the current row, from 1. */
unsigned csv_line(const struct csv *t);

/* csv_field(t, column): Returns the field of the current row, without blanks around it; "" if column is -1 or
 * the row has no such field.  Valid until the next csv_next(). */
const char *csv_field(const struct csv *t, int column);

/* csv_bad(t, column, e, what): Returns ST_EINVAL, and fills *e with the file, the line, the column and what. */
enum status csv_bad(const struct csv *t, int column, struct errinfo *e, const char *what);

/* csv_number(t, column, out, e): Reads the field as a number.  Returns ST_OK; ST_EINVAL: it is no finite
 * number. */
enum status csv_number(const struct csv *t, int column, double *out, struct errinfo *e);

#endif
