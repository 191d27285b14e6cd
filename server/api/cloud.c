#include "cloud.h"

#include "app.h"
#include "cloudfile.h"
#include "errinfo.h"
#include "mem.h"
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
static enum status fail(struct request *r, enum status st, const struct errinfo *e)
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

    return fail(r, cloud_take(r, out, &e), &e);
}

enum status cloud_read_two(struct request *r, struct cloudpoints *a,
                           struct cloudpoints *b)
{
    struct cloudfile_options o;
    struct errinfo e = {0};
    bool axes_given;
    enum status st;

    *a = *b = (struct cloudpoints){0};
    if (request_gone(r) || !cloud_options(r, &o, &axes_given))
        return ST_EINVAL;
    st = parse_clouds((const char *)r->body, r->len, &o, a, b, &e);
    a->axes_given = a->axes_given || axes_given;
    b->axes_given = b->axes_given || axes_given;
    return fail(r, done(r, st, &e), &e);
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
    return request_gone(r) ? ST_EBUSY : fail(r, st, &e);
}
