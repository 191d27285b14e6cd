/* face.h -- a face from a scan's points, and the comparison of two faces.
 * A face is immutable once built: any number of threads may compare it at the same time.
 * "Model" is what is known of faces in general (model.h), never a face. */
#ifndef CORE_FACE_H
#define CORE_FACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "align.h"
#include "decision.h"
#include "frame.h"
#include "grid.h"
#include "quality.h"
#include "status.h"
#include "surface.h"
#include "vec.h"

#define FACE_ENGINE     "surfaced/0.2.0 measure/4" /* and a model: face_engine() */
#define FACE_ENGINE_MAX 63
#define FACE_MIN_POINTS 100
#define FACE_MAX_POINTS 1000000 /* default limit: a depth image of 1280 x 720 fits */

struct face {
    struct surface surface;
    struct quality quality;
    struct frame frame; /* its canonical frame */
    /* share of the face that the scan does not show, as something covers it or it is
     * turned away, 0..1; 0 until whoever looked at more than these points says so. It
     * is not stored: it counts for probes */
    double hidden;
};

struct asymmetry;  /* asymmetry.h */
struct cells;      /* cells.h */
struct minimal;    /* minimal.h */
struct model;      /* model.h */
struct shape_work; /* shape_work.h */

/* face_engine(m, out): what makes scores: "surfaced/VERSION measure/N model/HHHHHHHH",
 * with the first 8 hex digits of m's digest (NULL: model_default).  N is counted up with
 * every change that gives two scans another score, or the same points another face.
 * Scores and calibrations of another N or another model are not comparable.  About 1 ms. */
void face_engine(const struct model *m, char out[FACE_ENGINE_MAX + 1]);

/* face_same_engine(a, b): are scores of the engines a and b comparable?  True where all but
 * the version is the same. */
bool face_same_engine(const char *a, const char *b);

/* A worker's reusable memory for building and comparing: after the first few calls nothing
 * is allocated any more.  One thread at a time. */
struct face_work;
/* face_work_new(m): m is the model to build and compare by, borrowed; NULL: model_default.
 * Returns NULL when out of memory. */
struct face_work *face_work_new(const struct model *m);
void face_work_free(struct face_work *w);

/* face_work_wipe(w): nothing of the faces that w has worked on stays in its memory, and what
 * more than FACE_WORK_KEEP bytes in a block were needed for is given back: faces of up to
 * 10,000 points are worked on without allocating again.  O(bytes used since the last time). */
#define FACE_WORK_KEEP ((size_t)4 << 20)
void face_work_wipe(struct face_work *w);

/* face_work_decide(w, d): from now on decide by the calibration d (copied); NULL: by the
 * model's own. */
void face_work_decide(struct face_work *w, const struct decision *d);

/* The model that w was made with, its mean face ready to align to, and its shape ready to be
 * fitted, which takes 0.4 MB from the first call on; NULL: out of memory. */
const struct model *face_work_model(const struct face_work *w);
const struct frame_mean *face_work_mean(const struct face_work *w);
struct shape_work *face_work_shape(struct face_work *w);

/* face_build(pts, n, w, out, bad): a face from a scanner's points (mm, any order): lattice,
 * surface, quality gate, canonical frame.
 * The gate is a coarse one (quality_place()): out->frame.likeness may be low, and NAN where too
 * little of the mean face is covered to tell; it decides nothing later.  Whether the points are
 * a face, scan/gate.h judges, for which what cannot be told is a refusal.
 * out   all zero, or a former face, whose memory is used again; on failure it is empty but
 *       may still hold memory: face_free().
 * bad   the index of the offending point for ST_ENOTFINITE and ST_ERANGE; may be NULL
 * Returns ST_OK; ST_ETOOFEW (< FACE_MIN_POINTS usable); ST_ENOTFINITE; ST_ERANGE;
 * ST_EDEGENERATE; ST_EUNITS (extent outside 60-500 mm); ST_ENOTFACE; ST_EQUALITY;
 * ST_ENOMEM; ST_ELIMIT. */
enum status face_build(const struct dvec3 *pts, size_t n, struct face_work *w,
                       struct face *out, size_t *bad);
void face_free(struct face *f); /* NULL and empty ones are allowed */

/* face_adopt(f, w): for decoding: mesh_link(), then everything that follows from the mesh.
 * On entry f->surface.mesh has what mesh_link() reads, nothing of it checked, and f->frame is
 * the stored frame (mean_id 0: none).  The frame is found again where it belongs to another
 * model's mean face.
 * Returns ST_OK, ST_ECORRUPT (f->surface.mesh.nv is 0 then), ST_ENOMEM. */
enum status face_adopt(struct face *f, struct face_work *w);

/* face_rebuild(f, w): replace f, which another engine built, by what this engine builds from
 * the same points.  Spikes stay as they were laid flat.  The points do not change by a bit,
 * so a second call changes nothing, nor does a first one on a face of this engine.
 * Returns as face_build(), except for the statuses about single points; f is empty on
 * failure.  Costs about as much as face_build(). */
enum status face_rebuild(struct face *f, struct face_work *w);

enum face_decision { FACE_MATCH, FACE_NO_MATCH, FACE_INCONCLUSIVE };

struct face_result {
    enum face_decision decision;
    bool comparable; /* there is enough in common; else the decision is inconclusive */
    double score_mm; /* what the decision was taken on (score.h) */
    double threshold_mm; /* what it had to be at most: the calibration's, changed by what
                             was compared (decision.h) */
    /* the score as if that had not changed: to compare with scores of other pairs and
     * with the calibration's threshold */
    double calibrated_mm;
    double rise_mm, factor; /* how that follows from the score (decision.h) */
    double fmr_at_score;    /* false match rate at a threshold of it (decision.h) */
    double overlap;         /* share of the template's measured area covered, 0..1 */
    double weight_overlap;  /* share of a whole face's weight in the common area, 0..1 */
    double change_mm;       /* root mean square of the change taken out (score.h) */
    double region_mm[GRID_REGIONS];     /* score of each region alone; NAN: not covered */
    double region_weight[GRID_REGIONS]; /* its share of a whole face's weight, 0..1 */
    struct align_result align;          /* transform probe -> template, certainty */
    double align_ms, measure_ms;        /* by the caller's clock; 0 without one */
};

/* face_compare(tmpl, probe, threshold_mm, clock_ms, w, out): align the probe to the
 * template, compute the score at that pose, decide.
 * threshold_mm  in place of that of w's calibration; 0 or less: that
 * clock_ms      may be NULL; used only for align_ms and measure_ms
 * The result depends only on the two faces, w's model, the calibration and the threshold.
 * Returns ST_OK (an inconclusive comparison included), ST_ENOMEM. */
enum status face_compare(const struct face *tmpl, const struct face *probe,
                         double threshold_mm, double (*clock_ms)(void),
                         struct face_work *w, struct face_result *out);

/* face_round(r, w): the score is rounded to 0.001 mm, the threshold up to 0.001 mm, the overlap
 * to 0.01, and fmr_at_score is that of the rounded score, by w's calibration (that of the
 * comparison), and of a rise of the threshold that is rounded as the threshold is: for who may
 * be told the decision, and should not learn a face from many scores.  The decision stays, and
 * the rounded numbers agree with it: a score above the threshold stays above, by 0.001 mm or
 * more. */
void face_round(struct face_result *r, const struct face_work *w);

/* face_compare_mirrored(tmpl, probe, clock_ms, w, out): face_compare() with the mirror image of
 * the probe (x to -x), at w's threshold: to tell whether a scanner swaps left and right.  The
 * cost of a triangulation more.  Returns ST_OK, ST_ENOMEM. */
enum status face_compare_mirrored(const struct face *tmpl, const struct face *probe,
                                  double (*clock_ms)(void), struct face_work *w,
                                  struct face_result *out);

/* face_minimal(tmpl, probe, transform, clock_ms, w, out): the minimal disparity, from the pose
 * that face_compare() found (minimal.h).  clock_ms: may be NULL.  Returns ST_OK, ST_ENOMEM. */
enum status face_minimal(const struct face *tmpl, const struct face *probe,
                         const double transform[16], double (*clock_ms)(void),
                         struct face_work *w, struct minimal *out);

/* face_weigh(tmpl, probe, w, least): least->disparity.weighted_mm and weight_mm2 by the
 * learned u of w's model, at the pose that face_minimal() found.  The cost of a measure.
 * Returns ST_OK, ST_ENOMEM. */
enum status face_weigh(const struct face *tmpl, const struct face *probe,
                       struct face_work *w, struct minimal *least);

/* face_place(f, w): find f->frame by the mean face of w's model.  ST_OK, ST_ENOMEM. */
enum status face_place(struct face *f, struct face_work *w);

/* face_gap(tmpl, probe, transform, w, out): the gap per cell at a pose (probe -> template, as
 * in align_result); transform NULL: at the pose that face_compare() would find.  A sample to
 * learn from (learn.h).  Returns ST_OK, ST_ENOMEM. */
enum status face_gap(const struct face *tmpl, const struct face *probe,
                     const double *transform, struct face_work *w, struct cells *out);

/* What a comparison was decided on, per cell of the template's canonical frame (grid.h). */
struct face_field {
    float gap_mm[GRID_N]; /* the mean gap, probe minus template (cells.h) */
    float
        rest_mm[GRID_N]; /* of it what is left once learned change is taken out (fit.h) */
    float weight[GRID_N];   /* what the cell counts, the sum is 1; 0: not covered */
    float local_mm[GRID_N]; /* what weight averages to the score (score_cells()) */
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
