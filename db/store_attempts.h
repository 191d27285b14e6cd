/* store_attempts.h -- verifications of a subject that failed one after the other. */
#ifndef DB_STORE_ATTEMPTS_H
#define DB_STORE_ATTEMPTS_H
#include "store_types.h"

/* store_attempts_get(s, subject, out, e): failures is 0 where there are none.  A last
 * failure that lies in the future (the clock was set back) is moved to now for good, so
 * that a wait that begins with it ends.  ST_ENOTFOUND: no such subject. */
enum status store_attempts_get(struct store *s, const char *subject,
                               struct store_attempts *out, struct errinfo *e);

/* store_attempts_fail(s, subject, e): one more, now.  store_attempts_clear(s, subject, e):
 * no more.  For speed neither waits for the disk, as store_event().
 * store_attempts_reset(s, actor, subject, e): no more, as actor asks; an event with it. */
enum status store_attempts_fail(struct store *s, const char *subject, struct errinfo *e);
enum status store_attempts_clear(struct store *s, const char *subject, struct errinfo *e);
enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e);

/* store_attempts_list(s, out, n, e): of all subjects that have some, in the order of their
 * coming; a new array released by free(). */
enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e);

#endif
