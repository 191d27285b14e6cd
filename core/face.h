/* face.h -- a face model, and the comparison of two: the paper's pipeline in two calls.
 * A face model is points + triangulation + spanning tree + what the measure needs to know
 * of holes; immutable once built, so that any number of threads may compare against it. */
#ifndef CORE_FACE_H
#define CORE_FACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "align.h"
#include "decision.h"
#include "disparity.h"
#include "frame.h"
#include "grid.h"
#include "quality.h"
#include "status.h"
#include "surface.h"
#include "vec.h"

#define FACE_ENGINE     "surfaced/0.2.0 measure/3" /* and a model: face_engine() */
#define FACE_ENGINE_MAX 63
#define FACE_MIN_POINTS 100
#define FACE_MAX_POINTS 300000 /* default limit */

struct face {
    struct surface surface;
    struct quality quality;
    struct frame frame; /* its canonical frame */
};

struct asymmetry; /* asymmetry.h */
struct cells;     /* cells.h */
struct model;     /* model.h */

/* The number of FACE_ENGINE's measure changes with whatever makes another disparity of the
 * same two scans, or another model of the same points; the version does not count.
 * face_engine(m, out): who judges: "surfaced/VERSION measure/N model/HHHHHHHH", the last the
 * first 8 hex digits of m's digest (NULL: model_default).  Disparities and calibrations of
 * another measure or another model are no others'.  About 1 ms. */
void face_engine(const struct model *m, char out[FACE_ENGINE_MAX + 1]);

/* face_same_engine(a, b): are what they made comparable: all but the version the same? */
bool face_same_engine(const char *a, const char *b);

/* A worker's reusable memory for building and comparing: after the first few calls nothing
 * is allocated any more.  One thread at a time. */
struct face_work;
/* face_work_new(m): m is borrowed, and what is built and compared by this memory is judged
 * by it; NULL: model_default.  NULL: out of memory. */
struct face_work *face_work_new(const struct model *m);
void face_work_free(struct face_work *w);

/* face_work_decide(w, d): decide by d (copied) from now on instead of by the model's own
 * calibration; NULL: by the model's again. */
void face_work_decide(struct face_work *w, const struct decision *d);

/* face_build(pts, n, w, out, bad): from a scanner's points (mm, any order) to a model:
 * lattice, triangulation, spikes laid flat, spanning tree, holes, quality gate, frame.
 * out   all zero or a former face, whose memory is used again; on failure it is empty but
 *       may still hold memory: face_free().
 * bad   index of the offending point for ST_ENOTFINITE and ST_ERANGE; may be NULL
 * Returns ST_OK; ST_ETOOFEW (< FACE_MIN_POINTS usable); ST_ENOTFINITE; ST_ERANGE;
 * ST_EDEGENERATE; ST_EUNITS (extent outside 60-500 mm); ST_ENOTFACE; ST_EQUALITY;
 * ST_ENOMEM; ST_ELIMIT. */
enum status face_build(const struct dvec3 *pts, size_t n, struct face_work *w,
                       struct face *out, size_t *bad);
void face_free(struct face *f); /* NULL and empty ones are allowed */

/* face_adopt(f, w): for decoding: mesh_link(), then everything that follows from the mesh.
 * f->surface.mesh has nv, nt, xy, z, org and parent, all of them unproven; f->frame the frame
 * stored, or mark 0: it is found again where it belongs to another model's mean face.
 * Returns ST_OK, ST_ECORRUPT (f->surface.mesh.nv is 0 then), ST_ENOMEM. */
enum status face_adopt(struct face *f, struct face_work *w);

/* face_rebuild(f, w): f, which another engine made, as this one makes it from the same points:
 * what face_build() does but for the spikes, which are laid flat in it for good.  The points
 * stay what they are, to the last bit, and so once more changes nothing; nor does it change
 * what this engine made of a scan without spikes (with some, the frame was found with them).
 * Returns as face_build() but what is about the points given; f is empty on failure.
 * About the cost of face_build(). */
enum status face_rebuild(struct face *f, struct face_work *w);

enum face_decision { FACE_MATCH, FACE_NO_MATCH, FACE_INCONCLUSIVE };

struct face_result {
    enum face_decision decision;
    double score_mm; /* what the decision was taken on (score.h) */
    double threshold_mm;
    double fmr_at_score;   /* share of impostors at or below score_mm */
    double weight_overlap; /* share of a whole face's weight in the common area, 0..1 */
    double change_mm;      /* what was taken out as change within a person (score.h) */
    double region_mm[GRID_REGIONS];     /* each region alone; NAN: not covered */
    double region_weight[GRID_REGIONS]; /* what it counts in a whole face, 0..1 */
    struct disparity disparity;         /* the plain measure of the papers, same pose */
    struct align_result align;          /* transform probe -> template, certainty */
    double align_ms, measure_ms;        /* by the caller's clock; 0 without one */
};

/* face_compare(tmpl, probe, threshold_mm, clock_ms, w, out): align the probe to the
 * template, measure the disparity at that pose, decide.
 * threshold_mm  0 or less: that of w's calibration
 * clock_ms      may be NULL; only ever read into align_ms and measure_ms
 * Deterministic: depends on the two faces, w's model and the threshold alone.
 * Returns ST_OK (an inconclusive comparison included), ST_ENOMEM. */
enum status face_compare(const struct face *tmpl, const struct face *probe,
                         double threshold_mm, double (*clock_ms)(void),
                         struct face_work *w, struct face_result *out);

/* face_place(f, w): find f->frame anew, by the mean face of w's model.  ST_OK, ST_ENOMEM. */
enum status face_place(struct face *f, struct face_work *w);

/* face_gap(tmpl, probe, transform, w, out): the gap per cell at a pose (probe -> template,
 * as in align_result), or with transform NULL at the pose that is found: what there is to
 * learn from (learn.h).  Returns ST_OK, ST_ENOMEM. */
enum status face_gap(const struct face *tmpl, const struct face *probe,
                     const double *transform, struct face_work *w, struct cells *out);

/* What a comparison was decided on, per cell of the template's canonical frame (grid.h). */
struct face_field {
    float gap_mm[GRID_N]; /* the mean gap, probe minus template (cells.h) */
    float
        rest_mm[GRID_N]; /* of it what is left once learned change is taken out (fit.h) */
    float weight[GRID_N];   /* what the cell counts, the sum is 1; 0: not covered */
    float local_mm[GRID_N]; /* what weight averages to the disparity (score_cells()) */
};

/* face_field(tmpl, probe, transform, w, out): what face_compare(), whose transform it is,
 * decided on.  The cost of a measure.  Returns ST_OK, ST_ENOMEM. */
enum status face_field(const struct face *tmpl, const struct face *probe,
                       const double transform[16], struct face_work *w,
                       struct face_field *out);

/* face_asymmetry(f, w, out): f against its mirror image, from the symmetry plane of its
 * canonical frame (asymmetry.h).  Deterministic.  Returns ST_OK, ST_ENOMEM. */
enum status face_asymmetry(const struct face *f, struct face_work *w,
                           struct asymmetry *out);

#endif
