#include "gate.h"

#include <math.h>

#include "shape.h"

/* The least of an enrolment's evidence.  Of real people's scans from stereo photogrammetry and
 * structured light the least has 13, of Kinect v2's single frames two of nine have 10 and 11;
 * of 600 made-up things that are no faces one has 12.6, and too little support (docs/model.md). */
#define GATE_SUPPORT  0.35
#define GATE_SEEN     0.475
#define GATE_EVIDENCE 12.5

/* The lower half of a large face passes for a small one whose forehead is not seen: of 1,240 such
 * halves three had an evidence of 12.8 to 14.1.  Of 190 small faces whose forehead was cut off one
 * has less. */
#define GATE_SMALL          0.9
#define GATE_EVIDENCE_SMALL 14.25

/* A cover hides evidence, and may itself be the sign of no face: where more than SOME is covered, or
 * an eye is not seen, more must be seen.  Of people with glasses one in 20 shows less, at an evidence
 * of 11.9; half a face shows 0.55 at most. */
#define GATE_SEEN_COVERED 0.6

/* mm: a scan of which more is left separates people too badly to be compared with for years.  Less
 * by so much for a face that is covered, times the share: two faces in one place leave 0.8 to 1.4 of
 * one of them, beside covers of 0.1 to 0.36; 3 of 14 such are enrolled, and no wearer of glasses less. */
#define GATE_RESIDUAL_MM      1.4
#define GATE_RESIDUAL_COVERED 2.0

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

static void gate_rate(const struct shape_work *w, const struct shape_fit *fit,
                      struct surface_found *f)
{
    f->support = explained(w, fit);
    f->likeness = fit->likeness;
    f->eyes = fit->eyes;
    f->detail = fit->detail;
    f->seen = (double)fit->skin / w->cells;
    f->forehead = fit->forehead;
    f->residual_mm = fit->residual_mm * fit->size;
    f->evidence = f->likeness + 4 * f->eyes + 5 * f->support + 5 * fmin(f->detail, 1) +
                  2 * f->seen + 2 * fmax(f->forehead, 0);
    f->head_size = fit->size;
}

enum status gate_judge(const struct shape_work *w, const struct shape_fit *fit,
                       bool enrolment, struct surface_found *f)
{
    f->support_wanted = enrolment ? GATE_SUPPORT : GATE_SUPPORT_PROBE;
    f->seen_wanted = !enrolment ? 0
                     : f->occluded > SCAN_OCCLUDED_SOME || fit->eyes == SHAPE_EYE_UNKNOWN
                         ? GATE_SEEN_COVERED
                         : GATE_SEEN;
    f->evidence_wanted = !enrolment ? -INFINITY
                         : fit->size < GATE_SMALL && fit->forehead < 0
                             ? GATE_EVIDENCE_SMALL
                             : GATE_EVIDENCE;
    f->residual_most =
        enrolment ? GATE_RESIDUAL_MM - GATE_RESIDUAL_COVERED * f->occluded : INFINITY;
    gate_rate(w, fit, f);
    /* What is unknown is NAN, for which comparisons are false. */
    if (!enrolment)
        return f->support >= f->support_wanted && f->likeness >= GATE_LIKENESS_PROBE
                   ? ST_OK
                   : ST_ENOTFACE;
    if (fit->cover > SURFACE_OCCLUDED_MOST * w->cells && f->support >= GATE_SUPPORT)
        return ST_EQUALITY; /* a face, as a probe may be, but covered */
    if (!(f->support >= f->support_wanted && f->evidence >= f->evidence_wanted))
        return ST_ENOTFACE;
    return f->seen >= f->seen_wanted && f->residual_mm <= f->residual_most ? ST_OK
                                                                           : ST_EQUALITY;
}
