#include "face.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "align_field.h"
#include "asymmetry.h"
#include "cells.h"
#include "decision.h"
#include "fit.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "mesh_link.h"
#include "minimal.h"
#include "model.h"
#include "model_digest.h"
#include "quality.h"
#include "score.h"
#include "shape_work.h"
#include "tuning.h"

struct face_work {
    struct measure_work measure; /* its scratch serves the builders too */
    struct align_work align;
    struct surface upright; /* asymmetry_find()'s */
    struct face mirrored;   /* face_compare_mirrored()'s probe */
    const struct model *model;
    struct frame_mean mean;          /* the model's */
    struct fit_basis motion, change; /* the model's */
    struct fit_basis *part;   /* [SCORE_PARTS], its change for a part of the face */
    struct shape_work *shape; /* both NULL until they are asked for */
    struct decision decision;
};

void face_engine(const struct model *m, char out[FACE_ENGINE_MAX + 1])
{
    const uint64_t digest = model_digest(m != NULL ? m : &model_default);

    (void)snprintf(out, FACE_ENGINE_MAX + 1, "%s model/%08x", FACE_ENGINE,
                   (unsigned)(digest >> 32));
}

bool face_same_engine(const char *a, const char *b)
{
    /* "surfaced/VERSION measure/N model/HHHHHHHH" */
    const char *x = strchr(a, ' '), *y = strchr(b, ' ');

    return x != NULL && y != NULL && strcmp(x, y) == 0;
}

struct face_work *face_work_new(const struct model *m)
{
    struct face_work *w = mem_array(1, sizeof *w);

    if (w == NULL)
        return NULL;
    memset(w, 0, sizeof *w);
    w->model = m != NULL ? m : &model_default;
    w->decision = w->model->decision;
    fit_prepare(&w->model->motion, &w->motion);
    fit_prepare(&w->model->change, &w->change);
    if (frame_mean_make(w->model, &w->mean) != ST_OK) {
        face_work_free(w);
        return NULL;
    }
    return w;
}

void face_work_decide(struct face_work *w, const struct decision *d)
{
    w->decision = d != NULL ? *d : w->model->decision;
}

const struct model *face_work_model(const struct face_work *w)
{
    return w->model;
}

const struct frame_mean *face_work_mean(const struct face_work *w)
{
    return &w->mean;
}

struct shape_work *face_work_shape(struct face_work *w)
{
    if (w->shape == NULL && (w->shape = mem_array(1, sizeof *w->shape)) != NULL)
        shape_work_prepare(w->model, w->shape);
    return w->shape;
}

void face_work_free(struct face_work *w)
{
    if (w == NULL)
        return;
    measure_work_free(&w->measure);
    align_work_free(&w->align);
    surface_free(&w->upright);
    face_free(&w->mirrored);
    if (w->shape != NULL)
        shape_work_free(w->shape);
    mem_free(w->shape);
    mem_free(w->part);
    mem_free(w);
}

void face_work_wipe(struct face_work *w)
{
    measure_work_wipe(&w->measure, FACE_WORK_KEEP);
    align_work_wipe(&w->align, FACE_WORK_KEEP);
    surface_free(&w->upright);
    face_free(&w->mirrored);
    if (w->shape != NULL)
        shape_work_wipe(w->shape, FACE_WORK_KEEP);
}

void face_free(struct face *f)
{
    if (f == NULL)
        return;
    surface_free(&f->surface);
    memset(f, 0, sizeof *f);
}

/* Search and measure use one block in turns: before and after a search. */
static void exchange(struct face_work *w)
{
    const struct scratch block = w->measure.scratch;

    w->measure.scratch = w->align.field;
    w->align.field = block;
}

static void clear(struct face *f)
{
    f->surface.mesh.nv = f->surface.mesh.nt = 0;
}

enum status face_place(struct face *f, struct face_work *w)
{
    enum status st;

    exchange(w);
    st = frame_find(&w->mean, &f->surface, &w->align, &f->frame);
    exchange(w);
    return st;
}

enum status face_adopt(struct face *f, struct face_work *w)
{
    enum status st = mesh_link(&f->surface.mesh, &w->measure.scratch);

    f->hidden = 0;
    if (st == ST_OK)
        st = surface_derive(&f->surface, &w->measure.scratch);
    if (st == ST_OK && f->frame.mean_id != w->mean.mean_id)
        st = face_place(f, w);
    if (st != ST_OK)
        clear(f);
    return st;
}

/* What face_build() does once the points are on the lattice.  flatten: lay spikes flat. */
static enum status build(const struct ivec3 *pts, size_t n, bool flatten,
                         struct face_work *w, struct face *out)
{
    struct scratch *s = &w->measure.scratch;
    enum status st;

    /* In this order: points on one spot are degenerate before they are small, and a face
     * in metres taken for millimetres is small before its points coincide. */
    if ((st = surface_prepare(pts, n, flatten, s, &out->surface)) != ST_OK ||
        (st = quality_extent(pts, n, s)) != ST_OK)
        return st;
    if (out->surface.mesh.nv < FACE_MIN_POINTS)
        return ST_ETOOFEW;
    if ((st = quality_rate(&out->surface, s, &out->quality)) != ST_OK ||
        (st = face_place(out, w)) != ST_OK)
        return st;
    return quality_place(&out->frame);
}

enum status face_build(const struct dvec3 *pts, size_t n, struct face_work *w,
                       struct face *out, size_t *bad)
{
    struct ivec3 *lattice;
    enum status st;

    clear(out);
    out->frame = (struct frame){0};
    out->hidden = 0;
    if (n < FACE_MIN_POINTS)
        return ST_ETOOFEW;
    if (n > MESH_MAX_POINTS)
        return ST_ELIMIT;
    if ((lattice = scratch_need(&w->measure.points, n * sizeof *lattice)) == NULL)
        return ST_ENOMEM;
    st = lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, bad);
    if (st == ST_OK)
        st = build(lattice, n, true, w, out);
    if (st != ST_OK)
        clear(out);
    return st;
}

enum status face_rebuild(struct face *f, struct face_work *w)
{
    const struct mesh *m = &f->surface.mesh;
    const uint32_t n = m->nv;
    struct ivec3 *pts = scratch_need(&w->measure.points, n * sizeof *pts);
    enum status st = ST_ENOMEM;

    if (pts != NULL) {
        for (uint32_t v = 0; v < n; v++)
            pts[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
        f->frame = (struct frame){0};
        st = build(pts, n, false, w, f);
    }
    if (st != ST_OK)
        clear(f);
    return st;
}

static bool comparable(const struct face_result *r)
{
    return r->align.stop != ALIGN_APART && r->overlap >= DECISION_MIN_OVERLAP &&
           r->weight_overlap >= DECISION_MIN_WEIGHT;
}

/* doubt_mm: how far above the threshold nothing can be said. */
static enum face_decision decide(const struct face_result *r, double doubt_mm)
{
    if (!r->comparable)
        return FACE_INCONCLUSIVE;
    if (r->score_mm <= r->threshold_mm)
        return FACE_MATCH;
    return r->score_mm <= r->threshold_mm + doubt_mm ? FACE_INCONCLUSIVE : FACE_NO_MATCH;
}

/* The deviation of the sum of two errors.  (sqrt() has the same digits everywhere, hypot()
 * has not.) */
static double together(double a, double b)
{
    return sqrt(a * a + b * b);
}

/* The pose of the probe over the template. */
static enum status search(const struct face *tmpl, const struct face *probe,
                          struct face_work *w, struct align_result *out)
{
    const struct align_pose first =
        align_pose_after(&tmpl->frame.pose, &probe->frame.pose);
    const struct align_weight u = {w->mean.rigid, tmpl->frame.pose};
    const struct align_how how = {.start = &first, .u = &u, .motion = &w->motion};
    enum status st;

    exchange(w);
    st = align_search(&tmpl->surface, &probe->surface, &how, &w->align, out);
    exchange(w);
    return st;
}

/* The gap per cell at a pose, and the overlap there (cells.h). */
static enum status gaps(const struct face *tmpl, const struct face *probe,
                        const double transform[16], struct face_work *w,
                        struct cells *cells, double *overlap)
{
    const enum status st =
        measure_gaps(&tmpl->surface, &probe->surface, transform, &w->measure);

    if (st != ST_OK)
        return st;
    return cells_measure(&tmpl->surface, &w->measure, &tmpl->frame.pose, cells, overlap);
}

enum status face_gap(const struct face *tmpl, const struct face *probe,
                     const double *transform, struct face_work *w, struct cells *out)
{
    struct align_result found;
    enum status st = ST_OK;
    double overlap;

    if (transform == NULL)
        st = search(tmpl, probe, w, &found);
    if (st == ST_OK)
        st = gaps(tmpl, probe, transform != NULL ? transform : found.transform, w, out,
                  &overlap);
    return st;
}

/* Few comparisons are open, and the parts' tables take 70 KB. */
static bool need_parts(struct face_work *w)
{
    if (w->part != NULL)
        return true;
    if ((w->part = mem_array(SCORE_PARTS, sizeof *w->part)) == NULL)
        return false;
    for (int i = 0; i < SCORE_PARTS; i++)
        score_prepare_part(w->model, (enum score_part)i, &w->part[i]);
    return true;
}

/* The terms of a comparison by the threshold t. */
static enum status terms_of(const struct face *tmpl, const struct face *probe,
                            const struct cells *cells, const struct score *score,
                            double t, struct face_work *w, struct decision_terms *out)
{
    struct decision_pair p = {
        .score_mm = score->mm,
        .part_mm = (double)INFINITY,
        .noise_mm = together(tmpl->quality.noise_mm, probe->quality.noise_mm),
        .rough_mm = score->rough_mm,
        .hidden = probe->hidden};
    const bool open = decision_open(t, &p);

    if (open && !need_parts(w))
        return ST_ENOMEM;
    for (int i = 0; i < SCORE_PARTS && open; i++) {
        double mm;
        const enum status st = score_of_part(w->model, (enum score_part)i, &w->part[i],
                                             cells, &w->align.fit, &mm);

        if (st != ST_OK)
            return st;
        p.part_mm = fmin(p.part_mm, mm);
    }
    *out = decision_terms(t, &p);
    return ST_OK;
}

enum status face_compare(const struct face *tmpl, const struct face *probe,
                         double threshold_mm, double (*clock_ms)(void),
                         struct face_work *w, struct face_result *out)
{
    const double start = clock_ms != NULL ? clock_ms() : 0;
    struct cells cells;
    struct score score;
    struct fit fit;
    struct decision_terms terms;
    double aligned;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = search(tmpl, probe, w, &out->align)) != ST_OK)
        return st;
    aligned = clock_ms != NULL ? clock_ms() : 0;
    if ((st = gaps(tmpl, probe, out->align.transform, w, &cells, &out->overlap)) !=
            ST_OK ||
        (st = score_of(w->model, &w->change, &cells, &w->align.fit, &fit, &score)) !=
            ST_OK ||
        (st = terms_of(tmpl, probe, &cells, &score,
                       threshold_mm > 0 ? threshold_mm : w->decision.threshold_mm, w,
                       &terms)) != ST_OK)
        return st;
    out->align_ms = aligned - start;
    out->measure_ms = clock_ms != NULL ? clock_ms() - aligned : 0;

    out->threshold_mm = terms.threshold_mm;
    out->score_mm = score.mm;
    out->calibrated_mm = terms.calibrated_mm;
    out->rise_mm = terms.rise_mm;
    out->factor = terms.factor;
    out->weight_overlap = score.weight;
    out->fmr_at_score =
        score.weight > 0 ? decision_fmr(&w->decision, out->calibrated_mm) : 1;
    out->change_mm = score.change_mm;
    memcpy(out->region_mm, score.region_mm, sizeof out->region_mm);
    memcpy(out->region_weight, score.region_weight, sizeof out->region_weight);
    out->comparable = comparable(out);
    out->decision = decide(out, terms.doubt_mm);
    return ST_OK;
}

void face_round(struct face_result *r, const struct face_work *w)
{
    const double above = ceil(r->threshold_mm * 1e3 - 1e-9); /* 0.138 is 0.138 */
    const double score = round(r->score_mm * 1e3);
    const bool fits = r->score_mm <= r->threshold_mm;

    if (r->rise_mm > 0)
        r->rise_mm += above / 1e3 - r->threshold_mm;
    r->threshold_mm = above / 1e3;
    r->score_mm = (fits ? score : fmax(score, above + 1)) / 1e3;
    r->overlap = round(r->overlap * 1e2) / 1e2;
    if (r->factor > 0) {
        r->calibrated_mm = fmax(0, (r->score_mm - r->rise_mm) / r->factor);
        if (r->weight_overlap > 0)
            r->fmr_at_score = decision_fmr(&w->decision, r->calibrated_mm);
    }
}

enum status face_compare_mirrored(const struct face *tmpl, const struct face *probe,
                                  double (*clock_ms)(void), struct face_work *w,
                                  struct face_result *out)
{
    static const double swap[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct face *m = &w->mirrored;
    double *r = m->frame.pose.r;
    enum status st = surface_move(&probe->surface, swap, &w->measure.points,
                                  &w->measure.scratch, &m->surface);

    if (st != ST_OK)
        return st;
    m->quality = probe->quality;
    m->hidden = probe->hidden;
    m->frame = probe->frame;
    r[1] = -r[1]; /* the frame is mirrored with it */
    r[2] = -r[2];
    r[3] = -r[3];
    r[6] = -r[6];
    m->frame.pose.t[0] = -m->frame.pose.t[0];
    return face_compare(tmpl, m, 0, clock_ms, w, out);
}

enum status face_minimal(const struct face *tmpl, const struct face *probe,
                         const double transform[16], double (*clock_ms)(void),
                         struct face_work *w, struct minimal *out)
{
    const double start = clock_ms != NULL ? clock_ms() : 0;
    const enum status st =
        minimal_find(&tmpl->surface, &probe->surface, transform, &w->measure, out);
    if (clock_ms != NULL)
        out->ms = clock_ms() - start;
    return st;
}

enum status face_weigh(const struct face *tmpl, const struct face *probe,
                       struct face_work *w, struct minimal *least)
{
    const struct score_weight u = {w->model->weight, tmpl->frame.pose};

    return measure_at(&tmpl->surface, &probe->surface, least->transform,
                      &(struct disparity_weight){score_weight_at, &u}, &w->measure,
                      &least->disparity);
}

enum status face_field(const struct face *tmpl, const struct face *probe,
                       const double transform[16], struct face_work *w,
                       struct face_field *out)
{
    struct score_cells part;
    struct cells cells;
    struct score score;
    struct fit fit;
    double overlap;
    enum status st = gaps(tmpl, probe, transform, w, &cells, &overlap);

    if (st == ST_OK)
        st = score_of(w->model, &w->change, &cells, &w->align.fit, &fit, &score);
    if (st != ST_OK)
        return st;
    score_cells(w->model, &cells, &fit, &score, &part);
    memcpy(out->gap_mm, cells.gap, sizeof out->gap_mm);
    memcpy(out->rest_mm, fit.rest, sizeof out->rest_mm);
    memcpy(out->weight, part.weight, sizeof out->weight);
    memcpy(out->local_mm, part.local_mm, sizeof out->local_mm);
    return ST_OK;
}

enum status face_asymmetry(const struct face *f, struct face_work *w,
                           struct asymmetry *out)
{
    static const struct align_pose upright = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct score_weight u = {w->model->weight, upright};

    return asymmetry_find(&f->surface, &f->frame.pose,
                          &(struct disparity_weight){score_weight_at, &u}, &w->measure,
                          &w->upright, out);
}
