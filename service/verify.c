#include "verify.h"

#include <math.h>
#include <stdio.h>

#include "store.h"
#include "mem.h"
#include "replay.h"
#include "sample.h"
#include "session.h"
#include "show.h"

static double now(const struct templates_context *c)
{
    return c->clock_ms != NULL ? c->clock_ms() : 0;
}

static enum status read_templates(struct templates_context *c, struct verification *v,
                                  struct errinfo *e)
{
    const enum status st = templates_read(c, &v->request->of, &v->templates, e);

    v->refusal = v->templates.refusal;
    return st == ST_OK && v->templates.of.n == 0
               ? errinfo_set(e, ST_ENOTFOUND, "the subject has no template")
               : st;
}

/* The face of a scan. */
static enum status build_face(struct templates_context *c, struct verification *v,
                              struct session *s, struct surface_face **face,
                              struct errinfo *e)
{
    const struct sample_options o = {.stop = v->request->stop};
    const double start = now(c);
    enum status st = session_read(s, o.stop, e);
    const double parsed = now(c);

    if (st != ST_OK)
        return st;
    v->times.parse += parsed - start;
    st = session_build(s, &o, c->work, face, e);
    v->times.prepare += now(c) - parsed;
    return st;
}

static enum status build_other(struct templates_context *c, struct verification *v,
                               struct errinfo *e)
{
    struct surface_face **face = v->request->other_face;
    enum status st = build_face(c, v, v->request->other, face, e);

    if (st == ST_OK && c->store != NULL)
        st = store_calibration_refresh(c->store, c->work, &c->calibration, e);
    v->templates = (struct templates){.context = c, .of = {.n = 1}, .face = {*face}};
    return st;
}

/* Is nothing told of the templates but that none of them matches? */
static bool silent(const struct verification *v)
{
    return v->best.result.decision != SURFACE_MATCH && !v->request->scores &&
           v->request->other == NULL;
}

static enum status minimal(struct verification *v, struct errinfo *e)
{
    const struct verify_request *r = v->request;
    const enum status st = sample_not_stopped(r->stop, e);

    if (st != ST_OK || r->detail == VERIFY_DECISION || silent(v))
        return st;
    return templates_minimal(&v->templates, *r->face, &v->best, &v->least,
                             r->detail >= VERIFY_MEASURE ? &v->parts : NULL, e);
}

static enum status heatmap(struct verification *v, struct errinfo *e)
{
    const struct cloudpoints *c = session_points(v->request->probe);
    enum status st = ST_ENOMEM;

    if (v->request->detail != VERIFY_HEATMAP)
        return ST_OK;
    if ((v->gap = mem_array(c->read, sizeof *v->gap)) != NULL)
        st = status_from(surface_gaps(v->templates.face[v->best.index],
                                      (const double(*)[3])c->at, c->n,
                                      v->least.align_transform, v->gap));
    if (st != ST_OK)
        return errinfo_set(e, st, "no memory for the heatmap");
    verify_spread(c, v->gap);
    return ST_OK;
}

static enum status record(struct templates_context *c, struct verification *v,
                          struct errinfo *e)
{
    const struct verify_request *r = v->request;
    const enum surface_decision decision = v->best.result.decision;
    const struct store_limits *limits = r->of.limits;
    char outcome[STORE_NAME_MAX + 1];
    struct store_probe probe = {.read = {NULL}};
    struct store_record what = {
        .subject = &v->templates.of.subject,
        .as = limits == NULL || limits->failures == 0 ? STORE_RECORD_UNCOUNTED
              : decision == SURFACE_MATCH             ? STORE_RECORD_PASSED
                                                      : STORE_RECORD_FAILED,
        .actor = r->of.token,
        .kind = "verify",
        .template_id = r->other != NULL ? "" : v->templates.of.t[v->best.index].id,
        .outcome = outcome,
        .decision = templates_decision(decision),
        .score = v->best.result.score,
        .probe = decision == SURFACE_MATCH ? &probe : NULL,
        .limits = limits};
    struct store_scan scan;
    enum status st = sample_not_stopped(r->stop, e);

    if (st != ST_OK || r->other != NULL)
        return st;
    scan = sample_counted(*r->face);
    what.scan = &scan;
    (void)snprintf(outcome, sizeof outcome, "%s%s", templates_decision(decision),
                   r->captured != NULL ? r->captured : "");
    if ((st = replay_look(r->probe, *r->face, &v->templates, v->best.index, &probe, e)) !=
        ST_OK)
        return st;
    what.replayed = replay_is(&v->templates, &probe);
    if ((st = store_record_verification(c->store, &what, &v->recorded, e)) != ST_OK)
        return st;
    v->refusal.why = v->recorded.why;
    v->refusal.wait_ms = v->recorded.wait_ms;
    v->refusal.now = v->recorded.now;
    if (v->recorded.why != STORE_WAIT_NONE)
        return errinfo_set(e, ST_EDENIED, "the subject is locked out");
    if (v->recorded.replayed)
        return replay_refused(e);
    v->decided = true;
    return ST_OK;
}

enum status verify_run(struct templates_context *c, struct verify_request *r,
                       struct verification *v, struct errinfo *e)
{
    enum status st;

    *v = (struct verification){.request = r, .templates = {.context = c}};
    st = r->other != NULL ? build_other(c, v, e) : read_templates(c, v, e);
    if (st == ST_OK)
        st = build_face(c, v, r->probe, r->face, e);
    if (st == ST_OK)
        st = templates_nearest(&v->templates, false, *r->face, &v->best, e);
    if (st == ST_OK)
        st = minimal(v, e);
    if (st == ST_OK)
        st = heatmap(v, e);
    if (st == ST_OK)
        st = record(c, v, e);
    if (st == ST_OK)
        st = templates_judge(&v->best, e);
    v->times.score = v->best.score_ms;
    v->times.align = v->least.align_ms;
    v->times.minimal = v->least.minimal_ms;
    return st;
}

void verify_free(struct verification *v)
{
    if (v->request->other != NULL)
        v->templates.of.n = 0; /* the face is its caller's */
    templates_free(&v->templates);
    mem_free(v->gap);
    v->gap = NULL;
}

struct describe_comparison verify_describe(const struct verification *v,
                                           const char *engine)
{
    const struct verify_request *r = v->request;
    const bool stored = r->other == NULL;

    return (struct describe_comparison){
        .result = &v->best.result,
        .minimal = r->detail == VERIFY_DECISION || silent(v) ? NULL : &v->least,
        .probe = r->detail == VERIFY_DECISION ? NULL : *r->face,
        .scan = &r->probe->found,
        .frames = r->probe->files ? r->probe : NULL,
        .other = stored ? NULL : &r->other->found,
        .other_face = stored ? NULL : *r->other_face,
        .coarse = !r->scores,
        .engine = engine,
        .subject = stored ? v->templates.of.subject.id : NULL,
        .template_id = stored && !silent(v) ? v->templates.of.t[v->best.index].id : NULL,
        .templates_compared = v->best.compared,
        .times = &v->times,
        .parts = r->detail >= VERIFY_MEASURE ? &v->parts : NULL,
        .gap_mm = v->gap,
        .n = session_points(r->probe)->read};
}

enum status verify_show(const struct verification *v, struct json *j, struct show *out)
{
    return show_comparison(v->templates.face[v->best.index], *v->request->face,
                           v->least.align_transform, &v->parts, j, out);
}

void verify_spread(const struct cloudpoints *c, double *value)
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
