/* attempts.h -- a subject whose verifications fail one after the other has to wait, so that
 * nobody can try faces until one passes.  Counted in the store (store_attempts_get() and
 * so on), so that a restart forgets nothing.  Safe on any thread. */
#ifndef SERVER_ATTEMPTS_H
#define SERVER_ATTEMPTS_H
#include <stdbool.h>
#include <stdint.h>

struct attempts;
struct request;
struct store;

/* attempts_new(s, limit, wait_s): after limit failures in a row a wait of wait_s seconds,
 * 1 <= wait_s <= OPTIONS_WAIT_MAX (options.h), that doubles with each further one up to
 * that.  limit 0: never.
 * s is borrowed.  NULL: out of memory. */
struct attempts *attempts_new(struct store *s, unsigned limit, unsigned wait_s);
void attempts_free(struct attempts *a); /* NULL is allowed */

/* attempts_wait_ms(a, failures, age_ms): how long yet, when so many failed in a row and the
 * last did age_ms ago; 0: not at all. */
int64_t attempts_wait_ms(const struct attempts *a, uint32_t failures, int64_t age_ms);

/* attempts_admit(a, r, subject): true: the subject need not wait.  False: r->response is set,
 * 429 with the time to wait. */
bool attempts_admit(struct attempts *a, struct request *r, const char *subject);

/* attempts_settle(a, r, subject, passed): a verification was decided; count it, before it is
 * told.  False: r->response is set and must not tell: others that were under way have failed
 * meanwhile and the subject has to wait (429, not counted: many at once are no way round the
 * limit), or a failure could not be counted. */
bool attempts_settle(struct attempts *a, struct request *r, const char *subject,
                     bool passed);

#endif
