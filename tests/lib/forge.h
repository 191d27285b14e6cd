/* forge.h -- authentic rows that no program writes, for tests of past times and of settings that
 * cannot be reached otherwise.  Needs the key of the database. */
#ifndef TESTS_FORGE_H
#define TESTS_FORGE_H
#include "status.h"

struct errinfo;

struct store_key; /* store_open.h */

/* forge_sql(path, key, sql, e): Runs statements on a database, then writes the MACs of all rows and a
 * change of kind "forge" with their digest. */
enum status forge_sql(const char *path, const struct store_key *key, const char *sql,
                      struct errinfo *e);

#endif
