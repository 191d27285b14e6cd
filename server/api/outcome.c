#include "outcome.h"

#include <string.h>

#include "access.h"
#include "app.h"
#include "auth.h"
#include "capture.h"
#include "errinfo.h"
#include "errmap.h"
#include "logger.h"
#include "metrics.h"
#include "request.h"
#include "throttle.h"

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
    metrics_event(r->app->metrics,
                  METRICS_REFUSED_ATTEMPTS + (why->why - STORE_WAIT_OWN));
}

void outcome_refuse(struct request *r, const struct templates_refusal *why,
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

static void outcome_warn(const struct request *r, unsigned warnings)
{
    static const char *const what[STORE_WARNINGS] = {
        "a subject is locked out: verifications failed",
        "a token has tried many subjects without a match",
        "a subject's verifications fail again and again between matches"};
    struct logger_line l;

    for (unsigned i = 0; i < STORE_WARNINGS; i++)
        if ((warnings & 1U << i) != 0) {
            metrics_event(r->app->metrics, METRICS_WARNINGS + i);
            logger_begin(&l, "warn", what[i]);
            logger_text(&l, "request_id", r->id);
            logger_text(&l, "token", r->actor);
            logger_end(&l);
        }
}

/* ---- verifications */

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

void outcome_verified(struct request *r, const struct verification *v, enum status st)
{
    const bool compared = st == ST_OK && v->request->other != NULL;
    const enum surface_decision decision = v->best.result.decision;
    char outcome[CAPTURE_OUTCOME];

    count_stages(r, v);
    if (v->templates.passed_over.code != ST_OK)
        logger_line("warn", "template skipped", "fault", v->templates.passed_over.msg);
    outcome_warn(r, v->recorded.warnings);
    if (v->decided || compared)
        metrics_decision(r->app->metrics, decision, v->best.result.score);
    if (v->decided)
        note(r, v);
    if (compared)
        access_event(r, "compare",
                     capture_outcome(r, templates_decision(decision), outcome));
}

/* ---- identifications */

/* A search without a match counts against the token's allowance. */
static void outcome_searched(struct request *r, enum surface_decision decision)
{
    if (decision != SURFACE_MATCH)
        throttle_note(r->app->searches, request_sender(r), "", false, logger_clock_ms());
    metrics_event(r->app->metrics, METRICS_IDENTIFIED + decision);
}

/* Who it is learns a client that may identify, and read. */
static void refuse_twin(struct request *r, const char *twin, const struct errinfo *e)
{
    r->result.outcome = "already_enrolled";
    if (auth_has(r, STORE_SCOPE_IDENTIFY) && auth_has(r, STORE_SCOPE_READ))
        request_problem(r, ERRMAP_TWIN, "%s: %s", e->msg, twin);
    else
        request_problem(r, ERRMAP_TWIN, "%s", e->msg);
}

void outcome_identified(struct request *r, const struct identification *x)
{
    const struct describe_times *t = &x->times;
    const bool match = x->decision == SURFACE_MATCH;

    if (t->parse > 0)
        request_stage(r, REQUEST_PARSE, t->parse);
    if (t->prepare > 0)
        request_stage(r, REQUEST_PREPARE, t->prepare);
    if (t->score > 0)
        request_stage(r, REQUEST_SCORE, t->score);
    if (!x->decided)
        return;
    outcome_searched(r, x->decision);
    r->result = (struct request_result){.kind = "identify",
                                        .outcome = templates_decision(x->decision),
                                        .scored = x->compared > 0,
                                        .score = x->best.result.score,
                                        .threshold = x->best.result.threshold,
                                        .overlap = x->best.result.overlap};
    if (match)
        memcpy(r->subject, x->templates.of.subject.id, sizeof r->subject);
}

/* ---- enrolments */

static void tally(struct request *r, const struct enrolment_result *each, size_t n,
                  bool none)
{
    struct metrics *m = r->app->metrics;

    for (size_t i = 0; i < n; i++) {
        const enum status why = each[i].why.code;

        if (why == ST_OK)
            metrics_event(m, each[i].created ? METRICS_ENROLLED : METRICS_KNOWN);
        else if (why == ST_EMISMATCH)
            metrics_event(m, METRICS_MISMATCH);
        else if (i > 0 ||
                 !none) /* else it is the response's problem, and counts as that */
            metrics_refused(m, why);
    }
}

void outcome_enrolled(struct request *r, const struct enrolment_outcome *out,
                      const struct enrolment_result *each, size_t n, enum status st,
                      const struct errinfo *e)
{
    outcome_warn(r, out->warnings);
    if (out->nearest.compared > 0)
        request_stage(r, REQUEST_SCORE, out->nearest.score_ms);
    if (st == ST_OK || out->none)
        tally(r, each, n, out->none);
    if (out->is_searched)
        outcome_searched(r, out->searched);
    if (st == ST_EEXISTS && out->twin[0] != '\0')
        refuse_twin(r, out->twin, e);
    else if (st != ST_OK)
        outcome_refuse(r, &out->refusal, e);
}
