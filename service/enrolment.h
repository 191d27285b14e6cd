/* enrolment.h -- samples become templates of a subject.
 * A further sample must match a reference template: the subject's oldest one, or one that was enrolled
 * with scope manage.  Matching any template is not enough: a series of samples, each similar to the one
 * before, would lead to another person.  An inconclusive sample is refused too, because an enrolled one
 * decides like the others.
 * Several samples of one capture session: the samples after the first accepted one must match it.  They
 * must also match a reference template, unless the subject had no template or the actor has the scope
 * manage.  All matching samples are stored in one transaction. */
#ifndef SERVICE_ENROLMENT_H
#define SERVICE_ENROLMENT_H
#include <stdbool.h>
#include "errinfo.h"
#include "gallery.h"
#include "status.h"
#include "store.h"
#include "templates.h"

struct json;         /* json.h */
struct sample_found; /* sample.h */

#define ENROLMENT_SAMPLES 20 /* most samples of one enrolment */

struct enrolment {
    const char *actor, *subject, *label; /* as in store_enroll() */
    const struct store_sample *sample;   /* samples [n]; face NULL: already refused */
    size_t n;                            /* number of samples, 1 to ENROLMENT_SAMPLES */
    const char *groups, *captured;       /* as in store_enroll() */
    bool manager;                        /* as in struct store_template */
    /* Gallery in which somebody who is enrolled under another id is looked for before the first template of a
     * subject is stored; NULL: nobody is. */
    struct gallery *gallery;
    bool force; /* samples are stored even if they do not match */
    /* Limits of failed attempts.  A sample that does not match the reference templates is a failed
     * attempt.  The lock-out is checked before the comparison, and again before its result is reported.
     * NULL: no lock-out, and attempts are not counted (the caller has the database itself). */
    const struct store_limits *limits;
};

struct enrolment_result {       /* result of one sample */
    struct errinfo why;         /* ST_OK, or the reason of the refusal */
    struct store_template tmpl; /* the stored template; zero if the sample was refused */
    bool created; /* the template is new; false: the subject had this cloud already */
};

struct enrolment_outcome {
    struct templates_refusal refusal; /* reason of ST_EDENIED */
    /* Last comparison with the reference templates; compared is 0 if there was none. */
    struct templates_nearest nearest;
    bool none;                      /* all samples were refused */
    bool is_searched;               /* the gallery was searched for somebody else: */
    enum surface_decision searched; /* the decision of the last search */
    char twin[STORE_SUBJECT_MAX +
              1];      /* the subject that matched, with ST_EEXISTS; "": none */
    unsigned warnings; /* as in struct store_recorded */
};

/* enrolment_begin(c, x, begun, e): Reads the subject's templates, and checks admission and lock-out.  So a
 * refusal that does not depend on the samples comes before the work on them.
 *   x      only actor, subject, limits and force are used; a subject that does not exist is admitted
 *   begun  to be passed to enrolment_add(), or released by templates_free(), also after a failure
 * Returns ST_OK; ST_EDENIED: begun->refusal has the reason; or as templates_read(). */
enum status enrolment_begin(struct templates_context *c, const struct enrolment *x,
                            struct templates *begun, struct errinfo *e);

/* enrolment_add(c, x, begun, each, out, e): Compares the samples with the reference templates, and stores those
 * that match, or all with x->force.  Other threads and processes may enrol meanwhile.
 * Each sample that does not match a reference template is recorded like a failed verification
 * (store_record_verification()), as enroll_mismatch.  A sample that does not match the first accepted
 * sample is not compared with the templates; it is recorded, but not counted.
 * With x->gallery each sample is first identified (identify_sample()).  No change may come between that and the
 * storing, else it is done again: of two enrolments of one face at once the second is refused.
 *   begun  takes ownership; NULL: enrolment_begin() was not called
 *   each   results [x->n]; in: all zero, except why of a sample without a face
 * Returns ST_OK, also if some samples are refused.  If all are refused, sets out->none and returns the
 * status of the first one (ST_EMISMATCH: it does not match).  After any other error nothing is stored.
 * ST_EDENIED: out->refusal has the reason; ST_EEXISTS: out->twin is another subject with this face; or as
 * templates_nearest(), store_record_verification(), identify_sample(), store_enroll(). */
enum status enrolment_add(struct templates_context *c, const struct enrolment *x,
                          struct templates *begun, struct enrolment_result *each,
                          struct enrolment_outcome *out, struct errinfo *e);

/* enrolment_code(st): Returns the code of a sample's refusal: "sample_mismatch", or as status_refusal(). */
const char *enrolment_code(enum status st);

/* enrolment_describe(j, file, x, found, face): Writes the result of one of several files of an enrolment: its
 * template, or the refusal.
 *   found  points_read is 0 if the file was not read
 *   face   not used if x was refused */
void enrolment_describe(struct json *j, const char *file,
                        const struct enrolment_result *x,
                        const struct sample_found *found,
                        const struct surface_face *face);

#endif
