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
                             bool enrolment, struct surface_work *w,
                             struct surface_face **out, struct sample_found *found)
{
    const struct sample_options o = {.frontal = c->scans.frontal, .enrolment = enrolment};

    return sample_build(path, p, &o, w, out, found, &c->e);
}

enum status ctl_sample_read(struct ctl *c, const char *path, bool enrolment,
                            struct surface_work *w, struct surface_face **out,
                            struct sample_found *found)
{
    struct cloudpoints p;
    enum status st = ctl_sample_parse(c, path, &p);

    if (st == ST_OK)
        st = ctl_sample_build(c, path, &p, enrolment, w, out, found);
    cloudpoints_free(&p);
    return st;
}

void ctl_sample_warnings(FILE *to, const char *label, const struct sample_found *f)
{
    const uint32_t warnings = f->scan.warnings;
    const char *comma = "";

    if (warnings != 0)
        (void)fprintf(to, "%-12s ", label);
    for (int i = 0; i < SURFACE_WARNINGS; i++)
        if ((warnings >> i & 1) != 0) {
            (void)fprintf(to, "%s%s", comma,
                          surface_warning_name((enum surface_warning)i));
            comma = ", ";
        }
    if (warnings != 0)
        (void)fprintf(to, "\n");
}
