#include "nearest.h"

#include <stdbool.h>

#include "calibration.h"
#include "errinfo.h"
#include "store.h"

static bool better(const struct face_result *a, const struct face_result *b)
{
    if ((a->decision == FACE_INCONCLUSIVE) != (b->decision == FACE_INCONCLUSIVE))
        return a->decision != FACE_INCONCLUSIVE;
    if (a->decision == FACE_INCONCLUSIVE)
        return a->disparity.overlap > b->disparity.overlap;
    return a->score_mm < b->score_mm;
}

enum status nearest_calibrate(struct nearest_context *c, struct errinfo *e)
{
    return calibration_follow(c->store, c->work, &c->calibration, e);
}

static enum status compare(struct nearest_context *c, const struct store_template *t,
                           const struct face *probe, struct face_result *out,
                           struct errinfo *e)
{
    const struct face *face;
    enum status st = c->hold(c->arg, t->id, c->work, &face, e);

    if (st != ST_OK)
        return st;
    st = face_compare(face, probe, 0.0, c->clock_ms, c->work, out);
    c->release(c->arg, face);
    return st == ST_OK ? st
                       : errinfo_set(e, st, "template %s: %s", t->id, status_message(st));
}

enum status nearest_find(struct nearest_context *c, const struct store_template *t,
                         size_t n, const struct face *probe, struct nearest *out,
                         struct errinfo *e)
{
    enum status st = nearest_calibrate(c, e);
    bool foreign = false; /* there is one that this engine cannot re-encode */

    *out = (struct nearest){0};
    if (st != ST_OK)
        return st;
    for (size_t i = 0; i < n; i++) {
        struct face_result result;

        st = compare(c, &t[i], probe, &result, e);
        if (st == ST_EVERSION) {
            c->pass_over(c->arg, e);
            foreign = true;
        }
        if (st == ST_EVERSION || st == ST_ENOTFOUND)
            continue;
        if (st != ST_OK)
            return st;
        if (out->compared++ == 0 || better(&result, &out->result)) {
            out->result = result;
            out->index = i;
        }
        out->align_ms += result.align_ms;
        out->measure_ms += result.measure_ms;
    }
    if (out->compared > 0)
        return ST_OK;
    if (foreign)
        return errinfo_set(e, ST_EVERSION,
                           "no template of the subject is of this engine, or can be "
                           "re-encoded by it");
    return errinfo_set(e, ST_ENOTFOUND, "the subject has no template");
}
