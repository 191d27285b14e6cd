#include "enrolment.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "describe.h"
#include "dry_run.h"
#include "identify.h"
#include "json.h"
#include "sample.h"
#include "store.h"

#define ANYWAY "; to enroll it anyway use force (scope manage)"

/* with_first: with the first of several, else with the templates that a sample has to fit. */
static enum status does_not_fit(const struct surface_comparison *r, bool with_first,
                                struct errinfo *e)
{
    if (r->decision == SURFACE_INCONCLUSIVE)
        return errinfo_set(
            e, ST_EMISMATCH,
            "the sample has too little in common with %s for a decision" ANYWAY,
            with_first ? "the first accepted sample"
                       : "the subject's oldest template and with each that was enrolled "
                         "with scope manage");
    return errinfo_set(
        e, ST_EMISMATCH, "the sample does not fit: it %s" ANYWAY,
        with_first ? "does not match the first accepted sample"
                   : "matches neither the subject's oldest template nor one that was "
                     "enrolled with scope manage");
}

static enum status mismatch(const struct templates_nearest *n, struct errinfo *e)
{
    if (templates_judge(n, e) != ST_OK)
        return e->code = ST_EMISMATCH;
    return does_not_fit(&n->result, false, e);
}

/* One enrolment under way. */
struct enrolling {
    struct templates_context *c;
    const struct enrolment *x;
    struct enrolment_result *each;
    struct enrolment_outcome *out;
    struct templates is; /* the subject's templates */
    bool read;           /* they are those of now, and no attempt has failed since */
    size_t first;        /* the first sample that may become a template */
    const char *newest;  /* the last of them, "": none */
    double first_score[ENROLMENT_SAMPLES];
};

/* Not reported before it is counted and recorded: there would be no limit. */
static enum status record(struct enrolling *g, struct errinfo *e)
{
    const struct templates *a = &g->is;
    const struct enrolment *x = g->x;
    const struct templates_nearest *n = &g->out->nearest;
    char outcome[STORE_NAME_MAX + 1];
    struct store_recorded out;
    const struct store_record what = {.subject = &a->of.subject,
                                      .as = x->limits != NULL ? STORE_RECORD_FAILED
                                                              : STORE_RECORD_UNCOUNTED,
                                      .actor = x->actor,
                                      .kind = "enroll_mismatch",
                                      .template_id = a->of.t[n->index].id,
                                      .outcome = outcome,
                                      .limits = x->limits};
    enum status st;

    (void)snprintf(outcome, sizeof outcome, "%s%s",
                   templates_decision(n->result.decision),
                   x->captured != NULL ? x->captured : "");
    g->read = false;
    if ((st = store_record_verification(g->c->store, &what, &out, e)) != ST_OK)
        return st;
    g->out->warnings |= out.warnings;
    if (out.why == STORE_WAIT_NONE)
        return mismatch(n, e);
    g->out->refusal = (struct templates_refusal){
        .why = out.why, .wait_ms = out.wait_ms, .now = out.now};
    return errinfo_set(e, ST_EDENIED, "the subject is locked out");
}

enum status enrolment_begin(struct templates_context *c, const struct enrolment *x,
                            struct templates *begun, struct errinfo *e)
{
    const struct templates_of what = {
        .subject = x->subject, .token = x->actor, .limits = x->force ? NULL : x->limits};
    const enum status st = templates_read(c, &what, begun, e);

    return st == ST_ENOTFOUND ? ST_OK : st; /* it is made with its first template */
}

/* g->is; n = 0: the subject is not there, or has no template. */
static enum status need_templates(struct enrolling *g, struct errinfo *e)
{
    enum status st = ST_OK;

    if (!g->read) {
        templates_free(&g->is);
        st = enrolment_begin(g->c, g->x, &g->is, e);
        g->out->refusal = g->is.refusal;
        g->read = st == ST_OK;
    }
    return st;
}

/* The sample against what it has to fit.  out->compared is 0 where there is nothing, and where it is
 * enrolled by force and there is nothing of this engine. */
static enum status compare_for_fit(struct enrolling *g, size_t i,
                                   struct templates_nearest *out, struct errinfo *e)
{
    struct templates *a = &g->is;
    enum status st = ST_OK;

    *out = (struct templates_nearest){.result = {0}};
    if (a->of.n > 0)
        st = templates_nearest(a, true, g->x->sample[i].face, out, e);
    if (st == ST_EVERSION && g->x->force)
        st = ST_OK;
    g->first_score[i] = out->first_score;
    return st;
}

static enum status check_fit(struct enrolling *g, size_t i, struct errinfo *e)
{
    struct templates_nearest *n = &g->out->nearest;
    enum status st = need_templates(g, e);

    if (st != ST_OK)
        return st;
    g->newest = g->is.of.n > 0 ? g->is.of.t[g->is.of.n - 1].id : "";
    if ((st = compare_for_fit(g, i, n, e)) != ST_OK || g->x->force || n->compared == 0 ||
        n->result.decision == SURFACE_MATCH)
        return st;
    return record(g, e);
}

/* From g->first on, the first sample that may become a template. */
static enum status find_first(struct enrolling *g, struct errinfo *e)
{
    for (; g->first < g->x->n; ++g->first) {
        struct enrolment_result *r = &g->each[g->first];
        enum status st;

        if (g->x->sample[g->first].face == NULL)
            continue;
        r->why.code = st = check_fit(g, g->first, e);
        if (st != ST_EMISMATCH)
            return st;
        r->why = *e;
    }
    g->out->none = true;
    *e = g->each[0].why;
    return e->code;
}

/* Sample i behind the first.  oldest: the first is the subject's oldest template to be. */
static enum status compare_with_first(struct enrolling *g, size_t i, bool oldest,
                                      struct surface_comparison *r, struct errinfo *e)
{
    const struct enrolment *x = g->x;
    const enum status st = status_from(
        surface_compare(g->c->work, x->sample[g->first].face, x->sample[i].face, r));

    if (st != ST_OK)
        return errinfo_set(e, st, "comparing: %s", status_message(st));
    if (oldest)
        g->first_score[i] = r->score;
    return ST_OK;
}

/* Against the subject's templates, where they are what a sample has to fit. */
static enum status fit_templates(struct enrolling *g, size_t i, struct errinfo *e)
{
    struct templates_nearest *n = &g->out->nearest;
    enum status st = compare_for_fit(g, i, n, e);

    if (st != ST_OK || n->compared == 0 || n->result.decision == SURFACE_MATCH)
        return st;
    if ((st = record(g, e)) != ST_EMISMATCH)
        return st;
    g->each[i].why = *e;
    return ST_OK;
}

/* One that does not match the first is recorded; it is no attempt at the subject. */
static enum status unlike_first(struct enrolling *g, size_t i,
                                const struct surface_comparison *r, struct errinfo *e)
{
    const struct store_snapshot *of = &g->is.of;
    char outcome[STORE_NAME_MAX + 1];
    struct store_recorded out;
    const struct store_record what = {.subject = &of->subject,
                                      .as = STORE_RECORD_UNCOUNTED,
                                      .actor = g->x->actor,
                                      .kind = "enroll_mismatch",
                                      .template_id = "",
                                      .outcome = outcome};

    (void)does_not_fit(r, true, &g->each[i].why);
    (void)snprintf(outcome, sizeof outcome, "%s, first sample",
                   templates_decision(r->decision));
    return of->n == 0 ? ST_OK : store_record_verification(g->c->store, &what, &out, e);
}

/* It has to match the first one, too: that says nothing of the subject, so that a scan that matches
 * does not allow to try others, uncounted. */
static enum status fit_other(struct enrolling *g, size_t i, struct errinfo *e)
{
    const bool none = g->is.of.n == 0;
    struct surface_comparison r = {0};
    enum status st;

    g->each[i].why = (struct errinfo){.code = ST_OK};
    if (g->x->force && !none) {
        struct templates_nearest n;

        return compare_for_fit(g, i, &n, e);
    }
    if ((st = compare_with_first(g, i, none, &r, e)) != ST_OK || g->x->force)
        return st;
    if (r.decision != SURFACE_MATCH)
        return unlike_first(g, i, &r, e);
    return none || g->x->manager ? ST_OK : fit_templates(g, i, e);
}

static enum status fit_others(struct enrolling *g, struct errinfo *e)
{
    enum status st = ST_OK;

    if (g->first + 1 < g->x->n && g->is.of.n == 0)
        st = store_calibration_refresh(g->c->store, g->c->work, &g->c->calibration, e);
    for (size_t i = g->first + 1; st == ST_OK && i < g->x->n; i++)
        if (g->x->sample[i].face != NULL)
            st = fit_other(g, i, e);
    return st;
}

/* Is there another subject with the face of sample i? */
static enum status look_for_twin(struct enrolling *g, size_t i, uint64_t *seq,
                                 struct errinfo *e)
{
    const struct enrolment *x = g->x;
    struct surface_face *face = (struct surface_face *)(uintptr_t)x->sample[i].face;
    struct identify_request r = {
        .actor = x->actor, .group = "", .face = &face, .captured = x->captured};
    struct identification is;
    enum status st = identify_sample(g->c, x->gallery, &r, &is, e);

    if (st == ST_OK) {
        g->out->is_searched = true;
        g->out->searched = is.decision;
    }
    if (st == ST_OK && is.decision == SURFACE_MATCH) {
        memcpy(g->out->twin, is.templates.of.subject.id, sizeof g->out->twin);
        st = errinfo_set(e, ST_EEXISTS,
                         "this face is enrolled already, as another subject");
    }
    if (*seq == 0) /* later searches may see more */
        *seq = is.seq;
    identify_free(&is);
    return st;
}

/* Before a subject's first template. */
static enum status need_unique(struct enrolling *g, uint64_t *seq, struct errinfo *e)
{
    enum status st = ST_OK;

    for (size_t i = 0;
         g->x->gallery != NULL && g->is.of.n == 0 && st == ST_OK && i < g->x->n; i++)
        if (g->each[i].why.code == ST_OK)
            st = look_for_twin(g, i, seq, e);
    return st;
}

static enum status store_fitting(struct enrolling *g, struct errinfo *e)
{
    const struct enrolment *x = g->x;
    unsigned char descriptor[ENROLMENT_SAMPLES][SURFACE_DESCRIPTOR];
    struct store_sample sample[ENROLMENT_SAMPLES];
    struct store_template t[ENROLMENT_SAMPLES];
    bool created[ENROLMENT_SAMPLES];
    struct store_enroll what = {.actor = x->actor,
                                .subject = x->subject,
                                .label = x->label,
                                .sample = sample,
                                .newest = x->force ? NULL : g->newest,
                                .manager = x->manager,
                                .groups = x->groups,
                                .captured = x->captured};
    enum status st = ST_OK;

    for (size_t i = 0; i < x->n; i++)
        if (g->each[i].why.code == ST_OK) {
            sample[what.n] = x->sample[i];
            sample[what.n].first_score = g->first_score[i];
            sample[what.n].descriptor = descriptor[what.n];
            if (surface_describe(g->c->work, x->sample[i].face, descriptor[what.n++]) ==
                SURFACE_ENOMEM)
                return errinfo_memory(e);
        }
    if ((st = need_unique(g, &what.seq, e)) == ST_OK)
        st = store_enroll(g->c->store, &what, t, created, e);
    for (size_t i = 0, k = 0; st == ST_OK && i < x->n; i++)
        if (g->each[i].why.code == ST_OK) {
            g->each[i].tmpl = t[k];
            g->each[i].created = created[k++];
        }
    sodium_memzero(descriptor, sizeof descriptor);
    return st;
}

enum status enrolment_add(struct templates_context *c, const struct enrolment *x,
                          struct templates *begun, struct enrolment_result *each,
                          struct enrolment_outcome *out, struct errinfo *e)
{
    struct enrolling g = {.c = c, .x = x, .each = each, .out = out, .is = {.context = c}};
    enum status st;

    *out = (struct enrolment_outcome){0};
    if (begun != NULL) {
        g.is = *begun;
        *begun = (struct templates){.context = c};
        g.read = true;
    }
    do {
        if ((st = find_first(&g, e)) == ST_OK && (st = fit_others(&g, e)) == ST_OK)
            st = store_fitting(&g, e);
        g.read = false;
    } while (st == ST_ECHANGED); /* another enrolment came in between */
    templates_free(&g.is);
    return st;
}

const char *enrolment_code(enum status st)
{
    return st == ST_EMISMATCH ? "sample_mismatch" : status_refusal(st);
}

void enrolment_describe(struct json *j, const char *file,
                        const struct enrolment_result *x,
                        const struct sample_found *found, const struct surface_face *face)
{
    const bool taken = x->why.code == ST_OK;

    json_text(j, "file", file);
    json_text(j, "template_id", taken ? x->tmpl.id : NULL);
    json_flag(j, "new", x->created);
    if (found->points_read > 0)
        describe_scan(j, "scan", found);
    else
        json_text(j, "scan", NULL);
    if (taken) {
        describe_quality(j, "quality", &x->tmpl.quality, face);
        json_text(j, "refusal", NULL);
        return;
    }
    json_text(j, "quality", NULL);
    json_object(j, "refusal");
    json_text(j, "code", enrolment_code(x->why.code));
    json_text(j, "detail", x->why.msg);
    json_close(j);
}
