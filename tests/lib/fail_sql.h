/* fail_sql.h -- a database that fails at one call, in tests that are linked with -Wl,--wrap=F for each
 * F of sql_begin, sql_run, sql_run_one, sql_query, sql_first, sql_next, sql_done and sql_end that may
 * fail.  The driver's own "ROLLBACK" never does. */
#ifndef TESTS_FAIL_SQL_H
#define TESTS_FAIL_SQL_H
#include "status.h"

/* fail_sql_at(n, st): Lets the n-th of these calls from now on fail with st; n = 0: none fails.  A
 * failing sql_next() finds no row, and its sql_done() says why.  The count starts again. */
void fail_sql_at(unsigned long n, enum status st);

/* fail_sql_count(): Returns the number of these calls since fail_sql_at(). */
unsigned long fail_sql_count(void);

#endif
