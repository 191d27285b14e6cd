/* attempts.h -- locks a subject out for a while after failed verifications in a row, so that
 * nobody can try faces until one matches.  The count is in the store (store_admit(),
 * store_settle()), so that it survives a restart.  Safe on any thread. */
#ifndef SERVER_ATTEMPTS_H
#define SERVER_ATTEMPTS_H
#include <stdbool.h>
#include <stdint.h>

struct attempts;
struct request;
struct store_attempts; /* store.h */

/* attempts_new(limit, wait_s): after limit failures in a row the lock-out lasts wait_s s,
 * 1 <= wait_s <= OPTIONS_WAIT_MAX (options.h), that doubles with each further one up to
 * that.  limit 0: no lock-out.  NULL: out of memory. */
struct attempts *attempts_new(unsigned limit, unsigned wait_s);
void attempts_free(struct attempts *a); /* NULL is allowed */

bool attempts_limited(const struct attempts *a); /* is there a lock-out? */

/* attempts_wait_ms(a, failures, age_ms): what is left of the lock-out when so many failed in a
 * row, the last of them age_ms ago; 0: none. */
int64_t attempts_wait_ms(const struct attempts *a, uint32_t failures, int64_t age_ms);

/* attempts_admit(a, r, now): true: the subject is not locked out.  False: r->response is set:
 * 429 with Retry-After. */
bool attempts_admit(const struct attempts *a, struct request *r,
                    const struct store_attempts *now);

#endif
