#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "mem.h"
#include "sample.h"
#include "ctl.h"
#include "ctl_scan.h"

#define MAX_FILE ((size_t)256 << 20)

enum status ctl_scan_file(const char *path, size_t most, unsigned char **bytes,
                          size_t *len, struct errinfo *e)
{
    const bool standard = strcmp(path, "-") == 0;
    FILE *in = standard ? stdin : fopen(path, "rb");
    unsigned char *larger;
    size_t room = 1 << 16, n;
    enum status st = ST_OK;

    *len = 0;
    *bytes = NULL;
    if (in == NULL)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%s: %s", path,
                           strerror(errno));
    do {
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
            st = errinfo_set(e, ST_ELIMIT, "%s: larger than %zu MB", path, most >> 20);
    } while (n != 0 && st == ST_OK);
    if (st == ST_OK && ferror(in))
        st = errinfo_set(e, ST_EIO, "%s: %s", path, strerror(errno));
    if (!standard)
        (void)fclose(in);
    return st;
}

double ctl_scan_unit(const struct ctl *c)
{
    if (c->units == NULL || strcmp(c->units, "mm") == 0)
        return 1;
    return strcmp(c->units, "cm") == 0 ? 10 : 1000;
}

enum status ctl_scan_parse(struct ctl *c, const char *path, struct dvec3 **pts, size_t *n)
{
    struct clouderror why = {.what = "out of memory"};
    unsigned char *bytes;
    size_t len;
    enum status st = ctl_scan_file(path, MAX_FILE, &bytes, &len, &c->e);

    *pts = NULL;
    *n = 0;
    if (st == ST_OK && (st = cloudfile_parse(bytes, len, CLOUDFILE_ANY, FACE_MAX_POINTS,
                                             pts, n, &why)) != ST_OK) {
        if (why.line != 0)
            (void)errinfo_set(&c->e, st, "%s, line %u: %s", path, why.line, why.what);
        else
            (void)errinfo_set(&c->e, st, "%s, byte %zu: %s", path, why.where, why.what);
    }
    free(bytes);
    return st;
}

enum status ctl_scan_points(struct ctl *c, const char *path, struct dvec3 **pts,
                            size_t *n)
{
    const double mm = ctl_scan_unit(c);
    const enum status st = ctl_scan_parse(c, path, pts, n);

    if (st == ST_OK)
        for (size_t i = 0; i < *n; i++)
            (*pts)[i] =
                (struct dvec3){(*pts)[i].x * mm, (*pts)[i].y * mm, (*pts)[i].z * mm};
    return st;
}

enum status ctl_scan_build(struct ctl *c, const char *path, const struct dvec3 *pts,
                           size_t n, struct face_work *w, struct face *out)
{
    const struct sample sample = {
        .name = path, .pts = pts, .n = n, .unit_mm = ctl_scan_unit(c)};

    return sample_build(&sample, w, out, &c->e);
}

enum status ctl_scan_read(struct ctl *c, const char *path, struct face_work *w,
                          struct face *out)
{
    struct dvec3 *pts;
    size_t n;
    enum status st = ctl_scan_points(c, path, &pts, &n);

    if (st == ST_OK)
        st = ctl_scan_build(c, path, pts, n, w, out);
    mem_free(pts);
    return st;
}
