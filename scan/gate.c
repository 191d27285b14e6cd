#include "gate.h"

#include <math.h>

#include "mem.h"
#include "shape.h"
#include "tuning.h"

/* Share of what is seen of the face that the fit explains: support, but of the cells with
 * points. */
static double explained(const struct shape_work *w, const struct shape_fit *f)
{
    const uint32_t seen = f->skin + f->cover + f->apart;

    return seen > 0 ? f->support * w->cells / seen : -1;
}

/* The points in the face's frame, in these scales along its axes, fitted again. */
static enum status fit_scaled(const struct gate_scan *s, const double by[3],
                              struct dvec3 *to, struct shape_fit *out)
{
    static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

    for (size_t i = 0; i < s->n; i++) {
        const struct dvec3 p = align_pose_apply(&s->fit->pose, s->pts[i]);

        to[i] = (struct dvec3){by[0] * p.x, by[1] * p.y, by[2] * p.z};
    }
    return shape_fit(s->shape, to, s->n, &still, 1, false, out);
}

/* The scales of which the support is most.  More is tried of what is hardly explained. */
static enum status find_scale(const struct gate_scan *s, bool wide, double *support,
                              double scale[3])
{
    static const double all[] = {0.8, 1.25, 0.5, 0.65, 1.5, 2};
    const int uniform = wide ? 6 : 2;
    struct dvec3 *pts = mem_array(s->n, sizeof *pts);
    enum status st = pts == NULL ? ST_ENOMEM : ST_OK;
    struct shape_fit fit;

    *support = s->fit->support;
    for (int k = 0; st == ST_OK && k < uniform + 6; k++) {
        double by[3] = {1, 1, 1};

        if (k < uniform)
            by[0] = by[1] = by[2] = all[k];
        else
            by[(k - uniform) / 2] = all[(k - uniform) % 2];
        st = fit_scaled(s, by, pts, &fit);
        if (st != ST_OK || !(fit.support > *support))
            continue;
        *support = fit.support;
        for (int a = 0; a < 3; a++)
            scale[a] = by[a];
    }
    mem_free(pts);
    return st;
}

/* Does another scale fit better by far?  Then f->scale is that one. */
static enum status judge_scale(const struct gate_scan *s, bool wide, bool *is,
                               struct gate *f)
{
    double support, scale[3] = {1, 1, 1};
    enum status st;

    *is = false;
    if (f->support >= GATE_SURE)
        return ST_OK;
    st = find_scale(s, wide, &support, scale);
    *is = st == ST_OK && support - s->fit->support > GATE_SCALE_GAIN;
    for (int a = 0; *is && a < 3; a++)
        f->scale[a] = scale[a];
    return st;
}

enum status gate_judge(const struct gate_scan *s, struct gate *f)
{
    const struct shape_fit *fit = s->fit;
    enum status st;
    bool scaled;

    f->support = explained(s->shape, fit);
    f->support_wanted = s->enrolment ? GATE_SUPPORT : GATE_SUPPORT_PROBE;
    f->likeness = fit->likeness;
    f->likeness_wanted = s->enrolment ? GATE_LIKENESS : GATE_LIKENESS_PROBE;
    f->eyes = fit->eyes;
    f->eyes_wanted = s->enrolment ? GATE_EYES : -1;
    f->seen = (double)fit->skin / s->shape->cells;
    f->seen_wanted = s->enrolment ? GATE_SEEN : 0;
    f->forehead = fit->forehead;
    f->forehead_wanted = s->enrolment ? GATE_FOREHEAD : -1;
    f->detail = fit->detail;
    f->detail_wanted = s->enrolment ? GATE_DETAIL : -INFINITY;
    f->evidence = f->likeness + 4 * f->eyes + 5 * f->support + 5 * fmin(f->detail, 1) +
                  2 * f->seen + 2 * f->forehead;
    f->evidence_wanted = s->enrolment ? GATE_EVIDENCE : -INFINITY;
    f->scale[0] = f->scale[1] = f->scale[2] = 1;
    /* What cannot be told is NAN, for which these are false. */
    st = f->support >= f->support_wanted && f->likeness >= f->likeness_wanted
             ? ST_OK
             : ST_ENOTFACE;
    if (!s->enrolment)
        return st;
    if (judge_scale(s, st != ST_OK, &scaled, f) != ST_OK)
        return ST_ENOMEM;
    if (scaled)
        return ST_ENOTFACE;
    if (fit->cover > SCAN_OCCLUDED_MOST * s->shape->cells &&
        f->support >= GATE_SUPPORT_PROBE && f->likeness >= f->likeness_wanted)
        return ST_EQUALITY; /* a face, as a probe may be, but covered */
    if (!(f->eyes >= f->eyes_wanted))
        return ST_ENOTFACE;
    if (st == ST_OK && !(f->seen >= f->seen_wanted && f->forehead > -1))
        return ST_EQUALITY; /* nobody can tell */
    if (!(f->forehead >= f->forehead_wanted && f->detail >= f->detail_wanted &&
          f->evidence >= f->evidence_wanted))
        return ST_ENOTFACE;
    return st;
}
