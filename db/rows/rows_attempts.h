/* rows_attempts.h -- the table of failed verifications, at most one row for each subject and token.
 * Every call runs inside the caller's transaction t.  The rows of a token cover STORE_ATTEMPTS_DAYS; rows
 * are deleted with their subject and with their token.  A row without failures holds a suspicion.
 * now: ms since 1970, UTC.  Returns of all calls: as sql.h; ST_ECORRUPT: a row is malformed. */
#ifndef DB_ROWS_ATTEMPTS_H
#define DB_ROWS_ATTEMPTS_H
#include "log_txn.h"
#include "rows_subject.h"

/* rows_attempts_get(t, subject, token, now, out, future, e): Reads the attempts on subject and by token.
 *   out     all members are set; a count without failures is 0, and so is its age
 *   future  set to true if a failure lies after now (the clock was set back); its age then counts as 0 */
enum status rows_attempts_get(struct log_txn *t, const struct store_subject *subject,
                              const char *token, int64_t now, struct store_attempts *out,
                              bool *future, struct errinfo *e);

/* rows_attempts_find(t, of, token, now, out, future, e): Like rows_attempts_get(), but reads only of->lookup
 * and of->one.id, which are known before the row of the subject was read. */
enum status rows_attempts_find(struct log_txn *t, const struct rows_subject *of,
                               const char *token, int64_t now, struct store_attempts *out,
                               bool *future, struct errinfo *e);

/* rows_attempts_not_after(t, subject, token, now, e): Sets the time of each failure that lies after now to now,
 * in all rows of subject and all rows of token. */
enum status rows_attempts_not_after(struct log_txn *t,
                                    const struct store_subject *subject,
                                    const char *token, int64_t now, struct errinfo *e);

/* rows_attempts_fail(t, subject, token, now, suspicion, e): Records one more failure of token for subject
 * at time now.
 *   suspicion  new suspicion of the row
 * ST_ENOTFOUND: the subject was erased. */
enum status rows_attempts_fail(struct log_txn *t, const struct store_subject *subject,
                               const char *token, int64_t now, uint32_t suspicion,
                               struct errinfo *e);

/* rows_attempts_expire(t, token, now, e): Deletes the token's rows that are older than STORE_ATTEMPTS_DAYS. */
enum status rows_attempts_expire(struct log_txn *t, const char *token, int64_t now,
                                 struct errinfo *e);

/* rows_attempts_match(t, subject, token, suspicion, e): Deletes the failures of token for subject, after a
 * match.
 *   suspicion  remaining suspicion of the row; 0: the row is deleted */
enum status rows_attempts_match(struct log_txn *t, const struct store_subject *subject,
                                const char *token, uint32_t suspicion, struct errinfo *e);

/* rows_attempts_told(t, subject, e): Sets the suspicion of all tokens for subject to 0. */
enum status rows_attempts_told(struct log_txn *t, const struct store_subject *subject,
                               struct errinfo *e);

/* rows_attempts_clear(t, subject, e): Deletes all rows of the subject. */
enum status rows_attempts_clear(struct log_txn *t, const struct store_subject *subject,
                                struct errinfo *e);

/* rows_attempts_revoke(t, token, e): Deletes all rows of the token. */
enum status rows_attempts_revoke(struct log_txn *t, const char *token, struct errinfo *e);

/* rows_attempts_each(t, subject, visit, arg, e): Calls visit(arg, token, e) for each token that has failed for
 * subject, until a call fails.  Returns the status of the last call.  visit() may call
 * rows_attempts_get(). */
enum status rows_attempts_each(struct log_txn *t, const struct store_subject *subject,
                               enum status (*visit)(void *arg, const char *token,
                                                    struct errinfo *e),
                               void *arg, struct errinfo *e);

/* rows_attempts_list(t, now, out, n, e): Lists the rows with failures in the order of the subjects'
 * creation, then by token.
 *   out  a new array of *n elements, to be released by free(); only subject, token, failures, at and
 *        age_ms are set */
enum status rows_attempts_list(struct log_txn *t, int64_t now,
                               struct store_attempts **out, size_t *n, struct errinfo *e);

#endif
