/* attempts.h -- limits for who tries faces until one matches: failed verifications in a row lock
 * a token out of a subject; those of other tokens shut the subject for everybody for
 * ATTEMPTS_OTHERS_S at a time, so that nobody can keep others out by failing; and a token may try
 * only so many subjects in vain in an hour.  The counts are in the store (store_admit(),
 * store_settle()), so that they survive a restart and are those of all processes.  Safe on any
 * thread. */
#ifndef SERVER_ATTEMPTS_H
#define SERVER_ATTEMPTS_H
#include <stdbool.h>
#include <stdint.h>

#define ATTEMPTS_OTHERS_S 60

struct attempts;
struct request;
struct store_attempts; /* store.h */
struct store_settle;   /* store.h */
struct store_settled;  /* store.h */

enum attempts_reason { /* the order of enum metrics_failed */
                       ATTEMPTS_MAY,
                       ATTEMPTS_OWN,
                       ATTEMPTS_OTHERS,
                       ATTEMPTS_SUBJECTS
};

/* attempts_new(limit, wait_s, subjects): after limit failures in a row the lock-out lasts
 * wait_s s, 1 <= wait_s <= OPTIONS_WAIT_MAX (options.h), that doubles with each further one up
 * to that.  subjects: those that a token may try without a match in STORE_TRIED_MS, 0: any
 * number; without a token this is not limited.  limit 0: no limit at all.  NULL: out of memory. */
struct attempts *attempts_new(unsigned limit, unsigned wait_s, unsigned subjects);
void attempts_free(struct attempts *a); /* NULL is allowed */

bool attempts_limited(const struct attempts *a); /* are there limits? */

/* attempts_wait_ms(a, now, why): what is left of the longest wait, and what it is for; 0: may
 * be verified. */
int64_t attempts_wait_ms(const struct attempts *a, const struct store_attempts *now,
                         enum attempts_reason *why);

/* attempts_admit(a, r, now): true: r may go on.  False: r->response is set: 429 with
 * Retry-After; and counted in the metrics. */
bool attempts_admit(const struct attempts *a, struct request *r,
                    const struct store_attempts *now);

/* attempts_watch(a, what): by which counts the store is to write an event: at each lock-out,
 * and at a third of the subjects that a token may try.
 * attempts_warn(r, out): what was such an event goes to the log and the metrics too. */
void attempts_watch(const struct attempts *a, struct store_settle *what);
void attempts_warn(const struct request *r, const struct store_settled *out);

#endif
