/* store_attempts.h -- consecutive failed attempts on a subject, by token: limits, lock-outs, reset.
 * store_snapshot_begin() reads the attempts, store_record_verification() counts them. */
#ifndef DB_STORE_ATTEMPTS_H
#define DB_STORE_ATTEMPTS_H
#include "store_open.h"

/* store_attempts_reset(s, actor, subject, e): Deletes the subject's failed attempts by all tokens, and appends
 * an entry with this actor to the change log.  ST_ENOTFOUND: no such subject. */
enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e);

/* store_attempts_reset_token(s, actor, token, e): Deletes the token's failed attempts on all subjects, and appends
 * an entry with this actor to the change log.  This also ends a lock-out after failures on too many
 * subjects.  ST_ENOTFOUND: no such token. */
enum status store_attempts_reset_token(struct store *s, const char *actor,
                                       const char *token, struct errinfo *e);

/* store_attempts_list(s, out, n, e): Lists the failed attempts of all subjects and tokens, in the order of the
 * subjects' creation.
 *   out  a new array of *n elements, to be released by free() */
enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e);

/* Limits against trying faces until one matches.
 * - Consecutive failed verifications of a subject lock a token out of it.
 * - The failures of all tokens together lock all tokens out, for a shorter time: at most
 *   STORE_WAIT_OTHERS_S for a token that has not failed, STORE_WAIT_SHARED_S for one that has.  So an
 *   attacker cannot keep other clients out by failing.
 * - A token that has tried `subjects` subjects without a match in STORE_TRIED_MS may try one more each
 *   STORE_TRIED_MS / subjects: a door with many failures becomes slow, and is not closed. */
struct store_limits {
    unsigned
        failures; /* consecutive failures that lock a token out; 0: no limits at all */
    unsigned
        wait_s; /* first lock-out, s; doubles with each failure, up to OPTIONS_WAIT_MAX */
    unsigned
        subjects; /* subjects of a token without a match in STORE_TRIED_MS; 0: any number */
};

#define STORE_WAIT_OTHERS_S 60
#define STORE_WAIT_SHARED_S 3600

/* Attempts below the lock-out, between the matches of the right person, are reported when the suspicion of
 * all tokens for the subject reaches STORE_SUSPICION.  A failure adds 3, a match subtracts 2, down to 0.
 * These are the logarithms of (1/2) / (3/10) and (7/10) / (1/2) in units of 0.17: one attempt between two
 * matches against a person who fails at three attempts in ten.  A failure without a match of the token
 * within STORE_RETRY_MS adds 6 more, because people try again at once. */
#define STORE_SUSPICION 75

struct store_worst {
    uint32_t failures; /* highest count of failures of one token */
    char until[32];    /* end of the longest lock-out; "": no token is locked out */
};

/* store_attempts_worst(s, actor, subject, l, out, e): Finds the longest lock-out from the subject among all tokens,
 * including tokens that have not failed.  ST_ENOTFOUND: no such subject. */
enum status store_attempts_worst(struct store *s, const char *actor, const char *subject,
                                 const struct store_limits *l, struct store_worst *out,
                                 struct errinfo *e);

enum store_wait { /* the order of enum metrics_failed */
                  STORE_WAIT_NONE,
                  STORE_WAIT_OWN,
                  STORE_WAIT_OTHERS,
                  STORE_WAIT_SUBJECTS
};

/* store_attempts_wait_ms(l, now, why): Returns the remaining time of the longest lock-out, ms, and sets *why to
 * its reason; 0: the subject may be verified.
 *   l  NULL: no limits */
int64_t store_attempts_wait_ms(const struct store_limits *l,
                               const struct store_attempts *now, enum store_wait *why);

/* store_attempts_suspicion(was, failed): Returns the token's suspicion after one more failure, or after
 * a match. */
uint32_t store_attempts_suspicion(const struct store_attempts *was, bool failed);

#endif
