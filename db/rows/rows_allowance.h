/* rows_allowance.h -- what a token may still add within an hour, inside a transaction that has the
 * lock of all changes: so the limit is exact, however many daemons share the database.  What was
 * added comes back evenly, so that there is always room for one more within an hour. */
#ifndef DB_ROWS_ALLOWANCE_H
#define DB_ROWS_ALLOWANCE_H
#include "log_txn.h"
#include "rows_types.h"

/* rows_allowance_get(t, by, a, e): how it stands; the actor is the token.  Nothing is read where a is
 * NULL, or there is no limit.
 * rows_allowance_need(a, e): is there room for one?  ST_EDENIED: a->wait_ms says when.
 * rows_allowance_use(t, by, a, n, e): of what rows_allowance_get() has read, n more are used. */
enum status rows_allowance_get(struct log_txn *t, const struct log_act *by,
                               struct store_allowance *a, struct errinfo *e);
enum status rows_allowance_need(const struct store_allowance *a, struct errinfo *e);
enum status rows_allowance_use(struct log_txn *t, const struct log_act *by,
                               const struct store_allowance *a, size_t n,
                               struct errinfo *e);

#endif
