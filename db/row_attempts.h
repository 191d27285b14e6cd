/* row_attempts.h -- failed verifications of a subject by a token, inside a transaction.
 * Rows are as many as a token can fail for in STORE_ATTEMPTS_DAYS, at most one for each
 * subject; they go with the subject and with the token. */
#ifndef DB_ROW_ATTEMPTS_H
#define DB_ROW_ATTEMPTS_H
#include "store_types.h"

struct store_txn; /* store_txn.h */

/* row_attempts_get(t, subject, token, now, out, future, e): failures, others and tried are 0
 * where there are none, else the ages are set.  *future: a failure lies after now, by which it is
 * read as now.  ST_ENOTFOUND: no such subject.
 * row_attempts_not_after(t, subject, token, now, e): those of the subject or of the token were
 * no later than that. */
enum status row_attempts_get(struct store_txn *t, const char *subject, const char *token,
                             int64_t now, struct store_attempts *out, bool *future,
                             struct errinfo *e);
enum status row_attempts_not_after(struct store_txn *t, const char *subject,
                                   const char *token, int64_t now, struct errinfo *e);

/* row_attempts_fail(t, subject, token, now, e): one more; what the token did before
 * STORE_ATTEMPTS_DAYS goes.  row_attempts_match(t, subject, token, e): none of this token.
 * row_attempts_clear(t, subject, e): none of any.  row_attempts_revoke(t, token, e): none of this
 * token for any subject. */
enum status row_attempts_fail(struct store_txn *t, const char *subject, const char *token,
                              int64_t now, struct errinfo *e);
enum status row_attempts_match(struct store_txn *t, const char *subject,
                               const char *token, struct errinfo *e);
enum status row_attempts_clear(struct store_txn *t, const char *subject,
                               struct errinfo *e);
enum status row_attempts_revoke(struct store_txn *t, const char *token,
                                struct errinfo *e);

/* row_attempts_list(t, now, out, n, e): in the order of the subjects' coming; released by
 * free(). */
enum status row_attempts_list(struct store_txn *t, int64_t now,
                              struct store_attempts **out, size_t *n, struct errinfo *e);

#endif
