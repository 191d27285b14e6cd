#include "face.h"

#include <math.h>
#include <string.h>

#include "decision.h"
#include "delaunay.h"
#include "holes.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "model.h"
#include "mst.h"
#include "quality.h"
#include "weight.h"

struct face_work {
    struct measure_work measure; /* its scratch serves the builders too */
    struct scratch points;       /* a cloud on the lattice */
    const struct model *model;
    struct decision decision;
};

struct face_work *face_work_new(const struct model *m)
{
    struct face_work *w = mem_array(1, sizeof *w);

    if (w == NULL)
        return NULL;
    memset(w, 0, sizeof *w);
    w->model = m != NULL ? m : &model_default;
    w->decision = w->model->decision;
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

enum status face_derive(struct face *f, struct face_work *w)
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

enum status face_adopt(struct face *f, struct face_work *w)
{
    enum status st = mesh_link(&f->mesh, &w->measure.scratch);

    if (st == ST_OK)
        st = face_derive(f, w);
    if (st != ST_OK)
        f->mesh.nv = f->mesh.nt = 0;
    return st;
}

/* What face_build() does once the points are on the lattice. */
static enum status build(const struct ivec3 *pts, size_t n, struct face_work *w,
                         struct face *out)
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
    if ((st = mst_build(m, s)) != ST_OK || (st = face_derive(out, w)) != ST_OK ||
        (st = quality_spikes(m, s)) != ST_OK)
        return st;
    return quality_rate(out, s);
}

enum status face_build(const struct dvec3 *pts, size_t n, struct face_work *w,
                       struct face *out, size_t *bad)
{
    struct ivec3 *lattice;
    enum status st;

    out->mesh.nv = out->mesh.nt = 0;
    if (n < FACE_MIN_POINTS)
        return ST_ETOOFEW;
    if (n > MESH_MAX_POINTS)
        return ST_ELIMIT;
    if ((lattice = scratch_need(&w->points, n * sizeof *lattice)) == NULL)
        return ST_ENOMEM;
    st = lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, bad);
    if (st == ST_OK)
        st = build(lattice, n, w, out);
    if (st != ST_OK)
        out->mesh.nv = out->mesh.nt = 0;
    return st;
}

static struct measure_surface surface_of(const struct face *f)
{
    return (struct measure_surface){&f->mesh, f->raw, f->spacing, f->bridge, f->measured};
}

enum status face_compare(const struct face *tmpl, const struct face *probe,
                         double threshold_mm, double (*clock_ms)(void),
                         struct face_work *w, struct face_result *out)
{
    const struct measure_surface a = surface_of(tmpl), b = surface_of(probe);
    const double start = clock_ms != NULL ? clock_ms() : 0;
    struct weight_face rigid;
    struct disparity_weight u;
    double aligned, total, share;
    enum status st;

    memset(out, 0, sizeof *out);
    u = weight_of(&a, &rigid);
    st = align_search(&a, &b, &u, &w->measure.scratch, &out->align);
    if (st != ST_OK)
        return st;
    aligned = clock_ms != NULL ? clock_ms() : 0;
    st = align_finish(&a, &b, &u, &w->measure, &out->align, &out->measure);
    if (st != ST_OK)
        return st;
    out->align_ms = aligned - start;
    out->measure_ms = clock_ms != NULL ? clock_ms() - aligned : 0;

    out->threshold_mm = threshold_mm > 0 ? threshold_mm : w->decision.threshold_mm;
    out->disparity_mm = out->measure.weighted_mm;
    out->fmr_at_score =
        out->measure.cells > 0 ? decision_fmr(&w->decision, out->disparity_mm) : 1;
    total = weight_total(&a, &u);
    share = total > 0 ? out->measure.weight_mm2 / total : 0;
    out->weight_overlap = share < 1 ? share : 1;
    if (out->align.stop == ALIGN_APART || out->measure.overlap < decision_min_overlap ||
        out->weight_overlap < decision_min_overlap)
        out->decision = FACE_INCONCLUSIVE;
    else
        out->decision =
            out->disparity_mm <= out->threshold_mm ? FACE_MATCH : FACE_NO_MATCH;
    return ST_OK;
}
