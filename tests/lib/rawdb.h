/* rawdb.h -- a database as another program sees it that writes to it and keeps to no CHECK and no
 * reference, whichever engine it is of: a file, or a PostgreSQL by its URL. */
#ifndef TESTS_RAWDB_H
#define TESTS_RAWDB_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo;
struct rawdb;

/* rawdb_open(where, out, e): a file is made where it is missing.  Waits for a writer, up to 5 s.
 * rawdb_run(d, sql, e): statements.
 * rawdb_each(d, sql, use, arg, e): the first column of each row that a query gives: a number or text as
 * text, n bytes and a NUL, or a blob.
 * rawdb_close(d): what is not committed is rolled back. */
typedef void rawdb_use(void *arg, const char *data, size_t n);
enum status rawdb_open(const char *where, struct rawdb **out, struct errinfo *e);
enum status rawdb_run(struct rawdb *d, const char *sql, struct errinfo *e);
enum status rawdb_each(struct rawdb *d, const char *sql, rawdb_use *use, void *arg,
                       struct errinfo *e);
void rawdb_close(struct rawdb *d);

#endif
