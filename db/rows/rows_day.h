/* rows_day.h -- the scores of each day's verifications, inside a transaction.  These rows are not
 * authenticated: a malformed one counts as empty. */
#ifndef DB_ROWS_DAY_H
#define DB_ROWS_DAY_H
#include "log_txn.h"
#include "rows_types.h"

/* rows_day_get(t, at, decision, out, e): Reads this daemon's row for the day of the time `at`.  All bins
 * are 0 if there is none. */
enum status rows_day_get(struct log_txn *t, const char *at, const char *decision,
                         struct store_day *out, struct errinfo *e);

/* rows_day_count(t, day, score, e): Adds a verification with this score to *day, and writes the row. */
enum status rows_day_count(struct log_txn *t, struct store_day *day, double score,
                           struct errinfo *e);

/* rows_day_list(t, since, out, n, e): Lists the days from since on, in their order, with the sums of all
 * daemons.
 *   out  a new array of *n elements, to be released by free() */
enum status rows_day_list(struct log_txn *t, const char *since, struct store_day **out,
                          size_t *n, struct errinfo *e);

#endif
