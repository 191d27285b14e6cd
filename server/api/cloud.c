#include "cloud.h"

#include <string.h>

#include "app.h"
#include "dry_run.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "logger.h"
#include "mem.h"
#include "params.h"
#include "parse.h"
#include "request.h"
#include "worker.h"

/* Responds with *e, unless a response is set or the client is gone. */
static bool succeeded(struct request *r, enum status st, const struct errinfo *e)
{
    if (request_gone(r))
        return false;
    if (st != ST_OK && r->response.http == 0)
        request_fail(r, e);
    return st == ST_OK;
}

static struct cloud *new_cloud(struct request *r)
{
    struct cloud *c = mem_array(1, sizeof *c);

    if (c == NULL)
        request_problem(r, ST_ENOMEM, "no memory for the files");
    else
        memset(c, 0, sizeof *c);
    return c;
}

static bool cloud_options(struct request *r, struct session *s)
{
    s->how = (struct cloudfile_options){.max_points = CLOUDFILE_POINTS,
                                        .max_bytes = r->app->max_body,
                                        .camera = CLOUDDEPTH_NO_CAMERA};
    return params_units(r, &s->how.unit_mm) && params_axes(r, &s->axes_given) &&
           params_camera(r, &s->how.camera);
}

/* The files of the form as frames. */
static enum status list_files(const struct request *r, size_t most, struct cloud *c,
                              struct errinfo *e)
{
    struct session *s = &c->session;
    enum status st =
        multipart_read(r->body, r->len, r->boundary, most, c->file, &s->n, e);

    s->files = true;
    for (size_t i = 0; i < s->n; i++) {
        const struct multipart_file *f = &c->file[i];
        struct session_frame *to = &s->frame[i];

        to->name = f->name;
        to->bytes = r->body + (f->data - r->body);
        to->len = f->len;
        to->coding = inflate_coding(f->coding[0] != '\0' ? f->coding : NULL);
        (void)request_media(f->type, &to->format);
    }
    return st;
}

struct cloud *cloud_open(struct request *r, size_t most)
{
    struct cloud *c = new_cloud(r);
    struct errinfo e = {0};
    bool fine = c != NULL && cloud_options(r, &c->session);

    if (fine && r->media == REQUEST_FORM) {
        fine = succeeded(r, list_files(r, most, c, &e), &e);
    } else if (fine) {
        c->session.n = 1;
        c->session.frame[0] = (struct session_frame){
            .name = "points", .bytes = r->body, .len = r->len, .format = r->format};
    }
    if (!fine) {
        cloud_free(c);
        return NULL;
    }
    c->session.body = r->body;
    r->body = NULL;
    r->len = 0;
    return c;
}

bool cloud_read(struct request *r, struct cloud *c)
{
    const double start = logger_clock_ms();
    struct errinfo e = {0};
    const enum status st = session_read(&c->session, &r->gone, &e);

    if (st == ST_OK)
        request_stage(r, REQUEST_PARSE, logger_clock_ms() - start);
    return succeeded(r, st, &e);
}

bool cloud_build(struct request *r, struct cloud *c, bool enrolment, struct worker *w)
{
    const struct sample_options o = {.enrolment = enrolment, .stop = &r->gone};
    const double start = logger_clock_ms();
    struct errinfo e = {0};
    const enum status st = session_build(&c->session, &o, w->compare.work, &w->probe, &e);

    request_stage(r, REQUEST_PREPARE, logger_clock_ms() - start);
    if (st != ST_OK && !request_gone(r))
        cloud_refuse(r, c, &e);
    return st == ST_OK && !request_gone(r);
}

/* ---- two scans */

/* The files a and b of a form, in this order. */
static bool read_pair(struct request *r, struct cloud *c, struct session_frame pair[2])
{
    struct session_frame *f = c->session.frame;
    const bool swapped = c->session.n == 2 && strcmp(c->file[0].field, "b") == 0;

    if (c->session.n != 2 || strcmp(c->file[swapped].field, "a") != 0 ||
        strcmp(c->file[!swapped].field, "b") != 0) {
        request_problem(r, ST_EINVAL, "the form must have two files, named a and b");
        return false;
    }
    f[swapped].name = "a";
    f[!swapped].name = "b";
    if (!cloud_read(r, c))
        return false;
    pair[0] = f[swapped];
    pair[1] = f[!swapped];
    c->session.n = 0; /* the points are the pair's */
    return succeeded(r, pair[0].why.code, &pair[0].why) &&
           succeeded(r, pair[1].why.code, &pair[1].why);
}

/* The members a and b of a JSON document. */
static bool parse_pair(struct request *r, struct cloud *c, struct session_frame pair[2])
{
    struct session *s = &c->session;
    struct cloudpoints *a = &pair[0].points, *b = &pair[1].points;
    const double start = logger_clock_ms();
    struct errinfo e = {0};
    const enum status st =
        parse_clouds((const char *)s->frame[0].bytes, s->frame[0].len, &s->how, a, b, &e);

    if (st == ST_OK)
        request_stage(r, REQUEST_PARSE, logger_clock_ms() - start);
    a->axes_given = a->axes_given || s->axes_given;
    b->axes_given = b->axes_given || s->axes_given;
    return succeeded(r, st, &e);
}

bool cloud_open_two(struct request *r, struct cloud **a, struct cloud **b)
{
    static const char *const name[2] = {"a.points", "b.points"};
    const bool form = r->media == REQUEST_FORM;
    struct session_frame pair[2] = {{.name = NULL}};
    struct cloud **out[2] = {a, b};
    struct cloud *c = cloud_open(r, 2);
    bool fine = c != NULL && (form ? read_pair(r, c, pair) : parse_pair(r, c, pair));

    cloud_free(c);
    for (int i = 0; i < 2; i++) {
        fine = (*out[i] = fine ? new_cloud(r) : NULL) != NULL;
        if (!fine) {
            cloudpoints_free(&pair[i].points);
            continue;
        }
        pair[i].name = name[i];
        (*out[i])->session.frame[0] = pair[i];
        (*out[i])->session.n = 1;
    }
    return fine;
}

/* ---- */

void cloud_refuse(struct request *r, const struct cloud *c, const struct errinfo *e)
{
    struct json *j;

    if (!c->session.files) {
        request_fail(r, e);
        return;
    }
    j = errmap_problem(errmap_get(e->code), e->msg, r->id);
    session_describe(j, &c->session);
    request_refuse(r, e->code, json_compact(j));
}

void cloud_free(struct cloud *c)
{
    if (c != NULL)
        session_free(&c->session);
    mem_free(c);
}
