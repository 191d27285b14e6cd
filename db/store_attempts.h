/* store_attempts.h -- verifications of a subject that failed one after the other, by token. */
#ifndef DB_STORE_ATTEMPTS_H
#define DB_STORE_ATTEMPTS_H
#include "store_open.h"

/* store_attempts_reset(s, actor, subject, e): none any more by any token, as actor asks; a change
 * with it.  ST_ENOTFOUND: no such subject.  They are read by store_snapshot_begin(), counted by
 * store_record_verification(). */
enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e);

/* store_attempts_reset_token(s, actor, token, e): the same of a token, on all subjects: also who has
 * failed at too many is no longer locked out.  ST_ENOTFOUND: no such token. */
enum status store_attempts_reset_token(struct store *s, const char *actor,
                                       const char *token, struct errinfo *e);

/* store_attempts_list(s, out, n, e): of all subjects and tokens that have some, in the order of
 * the subjects' creation; a new array released by free(). */
enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e);

/* Limits for who tries faces until one matches.
 * - Failed verifications of a subject in a row lock a token out of it.
 * - The failures of all tokens together lock all of them out, for a shorter time: a token that has not
 *   failed for STORE_WAIT_OTHERS_S, one that has for STORE_WAIT_SHARED_S at most.  So an attacker cannot
 *   keep others out by failing.
 * - A token that has tried `subjects` subjects without a match in STORE_TRIED_MS may try one more each
 *   STORE_TRIED_MS / subjects: a door with many failures becomes slow, and is not closed. */
struct store_limits {
    unsigned failures; /* in a row; 0: no limit at all */
    unsigned wait_s;   /* of the first lock-out; it doubles, up to OPTIONS_WAIT_MAX */
    unsigned
        subjects; /* without a match in STORE_TRIED_MS; 0: any number; only of a token */
};

#define STORE_WAIT_OTHERS_S 60
#define STORE_WAIT_SHARED_S 3600

/* Attempts that stay below the lock-out, between the matches of the right person, are told when the
 * suspicion of all tokens for the subject reaches STORE_SUSPICION.  A failure adds 3 and a match takes
 * 2 away, down to 0: these are the logarithms of (1/2) / (3/10) and (7/10) / (1/2) in units of 0.17, of
 * one attempt between two matches against a person who fails at three attempts in ten.  A failure that
 * no match of the token follows within STORE_RETRY_MS adds 6 more: people try again at once. */
#define STORE_SUSPICION 75

/* store_attempts_worst(s, subject, l, out, e): of all tokens, also of one that has not failed: who
 * waits longest?  ST_ENOTFOUND. */
struct store_worst {
    uint32_t failures; /* by the token that has most */
    char until[32];    /* "": none is locked out of the subject */
};
enum status store_attempts_worst(struct store *s, const char *subject,
                                 const struct store_limits *l, struct store_worst *out,
                                 struct errinfo *e);

enum store_wait { /* the order of enum metrics_failed */
                  STORE_WAIT_NONE,
                  STORE_WAIT_OWN,
                  STORE_WAIT_OTHERS,
                  STORE_WAIT_SUBJECTS
};

/* store_attempts_wait_ms(l, now, why): what is left of the longest wait, and what it is for; 0: the
 * subject may be verified.  l: NULL for no limit. */
int64_t store_attempts_wait_ms(const struct store_limits *l,
                               const struct store_attempts *now, enum store_wait *why);

/* store_attempts_suspicion(was, failed): Returns the token's suspicion after one more failure, or after
 * a match. */
uint32_t store_attempts_suspicion(const struct store_attempts *was, bool failed);

#endif
