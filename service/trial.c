#include "trial.h"

#include "cloudpoints.h"
#include "face.h"
#include "sample.h"
#include "scan.h"

bool trial_is_refusal(enum status st)
{
    return st >= ST_ELIMIT && st <= ST_EQUALITY;
}

const char *trial_code(enum status st)
{
    static const char *const code[ST_COUNT] = {
        [ST_ELIMIT] = "too_many_points", [ST_ETOOFEW] = "too_few_points",
        [ST_ENOTFINITE] = "not_finite",  [ST_ERANGE] = "out_of_range",
        [ST_EDEGENERATE] = "degenerate", [ST_EUNITS] = "units_suspicious",
        [ST_ENOFACE] = "no_face",        [ST_ESEVERAL] = "several_faces",
        [ST_EMIRRORED] = "mirrored",     [ST_ENOTFACE] = "not_a_face",
        [ST_EQUALITY] = "low_quality"};

    return st == ST_OK ? NULL : code[st] != NULL ? code[st] : "malformed";
}

static enum status run(const char *name, struct cloudpoints *c,
                       const struct scan_options *o, struct face_work *w,
                       struct face *face, struct trial *out)
{
    const enum status st = sample_build(name, c, o, w, face, &out->found, &out->why);

    advice_give(st, &out->found, face, &out->advice);
    return st;
}

/* As for a verification, which takes more than an enrolment; out has the enrolment's refusal,
 * which stays where this succeeds. */
static void run_loosely(const char *name, struct cloudpoints *c,
                        const struct scan_options *strict, struct face_work *w,
                        struct face *face, struct trial *out)
{
    const struct scan_options o = {
        .axes = strict->axes, .search = strict->search, .stop = strict->stop};
    struct trial loose = {.verification = ST_OK};

    out->verification = run(name, c, &o, w, face, &loose);
    if (out->verification != ST_OK) {
        out->why = loose.why;
        out->advice = loose.advice;
    }
    out->found = loose.found;
}

enum status trial_run(const char *name, struct cloudpoints *c,
                      const struct scan_options *by, struct face_work *w,
                      struct face *face, struct trial *out)
{
    struct scan_search search = {.done = false};
    const struct scan_options o = {
        .axes = by->axes, .enrolment = true, .search = &search, .stop = by->stop};
    struct cloudpoints again;

    *out = (struct trial){0};
    if (cloudpoints_copy(c, &again) != ST_OK)
        return errinfo_set(&out->why, ST_ENOMEM, "no memory for a copy of the points");
    out->enrolment = out->verification = run(name, c, &o, w, face, out);
    if (trial_is_refusal(out->enrolment)) {
        cloudpoints_free(c);
        *c = again;
        run_loosely(name, c, &o, w, face, out);
    } else {
        cloudpoints_free(&again);
    }
    return out->verification == ST_OK || trial_is_refusal(out->verification)
               ? ST_OK
               : out->verification;
}

void trial_unread(enum status st, const struct errinfo *e, struct trial *out)
{
    const struct face none = {.quality = {0}};

    *out = (struct trial){.enrolment = st, .verification = st, .why = *e};
    advice_give(st, &out->found, &none, &out->advice);
}
