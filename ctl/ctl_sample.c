#include <stdio.h>

#include "cloudfile.h"
#include "sample.h"
#include "ctl.h"
#include "ctl_sample.h"

enum status ctl_sample_parse(struct ctl *c, const char *path, struct cloudpoints *out)
{
    return cloudfile_read_path(path, c->scans.unit_mm, &c->scans.camera, out, &c->e);
}

enum status ctl_sample_build(struct ctl *c, const char *path, struct cloudpoints *p,
                             bool enrolment, struct face_work *w, struct face *out,
                             struct scan_found *found)
{
    const struct scan_options o = {.axes = c->scans.axes, .enrolment = enrolment};

    return sample_build(path, p, &o, w, out, found, &c->e);
}

enum status ctl_sample_read(struct ctl *c, const char *path, bool enrolment,
                            struct face_work *w, struct face *out,
                            struct scan_found *found)
{
    struct cloudpoints p;
    enum status st = ctl_sample_parse(c, path, &p);

    if (st == ST_OK)
        st = ctl_sample_build(c, path, &p, enrolment, w, out, found);
    cloudpoints_free(&p);
    return st;
}

void ctl_sample_warnings(FILE *to, const char *label, const struct scan_found *f)
{
    const char *comma = "";

    if (f->warnings != 0)
        (void)fprintf(to, "%-12s ", label);
    for (int i = 0; i < SCAN_WARNINGS; i++)
        if ((f->warnings >> i & 1) != 0) {
            (void)fprintf(to, "%s%s", comma, scan_warning_name((enum scan_warning)i));
            comma = ", ";
        }
    if (f->warnings != 0)
        (void)fprintf(to, "\n");
}
