/* forge.h -- rows as no program writes them, which are authentic all the same: for tests of past
 * times and of settings that cannot be reached otherwise.  It takes the database's key. */
#ifndef TESTS_FORGE_H
#define TESTS_FORGE_H
#include "status.h"

struct errinfo;

struct store_key; /* store_open.h */

/* forge_sql(path, key, sql, e): run statements on a database; then every row that has not its MAC gets
 * it, and a change of kind "forge" has the digest of the rows as they are. */
enum status forge_sql(const char *path, const struct store_key *key, const char *sql,
                      struct errinfo *e);

#endif
