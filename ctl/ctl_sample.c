#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudfile.h"
#include "sample.h"
#include "ctl.h"
#include "ctl_sample.h"

#define MAX_FILE ((size_t)256 << 20)

enum status ctl_sample_file(const char *path, size_t most, unsigned char **bytes,
                            size_t *len, struct errinfo *e)
{
    const bool standard = strcmp(path, "-") == 0;
    FILE *in = standard ? stdin : fopen(path, "rb");
    char is[32], may[32];
    struct stat info;
    unsigned char *larger;
    size_t room = 1 << 16, n;
    enum status st = ST_OK;

    *len = 0;
    *bytes = NULL;
    if (in == NULL)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%s: %s", path,
                           strerror(errno));
    if (fstat(fileno(in), &info) == 0 && S_ISREG(info.st_mode) &&
        (uintmax_t)info.st_size > most)
        st = errinfo_set(e, ST_ESIZE, "%s: %s, and at most %s are read", path,
                         ctl_bytes((uint64_t)info.st_size, is), ctl_bytes(most, may));
    while (st == ST_OK) {
        if (*bytes == NULL || *len + 1 == room) {
            room *= 2;
            if ((larger = realloc(*bytes, room)) == NULL) {
                st = errinfo_set(e, ST_ENOMEM, "%s: out of memory", path);
                break;
            }
            *bytes = larger;
        }
        *len += n = fread(*bytes + *len, 1, room - 1 - *len, in);
        (*bytes)[*len] = '\0';
        if (*len > most)
            st = errinfo_set(e, ST_ESIZE, "%s: at most %s are read", path,
                             ctl_bytes(most, may));
        if (n == 0)
            break;
    }
    if (st == ST_OK && ferror(in))
        st = errinfo_set(e, ST_EIO, "%s: %s", path, strerror(errno));
    if (!standard)
        (void)fclose(in);
    return st;
}

enum status ctl_sample_parse(struct ctl *c, const char *path, struct cloudpoints *out)
{
    const struct cloudfile_options o = {.max_points = FACE_MAX_POINTS,
                                        .max_bytes = MAX_FILE,
                                        .unit_mm = c->scans.unit_mm,
                                        .camera = c->scans.camera};
    struct errinfo why = {.msg = "out of memory"};
    unsigned char *bytes;
    size_t len;
    enum status st = ctl_sample_file(path, MAX_FILE, &bytes, &len, &c->e);

    *out = (struct cloudpoints){0};
    if (st == ST_OK && (st = cloudfile_read(bytes, len, &o, out, &why)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%.100s: %s", path, why.msg);
    free(bytes);
    return st;
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
