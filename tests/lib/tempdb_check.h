/* tempdb_check.h -- admin_check() of the database of tempdb.h, for the tests that are linked with
 * db/admin. */
#ifndef TESTS_TEMPDB_CHECK_H
#define TESTS_TEMPDB_CHECK_H
#include "admin_check.h"

/* tempdb_check(s): Runs admin_check() and prints its report. */
struct admin_check tempdb_check(struct store *s);

#endif
