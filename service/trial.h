/* trial.h -- what would be done with a scan, at enrolment and at verification. */
#ifndef VERIFY_TRIAL_H
#define VERIFY_TRIAL_H
#include <stdbool.h>
#include "advice.h"
#include "errinfo.h"
#include "scan.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct face;        /* face.h */
struct face_work;   /* face.h */

struct trial {
    enum status enrolment, verification; /* ST_OK, or why it would be refused */
    struct scan_found found; /* points_read is 0 where the points were not read */
    struct errinfo why;      /* the refusal; of the enrolment alone where the scan can be
                                verified by; "" for none */
    struct advice advice;    /* for what why is about */
};

/* trial_is_refusal(st): the scan is the reason, and can be changed at the scanner. */
bool trial_is_refusal(enum status st);

/* trial_code(st): the word for a refusal, as in the API ("not_a_face"); "malformed" for what
 * cannot be read at all; NULL for ST_OK. */
const char *trial_code(enum status st);

/* trial_run(name, c, by, w, face, out): build the face as for an enrolment and, where that is
 * refused, as for a verification.
 * name, w  as in sample_build()
 * by     of these options axes and stop
 * c      afterwards as scan_build() leaves it
 * face   the model, if either succeeds; else empty, its quality as sample_build() says
 * Cost   twice a face model at most, with one search for the face, and a copy of the points.
 * Returns ST_OK, also for a scan that is refused; ST_ENOMEM and what else is no refusal, with
 * out->why. */
enum status trial_run(const char *name, struct cloudpoints *c,
                      const struct scan_options *by, struct face_work *w,
                      struct face *face, struct trial *out);

/* trial_unread(st, e, out): of a file whose points are refused (trial_is_refusal(st)) when they
 * are read. */
void trial_unread(enum status st, const struct errinfo *e, struct trial *out);

#endif
