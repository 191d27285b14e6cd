#include "burst.h"

#include <stdio.h>
#include <string.h>

#include "app.h"
#include "cloud.h"
#include "cloudfile.h"
#include "describe.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "logger.h"
#include "mem.h"
#include "request.h"
#include "sample.h"
#include "dry_run.h"

_Static_assert((int)MULTIPART_FILES_MAX == (int)ENROLMENT_SAMPLES, "the same limit");

/* ST_OK also where the file is refused. */
static enum status take_file(struct cloud_reading *g, struct surface_work *w,
                             struct burst *b, size_t i, struct errinfo *e)
{
    const struct sample_options o = {.enrolment = true, .stop = &g->r->gone};
    const double start = logger_clock_ms();
    struct cloudpoints c = {0};
    double parsed;
    enum status st = cloud_read_file(g, &b->file[i], &c, e);

    request_stage(g->r, REQUEST_PARSE, (parsed = logger_clock_ms()) - start);
    if (st == ST_ELIMIT || st == ST_ESIZE)
        return st;
    if (st == ST_OK) {
        st = sample_build("points", &c, &o, w, &b->face[i], &b->found[i], e);
        request_stage(g->r, REQUEST_PREPARE, logger_clock_ms() - parsed);
    }
    cloudpoints_free(&c);
    if (st == ST_OK) {
        b->sample[i] =
            (struct store_sample){.face = b->face[i], .read = b->found[i].digest};
    } else if (dry_run_is_refusal(st) || st == ST_EINVAL) {
        b->each[i].why = *e;
        b->each[i].why.code = st;
        return ST_OK;
    }
    return st;
}

struct burst *burst_read(struct request *r, struct surface_work *w)
{
    struct cloud_reading g = {.r = r};
    struct burst *b = mem_array(1, sizeof *b);
    struct errinfo e = {0};
    enum status st;

    if (b == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for the files");
        return NULL;
    }
    memset(b, 0, sizeof *b);
    if (!cloud_options(r, &g.o, &g.axes_given)) {
        burst_free(b);
        return NULL;
    }
    st = multipart_read(r->body, r->len, r->boundary, MULTIPART_FILES_MAX, b->file, &b->n,
                        &e);
    for (size_t i = 0; st == ST_OK && i < b->n && !request_gone(r); i++)
        st = take_file(&g, w, b, i, &e);
    if (request_gone(r) || st != ST_OK) {
        if (st != ST_OK && !request_gone(r))
            request_fail(r, &e);
        burst_free(b);
        return NULL;
    }
    return b;
}

/* Ends j. */
static char *burst_list(struct json *j, const struct burst *b)
{
    json_array(j, "templates");
    for (size_t i = 0; i < b->n; i++) {
        json_object(j, NULL);
        describe_enrolled(j, b->file[i].name, &b->each[i], &b->found[i], b->face[i]);
        json_close(j);
    }
    return json_compact(j);
}

/* Whole, whatever the client prefers: else it would not know which files were refused. */
void burst_respond(struct request *r, const struct burst *b)
{
    const char *first = NULL;
    struct json *j = json_new();
    bool created = false;

    for (size_t i = b->n; i-- > 0;)
        if (b->each[i].why.code == ST_OK) {
            first = b->each[i].tmpl.id;
            created = created || b->each[i].created;
        }
    json_text(j, "subject", r->subject);
    request_respond(r, created ? 201 : 200, burst_list(j, b));
    if (first != NULL && r->response.http < 300)
        request_template(r, first);
}

void burst_refuse(struct request *r, const struct burst *b)
{
    const struct errinfo *why = &b->each[0].why;
    char detail[sizeof why->msg + 128];

    (void)snprintf(detail, sizeof detail, "none of the %zu files was enrolled; %.80s: %s",
                   b->n, b->file[0].name, why->msg);
    request_refuse(r, why->code,
                   burst_list(errmap_problem(errmap_get(why->code), detail, r->id), b));
}

void burst_free(struct burst *b)
{
    for (size_t i = 0; b != NULL && i < b->n; i++)
        surface_face_free(b->face[i]);
    mem_free(b);
}
