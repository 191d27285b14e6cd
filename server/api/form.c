#include "form.h"

#include <string.h>

#include "cloud.h"
#include "dry_run.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "logger.h"
#include "mem.h"
#include "request.h"

/* ST_OK also if the file is refused. */
static enum status read_frame(struct cloud_reading *g, const struct multipart_file *file,
                              struct session_frame *to, struct errinfo *e)
{
    enum status st;

    to->name = file->name;
    st = cloud_read_file(g, file, &to->points, e);
    if (st == ST_ELIMIT || st == ST_ESIZE || !(dry_run_is_refusal(st) || st == ST_EINVAL))
        return st;
    (void)errinfo_set(&to->why, st, "%.80s: %s", file->name, e->msg);
    return ST_OK;
}

static enum status read_frames(struct request *r, size_t most, struct form *f,
                               struct errinfo *e)
{
    struct cloud_reading g = {.r = r};
    size_t n = 0;
    enum status st;

    if (!cloud_options(r, &g.o, &g.axes_given))
        return ST_EINVAL;
    st = multipart_read(r->body, r->len, r->boundary, most, f->file, &n, e);
    for (size_t i = 0; st == ST_OK && i < n && !request_gone(r); i++) {
        f->session.n++;
        st = read_frame(&g, &f->file[i], &f->session.frame[i], e);
    }
    return st;
}

struct form *form_read(struct request *r, size_t most)
{
    const double start = logger_clock_ms();
    struct form *f = mem_array(1, sizeof *f);
    struct errinfo e = {0};
    enum status st;

    if (f == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for the files");
        return NULL;
    }
    memset(f, 0, sizeof *f);
    st = read_frames(r, most, f, &e);
    mem_free(r->body);
    r->body = NULL;
    r->len = 0;
    f->parse_ms = logger_clock_ms() - start;
    if (st == ST_OK && !request_gone(r))
        return f;
    if (st != ST_OK && r->response.http == 0 && !request_gone(r))
        request_fail(r, &e);
    form_free(f);
    return NULL;
}

void form_refuse(struct request *r, const struct form *f, const struct errinfo *e)
{
    struct json *j = errmap_problem(errmap_get(e->code), e->msg, r->id);

    session_describe(j, &f->session);
    request_refuse(r, e->code, json_compact(j));
}

void form_free(struct form *f)
{
    if (f != NULL)
        session_free(&f->session);
    mem_free(f);
}
