/* drift.h -- has the quality of the scans that a token sends changed: for doctor, GET /v1/stats and the
 * console. */
#ifndef SERVICE_DRIFT_H
#define SERVICE_DRIFT_H
#include "store.h"

enum drift_of { DRIFT_NONE, DRIFT_NOISE, DRIFT_QUALITY, DRIFT_UNUSABLE };

struct drift {
    enum drift_of of;
    int64_t since; /* first day of the change, days since 1970 */
    double before,
        after; /* means: of the noise in mm, of the quality, or the share of unusable scans */
};

/* drift_sum(day, n): Returns the sums of n days of a token, 1 or more; day and token are those of the first. */
struct store_scans drift_sum(const struct store_scans *day, size_t n);

/* drift_find(day, n, today): Finds the clearest change of a token's scans that still holds.
 *   day    [n] the days of a token, oldest first (store_scans())
 *   today  days since 1970; later days are ignored
 * A day divides the days into those from it on and those before it, at most DRIFT_WINDOW each.  A change is clear if
 * - there are DRIFT_BEFORE scans on DRIFT_BEFORE_DAYS days before, and DRIFT_SINCE on DRIFT_SINCE_DAYS since;
 * - the noise is DRIFT_NOISE_RATIO times as high or as low, the quality fell by DRIFT_QUALITY_FALL, or the share of
 *   unusable scans rose by DRIFT_UNUSABLE_RISE, since then, on the first day, and on the last days that have DRIFT_SINCE scans;
 * - the difference is DRIFT_SURE times its standard error by the spread of the days before, in which a day
 *   with fewer scans than usual counts for its part of a day.
 * How often it is wrong, and how soon it sees: tests/service/test_drift.c. */
#define DRIFT_WINDOW        28
#define DRIFT_BEFORE        50
#define DRIFT_BEFORE_DAYS   7
#define DRIFT_SINCE         20
#define DRIFT_SINCE_DAYS    2
#define DRIFT_NOISE_RATIO   1.5
#define DRIFT_QUALITY_FALL  0.15
#define DRIFT_UNUSABLE_RISE 0.1
#define DRIFT_SURE          6.0
struct drift drift_find(const struct store_scans *day, size_t n, int64_t today);

/* drift_say(d, out): Prints "noise doubled since Tuesday, 2026-11-24: 0.62 mm, before 0.31 mm"; "" for
 * DRIFT_NONE. */
#define DRIFT_TEXT 128
void drift_say(const struct drift *d, char out[DRIFT_TEXT]);

/* The days of one token. */
struct drift_token {
    const char *id, *name; /* id: "": an actor that is no token */
    const struct store_scans *day;
    size_t n;
    struct drift drift;
};

/* drift_each(s, tell, arg, e): Calls tell(arg, t) for each token with scans within STORE_SCAN_DAYS, in the order
 * of their names. */
enum status drift_each(struct store *s,
                       void (*tell)(void *arg, const struct drift_token *t), void *arg,
                       struct errinfo *e);

#endif
