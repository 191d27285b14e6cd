/* enrolment.h -- samples become templates of a subject.  A further sample must match the
 * subject's oldest template, or one that was enrolled with scope manage: not just any, or a row of
 * samples, each like the one before, would lead from the subject to anybody.  From then on it
 * decides like any of them, so one that does not tell (inconclusive) does not do either.
 * Several at once, of one sitting, are held against the same; where the subject has no template
 * yet, or they come with scope manage, against the first of them that may become one.  All that fit
 * are stored in one transaction. */
#ifndef SERVICE_ENROLMENT_H
#define SERVICE_ENROLMENT_H
#include <stdbool.h>
#include "errinfo.h"
#include "status.h"
#include "store.h"
#include "templates.h"

#define ENROLMENT_SAMPLES 20 /* at once */

struct enrolment {
    const char *actor, *subject, *label; /* as in store_enroll() */
    const struct store_sample *sample;   /* [n]; without a face: refused already */
    size_t n;                            /* 1 to ENROLMENT_SAMPLES */
    const char *captured;                /* as in store_enroll() */
    bool manager;                        /* as in struct store_template */
    bool force;                          /* they need not fit */
    /* A sample that does not fit the subject's templates is a failed attempt on the subject,
     * which is asked for before the comparison and again before its result is reported.  NULL:
     * whoever enrols has the database, is not locked out, and the attempt is not counted. */
    const struct store_limits *limits;
};

struct enrolment_result {       /* of a sample */
    struct errinfo why;         /* ST_OK, or why it was refused */
    struct store_template tmpl; /* as it is stored; zero if it was refused */
    bool created;               /* false: the subject had this very cloud already */
};

struct enrolment_outcome {
    struct templates_refusal refusal;
    struct nearest nearest;         /* the last comparison with the subject's templates;
                                       compared is 0 where there was nothing to fit */
    bool none;                      /* each sample was refused */
    bool locked_out, many_subjects; /* as in struct store_recorded */
};

/* enrolment_add(c, x, each, out, e): the samples are compared with what the subject has at that
 * moment, whatever other threads and processes enrol meanwhile.  Those that fit are stored, with
 * force all of them.
 * each  [x->n], all zero but for the reason why a sample without a face was refused
 * Returns ST_OK, also where some are refused; where all are, out->none and the first one's reason:
 * ST_EMISMATCH: it does not fit.
 * Each that does not fit, up to the first that does, is recorded like a failed verification
 * (store_record_verification()), as enroll_mismatch.  Those behind it are not: who has a scan that fits learns
 * nothing of the subject by comparing others with it.
 * On failure nothing is stored.  ST_EDENIED: out->refusal says why; or as templates_nearest(),
 * store_record_verification(), store_enroll(). */
enum status enrolment_add(struct templates_context *c, const struct enrolment *x,
                          struct enrolment_result *each, struct enrolment_outcome *out,
                          struct errinfo *e);

/* enrolment_code(st): the word for why a sample was not taken: "sample_mismatch", or as
 * status_refusal(). */
const char *enrolment_code(enum status st);

#endif
