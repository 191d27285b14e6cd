#include "dry_run.h"

#include "cloudpoints.h"
#include "face.h"
#include "sample.h"
#include "scan.h"

bool dry_run_is_refusal(enum status st)
{
    return st >= ST_ELIMIT && st <= ST_EQUALITY;
}

const char *dry_run_code(enum status st)
{
    return status_refusal(st);
}

static enum status run(const char *name, struct cloudpoints *c,
                       const struct scan_options *o, struct face_work *w,
                       struct face *face, struct dry_run *out)
{
    const enum status st = sample_build(name, c, o, w, face, &out->found, &out->why);

    advice_give(st, &out->found, face, &out->advice);
    return st;
}

/* As for a verification, which takes more than an enrolment; out has the enrolment's refusal,
 * which stays where this succeeds. */
static void run_loosely(const char *name, struct cloudpoints *c,
                        const struct scan_options *strict, struct face_work *w,
                        struct face *face, struct dry_run *out)
{
    const struct scan_options o = {
        .axes = strict->axes, .search = strict->search, .stop = strict->stop};
    struct dry_run loose = {.verification = ST_OK};

    out->verification = run(name, c, &o, w, face, &loose);
    if (out->verification != ST_OK) {
        out->why = loose.why;
        out->advice = loose.advice;
    }
    out->found = loose.found;
}

enum status dry_run_run(const char *name, struct cloudpoints *c,
                        const struct scan_options *by, struct face_work *w,
                        struct face *face, struct dry_run *out)
{
    struct scan_search search = {.done = false};
    const struct scan_options o = {
        .axes = by->axes, .enrolment = true, .search = &search, .stop = by->stop};
    struct cloudpoints again;

    *out = (struct dry_run){0};
    if (cloudpoints_copy(c, &again) != ST_OK)
        return errinfo_set(&out->why, ST_ENOMEM, "no memory for a copy of the points");
    out->enrolment = out->verification = run(name, c, &o, w, face, out);
    if (dry_run_is_refusal(out->enrolment)) {
        cloudpoints_free(c);
        *c = again;
        run_loosely(name, c, &o, w, face, out);
    } else {
        cloudpoints_free(&again);
    }
    return out->verification == ST_OK || dry_run_is_refusal(out->verification)
               ? ST_OK
               : out->verification;
}

void dry_run_unread(enum status st, const struct errinfo *e, struct dry_run *out)
{
    const struct face none = {.quality = {0}};

    *out = (struct dry_run){.enrolment = st, .verification = st, .why = *e};
    advice_give(st, &out->found, &none, &out->advice);
}
