/* row_attempts.h -- failed verifications of a subject, inside a transaction. */
#ifndef DB_ROW_ATTEMPTS_H
#define DB_ROW_ATTEMPTS_H
#include "store_types.h"

struct store_txn; /* store_txn.h */

/* row_attempts_get(t, subject, now, out, future, e): failures is 0 where there are none, else
 * at and age_ms are set.  *future: the last failure lies after now, by which it is read as now.
 * ST_ENOTFOUND: no such subject.
 * row_attempts_fail(t, subject, now, e): one more.  row_attempts_clear(t, subject, e): none.
 * row_attempts_not_after(t, subject, now, e): the last one was no later than that. */
enum status row_attempts_get(struct store_txn *t, const char *subject, int64_t now,
                             struct store_attempts *out, bool *future, struct errinfo *e);
enum status row_attempts_fail(struct store_txn *t, const char *subject, int64_t now,
                              struct errinfo *e);
enum status row_attempts_clear(struct store_txn *t, const char *subject,
                               struct errinfo *e);
enum status row_attempts_not_after(struct store_txn *t, const char *subject, int64_t now,
                                   struct errinfo *e);

/* row_attempts_list(t, out, n, e): in the order of the subjects' coming; released by free(). */
enum status row_attempts_list(struct store_txn *t, struct store_attempts **out, size_t *n,
                              struct errinfo *e);

#endif
