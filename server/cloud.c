#include "cloud.h"

#include <math.h>
#include <stdlib.h>

#include "app.h"
#include "cloudfile.h"
#include "errinfo.h"
#include "face.h"
#include "params.h"
#include "parse.h"
#include "request.h"
#include "sample.h"

/* By the request's parameters.  False: r->response says what is wrong with them. */
static bool take_options(struct request *r, struct cloudfile_options *o)
{
    *o = (struct cloudfile_options){.format = r->format,
                                    .max_points = FACE_MAX_POINTS,
                                    .max_bytes = r->app->max_body,
                                    .camera = CLOUDDEPTH_NO_CAMERA};
    return params_units(r, &o->unit_mm) && params_camera(r, &o->camera);
}

/* After the reading: the body is not needed any more. */
static enum status settle(struct request *r, enum status st, struct errinfo *e)
{
    free(r->body);
    r->body = NULL;
    r->len = 0;
    if (st == ST_EVERSION) /* another format, or a variant of one */
        e->code = ST_EINVAL;
    if (st != ST_OK)
        request_fail(r, e);
    return st;
}

enum status cloud_read(struct request *r, struct cloudpoints *out)
{
    struct cloudfile_options o;
    struct errinfo e = {0};
    enum status st;

    *out = (struct cloudpoints){0};
    if (!take_options(r, &o))
        return ST_EINVAL;
    st = cloudfile_read(r->body, r->len, &o, out, &e);
    return settle(r, st, &e);
}

enum status cloud_read_two(struct request *r, struct cloudpoints *a,
                           struct cloudpoints *b)
{
    struct cloudfile_options o;
    struct errinfo e = {0};
    enum status st;

    *a = *b = (struct cloudpoints){0};
    if (!take_options(r, &o))
        return ST_EINVAL;
    st = parse_clouds((const char *)r->body, r->len, &o, a, b, &e);
    return settle(r, st, &e);
}

enum status cloud_build(struct request *r, struct cloudpoints *c, const char *name,
                        bool enrolment, struct face_work *w, struct face *out)
{
    const struct scan_options o = {.enrolment = enrolment};
    struct scan_found found;
    struct errinfo e = {0};
    enum status st = sample_build(name, c, &o, w, out, &found, &e);

    if (st != ST_OK)
        request_fail(r, &e);
    return st;
}

void cloud_spread(const struct cloudpoints *c, double *value)
{
    size_t to = c->read;

    if (c->index == NULL)
        return;
    for (size_t i = c->n; i-- > 0;) { /* from the end: index[i] >= i */
        while (--to > c->index[i])
            value[to] = NAN;
        value[to] = value[i];
    }
    while (to > 0)
        value[--to] = NAN;
}
