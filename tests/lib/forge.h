/* forge.h -- rows as no program writes them, with right MACs: for tests of past times and
 * of settings that cannot be reached otherwise.  It takes the database's key. */
#ifndef TESTS_FORGE_H
#define TESTS_FORGE_H
#include "status.h"

struct errinfo;

/* forge_sql(path, sql, e): run statements on a database, in one transaction, and set the
 * MACs of all tokens and calibrations as they are then. */
enum status forge_sql(const char *path, const char *sql, struct errinfo *e);

#endif
