/* rows_attempts.h -- failed verifications of a subject by a token, inside a transaction.
 * Rows are as many as a token can fail for in STORE_ATTEMPTS_DAYS, at most one for each
 * subject; they go with the subject and with the token.  A row without failures keeps a suspicion. */
#ifndef DB_ROWS_ATTEMPTS_H
#define DB_ROWS_ATTEMPTS_H
#include "log_txn.h"
#include "rows_types.h"

/* rows_attempts_get(t, subject, token, now, out, future, e), rows_attempts_find(t, id, token, now, out,
 * future, e): of a subject, of the one with this id.  failures, others and tried are 0 where there are
 * none, else the ages are set.  *future: a failure lies after now, by which it is read as now.
 * rows_attempts_not_after(t, subject, token, now, e): those of the subject or of the token were
 * no later than that. */
enum status rows_attempts_get(struct log_txn *t, const struct store_subject *subject,
                              const char *token, int64_t now, struct store_attempts *out,
                              bool *future, struct errinfo *e);
enum status rows_attempts_find(struct log_txn *t, const char *id, const char *token,
                               int64_t now, struct store_attempts *out, bool *future,
                               struct errinfo *e);
enum status rows_attempts_not_after(struct log_txn *t,
                                    const struct store_subject *subject,
                                    const char *token, int64_t now, struct errinfo *e);

/* rows_attempts_fail(t, subject, token, now, suspicion, e): Records one more failure of token for subject
 * at time now, and its suspicion from then on.  Deletes the token's rows that are older than
 * STORE_ATTEMPTS_DAYS.  ST_ENOTFOUND: the subject was erased. */
enum status rows_attempts_fail(struct log_txn *t, const struct store_subject *subject,
                               const char *token, int64_t now, uint32_t suspicion,
                               struct errinfo *e);

/* rows_attempts_match(t, subject, token, suspicion, e): Deletes the failures of token for subject.
 * suspicion is what remains of the token's. */
enum status rows_attempts_match(struct log_txn *t, const struct store_subject *subject,
                                const char *token, uint32_t suspicion, struct errinfo *e);

/* rows_attempts_told(t, subject, e): Sets the suspicion of all tokens for subject to 0. */
enum status rows_attempts_told(struct log_txn *t, const struct store_subject *subject,
                               struct errinfo *e);

/* rows_attempts_clear(t, subject, e): Deletes all rows of the subject.
 * rows_attempts_revoke(t, token, e): Deletes all rows of the token. */
enum status rows_attempts_clear(struct log_txn *t, const struct store_subject *subject,
                                struct errinfo *e);
enum status rows_attempts_revoke(struct log_txn *t, const char *token, struct errinfo *e);

/* rows_attempts_each(t, subject, visit, arg, e): visit() each token that has failed for the subject;
 * it may call rows_attempts_get(). */
enum status rows_attempts_each(struct log_txn *t, const struct store_subject *subject,
                               enum status (*visit)(void *arg, const char *token,
                                                    struct errinfo *e),
                               void *arg, struct errinfo *e);

/* rows_attempts_list(t, now, out, n, e): in the order of the subjects' creation; released by
 * free(). */
enum status rows_attempts_list(struct log_txn *t, int64_t now,
                               struct store_attempts **out, size_t *n, struct errinfo *e);

#endif
