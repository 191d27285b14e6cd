#include "routes.h"

#include <stdio.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "capture.h"
#include "cloud.h"
#include "dry_run.h"
#include "enrolment.h"
#include "errinfo.h"
#include "errmap.h"
#include "intake.h"
#include "json.h"
#include "describe.h"
#include "logger.h"
#include "mem.h"
#include "outcome.h"
#include "params.h"
#include "request.h"
#include "sample.h"
#include "worker.h"

/* What the request asks for, beside the samples. */
struct asked {
    char label[STORE_LABEL_MAX + 1];
    bool force, unique;     /* unique: refused if another subject has the face */
    bool fuse;              /* of several files one template */
    struct templates begun; /* of enrolment_begin() */
};

static struct enrolment enrolment_of(const struct request *r, const struct asked *ask)
{
    return (struct enrolment){.actor = r->actor,
                              .subject = r->subject,
                              .label = ask->label,
                              .captured = r->capture.captured,
                              .manager = auth_has(r, STORE_SCOPE_MANAGE),
                              .gallery = ask->unique ? r->app->gallery : NULL,
                              .force = ask->force,
                              .limits =
                                  r->app->limits.failures > 0 ? &r->app->limits : NULL};
}

/* Before the work on a scan.  False: r->response says why not. */
static bool enroll_begin(struct request *r, struct worker *w, struct asked *ask)
{
    const struct enrolment x = enrolment_of(r, ask);
    struct errinfo e = {0};

    if (!intake_admit(r))
        return false;
    if (enrolment_begin(&w->compare, &x, &ask->begun, &e) == ST_OK)
        return true;
    outcome_refuse(r, &ask->begun.refusal, &e);
    return false;
}

/* Calls enrolment_add().  Returns true if at least one sample became a template; else r->response says why
 * not. */
static bool enroll(struct request *r, struct worker *w, struct asked *ask,
                   const struct store_sample *sample, size_t n,
                   struct enrolment_result *each, struct enrolment_outcome *out)
{
    struct enrolment x = enrolment_of(r, ask);
    struct errinfo e = {0};
    enum status st;

    x.sample = sample;
    x.n = n;
    st = enrolment_add(&w->compare, &x, &ask->begun, each, out, &e);
    outcome_enrolled(r, out, each, n, st, &e);
    return st == ST_OK;
}

/* False: r->response says what is wrong with them, or that the request may not be made. */
static bool read_parameters(struct request *r, struct asked *ask)
{
    const enum status st = request_query(r, "label", ask->label, sizeof ask->label);

    ask->force = false;
    ask->unique = false;
    ask->fuse = true;
    if (st != ST_OK && st != ST_ENOTFOUND) {
        request_problem(r, ERRMAP_PARAMETER, "label is malformed or longer than %d bytes",
                        STORE_LABEL_MAX);
        return false;
    }
    return params_flag(r, "force", &ask->force) && params_flag(r, "fuse", &ask->fuse) &&
           params_flag(r, "unique", &ask->unique) &&
           (!ask->force || auth_may(r, STORE_SCOPE_MANAGE));
}

/* ---- one template */

static void enroll_one(struct request *r, struct worker *w, struct asked *ask,
                       struct cloud *c)
{
    const struct session *s = &c->session;
    struct store_sample sample = {.read = s->read};
    struct enrolment_result x = {.created = false};
    struct enrolment_outcome out;
    struct json *j;

    if (!cloud_build(r, c, true, w))
        return;
    sample.face = w->probe;
    if (!enroll(r, w, ask, &sample, 1, &x, &out))
        return;
    r->result.outcome = x.created ? "enrolled" : "known";
    j = json_new();
    describe_template(j, &x.tmpl, w->probe, auth_scores(r));
    describe_scan(j, "scan", &s->found);
    if (s->files) {
        session_describe(j, s);
        request_respond(r, x.created ? 201 : 200, json_compact(j));
    } else {
        request_written(r, x.created ? 201 : 200, json_compact(j));
    }
    if (r->response.http < 300)
        request_template(r, x.tmpl.id);
}

/* ---- a template of each file */

_Static_assert((int)MULTIPART_FILES_MAX == (int)ENROLMENT_SAMPLES, "the same limit");

struct burst {
    struct surface_face *face[ENROLMENT_SAMPLES];
    struct store_sample sample[ENROLMENT_SAMPLES]; /* of a refused file no face */
    struct enrolment_result each[ENROLMENT_SAMPLES];
};

/* False: r->response says what is wrong beside single files. */
static bool build_each(struct request *r, struct worker *w, struct cloud *c,
                       struct burst *b)
{
    const struct sample_options o = {.enrolment = true, .stop = &r->gone};
    const double start = logger_clock_ms();
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < c->session.n && !request_gone(r); i++) {
        struct session_frame *f = &c->session.frame[i];
        struct errinfo *why = &b->each[i].why;

        *why = f->why;
        if (why->code != ST_OK)
            continue;
        st = sample_build(f->name, &f->points, &o, w->compare.work, &b->face[i],
                          &f->found, why);
        if (st == ST_OK)
            b->sample[i] =
                (struct store_sample){.face = b->face[i], .read = f->found.digest};
        else if (dry_run_is_refusal(why->code = st))
            st = ST_OK;
        else
            request_fail(r, why);
    }
    request_stage(r, REQUEST_PREPARE, logger_clock_ms() - start);
    return st == ST_OK && !request_gone(r);
}

/* Ends j. */
static char *list_each(struct json *j, const struct cloud *c, const struct burst *b)
{
    json_array(j, "templates");
    for (size_t i = 0; i < c->session.n; i++) {
        const struct session_frame *f = &c->session.frame[i];

        json_object(j, NULL);
        enrolment_describe(j, f->name, &b->each[i], &f->found, b->face[i]);
        json_close(j);
    }
    return json_compact(j);
}

/* Whole, whatever the client prefers: else it would not know which files were refused. */
static void respond_each(struct request *r, const struct cloud *c, const struct burst *b)
{
    const char *first = NULL;
    struct json *j = json_new();
    bool created = false;

    for (size_t i = c->session.n; i-- > 0;)
        if (b->each[i].why.code == ST_OK) {
            first = b->each[i].tmpl.id;
            created = created || b->each[i].created;
        }
    json_text(j, "subject", r->subject);
    request_respond(r, created ? 201 : 200, list_each(j, c, b));
    if (first != NULL && r->response.http < 300)
        request_template(r, first);
}

/* No file was enrolled: the problem of the first one, with the same list. */
static void refuse_each(struct request *r, const struct cloud *c, const struct burst *b)
{
    const struct errinfo *why = &b->each[0].why;
    const bool named = why->code != ST_EMISMATCH; /* what is read and built names it */
    char detail[sizeof why->msg + 128];

    (void)snprintf(detail, sizeof detail, "none of the %zu files was enrolled; %.80s%s%s",
                   c->session.n, named ? "" : c->session.frame[0].name, named ? "" : ": ",
                   why->msg);
    request_refuse(r, why->code,
                   list_each(errmap_problem(errmap_get(why->code), detail, r->id), c, b));
}

static void enroll_each(struct request *r, struct worker *w, struct asked *ask,
                        struct cloud *c)
{
    struct burst *b = mem_array(1, sizeof *b);
    struct enrolment_outcome out;

    if (b == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for the files");
        return;
    }
    memset(b, 0, sizeof *b);
    if (build_each(r, w, c, b)) {
        r->result.outcome = "enrolled";
        if (enroll(r, w, ask, b->sample, c->session.n, b->each, &out))
            respond_each(r, c, b);
        else if (out.none)
            refuse_each(r, c, b);
    }
    for (size_t i = 0; i < ENROLMENT_SAMPLES; i++)
        surface_face_free(b->face[i]);
    mem_free(b);
}

void enroll_handle(struct request *r, struct worker *w)
{
    struct asked ask = {.begun = {.context = &w->compare}};
    struct cloud *c = NULL;

    r->result.kind = "enroll";
    if (read_parameters(r, &ask) && (!ask.unique || identify_scan_may(r)) &&
        (c = cloud_open(r, MULTIPART_FILES_MAX)) != NULL && capture_admit(r) &&
        enroll_begin(r, w, &ask) && cloud_read(r, c)) {
        if (c->session.files && !ask.fuse)
            enroll_each(r, w, &ask, c);
        else
            enroll_one(r, w, &ask, c);
    }
    templates_free(&ask.begun);
    cloud_free(c);
}
