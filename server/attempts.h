/* attempts.h -- locks a subject out for a while after failed verifications in a row, so that
 * nobody can try faces until one matches.  The count is in the store (store_attempts_get()
 * and so on), so that it survives a restart.  Safe on any thread. */
#ifndef SERVER_ATTEMPTS_H
#define SERVER_ATTEMPTS_H
#include <stdbool.h>
#include <stdint.h>

struct attempts;
struct request;
struct store;

/* attempts_new(s, limit, wait_s): after limit failures in a row the lock-out lasts wait_s s,
 * 1 <= wait_s <= OPTIONS_WAIT_MAX (options.h), that doubles with each further one up to
 * that.  limit 0: no lock-out.
 * s is borrowed.  NULL: out of memory. */
struct attempts *attempts_new(struct store *s, unsigned limit, unsigned wait_s);
void attempts_free(struct attempts *a); /* NULL is allowed */

/* attempts_wait_ms(a, failures, age_ms): what is left of the lock-out when so many failed in a
 * row, the last of them age_ms ago; 0: none. */
int64_t attempts_wait_ms(const struct attempts *a, uint32_t failures, int64_t age_ms);

/* attempts_admit(a, r, subject): true: the subject is not locked out.  False: r->response is
 * set: 429 with Retry-After. */
bool attempts_admit(struct attempts *a, struct request *r, const char *subject);

/* attempts_settle(a, r, subject, passed): counts the outcome of a verification, before the
 * response tells it.  False: r->response is set and does not tell it: the failure could not be
 * counted, or verifications that ran at the same time have locked the subject out (429, not
 * counted: running many at once must not be a way round the limit). */
bool attempts_settle(struct attempts *a, struct request *r, const char *subject,
                     bool passed);

#endif
