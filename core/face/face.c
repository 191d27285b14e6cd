#include "face.h"

#include <math.h>
#include <string.h>

#include "asymmetry.h"
#include "encode.h"
#include "fit.h"
#include "heights.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "mesh_link.h"
#include "minimal.h"
#include "model.h"
#include "pair.h"
#include "place.h"
#include "quality.h"
#include "ratio.h"
#include "series.h"
#include "shape_work.h"
#include "face_work.h"

/* mm^2 that two surfaces must have in common before a small disparity says anything: a quarter of a
 * face. */
#define FACE_DOUBT_AREA_MM2 4000.0

/* Support below which nothing is a face, or whoever looks at more than its surface would know. */
#define FACE_SUPPORT 0.15

/* The weights as a weight of the papers' measure: of places (lattice units) on a surface. */
struct places {
    const float *weight; /* [GRID_N] */
    struct pose frame;   /* surface -> canonical frame */
};

static float weight_at(const void *arg, double x, double y, double z)
{
    const struct places *p = arg;
    const double mm = 1 / LATTICE_PER_MM;
    const struct dvec3 q = pose_apply(&p->frame, (struct dvec3){mm * x, mm * y, mm * z});
    const uint32_t i = grid_cell(q.x, q.y);

    return i == GRID_NONE ? 0 : p->weight[i];
}

void face_free(struct surface_face *f)
{
    if (f == NULL)
        return;
    surface_free(&f->surface);
    memset(f, 0, sizeof *f);
}

void surface_face_free(struct surface_face *face)
{
    face_free(face);
    mem_free(face);
}

struct surface_face *face_renew(struct surface_face **out)
{
    struct surface_face *f = *out;

    *out = NULL;
    if (f == NULL && (f = mem_array(1, sizeof *f)) != NULL)
        memset(f, 0, sizeof *f);
    return f;
}

enum surface_status face_finish(enum status st, struct surface_face *f,
                                struct surface_face **out)
{
    if (st == ST_OK)
        *out = f;
    else
        surface_face_free(f);
    return status_to(st);
}

static void clear(struct surface_face *f)
{
    f->surface.mesh.nv = f->surface.mesh.nt = 0;
}

enum status face_adopt(struct surface_face *f, struct surface_work *w)
{
    enum status st = mesh_link(&f->surface.mesh, &w->measure.scratch);

    if (st == ST_OK)
        st = surface_derive(&f->surface, &w->measure.scratch);
    if (st == ST_OK && f->frame.mean_id != w->mean.mean_id)
        st = place_find(f, w);
    if (st != ST_OK)
        clear(f);
    return st;
}

/* The surface of points on the lattice, and its quality.  flatten: lay spikes flat. */
static enum status face_prepare(const struct ivec3 *pts, size_t n, bool flatten,
                                struct surface_work *w, struct surface_face *out)
{
    struct scratch *s = &w->measure.scratch;
    enum status st;

    /* In this order: points on one spot are degenerate before they are small, and a face
     * in metres taken for millimetres is small before its points coincide. */
    if ((st = surface_prepare(pts, n, flatten, s, &out->surface)) != ST_OK ||
        (st = quality_extent(pts, n, s)) != ST_OK)
        return st;
    if (out->surface.mesh.nv < SURFACE_MIN_POINTS)
        return ST_ETOOFEW;
    return quality_rate(&out->surface, (double)out->step_mm, s, &out->quality);
}

/* What face_build() does once the points are on the lattice. */
static enum status face_build_surface(const struct ivec3 *pts, size_t n, bool flatten,
                                      struct surface_work *w, struct surface_face *out)
{
    enum status st = face_prepare(pts, n, flatten, w, out);

    if (st != ST_OK || (st = place_find(out, w)) != ST_OK)
        return st;
    return out->frame.support > FACE_SUPPORT ? ST_OK : ST_ENOTFACE;
}

/* The points on the lattice, in w. */
static enum status face_load(const struct dvec3 *pts, size_t n, struct surface_work *w,
                             struct surface_face *out, size_t *bad,
                             struct ivec3 **lattice)
{
    clear(out);
    out->frame = (struct frame){0};
    if (n < SURFACE_MIN_POINTS)
        return ST_ETOOFEW;
    if (n > SURFACE_MAX_POINTS)
        return ST_ELIMIT;
    if ((*lattice = scratch_need(&w->measure.points, n * sizeof **lattice)) == NULL)
        return ST_ENOMEM;
    return lattice_from_mm(pts, n, LATTICE_PER_MM, *lattice, bad);
}

enum status face_build(const struct dvec3 *pts, size_t n, struct surface_work *w,
                       struct surface_face *out, size_t *bad)
{
    struct ivec3 *lattice;
    enum status st = face_load(pts, n, w, out, bad, &lattice);

    if (st == ST_OK)
        st = face_build_surface(lattice, n, true, w, out);
    if (st != ST_OK)
        clear(out);
    return st;
}

enum status face_lay(const struct dvec3 *pts, size_t n, const struct pose *pose,
                     struct surface_work *w, struct surface_face *out, size_t *bad)
{
    struct ivec3 *lattice;
    enum status st = face_load(pts, n, w, out, bad, &lattice);

    if (st == ST_OK)
        st = face_prepare(lattice, n, true, w, out);
    if (st != ST_OK)
        clear(out);
    out->frame = (struct frame){.pose = *pose, .mean_id = w->mean.mean_id};
    out->encoding.n = 0;
    return st;
}

enum status face_rebuild(struct surface_face *f, struct surface_work *w)
{
    const struct mesh *m = &f->surface.mesh;
    const uint32_t n = m->nv;
    struct ivec3 *pts = scratch_need(&w->measure.points, n * sizeof *pts);
    enum status st = ST_ENOMEM;

    if (pts != NULL) {
        for (uint32_t v = 0; v < n; v++)
            pts[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
        f->frame = (struct frame){0};
        st = face_build_surface(pts, n, false, w, f);
    }
    if (st != ST_OK)
        clear(f);
    return st;
}

enum surface_status surface_rebuild(struct surface_work *work, struct surface_face **face)
{
    struct surface_face *f = face_renew(face);

    return face_finish(f != NULL ? face_rebuild(f, work) : ST_ENOMEM, f, face);
}

enum status face_align(const struct surface_face *tmpl, const struct surface_face *probe,
                       struct surface_work *w, struct align_result *out)
{
    struct pair pair;
    enum status st = pair_make(tmpl, probe, w, &pair);
    const struct pose a = pose_unscaled(&pair.tmpl.pose);
    const struct pose b = pose_unscaled(&pair.probe.pose);
    const struct pose first = pose_after(&a, &b);
    const struct align_weight u = {w->mean.rigid, pair.tmpl.pose};
    const struct align_how how = {.start = &first, .u = &u, .motion = &w->change};

    if (st != ST_OK)
        return st;
    scratch_exchange(&w->measure.scratch, &w->align.field);
    st = align_search(&tmpl->surface, &probe->surface, &how, &w->align, out);
    scratch_exchange(&w->measure.scratch, &w->align.field);
    return st;
}

/* The cells that both scans have, as a share of the template's. */
static double common(const struct encoding *tmpl, const struct encoding *probe)
{
    uint32_t both = 0;

    for (uint32_t i = 0; i < GRID_N / 8; i++)
        both += (uint32_t)__builtin_popcount(tmpl->there[i] & probe->there[i]);
    return tmpl->cells > 0 ? (double)both / tmpl->cells : 0;
}

/* Sets decision and rate by the score, the expected score and the threshold.  Two scans without
 * information have the score 0, at or above which a threshold may be. */
static void decide(const struct surface_work *w, struct surface_comparison *r)
{
    r->decision = !(r->expected > 0)            ? SURFACE_INCONCLUSIVE
                  : r->score >= r->threshold    ? SURFACE_MATCH
                  : r->expected >= r->threshold ? SURFACE_NO_MATCH
                                                : SURFACE_INCONCLUSIVE;
    r->false_match_rate = surface_calibration_rate(&w->calibration, r->score);
}

static enum status score_of(const struct encoding *tmpl, const struct encoding *probe,
                            struct surface_work *w, struct surface_comparison *out)
{
    struct ratio_probe *r = ratio_probe(probe, w->model->kinship, &w->normal);

    if (r == NULL)
        return ST_ENOMEM;
    out->score = ratio_score(r, tmpl, &out->expected);
    out->overlap = common(tmpl, probe);
    return ST_OK;
}

enum surface_status surface_compare(struct surface_work *w,
                                    const struct surface_face *tmpl,
                                    const struct surface_face *probe,
                                    struct surface_comparison *out)
{
    struct pair pair;
    enum status st = pair_make(tmpl, probe, w, &pair);

    memset(out, 0, sizeof *out);
    if (st == ST_OK)
        st = score_of(pair.tmpl.encoding, pair.probe.encoding, w, out);
    out->threshold = w->calibration.threshold;
    decide(w, out);
    return status_to(st);
}

/* The mean of n likelihood ratios is one again: of a stranger's scan its expectation is 1, so that it
 * reaches e^t with a probability of e^-t at most (Markov), like each of them alone.  The greatest of
 * them, divided by n, is no more than their mean. */
void surface_best_of(const struct surface_work *w, uint32_t n,
                     struct surface_comparison *r)
{
    r->score -= series_ln(n);
    r->expected -= series_ln(n);
    decide(w, r);
}

void surface_shown(const struct surface_comparison *r, double steps, double *score,
                   double *threshold)
{
    const double least = ceil(r->threshold * steps - 1e-6); /* 8.3 is 8.3 */
    const double near = round(r->score * steps);
    const bool fits = r->score >= r->threshold;

    *threshold = least / steps;
    *score = (fits ? fmax(near, least) : fmin(near, least - 1)) / steps;
}

enum surface_status surface_compare_mirrored(struct surface_work *w,
                                             const struct surface_face *tmpl,
                                             const struct surface_face *probe,
                                             struct surface_comparison *out)
{
    struct encoding mirrored;
    float z[GRID_N], swapped[GRID_N];
    struct pair pair;
    enum status st = pair_make(tmpl, probe, w, &pair);

    memset(out, 0, sizeof *out);
    if (st != ST_OK || (st = pair_heights(&pair.probe, w, z)) != ST_OK)
        return status_to(st);
    for (uint32_t i = 0; i < GRID_N; i++)
        swapped[i] = z[grid_mirror(i)];
    st = encode_heights(&w->encode, swapped, (double)pair.probe.encoding->residual_mm,
                        &w->normal, &mirrored);
    if (st == ST_OK)
        st = score_of(pair.tmpl.encoding, &mirrored, w, out);
    out->threshold = w->calibration.threshold;
    decide(w, out);
    return status_to(st);
}

/* What was measured at out->transform. */
static void put_measure(const struct disparity *d, struct surface_disparity *out)
{
    out->disparity_mm = d->plain_mm;
    out->volume_mm3 = d->volume_mm3;
    out->area_mm2 = d->area_mm2;
    out->weighted_mm = d->weighted_mm;
}

static double now_ms(const struct surface_work *w)
{
    return w->clock_ms != NULL ? w->clock_ms() : 0;
}

enum surface_status surface_disparity(struct surface_work *w,
                                      const struct surface_face *tmpl,
                                      const struct surface_face *probe,
                                      struct surface_disparity *out)
{
    const double begin = now_ms(w);
    struct align_result a;
    struct minimal least;
    double aligned;
    enum status st = face_align(tmpl, probe, w, &a);

    memset(out, 0, sizeof *out);
    out->stop = align_stop_name(ALIGN_APART);
    if (st != ST_OK)
        return status_to(st);
    aligned = now_ms(w);
    st = minimal_find(&tmpl->surface, &probe->surface, a.transform, &w->measure, &least);
    memcpy(out->transform, least.transform, sizeof out->transform);
    memcpy(out->align_transform, a.transform, sizeof out->align_transform);
    put_measure(&least.disparity, out);
    out->turn_deg = a.turn_deg;
    out->shift_mm = a.shift_mm;
    out->cost_mm = a.cost_mm;
    out->rival_mm = a.rival_mm;
    out->starts = a.starts;
    out->evaluations = a.evaluations;
    out->stop = align_stop_name(a.stop);
    out->align_ms = aligned - begin;
    out->minimal_ms = now_ms(w) - aligned;
    return status_to(st);
}

/* Where a score contradicts the surfaces, the pair whose probe is laid from the template's frame.
 * more: there is one. */
static enum status doubt(const struct surface_face *tmpl,
                         const struct surface_face *probe, double score,
                         struct surface_work *w, struct pair *pair, bool *more)
{
    struct surface_disparity least;
    enum status st;

    *more = false;
    if (!(score < SURFACE_DOUBT) || pair->tmpl.encoding->n == 0 ||
        pair->probe.encoding->n == 0)
        return ST_OK;
    if ((st = status_from(surface_disparity(w, tmpl, probe, &least))) != ST_OK)
        return st;
    *more =
        least.disparity_mm <= SURFACE_DOUBT_MM && least.area_mm2 >= FACE_DOUBT_AREA_MM2;
    return *more ? pair_again(probe, least.transform, w, pair) : ST_OK;
}

enum surface_status surface_compare_again(struct surface_work *w,
                                          const struct surface_face *tmpl,
                                          const struct surface_face *probe,
                                          struct surface_comparison *io)
{
    struct surface_comparison again = *io;
    struct pair pair;
    bool more;
    enum status st;

    if (io->decision != SURFACE_NO_MATCH || !(io->score < SURFACE_DOUBT))
        return status_to(ST_OK);
    if ((st = pair_make(tmpl, probe, w, &pair)) != ST_OK ||
        (st = doubt(tmpl, probe, io->score, w, &pair, &more)) != ST_OK || !more)
        return status_to(st);
    st = score_of(pair.tmpl.encoding, pair.probe.encoding, w, &again);
    if (st != ST_OK || !(again.score > io->score))
        return status_to(st);
    decide(w, &again);
    *io = again;
    return status_to(ST_OK);
}

enum surface_status surface_weigh(struct surface_work *w, const struct surface_face *tmpl,
                                  const struct surface_face *probe,
                                  struct surface_disparity *least)
{
    const struct places u = {w->weight, tmpl->frame.pose};
    struct disparity d;
    const enum status st =
        measure_at(&tmpl->surface, &probe->surface, least->transform,
                   &(struct disparity_weight){weight_at, &u}, &w->measure, &d);

    if (st == ST_OK)
        put_measure(&d, least);
    return status_to(st);
}

/* Returns true if either scan has the cell. */
static bool counts(const struct encoding *a, const struct encoding *b, uint32_t cell)
{
    return ((a->there[cell / 8] | b->there[cell / 8]) >> cell % 8 & 1) != 0;
}

/* The pair on which surface_compare() and surface_compare_again() decide. */
static enum status decided(const struct surface_face *tmpl,
                           const struct surface_face *probe, struct surface_work *w,
                           struct pair *pair)
{
    const struct pair_side first = pair->probe;
    struct surface_comparison r, again;
    bool more;
    enum status st = score_of(pair->tmpl.encoding, first.encoding, w, &r);

    if (st != ST_OK || (st = doubt(tmpl, probe, r.score, w, pair, &more)) != ST_OK ||
        !more)
        return st;
    st = score_of(pair->tmpl.encoding, pair->probe.encoding, w, &again);
    if (st == ST_OK && !(again.score > r.score))
        pair->probe = first;
    return st;
}

enum surface_status surface_parts(struct surface_work *w, const struct surface_face *tmpl,
                                  const struct surface_face *probe,
                                  struct surface_parts *out)
{
    struct pair pair;
    enum status st = pair_make(tmpl, probe, w, &pair);
    const struct pair_side *const side[] = {&pair.tmpl, &pair.probe};
    const struct encoding *of[2];
    float z[2][GRID_N];
    double slope[2][MODEL_MODES], part[GRID_N] = {0}, rest = 0, all = 0;
    struct ratio_probe *r;
    struct pose rigid;

    memset(out, 0, sizeof *out);
    if (st != ST_OK)
        return status_to(st);
    rigid = pose_unscaled(&pair.tmpl.pose);
    pose_to_matrix(&rigid, out->frame);
    out->scale = 1 / place_size(&pair.tmpl.pose);
    if ((st = decided(tmpl, probe, w, &pair)) != ST_OK)
        return status_to(st);
    of[0] = pair.tmpl.encoding;
    of[1] = pair.probe.encoding;
    if ((r = ratio_probe(of[1], w->model->kinship, &w->normal)) == NULL)
        return status_to(ST_ENOMEM);
    rest = ratio_slopes(r, of[0], slope[0], slope[1]);
    for (int i = 0; st == ST_OK && i < 2; i++) {
        st = pair_heights(side[i], w, z[i]);
        if (st == ST_OK)
            st = encode_parts(&w->encode, z[i], (double)of[i]->residual_mm, slope[i],
                              &w->normal, part);
    }
    if (st == ST_OK)
        st = encode_rest(
            &w->encode, z[0], z[1],
            (const double[]){(double)of[0]->residual_mm, (double)of[1]->residual_mm},
            &w->normal, out->rest_mm);
    for (uint32_t i = 0; st == ST_OK && i < GRID_N; i++) {
        const float flat = w->encode.normal_z[i];

        out->gap_mm[i] = flat > 0.0f ? (z[1][i] - z[0][i]) * flat : (float)NAN;
        all += counts(of[0], of[1], i) ? (double)w->weight[i] : 0;
        rest -= part[i];
    }
    for (uint32_t i = 0; st == ST_OK && i < GRID_N; i++) {
        if (counts(of[0], of[1], i) && all > 0)
            part[i] += rest * (double)w->weight[i] / all;
        out->part[i] = part[i] != 0 ? (float)part[i] : (float)NAN;
        out->region[grid_region_of(i)] += part[i];
    }
    return status_to(st);
}

enum surface_status surface_asymmetry(struct surface_work *w,
                                      const struct surface_face *f,
                                      struct surface_asymmetry *out)
{
    static const struct pose upright = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct places u = {w->weight, upright};
    const struct pose pose = pose_unscaled(&f->frame.pose);

    return status_to(asymmetry_find(&f->surface, &pose,
                                    &(struct disparity_weight){weight_at, &u},
                                    &w->measure, &w->upright, out));
}
