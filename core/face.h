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
#include "mesh.h"
#include "status.h"
#include "vec.h"

#define FACE_ENGINE     "surfaced/0.1.0 measure/1"
#define FACE_MIN_POINTS 100
#define FACE_MAX_POINTS 300000 /* default limit */

struct face_quality {
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* measured area over the hull's area, 0..1 */
    double density_mm; /* typical distance between neighbours */
    double noise_mm;   /* white noise estimated from the surface itself */
};

struct face {
    struct mesh mesh;
    float *spacing;  /* [nv] holes_spacing() */
    uint8_t *bridge; /* [nt] holes_mark() */
    int32_t *raw;    /* [nv] heights as scanned; the mesh's have the spikes laid flat */
    double measured; /* square lattice units */
    struct face_quality quality;
    void *block;  /* holds spacing, raw and bridge */
    uint32_t cap; /* points block has room for */
};

struct model; /* model.h */

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
 * lattice, triangulation, spikes laid flat, spanning tree, holes, quality gate.
 * out   all zero or a former face, whose memory is used again; on failure it is empty but
 *       may still hold memory: face_free().
 * bad   index of the offending point for ST_ENOTFINITE and ST_ERANGE; may be NULL
 * Returns ST_OK; ST_ETOOFEW (< FACE_MIN_POINTS usable); ST_ENOTFINITE; ST_ERANGE;
 * ST_EDEGENERATE; ST_EUNITS (extent outside 60-500 mm); ST_ENOTFACE; ST_EQUALITY;
 * ST_ENOMEM; ST_ELIMIT. */
enum status face_build(const struct dvec3 *pts, size_t n, struct face_work *w,
                       struct face *out, size_t *bad);
void face_free(struct face *f); /* NULL and empty ones are allowed */

/* face_derive(f, w): set everything but the mesh from f->mesh (decoded, linked and with
 * its tree).  Returns ST_OK, ST_ENOMEM. */
enum status face_derive(struct face *f, struct face_work *w);

/* face_adopt(f, w): for decoding: mesh_link() and then face_derive().  f->mesh has nv, nt,
 * xy, z, org and parent, all of them unproven.
 * Returns ST_OK, ST_ECORRUPT (f->mesh.nv is 0 then), ST_ENOMEM. */
enum status face_adopt(struct face *f, struct face_work *w);

enum face_decision { FACE_MATCH, FACE_NO_MATCH, FACE_INCONCLUSIVE };

struct face_result {
    enum face_decision decision;
    double disparity_mm; /* the weighted disparity the decision was taken on */
    double threshold_mm;
    double weight_overlap; /* share of the template's weight (weight.h) that lies in the
                              common area, 0..1 */
    double fmr_at_score;   /* share of impostors at or below disparity_mm */
    struct disparity measure;
    struct align_result
        align; /* transform probe -> template, evaluations, why it stopped */
    double align_ms, measure_ms; /* by the caller's clock; 0 without one */
};

/* face_compare(tmpl, probe, threshold_mm, clock_ms, w, out): align the probe to the
 * template, measure the minimal disparity, decide.
 * threshold_mm  0 or less: that of w's calibration
 * clock_ms      may be NULL; only ever read into align_ms and measure_ms
 * Deterministic: depends on the two models and the threshold alone.
 * Returns ST_OK (an inconclusive comparison included), ST_ENOMEM. */
enum status face_compare(const struct face *tmpl, const struct face *probe,
                         double threshold_mm, double (*clock_ms)(void),
                         struct face_work *w, struct face_result *out);

/* face_heatmap(tmpl, pts, n, transform, gap_mm): for detail=heatmap: the signed gap
 * (probe minus template, mm) at each of the probe's own points in the order given, NAN
 * where the template does not cover it or it is off the lattice.
 * Cost  O(tmpl->mesh.nv + n) for points spread like the template's, in any order. */
void face_heatmap(const struct face *tmpl, const struct dvec3 *pts, size_t n,
                  const double transform[16], double *gap_mm);

#endif
