/* dry_run.h -- what would be done with a scan, at enrolment and at verification. */
#ifndef SERVICE_DRY_RUN_H
#define SERVICE_DRY_RUN_H
#include <stdbool.h>
#include "advice.h"
#include "errinfo.h"
#include "sample.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */

struct dry_run {
    enum status enrolment, verification; /* ST_OK, or why it would be refused */
    struct sample_found found; /* points_read is 0 where the points were not read */
    struct errinfo
        why; /* the refusal; of the enrolment only, if a verification would accept the scan; "": none */
    struct advice advice; /* for what why is about */
};

/* dry_run_is_refusal(st): whether st is about the scan, and can be changed at the
 * scanner. */
bool dry_run_is_refusal(enum status st);

/* dry_run_run(name, c, by, w, face, out): build the face as for an enrolment and, if that
 * is refused, as for a verification.
 * name, w  as in sample_build()
 * by     its enrolment is ignored
 * c      afterwards as it was
 * face   as in surface_build(), where either succeeds; else *face is NULL
 * Cost   twice a face model at most, with one search for the face, and a copy of the points.
 * Returns ST_OK, also for a refused scan; ST_ENOMEM and others that are not refusals, with
 * out->why. */
enum status dry_run_run(const char *name, const struct cloudpoints *c,
                        const struct sample_options *by, struct surface_work *w,
                        struct surface_face **face, struct dry_run *out);

/* dry_run_unread(st, e, out): for a file whose points were refused
 * (dry_run_is_refusal(st)) by its reader. */
void dry_run_unread(enum status st, const struct errinfo *e, struct dry_run *out);

#endif
