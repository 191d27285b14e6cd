#include "compare.h"

#include <math.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "capture.h"
#include "cloud.h"
#include "dry_run.h"
#include "errmap.h"
#include "json.h"
#include "access.h"
#include "logger.h"
#include "metrics.h"
#include "params.h"
#include "request.h"
#include "show.h"
#include "verify.h"
#include "worker.h"

/* ---- refusals */

static void refuse_attempt(struct request *r, const struct templates_refusal *why)
{
    switch (why->why) {
    case STORE_WAIT_OWN:
        request_problem(
            r, ERRMAP_ATTEMPTS,
            "the subject's last %u verifications failed: it is locked out for now",
            why->now.failures);
        break;
    case STORE_WAIT_OTHERS:
        request_problem(r, ERRMAP_ATTEMPTS,
                        "%u verifications of the subject by this or other tokens failed: "
                        "it is locked out for now",
                        why->now.failures + why->now.others);
        break;
    default:
        request_problem(r, ERRMAP_SUBJECTS,
                        "this token has tried %u other subjects without a match within "
                        "an hour: it has to wait before it tries one more",
                        why->now.tried);
    }
    r->response.retry_after = (unsigned)((why->wait_ms + 999) / 1000);
    metrics_attempts(r->app->metrics, (enum metrics_failed)(why->why - STORE_WAIT_OWN));
}

void compare_refuse(struct request *r, const struct templates_refusal *why,
                    const struct errinfo *e)
{
    if (why->why != STORE_WAIT_NONE)
        refuse_attempt(r, why);
    else if (why->admit != TEMPLATES_ADMITTED)
        request_problem(
            r, why->admit == TEMPLATES_DISABLED ? ERRMAP_DISABLED : ERRMAP_EXPIRED, "%s",
            e->msg);
    else
        request_fail(r, e);
}

void compare_warn(const struct request *r, unsigned warnings)
{
    static const char *const what[STORE_WARNINGS] = {
        "a subject is locked out: verifications failed",
        "a token has tried many subjects without a match",
        "a subject's verifications fail again and again between matches"};
    struct logger_line l;

    for (unsigned i = 0; i < STORE_WARNINGS; i++)
        if ((warnings & 1U << i) != 0) {
            metrics_warning(r->app->metrics, (enum metrics_warning)i);
            logger_begin(&l, "warn", what[i]);
            logger_text(&l, "request_id", r->id);
            logger_text(&l, "token", r->actor);
            logger_end(&l);
        }
}

/* ---- requests */

static void count_stages(struct request *r, const struct verification *v)
{
    const struct describe_times *t = &v->times;

    if (t->parse > 0)
        request_stage(r, REQUEST_PARSE, t->parse);
    if (t->prepare > 0)
        request_stage(r, REQUEST_PREPARE, t->prepare);
    if (v->best.compared == 0)
        return;
    request_stage(r, REQUEST_SCORE, t->score);
    if (t->minimal > 0) {
        request_stage(r, REQUEST_ALIGN, t->align);
        request_stage(r, REQUEST_MINIMAL, t->minimal);
    }
}

/* There is no subject to protect: where the event is lost the response stands. */
static void record_comparison(struct request *r, enum surface_decision decision)
{
    char outcome[CAPTURE_OUTCOME];

    access_event(r, "compare", capture_outcome(r, templates_decision(decision), outcome));
}

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

static void note(struct request *r, const struct verification *v)
{
    const struct surface_comparison *result = &v->best.result;

    r->result = (struct request_result){.kind = "verify",
                                        .outcome = templates_decision(result->decision),
                                        .scored = true,
                                        .score = result->score,
                                        .threshold = result->threshold,
                                        .overlap = result->overlap};
    memcpy(r->subject, v->templates.of.subject.id, sizeof r->subject);
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
        compare_refuse(r, &v->refusal, e);
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
    count_stages(r, &v);
    worker_passed_over(&v.templates);
    compare_warn(r, v.recorded.warnings);
    if (v.decided || (st == ST_OK && other != NULL))
        metrics_decision(r->app->metrics, v.best.result.decision);
    if (v.decided)
        note(r, &v);
    if (st == ST_OK && other != NULL)
        record_comparison(r, v.best.result.decision);
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
