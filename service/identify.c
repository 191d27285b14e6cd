#include "identify.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "groups.h"
#include "json.h"
#include "replay.h"
#include "sample.h"
#include "session.h"
#include "store.h"

/* Subjects that are compared beside those who are listed.  Among 100,000 people one whose score is 8 or more is
 * among the first ten of the search. */
#define IDENTIFY_ALWAYS 32

/* More that are asked for, in place of those whom the gallery should not have. */
#define IDENTIFY_SPARE 8

/* The same number is compared for every scan: the first stage leaves nobody out for a low score. */
#define IDENTIFY_FLOOR (-1e9)

static double now(const struct templates_context *c)
{
    return c->clock_ms != NULL ? c->clock_ms() : 0;
}

static enum status build_probe(struct templates_context *c, struct identification *x,
                               struct errinfo *e)
{
    const struct identify_request *r = x->request;
    const struct sample_options o = {.stop = r->stop};
    const double start = now(c);
    enum status st = session_read(r->probe, o.stop, e);
    const double parsed = now(c);

    x->times.parse = parsed - start;
    if (st == ST_OK)
        st = session_build(r->probe, &o, c->work, r->face, e);
    x->times.prepare = now(c) - parsed;
    return st;
}

/* ---- who is compared */

/* The better of x's best and t, whose comparison is n. */
static void keep_best(struct identification *x, struct templates *t,
                      const struct templates_nearest *n)
{
    if (x->compared == 0 || n->result.score > x->best.result.score) {
        const struct templates other = x->templates;

        x->templates = *t;
        x->best = *n;
        *t = other;
    }
    x->compared++;
}

/* Into the list, by falling score. */
static void list_candidate(struct identification *x, const struct templates *t,
                           const struct templates_nearest *n)
{
    size_t at = x->n;

    while (at > 0 && n->result.score > x->candidate[at - 1].result.score)
        at--;
    if (at == x->request->candidates)
        return;
    x->n += x->n < x->request->candidates;
    memmove(&x->candidate[at + 1], &x->candidate[at],
            (x->n - 1 - at) * sizeof *x->candidate);
    x->candidate[at].result = n->result;
    memcpy(x->candidate[at].subject, t->of.subject.id, sizeof x->candidate[at].subject);
    memcpy(x->candidate[at].template_id, t->of.t[n->index].id,
           sizeof x->candidate[at].template_id);
}

/* May the subject be found, whatever the gallery says? */
static bool is_admitted(const struct identify_request *r, const char *bound,
                        const struct store_subject *s)
{
    return s->identify && groups_meet(bound, s->groups) &&
           (r->group[0] == '\0' || groups_meet(r->group, s->groups));
}

/* A subject that is gone, disabled or expired in this transaction is nobody; one that is damaged, or whose
 * templates are all of another engine, is not compared. */
static enum status compare_found(struct templates_context *c, struct identification *x,
                                 struct store_people *people, const unsigned char *uid,
                                 struct errinfo *e)
{
    struct templates_nearest n;
    struct templates t;
    enum status st = sample_not_stopped(x->request->stop, e);

    if (st != ST_OK)
        return st;
    st = templates_read_found(c, people, uid, x->request->actor, &t, e);
    if (st == ST_OK &&
        is_admitted(x->request, store_people_bound(people), &t.of.subject) &&
        (st = templates_compare(&t, false, *x->request->face, &n, e)) == ST_OK) {
        list_candidate(x, &t, &n);
        keep_best(x, &t, &n);
    }
    if (st == ST_ECORRUPT || st == ST_EVERSION)
        x->skipped++;
    if (st == ST_EDENIED || st == ST_ENOTFOUND || st == ST_ECORRUPT || st == ST_EVERSION)
        st = ST_OK;
    templates_free(&t);
    return st;
}

static enum status search_people(struct templates_context *c, struct gallery *g,
                                 struct identification *x, struct store_people *people,
                                 struct errinfo *e)
{
    const struct identify_request *r = x->request;
    const uint32_t most = (uint32_t)r->candidates + IDENTIFY_ALWAYS;
    const struct gallery_search what = {.probe = *r->face,
                                        .bound = store_people_bound(people),
                                        .group = r->group,
                                        .floor = IDENTIFY_FLOOR,
                                        .most = most + IDENTIFY_SPARE};
    struct store_calibration k;
    struct gallery_found found = {.n = 0};
    const int64_t version = store_people_calibration(people, &k);
    enum status st;

    if (r->group[0] != '\0' && !groups_within(what.bound, r->group))
        return errinfo_set(e, ST_EDENIED, "the token is not bound to the group %s",
                           r->group);
    st = gallery_follow(g, people, e);

    if (version != c->calibration) {
        store_calibration_apply(c->store, k, c->work);
        c->calibration = version;
    }
    if (st == ST_OK && (st = gallery_find(g, c->work, &what, &found, e)) == ST_EINVAL) {
        x->unknown = true;
        st = ST_OK;
    }
    x->searched = found.searched;
    x->skipped = found.skipped;
    for (size_t i = 0; st == ST_OK && i < found.n && x->compared < most; i++)
        st = compare_found(c, x, people, found.uid[i], e);
    gallery_found_free(&found);
    return st;
}

/* ---- the decision */

/* The best subject's comparison decides as among so many people. */
static enum status decide(struct templates_context *c, struct identification *x,
                          struct errinfo *e)
{
    const struct surface_calibration *by = surface_work_calibration(c->work);
    const uint32_t people = x->searched < UINT32_MAX ? (uint32_t)x->searched : UINT32_MAX;
    struct surface_comparison *best = &x->best.result;
    int extrapolated = 0;
    enum status st = ST_OK;

    best->threshold = surface_search_threshold(by, people);
    x->decision = SURFACE_NO_MATCH;
    if (x->compared > 0) {
        surface_best_of(c->work, 1, best);
        st = templates_doubt(&x->templates, *x->request->face, &x->best, e);
        x->decision = best->decision;
        x->fpir = surface_search_fpir(by, people, best->score, &extrapolated);
        x->extrapolated = extrapolated != 0;
    }
    if (x->decision == SURFACE_NO_MATCH &&
        (x->skipped > 0 || (x->unknown && x->searched > 0)))
        x->decision = SURFACE_INCONCLUSIVE; /* it may be one of those */
    return st;
}

/* ---- the record */

/* "match 21.4 of 1000 door-3" */
static void print_outcome(const struct identification *x, char out[STORE_NAME_MAX + 1])
{
    const struct identify_request *r = x->request;
    char score[32] = "";

    if (x->decision == SURFACE_MATCH)
        (void)snprintf(score, sizeof score, " %.1f", x->best.result.score);
    (void)snprintf(out, STORE_NAME_MAX + 1, "%s%s of %" PRIu64 "%s%s%s%s",
                   templates_decision(x->decision), score, x->searched,
                   r->probe == NULL ? ", enroll" : "",
                   r->captured != NULL ? r->captured : "", r->group[0] != '\0' ? " " : "",
                   r->group);
}

static enum status record_match(struct templates_context *c, struct identification *x,
                                const char *outcome, const struct store_scan *scan,
                                struct errinfo *e)
{
    const struct identify_request *r = x->request;
    struct store_recorded recorded;
    struct store_probe probe;
    struct store_record what = {.subject = &x->templates.of.subject,
                                .as = STORE_RECORD_UNCOUNTED,
                                .actor = r->actor,
                                .kind = "identify",
                                .template_id = x->templates.of.t[x->best.index].id,
                                .outcome = outcome};
    enum status st;

    if (r->probe == NULL) /* an enrolment, which is refused */
        return store_record_verification(c->store, &what, &recorded, e);
    what.probe = &probe;
    what.scan = scan;
    st = replay_look(r->probe, *r->face, &x->templates, x->best.index, &probe, e);

    if (st != ST_OK)
        return st;
    what.replayed = replay_is(&x->templates, &probe);
    if ((st = store_record_verification(c->store, &what, &recorded, e)) != ST_OK)
        return st;
    return recorded.replayed ? replay_refused(e) : ST_OK;
}

/* Those who are listed are named though they may never have been there: an entry each. */
static enum status record_search(struct templates_context *c, struct identification *x,
                                 struct errinfo *e)
{
    const struct identify_request *r = x->request;
    char outcome[STORE_NAME_MAX + 1];
    struct store_scan scan;
    enum status st = sample_not_stopped(r->stop, e);

    if (st != ST_OK)
        return st;
    scan = sample_counted(*r->face);
    print_outcome(x, outcome);
    st = x->decision == SURFACE_MATCH
             ? record_match(c, x, outcome, &scan, e)
             : store_event_scan(c->store, "identify", r->actor, "", outcome,
                                r->probe != NULL ? &scan : NULL, e);
    for (size_t i = 0; st == ST_OK && i < x->n; i++) {
        const struct identify_candidate *one = &x->candidate[i];

        (void)snprintf(outcome, sizeof outcome, "%.1f of %" PRIu64, one->result.score,
                       x->searched);
        st = store_event(c->store, "candidate", r->actor, one->subject, one->template_id,
                         outcome, e);
        if (st == ST_ENOTFOUND) /* erased meanwhile */
            st = ST_OK;
    }
    x->decided = st == ST_OK;
    return st;
}

/* ST_ENOTFOUND: the best subject, or the template, was deleted after the search's transaction. */
static enum status identify_once(struct templates_context *c, struct gallery *g,
                                 struct identification *x, struct errinfo *e)
{
    struct store_people *people = NULL;
    enum status st =
        store_people_begin(c->store, x->request->actor, c->calibration, &people, e);

    if (st == ST_OK) {
        x->seq = store_people_seq(people);
        st = store_people_end(people, search_people(c, g, x, people, e), e);
    }
    if (st == ST_OK)
        st = decide(c, x, e);
    return st == ST_OK ? record_search(c, x, e) : st;
}

static enum status identify(struct templates_context *c, struct gallery *g,
                            struct identification *x, struct errinfo *e)
{
    const struct identification begun = *x;
    const double start = now(c);
    enum status st = identify_once(c, g, x, e);

    for (int tries = 0; st == ST_ENOTFOUND && tries < 3; tries++) {
        templates_free(&x->templates);
        *x = begun;
        st = identify_once(c, g, x, e);
    }
    x->times.score = now(c) - start;
    return st;
}

enum status identify_run(struct templates_context *c, struct gallery *g,
                         struct identify_request *r, struct identification *x,
                         struct errinfo *e)
{
    enum status st;

    *x = (struct identification){.request = r, .templates = {.context = c}};
    if ((st = build_probe(c, x, e)) != ST_OK || (st = identify(c, g, x, e)) != ST_OK)
        return st;
    return templates_judge(&x->best, e);
}

enum status identify_sample(struct templates_context *c, struct gallery *g,
                            struct identify_request *r, struct identification *x,
                            struct errinfo *e)
{
    *x = (struct identification){.request = r, .templates = {.context = c}};
    return identify(c, g, x, e);
}

void identify_free(struct identification *x)
{
    templates_free(&x->templates);
}

/* ---- the report */

static void describe_candidate(struct json *j, const struct identify_candidate *one,
                               double steps)
{
    double score, threshold;

    surface_shown(&one->result, steps, &score, &threshold);
    json_object(j, NULL);
    json_text(j, "subject", one->subject);
    json_text(j, "template_id", one->template_id);
    json_score(j, "score", score);
    json_rate(j, "fmr_at_score", one->result.false_match_rate);
    json_close(j);
}

static void describe_numbers(struct json *j, const struct identification *x, double steps)
{
    double score = (double)NAN, threshold = (double)NAN;

    if (x->compared > 0)
        surface_shown(&x->best.result, steps, &score, &threshold);
    else
        threshold = x->best.result.threshold;
    json_score(j, "score", score);
    json_score(j, "threshold", threshold);
    json_rate(j, "fpir_at_score", x->compared > 0 ? x->fpir : (double)NAN);
    json_flag(j, "extrapolated", x->extrapolated);
    json_number(j, "searched", (double)x->searched);
    json_number(j, "skipped", (double)x->skipped);
    json_number(j, "compared", x->compared);
}

void identify_describe(struct json *j, const struct identification *x, bool brief,
                       bool scores, const char *engine)
{
    const struct identify_request *r = x->request;
    const bool match = x->decision == SURFACE_MATCH;
    const double steps = scores ? 100 : 10;
    const struct surface_quality quality = surface_face_quality(*r->face);

    json_text(j, "decision", templates_decision(x->decision));
    json_text(j, "subject", match ? x->templates.of.subject.id : NULL);
    json_text(j, "template_id", match ? x->templates.of.t[x->best.index].id : NULL);
    if (brief)
        return;
    if (match || scores || r->candidates > 0)
        describe_numbers(j, x, steps);
    else
        json_number(j, "searched", (double)x->searched);
    if (r->candidates > 0) {
        json_array(j, "candidates");
        for (size_t i = 0; i < x->n; i++)
            describe_candidate(j, &x->candidate[i], steps);
        json_close(j);
    }
    describe_scan(j, "scan", &r->probe->found);
    if (r->probe->files)
        session_describe(j, r->probe);
    describe_quality(j, "quality", &quality, *r->face);
    json_text(j, "engine", engine);
    json_object(j, "timing_ms");
    json_number(j, "parse", x->times.parse);
    json_number(j, "prepare", x->times.prepare);
    if (match || scores) {
        json_number(j, "score", x->times.score);
        json_number(j, "total", x->times.total);
    }
    json_close(j);
}
