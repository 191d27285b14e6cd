#include "cloud.h"

#include <string.h>

#include "app.h"
#include "cloudfile.h"
#include "errinfo.h"
#include "inflate.h"
#include "mem.h"
#include "multipart.h"
#include "params.h"
#include "parse.h"
#include "request.h"
#include "sample.h"

bool cloud_options(struct request *r, struct cloudfile_options *o, bool *axes_given)
{
    *axes_given = false;
    *o = (struct cloudfile_options){.format = r->format,
                                    .max_points = CLOUDFILE_POINTS,
                                    .max_bytes = r->app->max_body,
                                    .camera = CLOUDDEPTH_NO_CAMERA};
    return params_units(r, &o->unit_mm) && params_axes(r, axes_given) &&
           params_camera(r, &o->camera);
}

/* After the reading: the body is not needed any more. */
static enum status done(struct request *r, enum status st, struct errinfo *e)
{
    mem_free(r->body);
    r->body = NULL;
    r->len = 0;
    if (st != ST_EVERSION) /* another format, or a variant of one */
        return st;
    return e->code = ST_EINVAL;
}

/* r->response is set already where a parameter is wrong. */
static enum status cloud_fail(struct request *r, enum status st, const struct errinfo *e)
{
    if (st != ST_OK && r->response.http == 0)
        request_fail(r, e);
    return st;
}

enum status cloud_take(struct request *r, struct cloudpoints *out, struct errinfo *e)
{
    struct cloudfile_options o;
    bool axes_given;
    enum status st;

    *out = (struct cloudpoints){0};
    if (request_gone(r) || !cloud_options(r, &o, &axes_given))
        return ST_EINVAL;
    st = cloudfile_read(r->body, r->len, &o, out, e);
    out->axes_given = out->axes_given || axes_given;
    return done(r, st, e);
}

enum status cloud_read(struct request *r, struct cloudpoints *out)
{
    struct errinfo e = {0};

    return cloud_fail(r, cloud_take(r, out, &e), &e);
}

/* len bytes, of which the last is followed by one that may be written. */
static enum status read_bytes(struct cloud_reading *g, unsigned char *bytes, size_t len,
                              struct cloudpoints *out, struct errinfo *e)
{
    const unsigned char behind = bytes[len];
    enum status st;

    bytes[len] = 0;
    st = cloudfile_read(bytes, len, &g->o, out, e);
    bytes[len] = behind;
    out->axes_given = out->axes_given || g->axes_given;
    g->o.max_points -= out->read;
    return st == ST_EVERSION ? ST_EINVAL : st; /* as of a file that is sent alone */
}

static enum status read_packed(struct cloud_reading *g, enum inflate_coding coding,
                               const struct multipart_file *f, struct cloudpoints *out,
                               struct errinfo *e)
{
    unsigned char *bytes;
    size_t len;
    enum status st =
        inflate_body(coding, f->data, f->len, g->o.max_bytes, &bytes, &len, e);

    g->o.max_bytes -= len;
    if (st == ST_OK)
        st = read_bytes(g, bytes, len, out, e);
    mem_free(bytes);
    return st;
}

static enum status read_file(struct cloud_reading *g, const struct multipart_file *f,
                             struct cloudpoints *out, struct errinfo *e)
{
    static const unsigned char gzip[2] = {0x1f, 0x8b};
    enum inflate_coding coding = inflate_coding(f->coding[0] != '\0' ? f->coding : NULL);

    if (coding == INFLATE_OTHER)
        return errinfo_set(e, ST_EINVAL,
                           "Content-Encoding may be gzip or zstd, one of them and once");
    if (f->len == 0)
        return errinfo_set(e, ST_EINVAL, "the file is empty");
    if (coding == INFLATE_NONE && f->len > 2 && memcmp(f->data, gzip, 2) == 0)
        coding = INFLATE_GZIP;
    (void)request_media(f->type, &g->o.format);
    if (coding != INFLATE_NONE)
        return read_packed(g, coding, f, out, e);
    return read_bytes(g, g->r->body + (f->data - g->r->body), f->len, out, e);
}

enum status cloud_read_file(struct cloud_reading *g, const struct multipart_file *f,
                            struct cloudpoints *out, struct errinfo *e)
{
    const enum status st = read_file(g, f, out, e);

    if (st == ST_ELIMIT)
        return errinfo_set(e, st, "the files together have more than %d points",
                           CLOUDFILE_POINTS);
    if (st == ST_ESIZE)
        return errinfo_set(e, st,
                           "the limit is %zu bytes of all files together when unpacked",
                           g->r->app->max_body);
    return st;
}

static enum status read_pair(struct cloud_reading *g, struct cloudpoints *a,
                             struct cloudpoints *b, struct errinfo *e)
{
    struct multipart_file f[2];
    size_t n;
    enum status st = multipart_read(g->r->body, g->r->len, g->r->boundary, 2, f, &n, e);
    const bool swapped = st == ST_OK && n == 2 && strcmp(f[0].field, "b") == 0;

    if (st == ST_OK && (n != 2 || strcmp(f[swapped].field, "a") != 0 ||
                        strcmp(f[!swapped].field, "b") != 0))
        st = errinfo_set(e, ST_EINVAL, "the form must have two files, named a and b");
    for (int i = 0; st == ST_OK && i < 2; i++) {
        st = cloud_read_file(g, &f[i ^ (int)swapped], i == 0 ? a : b, e);
        if (st != ST_OK) {
            const struct errinfo why = *e;

            st = errinfo_set(e, st, "%s: %s", i == 0 ? "a" : "b", why.msg);
        }
    }
    if (st != ST_OK) {
        cloudpoints_free(a);
        cloudpoints_free(b);
    }
    return st;
}

enum status cloud_read_two(struct request *r, struct cloudpoints *a,
                           struct cloudpoints *b)
{
    struct cloud_reading g = {.r = r};
    struct errinfo e = {0};
    enum status st;

    *a = *b = (struct cloudpoints){0};
    if (request_gone(r) || !cloud_options(r, &g.o, &g.axes_given))
        return ST_EINVAL;
    st = r->media == REQUEST_FORM
             ? read_pair(&g, a, b, &e)
             : parse_clouds((const char *)r->body, r->len, &g.o, a, b, &e);
    a->axes_given = a->axes_given || g.axes_given;
    b->axes_given = b->axes_given || g.axes_given;
    return cloud_fail(r, done(r, st, &e), &e);
}

enum status cloud_build(struct request *r, struct cloudpoints *c, const char *name,
                        bool enrolment, struct surface_work *w, struct surface_face **out,
                        struct sample_found *found)
{
    const struct sample_options o = {.enrolment = enrolment, .stop = &r->gone};
    struct errinfo e = {0};
    enum status st;

    if (request_gone(r))
        return ST_EBUSY;
    st = sample_build(name, c, &o, w, out, found, &e);
    return request_gone(r) ? ST_EBUSY : cloud_fail(r, st, &e);
}
