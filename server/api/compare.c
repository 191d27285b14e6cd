#include "routes.h"

#include "access.h"
#include "app.h"
#include "auth.h"
#include "capture.h"
#include "cloud.h"
#include "dry_run.h"
#include "json.h"
#include "logger.h"
#include "outcome.h"
#include "pairs.h"
#include "params.h"
#include "request.h"
#include "show.h"
#include "verify.h"
#include "worker.h"

/* With the enrolled surface it is recorded like an export. */
static void surfaces(struct request *r, const struct worker *w,
                     const struct verification *v, const struct describe_comparison *c,
                     struct json *j)
{
    struct show show;

    json_object(j, "extras");
    describe_comparison(j, c);
    json_object(j, "calibration");
    show_calibration(j, surface_work_calibration(w->compare.work));
    json_close(j);
    json_close(j);
    (void)verify_show(v, j, &show);
    request_bytes(r, "model/gltf-binary", show.glb, show.len);
    if (c->subject != NULL && r->response.http == 200)
        access_event(r, "surface", "sent");
}

static void compare_respond(struct request *r, struct worker *w, struct verification *v)
{
    const enum verify_detail detail = v->request->detail;
    struct describe_comparison c;
    struct json *j = json_new();

    v->times.total = logger_clock_ms() - r->start_ms;
    c = verify_describe(v, store_made_by(r->app->store));
    if (detail == VERIFY_SURFACE) {
        surfaces(r, w, v, &c, j);
        return;
    }
    describe_comparison(j, &c);
    request_respond(r, 200, json_compact(j));
    r->response.minimal = detail == VERIFY_DECISION && r->response.http == 200;
}

static void compare_refuse_verification(struct request *r, const struct verification *v,
                                        const struct cloud *probe,
                                        const struct errinfo *e)
{
    const bool scan =
        dry_run_is_refusal(e->code) || e->code == ST_EPEOPLE || e->code == ST_EINVAL;

    if (scan && v->best.compared == 0)
        cloud_refuse(r, probe, e);
    else
        outcome_refuse(r, &v->refusal, e);
}

static void compare_run(struct request *r, struct worker *w, struct verify_request *ask,
                        struct cloud *probe, struct cloud *other)
{
    struct verification v;
    struct errinfo e = {0};
    enum status st;

    ask->probe = &probe->session;
    ask->face = &w->probe;
    ask->other = other != NULL ? &other->session : NULL;
    ask->other_face = &w->other;
    ask->captured = r->capture.captured;
    ask->stop = &r->gone;
    ask->scores = auth_scores(r);
    st = verify_run(&w->compare, ask, &v, &e);
    outcome_verified(r, &v, st);
    if (st == ST_OK)
        compare_respond(r, w, &v);
    else if (!request_gone(r))
        compare_refuse_verification(r, &v, probe, &e);
    verify_free(&v);
}

/* One of subject and template_id is NULL.  The frames of a form are one probe, and one attempt. */
static void compare_verify(struct request *r, struct worker *w, const char *subject,
                           const char *template_id)
{
    struct verify_request ask = {.of = {.subject = subject,
                                        .template_id = template_id,
                                        .token = r->actor,
                                        .limits = &r->app->limits}};
    struct cloud *probe;

    r->result.kind = "verify";
    if (!params_detail(r, STORE_SCOPE_DETAIL, &ask.detail) ||
        (probe = cloud_open(r, MULTIPART_FRAMES_MAX)) == NULL)
        return;
    if (capture_admit(r))
        compare_run(r, w, &ask, probe, NULL);
    cloud_free(probe);
}

void compare_subject(struct request *r, struct worker *w)
{
    compare_verify(r, w, r->subject, NULL);
}

void compare_template(struct request *r, struct worker *w)
{
    compare_verify(r, w, NULL, r->template_id);
}

void compare_scans(struct request *r, struct worker *w)
{
    struct verify_request ask = {0};
    struct cloud *a, *b;

    if (!params_detail(r, STORE_SCOPE_VERIFY, &ask.detail) || !capture_admit(r))
        return;
    if (cloud_open_two(r, &a, &b))
        compare_run(r, w, &ask, b, a);
    cloud_free(a);
    cloud_free(b);
}

/* Without scores the comparisons tell what an enrolment tells: whether a template fits. */
void compare_templates(struct request *r, struct worker *w)
{
    struct errinfo e = {0};
    struct pairs p;

    if (pairs_run(&w->compare, r->subject, r->actor, &r->gone, &p, &e) == ST_OK) {
        struct json *j = json_new();

        pairs_describe(j, &p, auth_scores(r), store_made_by(r->app->store));
        request_respond(r, 200, json_compact(j));
        if (r->response.http == 200)
            access_event(r, "compare_templates", "sent");
    } else if (!request_gone(r)) {
        request_fail(r, &e);
    }
    pairs_free(&p);
}
