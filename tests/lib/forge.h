/* forge.h -- rows as no program writes them, which the audit log tells of all the same: for
 * tests of past times and of settings that cannot be reached otherwise.  It takes the
 * database's key. */
#ifndef TESTS_FORGE_H
#define TESTS_FORGE_H
#include "status.h"

struct errinfo;

/* forge_sql(path, sql, e): run statements on a database, and append to the changes what they
 * leave of each row. */
enum status forge_sql(const char *path, const char *sql, struct errinfo *e);

#endif
