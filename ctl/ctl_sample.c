#include <stdio.h>
#include <stdlib.h>

#include "cloudfile.h"
#include "corpus.h"
#include "readfile.h"
#include "sample.h"
#include "ctl.h"
#include "ctl_sample.h"

#define MAX_FILE ((size_t)256 << 20)

enum status ctl_sample_parse(struct ctl *c, const char *path, struct cloudpoints *out)
{
    const struct cloudfile_options o = {.max_points = CLOUDFILE_POINTS,
                                        .max_bytes = MAX_FILE,
                                        .unit_mm = c->scans.unit_mm,
                                        .camera = c->scans.camera};
    struct errinfo why = {.msg = "out of memory"};
    unsigned char *bytes;
    size_t len;
    enum status st = readfile_all(path, MAX_FILE, &bytes, &len, &c->e);

    *out = (struct cloudpoints){0};
    if (st == ST_OK && (st = cloudfile_read(bytes, len, &o, out, &why)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%.100s: %s", path, why.msg);
    free(bytes);
    return st;
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

/* ---- of a collection */

void ctl_sample_print_left(const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++)
        (void)fprintf(stderr, "surfacectl: %s: %s\n", k->left[i].file, k->left[i].why);
}

void ctl_sample_left(struct json *j, const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++) {
        json_object(j, NULL);
        json_text(j, "file", k->left[i].file);
        json_text(j, "reason", k->left[i].why);
        json_close(j);
    }
    json_close(j);
}
