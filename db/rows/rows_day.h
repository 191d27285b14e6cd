/* rows_day.h -- the scores of each day's verifications, inside a transaction. */
#ifndef DB_ROWS_DAY_H
#define DB_ROWS_DAY_H
#include "log_txn.h"
#include "rows_types.h"

/* rows_day_count(t, day, decision, score, e): one more.  day: as a time begins; decision: a word.
 * rows_day_ahead(t, day, decision): while sql_ahead() is on: what that reads.
 * rows_day_list(t, since, out, n, e): of that day and later, in their order; released by free().
 * Not authenticated: what is no row of this program's counts as none. */
enum status rows_day_count(struct log_txn *t, const char *day, const char *decision,
                           double score, struct errinfo *e);
void rows_day_ahead(struct log_txn *t, const char *day, const char *decision);
enum status rows_day_list(struct log_txn *t, const char *since, struct store_day **out,
                          size_t *n, struct errinfo *e);

#endif
