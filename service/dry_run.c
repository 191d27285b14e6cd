#include "dry_run.h"

#include "cloudpoints.h"

bool dry_run_is_refusal(enum status st)
{
    return st >= ST_ELIMIT && st <= ST_EQUALITY;
}

enum status dry_run_run(const char *name, const struct cloudpoints *c,
                        const struct sample_options *by, struct surface_work *w,
                        struct surface_face **face, struct dry_run *out)
{
    const struct surface_stop stop = sample_stop(by);
    const struct surface_cloud cloud = sample_cloud(c, by, &stop);
    struct sample_found strict = sample_begin(c);
    enum surface_status refused;
    enum status st;

    *out = (struct dry_run){.found = strict};
    out->verification = status_from(
        surface_check(w, &cloud, face, &refused, &strict.scan, &out->found.scan));
    out->enrolment = status_from(refused);
    sample_tell(c, &strict.scan);
    sample_tell(c, &out->found.scan);
    st = out->verification;
    if (st != ST_OK) {
        sample_refuse(name, st, &out->found, &out->why);
        advice_give(st, &out->found.scan, NULL, &out->advice);
        return dry_run_is_refusal(st) ? ST_OK : st;
    }
    if (out->enrolment != ST_OK) {
        sample_refuse(name, out->enrolment, &strict, &out->why);
        advice_give(out->enrolment, &strict.scan, NULL, &out->advice);
    } else {
        advice_give(ST_OK, &out->found.scan, *face, &out->advice);
    }
    return ST_OK;
}

void dry_run_unread(enum status st, const struct errinfo *e, struct dry_run *out)
{
    *out = (struct dry_run){.enrolment = st, .verification = st, .why = *e};
    advice_give(st, &out->found.scan, NULL, &out->advice);
}
