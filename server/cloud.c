#include "cloud.h"

#include <stdlib.h>

#include "cloudfile.h"
#include "errinfo.h"
#include "face.h"
#include "parse.h"
#include "mem.h"
#include "params.h"
#include "request.h"
#include "sample.h"

void cloud_free(struct cloud *c)
{
    mem_free(c->pts);
    *c = (struct cloud){0};
}

static void to_mm(struct cloud *c, double mm)
{
    c->unit_mm = mm;
    if (mm != 1.0) {
        for (size_t i = 0; i < c->n; i++) {
            c->pts[i].x *= mm;
            c->pts[i].y *= mm;
            c->pts[i].z *= mm;
        }
    }
}

static void drop_body(struct request *r)
{
    free(r->body);
    r->body = NULL;
    r->len = 0;
}

static enum status read_json(struct request *r, double mm, struct cloud *out,
                             struct errinfo *e)
{
    struct parse_cloud c;
    enum status st = parse_cloud((const char *)r->body, r->len, FACE_MAX_POINTS, &c, e);

    if (st == ST_OK) {
        *out = (struct cloud){.pts = c.pts, .n = c.n};
        to_mm(out, c.has_units ? c.mm : mm);
    }
    return st;
}

static enum status read_file(struct request *r, double mm, struct cloud *out,
                             struct errinfo *e)
{
    static const enum cloudfile_format format[] = {
        [REQUEST_PLY] = CLOUDFILE_PLY,
        [REQUEST_OBJ] = CLOUDFILE_OBJ,
        [REQUEST_XYZ] = CLOUDFILE_XYZ,
        [REQUEST_BYTES] = CLOUDFILE_ANY,
    };
    struct clouderror fe = {0};
    enum status st = cloudfile_parse(r->body, r->len, format[r->media], FACE_MAX_POINTS,
                                     &out->pts, &out->n, &fe);

    if (st == ST_OK)
        to_mm(out, mm);
    else if (st == ST_ENOMEM)
        (void)errinfo_set(e, st, "no memory for the points");
    else if (fe.line > 0)
        (void)errinfo_set(e, st == ST_EVERSION ? ST_EINVAL : st, "line %u: %s",
                          (unsigned)fe.line, fe.what);
    else
        (void)errinfo_set(e, st == ST_EVERSION ? ST_EINVAL : st, "byte %zu: %s", fe.where,
                          fe.what);
    return st;
}

enum status cloud_read(struct request *r, struct cloud *out)
{
    struct errinfo e = {0};
    double mm = 1.0;
    enum status st;

    *out = (struct cloud){0};
    if (!params_units(r, &mm))
        return ST_EINVAL;
    st = r->media == REQUEST_JSON ? read_json(r, mm, out, &e) : read_file(r, mm, out, &e);
    drop_body(r);
    if (st != ST_OK) {
        *out = (struct cloud){0};
        request_fail(r, &e);
    }
    return st;
}

enum status cloud_read_two(struct request *r, struct cloud *a, struct cloud *b)
{
    struct errinfo e = {0};
    struct parse_cloud ja, jb;
    double mm = 1.0;
    enum status st;

    *a = *b = (struct cloud){0};
    if (!params_units(r, &mm))
        return ST_EINVAL;
    st = parse_clouds((const char *)r->body, r->len, FACE_MAX_POINTS, &ja, &jb, &e);
    drop_body(r);
    if (st != ST_OK) {
        request_fail(r, &e);
        return st;
    }
    *a = (struct cloud){.pts = ja.pts, .n = ja.n};
    *b = (struct cloud){.pts = jb.pts, .n = jb.n};
    to_mm(a, ja.has_units ? ja.mm : mm);
    to_mm(b, jb.has_units ? jb.mm : mm);
    return ST_OK;
}

enum status cloud_build(struct request *r, const struct cloud *c, const char *name,
                        struct face_work *w, struct face *out)
{
    const struct sample sample = {
        .name = name, .pts = c->pts, .n = c->n, .unit_mm = c->unit_mm};
    struct errinfo e = {0};
    enum status st = sample_build(&sample, w, out, &e);

    if (st != ST_OK)
        request_fail(r, &e);
    return st;
}
