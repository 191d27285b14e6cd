/* rawdb.h -- the connection of another program, which writes without CHECK and foreign keys, to
 * either engine: a file, or a PostgreSQL by its URL. */
#ifndef TESTS_RAWDB_H
#define TESTS_RAWDB_H
#include <stddef.h>
#include "status.h"

struct errinfo;
struct rawdb;

/* rawdb_open(where, out, e): Connects; creates a file that is missing.  A statement waits for a writer
 * for up to 5 s. */
enum status rawdb_open(const char *where, struct rawdb **out, struct errinfo *e);

/* rawdb_run(d, sql, e): Runs statements. */
enum status rawdb_run(struct rawdb *d, const char *sql, struct errinfo *e);

/* rawdb_each(d, sql, use, arg, e): Calls use() with the first column of each row of a query: a number
 * or text as text, n bytes and a NUL, or a blob. */
typedef void rawdb_use(void *arg, const char *data, size_t n);
enum status rawdb_each(struct rawdb *d, const char *sql, rawdb_use *use, void *arg,
                       struct errinfo *e);

/* rawdb_close(d): Disconnects; an open transaction is rolled back. */
void rawdb_close(struct rawdb *d);

#endif
