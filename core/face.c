#include "face.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "align_field.h"
#include "asymmetry.h"
#include "cells.h"
#include "decision.h"
#include "delaunay.h"
#include "fit.h"
#include "holes.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "model.h"
#include "mst.h"
#include "quality.h"
#include "score.h"

struct face_work {
    struct measure_work measure; /* its scratch serves the builders too */
    struct scratch points;       /* a cloud on the lattice */
    struct align_work align;
    struct asymmetry_work asymmetry;
    const struct model *model;
    struct frame_mean mean;          /* the model's */
    struct fit_basis motion, change; /* the model's */
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
    if (frame_mean_make(w->model, &w->points, &w->mean) != ST_OK) {
        face_work_free(w);
        return NULL;
    }
    return w;
}

void face_work_decide(struct face_work *w, const struct decision *d)
{
    w->decision = d != NULL ? *d : w->model->decision;
}

void face_work_free(struct face_work *w)
{
    if (w == NULL)
        return;
    measure_work_free(&w->measure);
    align_work_free(&w->align);
    asymmetry_work_free(&w->asymmetry);
    frame_mean_free(&w->mean);
    scratch_free(&w->points);
    mem_free(w);
}

void face_free(struct face *f)
{
    if (f == NULL)
        return;
    mesh_free(&f->mesh);
    mem_free(f->block);
    memset(f, 0, sizeof *f);
}

/* Search and measure use one block in turns: before and after a search. */
static void exchange(struct face_work *w)
{
    const struct scratch block = w->measure.scratch;

    w->measure.scratch = w->align.field;
    w->align.field = block;
}

static struct measure_surface surface_of(const struct face *f)
{
    return (struct measure_surface){&f->mesh, f->raw, f->spacing, f->bridge, f->measured};
}

/* Everything that follows from the mesh with its tree. */
static enum status derive(struct face *f, struct face_work *w)
{
    const size_t nv = f->mesh.nv, spacing = mem_round(nv * sizeof *f->spacing);
    const size_t raw = spacing + mem_round(nv * sizeof *f->raw);
    unsigned char *block;
    enum status st;

    if (f->block == NULL || f->cap < nv) {
        if ((block = mem_array(raw + 2 * nv, 1)) == NULL)
            return ST_ENOMEM;
        mem_free(f->block);
        f->block = block;
        f->cap = (uint32_t)nv;
    }
    f->spacing = f->block;
    f->raw = (int32_t *)(void *)((unsigned char *)f->block + spacing);
    f->bridge = (uint8_t *)f->block + raw;
    memcpy(f->raw, f->mesh.z, nv * sizeof *f->raw);
    if ((st = holes_spacing(&f->mesh, &w->measure.scratch, f->spacing)) != ST_OK)
        return st;
    f->measured = holes_mark(&f->mesh, f->spacing, f->bridge);
    return ST_OK;
}

enum status face_place(struct face *f, struct face_work *w)
{
    const struct measure_surface s = surface_of(f);
    enum status st;

    exchange(w);
    st = frame_find(&w->mean, &s, &w->align, &f->frame);
    exchange(w);
    return st;
}

enum status face_adopt(struct face *f, struct face_work *w)
{
    enum status st = mesh_link(&f->mesh, &w->measure.scratch);

    if (st == ST_OK)
        st = derive(f, w);
    if (st == ST_OK && f->frame.mark != w->mean.mark)
        st = face_place(f, w);
    if (st != ST_OK)
        f->mesh.nv = f->mesh.nt = 0;
    return st;
}

/* What face_build() does once the points are on the lattice.  laid: their spikes are laid
 * flat already. */
static enum status build(const struct ivec3 *pts, size_t n, bool laid,
                         struct face_work *w, struct face *out)
{
    struct scratch *s = &w->measure.scratch;
    struct mesh *m = &out->mesh;
    enum status st;

    /* In this order: points on one spot are degenerate before they are small, and a face
     * in metres taken for millimetres is small before its points coincide. */
    if ((st = delaunay_build(pts, n, s, m)) != ST_OK)
        return st;
    if ((st = quality_extent(pts, n, s)) != ST_OK)
        return st;
    if (m->nv < FACE_MIN_POINTS)
        return ST_ETOOFEW;
    if ((st = mst_build(m, s)) != ST_OK || (st = derive(out, w)) != ST_OK ||
        (!laid && (st = quality_spikes(m, s)) != ST_OK) ||
        (st = quality_rate(out, s)) != ST_OK)
        return st;
    if ((st = face_place(out, w)) != ST_OK)
        return st;
    return quality_place(&out->frame);
}

enum status face_build(const struct dvec3 *pts, size_t n, struct face_work *w,
                       struct face *out, size_t *bad)
{
    struct ivec3 *lattice;
    enum status st;

    out->mesh.nv = out->mesh.nt = 0;
    out->frame = (struct frame){0};
    if (n < FACE_MIN_POINTS)
        return ST_ETOOFEW;
    if (n > MESH_MAX_POINTS)
        return ST_ELIMIT;
    if ((lattice = scratch_need(&w->points, n * sizeof *lattice)) == NULL)
        return ST_ENOMEM;
    st = lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, bad);
    if (st == ST_OK)
        st = build(lattice, n, false, w, out);
    if (st != ST_OK)
        out->mesh.nv = out->mesh.nt = 0;
    return st;
}

enum status face_renew(struct face *f, struct face_work *w)
{
    struct mesh *m = &f->mesh;
    const uint32_t n = m->nv;
    struct ivec3 *pts = scratch_need(&w->points, n * sizeof *pts);
    enum status st = ST_ENOMEM;

    if (pts != NULL) {
        for (uint32_t v = 0; v < n; v++)
            pts[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
        f->frame = (struct frame){0};
        st = build(pts, n, true, w, f);
    }
    if (st != ST_OK)
        m->nv = m->nt = 0;
    return st;
}

static enum face_decision decide(const struct face_result *r)
{
    if (r->align.stop == ALIGN_APART || r->measure.overlap < decision_min_overlap ||
        r->weight_overlap < decision_min_weight)
        return FACE_INCONCLUSIVE;
    return r->disparity_mm <= r->threshold_mm ? FACE_MATCH : FACE_NO_MATCH;
}

/* The pose of the probe over the template. */
static enum status search(const struct face *tmpl, const struct face *probe,
                          struct face_work *w, struct align_result *out)
{
    const struct measure_surface a = surface_of(tmpl), b = surface_of(probe);
    const struct align_pose first =
        align_pose_after(&tmpl->frame.pose, &probe->frame.pose);
    const struct align_weight u = {w->mean.hold, tmpl->frame.pose};
    const struct align_how how = {&first, &u, &w->motion};
    enum status st;

    exchange(w);
    st = align_search(&a, &b, &how, &w->align, out);
    exchange(w);
    return st;
}

/* The plain measure at a pose, and the gap per cell. */
static enum status measure(const struct face *tmpl, const struct face *probe,
                           const double transform[16], struct face_work *w,
                           struct disparity *plain, struct cells *cells)
{
    const struct measure_surface a = surface_of(tmpl), b = surface_of(probe);
    const enum status st = measure_at(&a, &b, transform, NULL, &w->measure, plain);

    if (st == ST_OK)
        cells_measure(&a, &w->measure, &tmpl->frame.pose, cells);
    return st;
}

enum status face_gap(const struct face *tmpl, const struct face *probe,
                     const double *transform, struct face_work *w, struct cells *out)
{
    struct align_result found;
    struct disparity plain;
    enum status st = ST_OK;

    if (transform == NULL)
        st = search(tmpl, probe, w, &found);
    if (st == ST_OK)
        st = measure(tmpl, probe, transform != NULL ? transform : found.transform, w,
                     &plain, out);
    return st;
}

enum status face_compare(const struct face *tmpl, const struct face *probe,
                         double threshold_mm, double (*clock_ms)(void),
                         struct face_work *w, struct face_result *out)
{
    const double start = clock_ms != NULL ? clock_ms() : 0;
    struct cells cells;
    struct score score;
    struct fit fit;
    double aligned;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = search(tmpl, probe, w, &out->align)) != ST_OK)
        return st;
    aligned = clock_ms != NULL ? clock_ms() : 0;
    if ((st = measure(tmpl, probe, out->align.transform, w, &out->measure, &cells)) !=
            ST_OK ||
        (st = score_of(w->model, &w->change, &cells, &w->align.fit, &fit, &score)) !=
            ST_OK)
        return st;
    out->align_ms = aligned - start;
    out->measure_ms = clock_ms != NULL ? clock_ms() - aligned : 0;

    out->threshold_mm = threshold_mm > 0 ? threshold_mm : w->decision.threshold_mm;
    out->disparity_mm = score.disparity_mm;
    out->weight_overlap = score.weight;
    out->fmr_at_score =
        score.weight > 0 ? decision_fmr(&w->decision, out->disparity_mm) : 1;
    out->change_mm = score.change_mm;
    memcpy(out->region_mm, score.region_mm, sizeof out->region_mm);
    memcpy(out->region_weight, score.region_weight, sizeof out->region_weight);
    out->decision = decide(out);
    return ST_OK;
}

enum status face_asymmetry(const struct face *f, struct face_work *w,
                           struct asymmetry *out)
{
    const struct measure_surface s = surface_of(f);

    return asymmetry_find(&s, &f->frame.pose, &w->measure, &w->asymmetry, out);
}
