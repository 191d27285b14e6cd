/* store_attempts.h -- verifications of a subject that failed one after the other, by token. */
#ifndef DB_STORE_ATTEMPTS_H
#define DB_STORE_ATTEMPTS_H
#include "store_open.h"

/* store_attempts_reset(s, actor, subject, e): none any more by any token, as actor asks; a change
 * with it.  ST_ENOTFOUND: no such subject.  They are read by store_admit(), counted by
 * store_settle(). */
enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e);

/* store_attempts_list(s, out, n, e): of all subjects and tokens that have some, in the order of
 * the subjects' creation; a new array released by free(). */
enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e);

#endif
