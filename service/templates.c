#include "templates.h"

#include <math.h>

#include "store.h"

/* A non-match is that of a mirrored scan where its mirror image scores higher by so much, and so
 * far above the threshold.  Of 40 made-up people the 13 whose mirrored scans do not match gain 20
 * to 65, to 26 or more; of 120 strangers the mirror image of one matches, with 10.3, where the
 * scan does not. */
#define DECISION_MIRRORED 10.0

/* ---- reading */

/* May the subject be verified and enrolled?  If not, *e says what to do. */
static enum templates_admit may_be_used(const struct store_subject *one,
                                        struct errinfo *e)
{
    if (one->disabled) {
        (void)errinfo_set(e, ST_EDENIED, "subject %s is disabled: enable it first",
                          one->id);
        return TEMPLATES_DISABLED;
    }
    if (one->expired) {
        (void)errinfo_set(e, ST_EDENIED,
                          "subject %s expired at %s: set a later expiry first", one->id,
                          one->expires);
        return TEMPLATES_EXPIRED;
    }
    return TEMPLATES_ADMITTED;
}

static enum status admit(const struct store_limits *limits, struct templates *t,
                         struct errinfo *e)
{
    struct templates_refusal *why = &t->refusal;

    why->admit = may_be_used(&t->of.subject, e);
    if (why->admit != TEMPLATES_ADMITTED)
        return ST_EDENIED;
    if (t->of.n > 0)
        why->wait_ms = store_attempts_wait_ms(limits, &t->of.attempts, &why->why);
    why->now = t->of.attempts;
    return why->wait_ms == 0 ? ST_OK
                             : errinfo_set(e, ST_EDENIED, "the subject is locked out");
}

/* Another engine's face that this one cannot re-encode is passed over. */
static enum status take_face(struct templates *t, size_t i, struct errinfo *e)
{
    const enum status st =
        store_snapshot_face(&t->of, i, t->context->work, &t->face[i], e);

    if (st != ST_EVERSION)
        return st;
    t->passed_over = *e;
    return ST_OK;
}

enum status templates_read(struct templates_context *c, const struct templates_of *ask,
                           struct templates *out, struct errinfo *e)
{
    const struct store_snapshot_of what = {.subject = ask->subject,
                                           .template_id = ask->template_id,
                                           .token = ask->token,
                                           .calibration = c->calibration};
    enum status st;

    *out =
        (struct templates){.context = c, .token = ask->token != NULL ? ask->token : ""};
    st = store_snapshot_begin(c->store, &what, &out->of, e);
    if (st == ST_OK && !ask->regardless)
        st = admit(ask->limits, out, e);
    for (size_t i = 0; st == ST_OK && i < out->of.n; i++)
        st = take_face(out, i, e);
    st = store_snapshot_end(&out->of, st, e);
    if (st == ST_OK && out->of.calibration != c->calibration) {
        store_calibration_apply(c->store, out->of.k, c->work);
        c->calibration = out->of.calibration;
    }
    return st;
}

enum status templates_read_found(struct templates_context *c, struct store_people *people,
                                 const unsigned char *uid, const char *token,
                                 struct templates *out, struct errinfo *e)
{
    const struct store_snapshot_of what = {.uid = uid, .people = people};
    enum status st;

    *out = (struct templates){.context = c, .token = token};
    if ((st = store_snapshot_begin(c->store, &what, &out->of, e)) == ST_OK)
        st = admit(NULL, out, e);
    for (size_t i = 0; st == ST_OK && i < out->of.n; i++)
        st = take_face(out, i, e);
    return store_snapshot_end(&out->of, st, e);
}

void templates_free(struct templates *t)
{
    for (size_t i = 0; i < t->of.n && i < STORE_TEMPLATES_MAX; i++)
        surface_face_free(t->face[i]);
    store_snapshot_free(&t->of);
    *t = (struct templates){.context = t->context};
}

/* ---- comparing */

/* The face of template i with its surface, which is read when it is needed.  The template may have been
 * deleted since: ST_ENOTFOUND. */
static enum status need_surface(struct templates *t, size_t i, struct errinfo *e)
{
    const struct templates_context *c = t->context;
    struct store_template now;

    if (t->of.t == NULL || surface_face_points(t->face[i], NULL) > 0)
        return ST_OK;
    return store_template_load(c->store, t->token, t->of.t[i].id, &now, c->work,
                               &t->face[i], e);
}

/* By the encodings, and by the surfaces if the scans were taken for heads of different sizes. */
static enum status compare_one(struct templates *t, size_t i,
                               const struct surface_face *probe,
                               struct surface_comparison *out, struct errinfo *e)
{
    struct surface_work *w = t->context->work;
    enum status st = status_from(surface_compare(w, t->face[i], probe, out));

    if (st == ST_EINVAL && (st = need_surface(t, i, e)) == ST_OK)
        st = status_from(surface_compare(w, t->face[i], probe, out));
    return st == ST_OK || st == ST_ENOTFOUND
               ? st
               : errinfo_set(e, st, "template %s: %s", t->of.t[i].id, status_message(st));
}

const char *templates_decision(enum surface_decision d)
{
    static const char *const name[] = {[SURFACE_MATCH] = "match",
                                       [SURFACE_NO_MATCH] = "no_match",
                                       [SURFACE_INCONCLUSIVE] = "inconclusive"};

    return name[d];
}

static bool better(const struct surface_comparison *a, const struct surface_comparison *b)
{
    static const int rank[] = {
        [SURFACE_MATCH] = 2, [SURFACE_NO_MATCH] = 1, [SURFACE_INCONCLUSIVE] = 0};

    if (rank[a->decision] != rank[b->decision])
        return rank[a->decision] > rank[b->decision];
    return a->score > b->score;
}

/* One comparison more, with the template that decides; none for a scan in its place. */
static enum status find_mirrored(const struct templates *t,
                                 const struct surface_face *probe,
                                 struct templates_nearest *of, struct errinfo *e)
{
    struct surface_work *w = t->context->work;
    struct surface_comparison swapped = {0};
    enum status st;

    if (of->result.decision != SURFACE_NO_MATCH || t->of.t == NULL)
        return ST_OK;
    if ((st = status_from(
             surface_compare_mirrored(w, t->face[of->index], probe, &swapped))) != ST_OK)
        return errinfo_set(e, st, "the mirror image: %s", status_message(st));
    surface_best_of(w, of->compared, &swapped);
    of->mirrored =
        swapped.score > fmax(of->result.score, swapped.threshold) + DECISION_MIRRORED;
    return ST_OK;
}

/* Does the surface of the template that decides say otherwise? */
static enum status look_again(struct templates *t, const struct surface_face *probe,
                              struct templates_nearest *of, struct errinfo *e)
{
    struct surface_comparison again = of->result;
    struct surface_work *w = t->context->work;
    enum status st;

    if (again.decision != SURFACE_NO_MATCH || !(again.score < SURFACE_DOUBT))
        return ST_OK;
    if ((st = need_surface(t, of->index, e)) != ST_OK)
        return st;
    st = status_from(surface_compare_again(w, t->face[of->index], probe, &again));
    if (st != ST_OK)
        return errinfo_set(e, st, "a second look: %s", status_message(st));
    if (again.score > of->result.score) {
        surface_best_of(w, of->compared, &again);
        of->result = again;
    }
    return ST_OK;
}

/* Of the results [n], template[k] being the k-th one's; each lowered, then the best. */
static void templates_choose(struct surface_comparison *r, const size_t *template,
                             uint32_t n, const struct surface_work *w,
                             struct templates_nearest *out)
{
    out->first_score = r[0].score;
    out->compared = n;
    for (uint32_t k = 0; k < n; k++) {
        surface_best_of(w, n, &r[k]);
        if (k == 0 || better(&r[k], &out->result)) {
            out->result = r[k];
            out->index = template[k];
        }
    }
}

enum status templates_compare(struct templates *t, bool fit,
                              const struct surface_face *probe,
                              struct templates_nearest *out, struct errinfo *e)
{
    const struct templates_context *c = t->context;
    struct surface_comparison result[STORE_TEMPLATES_MAX];
    size_t template[STORE_TEMPLATES_MAX];
    uint32_t n = 0;
    enum status st;

    *out = (struct templates_nearest){.result = {0}};
    for (size_t i = 0; i < t->of.n; i++) {
        double start;

        if (t->face[i] == NULL || (fit && n > 0 && !t->of.t[i].manager))
            continue;
        start = c->clock_ms != NULL ? c->clock_ms() : 0;
        st = compare_one(t, i, probe, &result[n], e);
        out->score_ms += c->clock_ms != NULL ? c->clock_ms() - start : 0;
        if (st != ST_OK)
            return st;
        template[n++] = i;
    }
    if (n > 0) {
        templates_choose(result, template, n, c->work, out);
        return ST_OK;
    }
    if (t->of.n > 0)
        return errinfo_set(e, ST_EVERSION,
                           "no template of the subject was made by this engine or can "
                           "be re-encoded by it");
    return errinfo_set(e, ST_ENOTFOUND, "the subject has no template");
}

enum status templates_doubt(struct templates *t, const struct surface_face *probe,
                            struct templates_nearest *io, struct errinfo *e)
{
    const enum status st = look_again(t, probe, io, e);

    return st == ST_OK ? find_mirrored(t, probe, io, e) : st;
}

enum status templates_nearest(struct templates *t, bool fit,
                              const struct surface_face *probe,
                              struct templates_nearest *out, struct errinfo *e)
{
    const enum status st = templates_compare(t, fit, probe, out, e);

    return st == ST_OK ? templates_doubt(t, probe, out, e) : st;
}

enum status templates_pair(struct templates *t, size_t i, size_t k,
                           struct surface_comparison *out, struct errinfo *e)
{
    struct templates_nearest of = {.index = i, .compared = 1};
    enum status st =
        status_from(surface_compare(t->context->work, t->face[i], t->face[k], out));

    of.result = *out;
    if (st == ST_EINVAL ||
        (out->decision == SURFACE_NO_MATCH && out->score < SURFACE_DOUBT)) {
        if ((st = need_surface(t, k, e)) == ST_OK)
            st = compare_one(t, i, t->face[k], &of.result, e);
    } else if (st != ST_OK) {
        st = errinfo_set(e, st, "template %s: %s", t->of.t[i].id, status_message(st));
    }
    if (st == ST_OK)
        st = look_again(t, t->face[k], &of, e);
    *out = of.result;
    return st;
}

enum status templates_judge(const struct templates_nearest *n, struct errinfo *e)
{
    if (!n->mirrored)
        return ST_OK;
    return errinfo_set(
        e, ST_EMIRRORED,
        "the scan does not match, but its mirror image does: left and right "
        "are swapped; switch mirroring off where it was made");
}

enum status templates_minimal(struct templates *t, const struct surface_face *probe,
                              const struct templates_nearest *of,
                              struct surface_disparity *out, struct surface_parts *parts,
                              struct errinfo *e)
{
    const struct templates_context *c = t->context;
    const enum status may = need_surface(t, of->index, e);
    const struct surface_face *face = t->face[of->index];
    enum surface_status st;

    *out = (struct surface_disparity){0};
    if (may != ST_OK)
        return may;
    surface_work_clock(c->work, c->clock_ms);
    st = surface_disparity(c->work, face, probe, out);
    if (st == SURFACE_OK && parts != NULL) {
        st = surface_weigh(c->work, face, probe, out);
    }
    if (st == SURFACE_OK && parts != NULL)
        st = surface_parts(c->work, face, probe, parts);
    return st == SURFACE_OK
               ? ST_OK
               : errinfo_set(e, status_from(st), "comparing: %s", surface_message(st));
}
