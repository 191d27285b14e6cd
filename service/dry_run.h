/* dry_run.h -- whether a scan would be accepted, at enrolment and at verification. */
#ifndef SERVICE_DRY_RUN_H
#define SERVICE_DRY_RUN_H
#include <stdbool.h>
#include "advice.h"
#include "errinfo.h"
#include "sample.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */

struct dry_run {
    enum status enrolment, verification; /* ST_OK, or the reason of the refusal */
    struct sample_found found; /* report on the scan; points_read is 0: not read */
    /* The refusal; that of the enrolment only if a verification would accept the scan; "": none. */
    struct errinfo why;
    struct advice advice; /* advice on why */
};

/* dry_run_is_refusal(st): Returns true if st concerns the scan, and can be avoided at the scanner. */
bool dry_run_is_refusal(enum status st);

/* dry_run_run(name, c, by, w, face, out): Builds the face as for an enrolment and, if that is refused, as for
 * a verification.
 *   name, w  as in sample_build()
 *   by       its member enrolment is ignored
 *   c        is not changed
 *   face     as in surface_build(), if one of both succeeds; else *face is NULL
 * Cost: at most two face models, with one search for the face, and a copy of the points.
 * Returns ST_OK, also for a refused scan; ST_ENOMEM and other errors that are not refusals, with
 * out->why set. */
enum status dry_run_run(const char *name, const struct cloudpoints *c,
                        const struct sample_options *by, struct surface_work *w,
                        struct surface_face **face, struct dry_run *out);

/* dry_run_unread(st, e, out): Sets *out for a file whose points its reader has refused with st and *e
 * (dry_run_is_refusal(st) is true). */
void dry_run_unread(enum status st, const struct errinfo *e, struct dry_run *out);

#endif
