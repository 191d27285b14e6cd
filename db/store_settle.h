/* store_settle.h -- all that a verification writes, in one transaction. */
#ifndef DB_STORE_SETTLE_H
#define DB_STORE_SETTLE_H
#include "store_open.h"

enum store_settle_as {
    STORE_SETTLE_UNCOUNTED, /* attempts are left as they are */
    STORE_SETTLE_PASSED,    /* none of the actor's are left */
    STORE_SETTLE_FAILED     /* one more of the actor */
};

struct store_settle {
    const struct store_subject *subject; /* as store_admit() gave it */
    enum store_settle_as as;
    const char *actor, *kind, *template_id, *outcome; /* of the event */

    /* A probe that matched, which is refused where it is no new scan: the cloud of a template of
     * the subject.  NULL: not asked. */
    const struct store_probe *probe;

    /* may: by the attempts as they are now, may the verification still be answered?  Others of
     * the subject may have failed since it was admitted.  NULL: yes. */
    bool (*may)(void *arg, const struct store_attempts *now);
    void *arg;

    /* Of one that failed, an event more where the operator should look: "locked_out" when the
     * actor has failed for the subject so often in a row, "many_subjects" when the subjects
     * that it tried in vain in STORE_TRIED_WARN_MS become so many, twice as many, and so on.
     * 0: never. */
    uint32_t warn_failures, warn_tried;
};

struct store_settled {
    bool may;      /* may() said so; else nothing was written */
    bool replayed; /* it was no new scan: recorded as "replayed", and counted as failed */
    bool locked_out, many_subjects; /* there was reason for such an event */
};

/* store_settle(s, what, out, e): attempts, entry of the access log, and that the subject was seen,
 * the latter at most once a minute.  A failure is on the disk when it returns; what is none does
 * not wait for the disk, as store_event().  ST_ENOTFOUND: the subject was erased meanwhile. */
enum status store_settle(struct store *s, const struct store_settle *what,
                         struct store_settled *out, struct errinfo *e);

#endif
