/* enrolment.h -- a sample becomes a template of a subject.  A further sample must match the
 * nearest of those that are there: from then on it decides like any of them, so one that
 * does not tell (inconclusive) does not do either. */
#ifndef VERIFY_ENROLMENT_H
#define VERIFY_ENROLMENT_H
#include <stdbool.h>
#include "admit.h"
#include "errinfo.h"
#include "nearest.h"
#include "status.h"
#include "store.h"

struct enrolment {
    const char *actor, *subject, *label; /* as in store_enroll() */
    const struct face *face;
    const char *read;     /* digest of the points it was made of (struct scan_found) */
    const char *captured; /* as in store_enroll() */
    bool force;           /* whether it fits is not asked */
    /* A sample that does not fit is a failed attempt on the subject: may(arg, now) is asked
     * before the comparison and again before its result is told; NULL: whoever enrols has the
     * database, is not locked out, and the attempt is not counted. */
    bool (*may)(void *arg, const struct store_attempts *now);
    void *arg;
    unsigned warn_failures, warn_tried; /* as in store_settle() */
};

struct enrolment_outcome {
    struct store_template tmpl;     /* as it is stored; zero on failure */
    bool created;                   /* false: the subject had this very cloud already */
    enum admit admit;               /* may samples of the subject be enrolled? */
    struct nearest nearest;         /* compared is 0 where there was nothing to fit */
    bool locked;                    /* may() said no */
    bool locked_out, many_subjects; /* as in struct store_settled */
    struct errinfo lost; /* why there is no event of a sample that did not fit */
};

/* enrolment_add(c, x, out, e): the sample is compared (unless force) and stored, with all
 * that the subject has at that moment, whatever other threads and processes enrol meanwhile.
 * Returns ST_OK; ST_EMISMATCH: it does not fit, which is recorded like a failed verification
 * (store_settle()), as enroll_mismatch; ST_EDENIED: out->admit says that the subject is disabled
 * or has expired, or out->locked; or as nearest_find(), store_settle(), store_enroll(). */
enum status enrolment_add(struct admission_context *c, const struct enrolment *x,
                          struct enrolment_outcome *out, struct errinfo *e);

#endif
