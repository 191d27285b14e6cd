#include "cloud.h"

#include <stdlib.h>

#include "cloudfile.h"
#include "errinfo.h"
#include "errmap.h"
#include "face.h"
#include "parse.h"
#include "lattice.h"
#include "mem.h"
#include "params.h"
#include "request.h"

void cloud_free(struct cloud *c)
{
    mem_free(c->pts);
    *c = (struct cloud){0};
}

static void to_mm(const struct cloud *c, double mm)
{
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
        *out = (struct cloud){c.pts, c.n};
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
    *a = (struct cloud){ja.pts, ja.n};
    *b = (struct cloud){jb.pts, jb.n};
    to_mm(a, ja.has_units ? ja.mm : mm);
    to_mm(b, jb.has_units ? jb.mm : mm);
    return ST_OK;
}

enum status cloud_build(struct request *r, const struct cloud *c, const char *name,
                        struct face_work *w, struct face *out)
{
    size_t bad = 0;
    enum status st = face_build(c->pts, c->n, w, out, &bad);

    switch (st) {
    case ST_OK:
        break;
    case ST_ETOOFEW:
        request_problem(r, st, "%s has fewer than %d usable points (%zu were sent)", name,
                        FACE_MIN_POINTS, c->n);
        break;
    case ST_ENOTFINITE:
        request_problem(r, st, "%s[%zu] is not three finite numbers", name, bad);
        break;
    case ST_ERANGE:
        request_problem(r, st, "%s[%zu] has a coordinate beyond %.0f mm", name, bad,
                        LATTICE_MAX / LATTICE_PER_MM);
        break;
    case ST_EDEGENERATE:
        request_problem(r, st, "%s: all on one line, or no area", name);
        break;
    case ST_EUNITS:
        request_problem(r, st, "%s: the extent is outside 60-500 mm; is the unit right?",
                        name);
        break;
    case ST_ENOTFACE:
        request_problem(r, st, "%s: the surface does not have the shape of a face", name);
        break;
    case ST_EQUALITY:
        request_problem(r, st, "%s: too sparse, too noisy or too many holes", name);
        break;
    default:
        request_problem(r, st, "%s: %s", name, status_message(st));
    }
    return st;
}
