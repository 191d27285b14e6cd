#include "nearest.h"

#include <math.h>
#include <stdbool.h>

#include "errinfo.h"
#include "minimal.h"

/* A non-match is that of a mirrored scan where its mirror image scores higher by so much, and so
 * far above the threshold.  Of 40 made-up people the 13 whose mirrored scans do not match gain 20
 * to 65, to 26 or more; of 120 strangers the mirror image of one matches, with 10.3, where the
 * scan does not. */
#define DECISION_MIRRORED 10.0

static bool better(const struct face_result *a, const struct face_result *b)
{
    static const int rank[] = {
        [FACE_MATCH] = 2, [FACE_NO_MATCH] = 1, [FACE_INCONCLUSIVE] = 0};

    if (rank[a->decision] != rank[b->decision])
        return rank[a->decision] > rank[b->decision];
    return a->score > b->score;
}

static enum status compare(struct admission_context *c, const struct admission *a,
                           size_t i, const struct face *probe, struct face_result *out,
                           struct errinfo *e)
{
    const struct face *face;
    enum status st = admission_hold(c, a, i, &face, e);

    if (st != ST_OK)
        return st;
    st = face_compare(face, probe, (double)NAN, c->clock_ms, c->work, out);
    admission_release(c, a, i, face);
    return st == ST_OK
               ? st
               : errinfo_set(e, st, "template %s: %s", a->of.t[i].id, status_message(st));
}

/* One comparison more, with the template that decides. */
static enum status find_mirrored(struct admission_context *c, const struct admission *a,
                                 const struct face *probe, struct nearest *of,
                                 struct errinfo *e)
{
    const struct face *face;
    struct face_result swapped;
    enum status st;

    if (of->result.decision != FACE_NO_MATCH)
        return ST_OK;
    if ((st = admission_hold(c, a, of->index, &face, e)) != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st; /* deleted since */
    st = face_compare_mirrored(face, probe, c->work, &swapped);
    admission_release(c, a, of->index, face);
    if (st != ST_OK)
        return errinfo_set(e, st, "the mirror image: %s", status_message(st));
    face_best_of(&swapped, of->compared, c->work);
    of->mirrored =
        swapped.score > fmax(of->result.score, swapped.threshold) + DECISION_MIRRORED;
    return ST_OK;
}

/* Of the results [n], template[k] being the k-th one's; each lowered, then the best. */
static void choose(struct face_result *r, const size_t *template, uint32_t n,
                   const struct face_work *w, struct nearest *out)
{
    out->first_score = r[0].score;
    for (uint32_t k = 0; k < n; k++) {
        face_best_of(&r[k], n, w);
        if (k == 0 || better(&r[k], &out->result)) {
            out->result = r[k];
            out->index = template[k];
        }
        out->score_ms += r[k].score_ms;
    }
}

/* all: else as nearest_fit(). */
static enum status find(struct admission_context *c, const struct admission *a, bool all,
                        const struct face *probe, struct nearest *out, struct errinfo *e)
{
    struct face_result result[STORE_TEMPLATES_MAX];
    size_t template[STORE_TEMPLATES_MAX];
    bool foreign = false; /* there is one that this engine cannot re-encode */

    *out = (struct nearest){0};
    for (size_t i = 0; i < a->of.n; i++) {
        enum status st;

        if (!all && out->compared > 0 && !a->of.t[i].manager)
            continue;
        st = compare(c, a, i, probe, &result[out->compared], e);
        foreign |= st == ST_EVERSION;
        if (st == ST_EVERSION || st == ST_ENOTFOUND)
            continue;
        if (st != ST_OK)
            return st;
        template[out->compared++] = i;
    }
    if (out->compared > 0) {
        choose(result, template, out->compared, c->work, out);
        return find_mirrored(c, a, probe, out, e);
    }
    if (foreign)
        return errinfo_set(e, ST_EVERSION,
                           "no template of the subject is of this engine, or can be "
                           "re-encoded by it");
    return errinfo_set(e, ST_ENOTFOUND, "the subject has no template");
}

enum status nearest_find(struct admission_context *c, const struct admission *a,
                         const struct face *probe, struct nearest *out, struct errinfo *e)
{
    return find(c, a, true, probe, out, e);
}

enum status nearest_fit(struct admission_context *c, const struct admission *a,
                        const struct face *probe, struct nearest *out, struct errinfo *e)
{
    return find(c, a, false, probe, out, e);
}

enum status nearest_judge(const struct nearest *n, struct errinfo *e)
{
    if (!n->mirrored)
        return ST_OK;
    return errinfo_set(
        e, ST_EMIRRORED,
        "the scan does not match, but its mirror image does: left and right "
        "are swapped; switch mirroring off where it was made");
}

enum status nearest_minimal(struct admission_context *c, const struct admission *a,
                            const struct face *probe, struct nearest *of, bool weigh,
                            struct minimal *out, struct errinfo *e)
{
    const struct face *face;
    enum status st = admission_hold(c, a, of->index, &face, e);

    if (st != ST_OK)
        return st;
    st = face_minimal(face, probe, c->clock_ms, c->work, &of->result, out);
    if (st == ST_OK && weigh)
        st = face_weigh(face, probe, c->work, out);
    if (st == ST_OK && weigh)
        st = face_regions(face, probe, c->work, &of->result);
    admission_release(c, a, of->index, face);
    return st == ST_OK ? st
                       : errinfo_set(e, st, "template %s: %s", a->of.t[of->index].id,
                                     status_message(st));
}
