#include "gate.h"

#include <math.h>

#include "mem.h"
#include "shape.h"
#include "tuning.h"

/* The least of an enrolment's evidence.  Of real people's scans from stereo photogrammetry and
 * structured light the least has 13, of Kinect v2's single frames two of nine have 10 and 11;
 * of some 200 things that are no faces the most has 10.2 (docs/accuracy.md). */
#define GATE_SUPPORT  0.35
#define GATE_SEEN     0.475
#define GATE_EVIDENCE 12.5

/* mm: a scan of which more is left tells people apart too badly to be compared with for years. */
#define GATE_RESIDUAL_MM 1.4

/* Of a probe that shows nothing like a face nothing can be compared.  Of real people's scans whose
 * face was found the least likeness is 1.5, Kinect's single frames included. */
#define GATE_SUPPORT_PROBE  0.2
#define GATE_LIKENESS_PROBE 1.2

/* Share of what is seen of the face that the fit explains: support, but of the cells with
 * points. */
static double explained(const struct shape_work *w, const struct shape_fit *f)
{
    const uint32_t seen = f->skin + f->cover + f->apart;

    return seen > 0 ? f->support * w->cells / seen : -1;
}

static void rate(const struct shape_work *w, const struct shape_fit *fit, double size,
                 struct gate *f)
{
    f->support = explained(w, fit);
    f->likeness = fit->likeness;
    f->eyes = fit->eyes;
    f->detail = fit->detail;
    f->seen = (double)fit->skin / w->cells;
    f->forehead = fit->forehead;
    f->residual_mm = fit->residual_mm;
    f->evidence = f->likeness + 4 * f->eyes + 5 * f->support + 5 * fmin(f->detail, 1) +
                  2 * f->seen + 2 * fmax(f->forehead, 0);
    f->size = size;
}

/* What cannot be told is NAN, for which this is false. */
static bool enough(const struct gate *f)
{
    return f->support >= f->support_wanted && f->evidence >= f->evidence_wanted;
}

/* The points in the face's frame, as if the head were of the model's size, fitted again. */
static enum status judge_size(const struct gate_scan *s, double size, struct dvec3 *to,
                              struct gate *f)
{
    static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const double by = 1 / size;
    struct shape_fit fit;
    enum status st;

    for (size_t i = 0; i < s->n; i++) {
        const struct dvec3 p = align_pose_apply(&s->fit->pose, s->pts[i]);

        to[i] = (struct dvec3){by * p.x, by * p.y, by * p.z};
    }
    st = shape_fit(s->shape, to, s->n, &still, 1, false, &fit);
    if (st == ST_OK)
        rate(s->shape, &fit, size, f);
    return st;
}

static enum status judge_sizes(const struct gate_scan *s, struct gate *f)
{
    static const double size[] = {0.92, 1.08, 0.84, 1.16, 0.77, 0.71};
    struct dvec3 *pts = mem_array(s->n, sizeof *pts);
    enum status st = pts == NULL ? ST_ENOMEM : ST_OK;

    for (size_t k = 0; st == ST_OK && !enough(f) && k < sizeof size / sizeof *size; k++) {
        struct gate other = *f;

        st = judge_size(s, size[k], pts, &other);
        if (st == ST_OK && other.evidence > f->evidence)
            *f = other;
    }
    mem_free(pts);
    return st;
}

enum status gate_judge(const struct gate_scan *s, struct gate *f)
{
    const struct shape_fit *fit = s->fit;

    f->support_wanted = s->enrolment ? GATE_SUPPORT : GATE_SUPPORT_PROBE;
    f->seen_wanted = s->enrolment ? GATE_SEEN : 0;
    f->evidence_wanted = s->enrolment ? GATE_EVIDENCE : -INFINITY;
    f->residual_most = s->enrolment ? GATE_RESIDUAL_MM : INFINITY;
    rate(s->shape, fit, 1, f);
    if (!s->enrolment)
        return f->support >= f->support_wanted && f->likeness >= GATE_LIKENESS_PROBE
                   ? ST_OK
                   : ST_ENOTFACE;
    if (fit->cover > SCAN_OCCLUDED_MOST * s->shape->cells && f->support >= GATE_SUPPORT)
        return ST_EQUALITY; /* a face, as a probe may be, but covered */
    if (!enough(f) && judge_sizes(s, f) != ST_OK)
        return ST_ENOMEM;
    if (!enough(f))
        return ST_ENOTFACE;
    return f->seen >= f->seen_wanted && f->residual_mm <= f->residual_most ? ST_OK
                                                                           : ST_EQUALITY;
}
