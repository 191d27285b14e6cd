/* enrolment.h -- samples become templates of a subject.  A further sample must match the
 * subject's oldest template, or one that was enrolled with scope manage: matching any
 * template is not enough, since a series of samples, each like the one before, would lead
 * to another person. An inconclusive sample is refused too, since an enrolled one decides
 * like the others. Of several samples of one capture session those behind the first accepted one
 * must match it; then also the same templates, unless the subject has none yet or they come
 * with scope manage. All that match are stored in one transaction. */
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
    bool force;                          /* they need not match */
    /* A sample that does not match the subject's templates is a failed attempt; the
     * lock-out is checked before the comparison and again before its result is
     * reported. NULL: no lock-out, and attempts are not counted (the caller has the
     * database). */
    const struct store_limits *limits;
};

struct enrolment_result {       /* of a sample */
    struct errinfo why;         /* ST_OK, or why it was refused */
    struct store_template tmpl; /* as it is stored; zero if it was refused */
    bool created;               /* false: the subject had this cloud already */
};

struct enrolment_outcome {
    struct templates_refusal refusal;
    struct templates_nearest nearest; /* the last comparison with the subject's templates;
                                       compared is 0 where there was nothing to fit */
    bool none;                        /* each sample was refused */
    unsigned warnings;                /* as in struct store_recorded */
};

/* enrolment_begin(c, x, begun, e): what enrolment_add() would refuse whatever the samples are, before the
 * work on them; of *x actor, subject, limits and force.  A subject that is not there is admitted.
 * begun  for enrolment_add(), or templates_free(), also after a failure
 * Returns ST_OK; ST_EDENIED: begun->refusal says why; or as templates_read(). */
enum status enrolment_begin(struct templates_context *c, const struct enrolment *x,
                            struct templates *begun, struct errinfo *e);

/* enrolment_add(c, x, begun, each, out, e): compare the samples with the subject's templates and
 * store those that match, with force all. Other threads and processes may enrol
 * meanwhile.
 * begun taken; NULL: enrolment_begin() was not called
 * each  [x->n], all zero, except why of a sample without a face
 * Returns ST_OK, also if some are refused; if all are, out->none is set and the first one's
 * status is returned (ST_EMISMATCH: it does not match).
 * Each sample that does not match the templates is recorded like a failed verification
 * (store_record_verification()), as enroll_mismatch.  One that does not match the first accepted
 * sample is not compared with them; it is recorded, and not counted.
 * On failure nothing is stored.  ST_EDENIED: out->refusal says why; or as
 * templates_nearest(), store_record_verification(), store_enroll(). */
enum status enrolment_add(struct templates_context *c, const struct enrolment *x,
                          struct templates *begun, struct enrolment_result *each,
                          struct enrolment_outcome *out, struct errinfo *e);

/* enrolment_code(st): the code of a sample's refusal: "sample_mismatch", or as
 * status_refusal(). */
const char *enrolment_code(enum status st);

#endif
