/* libsurface.c -- the library's public functions, over core/find and core/face.  Names follow
 * the header as it is installed: surface_*. */
#include "libsurface.h"

#include <math.h>
#include <string.h>

#include "asymmetry.h"
#include "calibration.h"
#include "cloudpoints.h"
#include "codec.h"
#include "face.h"
#include "heatmap.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "minimal.h"
#include "model.h"
#include "scan.h"
#include "status.h"

/* The public statuses have the numbers of the internal ones. */
#define SAME(a, b) _Static_assert((int)(a) == (int)(b), "one number each")
SAME(SURFACE_OK, ST_OK);
SAME(SURFACE_EINVAL, ST_EINVAL);
SAME(SURFACE_ENOMEM, ST_ENOMEM);
SAME(SURFACE_ELIMIT, ST_ELIMIT);
SAME(SURFACE_ETOOFEW, ST_ETOOFEW);
SAME(SURFACE_ENOTFINITE, ST_ENOTFINITE);
SAME(SURFACE_ERANGE, ST_ERANGE);
SAME(SURFACE_EDEGENERATE, ST_EDEGENERATE);
SAME(SURFACE_EUNITS, ST_EUNITS);
SAME(SURFACE_ENOFACE, ST_ENOFACE);
SAME(SURFACE_ESEVERAL, ST_ESEVERAL);
SAME(SURFACE_EMIRRORED, ST_EMIRRORED);
SAME(SURFACE_ENOTFACE, ST_ENOTFACE);
SAME(SURFACE_EQUALITY, ST_EQUALITY);
SAME(SURFACE_ECORRUPT, ST_ECORRUPT);
SAME(SURFACE_EVERSION, ST_EVERSION);
SAME(SURFACE_EINTERNAL, ST_EINTERNAL);
SAME(SURFACE_MIN_POINTS, FACE_MIN_POINTS);
SAME(SURFACE_MAX_POINTS, MESH_MAX_POINTS);
SAME(SURFACE_ENGINE_SIZE, FACE_ENGINE_MAX + 1);
SAME(SURFACE_KNOTS, CALIBRATION_KNOTS);
SAME(SURFACE_CELLS_X, GRID_NX);
SAME(SURFACE_CELLS_Y, GRID_NY);
SAME(SURFACE_REGIONS, GRID_REGIONS);
SAME(SURFACE_NOSE, GRID_NOSE);
SAME(SURFACE_CHIN, GRID_CHIN);
SAME(SURFACE_MATCH, FACE_MATCH);
SAME(SURFACE_NO_MATCH, FACE_NO_MATCH);
SAME(SURFACE_INCONCLUSIVE, FACE_INCONCLUSIVE);
SAME(SURFACE_SEVERAL, SCAN_SEVERAL);
SAME(SURFACE_MIRRORED, SCAN_MIRRORED);
SAME(SURFACE_BEHIND, SCAN_BEHIND);
SAME(SURFACE_TURNED, SCAN_TURNED);
SAME(SURFACE_OCCLUDED, SCAN_OCCLUDED);
SAME(SURFACE_THINNED, SCAN_THINNED);
SAME(SURFACE_SPARSE, QUALITY_SPARSE);
SAME(SURFACE_NOISY, QUALITY_NOISY);
SAME(SURFACE_INCOMPLETE, QUALITY_INCOMPLETE);
SAME(SURFACE_OBLIQUE, QUALITY_TURNED);

struct surface_model {
    struct model model;
};

struct surface_work {
    struct face_work *face;
    struct calibration calibration;
};

struct surface_face {
    struct face face;
};

static enum surface_status public(enum status st) {
    switch ((int)st){
        case SURFACE_OK : case SURFACE_EINVAL : case SURFACE_ENOMEM : case
        SURFACE_ELIMIT : case SURFACE_ETOOFEW : case SURFACE_ENOTFINITE : case
        SURFACE_ERANGE : case SURFACE_EDEGENERATE : case SURFACE_EUNITS : case
        SURFACE_ENOFACE : case SURFACE_ESEVERAL : case SURFACE_EMIRRORED : case
        SURFACE_ENOTFACE : case SURFACE_EQUALITY : case SURFACE_ECORRUPT : case
        SURFACE_EVERSION : return (enum surface_status)st;
        default : return SURFACE_EINTERNAL;
    }
}

/* A struct of the library's size from one of the caller's, whose size comes first: what the
 * caller does not know is 0. */
static void take(void *to, const void *from, size_t size)
{
    size_t known;

    memcpy(&known, from, sizeof known);
    memset(to, 0, size);
    memcpy(to, from, known < size ? known : size);
}

/* To the caller's struct as much as it has room for. */
static void give(void *to, const void *from, size_t size)
{
    size_t known;

    memcpy(&known, to, sizeof known);
    if (known > size)
        known = size;
    if (known > sizeof known)
        memcpy((char *)to + sizeof known, (const char *)from + sizeof known,
               known - sizeof known);
}

const char *surface_version(void)
{
    return SURFACE_VERSION;
}

const char *surface_message(enum surface_status st)
{
    const enum status known = (enum status)st;

    return public(known) == st ? status_message(known) : status_message(ST_COUNT);
}

/* ---- model and calibration */

enum surface_status surface_model_parse(const char *text, size_t length,
                                        struct surface_model **out, uint32_t *line)
{
    struct surface_model *m = mem_array(1, sizeof *m);
    enum status st;

    *out = NULL;
    if (m == NULL)
        return SURFACE_ENOMEM;
    if ((st = model_parse(text, length, &m->model, line)) == ST_OK)
        *out = m;
    else
        mem_free(m);
    return public(st);
}

void surface_model_free(struct surface_model *model)
{
    mem_free(model);
}

void surface_engine(const struct surface_model *model, char out[SURFACE_ENGINE_SIZE])
{
    face_engine(model != NULL ? &model->model : NULL, out);
}

struct surface_work *surface_work_new(const struct surface_model *model)
{
    struct surface_work *work = mem_array(1, sizeof *work);

    if (work == NULL)
        return NULL;
    if ((work->face = face_work_new(model != NULL ? &model->model : NULL)) == NULL) {
        mem_free(work);
        return NULL;
    }
    work->calibration = face_work_model(work->face)->calibration;
    return work;
}

void surface_work_free(struct surface_work *work)
{
    if (work == NULL)
        return;
    face_work_free(work->face);
    mem_free(work);
}

enum surface_status surface_work_calibrate(struct surface_work *work,
                                           const struct surface_calibration *by)
{
    struct calibration c = face_work_model(work->face)->calibration;
    struct surface_calibration given;

    if (by != NULL) {
        take(&given, by, sizeof given);
        if (given.knots > SURFACE_KNOTS)
            return SURFACE_EINVAL;
        c = (struct calibration){.threshold = given.threshold, .n = given.knots};
        for (uint32_t i = 0; i < c.n; i++)
            c.knot[i] =
                (struct calibration_knot){given.knot[i].score, given.knot[i].rate};
        if (!calibration_valid(&c))
            return SURFACE_EINVAL;
    }
    work->calibration = c;
    face_work_decide(work->face, &c);
    return SURFACE_OK;
}

double surface_false_match_rate(const struct surface_work *work, double score)
{
    return calibration_fmr(&work->calibration, score);
}

void surface_work_wipe(struct surface_work *work)
{
    face_work_wipe(work->face);
}

/* ---- building */

/* The points that have a value; in a depth image (0, 0, 0) is none. */
static enum status copy_cloud(const struct surface_cloud *cloud, struct cloudpoints *c)
{
    const bool image = cloud->width != 0, frontal = (cloud->flags & SURFACE_FRONTAL) != 0;
    const size_t room = cloud->n != 0 ? cloud->n : 1;

    c->at = mem_array(room, sizeof *c->at);
    c->index = mem_array(room, sizeof *c->index);
    if (cloud->normals != NULL)
        c->normal = mem_array(room, sizeof *c->normal);
    if (c->at == NULL || c->index == NULL ||
        (c->normal == NULL) != (cloud->normals == NULL))
        return ST_ENOMEM;
    for (size_t i = 0; i < cloud->n; i++) {
        const double *p = cloud->points[i];
        const bool finite = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);

        if ((!finite && !frontal) || (image && p[0] == 0 && p[1] == 0 && p[2] == 0))
            continue;
        c->at[c->n] = (struct dvec3){p[0], p[1], p[2]};
        if (c->normal != NULL)
            c->normal[c->n] = (struct dvec3){cloud->normals[i][0], cloud->normals[i][1],
                                             cloud->normals[i][2]};
        c->index[c->n++] = (uint32_t)i;
    }
    return ST_OK;
}

static void describe(const struct scan_found *f, struct surface_found *out)
{
    out->points_used = f->points_used;
    out->unit_mm = f->unit_mm;
    out->unit_found = f->unit_found;
    out->faces = f->faces;
    out->warnings = f->warnings;
    memcpy(out->extent, f->extent, sizeof out->extent);
    memcpy(out->view, f->view, sizeof out->view);
    out->yaw_deg = f->yaw_deg;
    out->pitch_deg = f->pitch_deg;
    out->roll_deg = f->roll_deg;
    out->occluded = f->occluded;
    out->elsewhere = f->elsewhere;
    out->support = f->gate.support;
    out->support_wanted = f->gate.support_wanted;
    out->evidence = f->gate.evidence;
    out->evidence_wanted = f->gate.evidence_wanted;
    out->seen = f->gate.seen;
    out->seen_wanted = f->gate.seen_wanted;
    out->residual_mm = f->gate.residual_mm;
    out->residual_most = f->gate.residual_most;
    out->head_size = f->gate.size;
}

/* Is the cloud's description possible? */
static enum status check_cloud(const struct surface_cloud *cloud)
{
    if (cloud->n > SURFACE_MAX_POINTS)
        return ST_ELIMIT;
    return (cloud->points != NULL || cloud->n == 0) &&
                   (uint64_t)cloud->width * cloud->height ==
                       (cloud->width != 0 ? cloud->n : 0) &&
                   isfinite(cloud->unit_mm) && cloud->unit_mm >= 0 &&
                   (cloud->flags & ~(uint32_t)(SURFACE_FRONTAL | SURFACE_ENROLMENT)) == 0
               ? ST_OK
               : ST_EINVAL;
}

/* A face that is empty, or the former one at *out. */
static struct surface_face *face_for(struct surface_face **out)
{
    struct surface_face *f = *out;

    *out = NULL;
    if (f == NULL && (f = mem_array(1, sizeof *f)) != NULL)
        memset(f, 0, sizeof *f);
    return f;
}

static enum surface_status finish(enum status st, struct surface_face *f,
                                  struct surface_face **out)
{
    if (st == ST_OK)
        *out = f;
    else
        surface_face_free(f);
    return public(st);
}

enum surface_status surface_build(struct surface_work *work,
                                  const struct surface_cloud *cloud,
                                  struct surface_face **out, struct surface_found *found)
{
    struct surface_found about = {0};
    struct scan_found internal = {0};
    struct surface_cloud from;
    struct cloudpoints c = {0};
    struct scan_options how = {0};
    struct surface_face *f = face_for(out);
    size_t bad = 0;
    enum status st;

    take(&from, cloud, sizeof from);
    if ((st = f == NULL ? ST_ENOMEM : check_cloud(&from)) == ST_OK &&
        (st = copy_cloud(&from, &c)) == ST_OK) {
        how.axes = from.flags & SURFACE_FRONTAL ? SCAN_AXES_SCANNER : SCAN_AXES_AUTO;
        how.enrolment = (from.flags & SURFACE_ENROLMENT) != 0;
        about.points = c.n;
        c.read = from.n;
        c.unit_mm = from.unit_mm;
        c.width = from.width;
        c.height = from.height;
        st = scan_build(&c, &how, work->face, &f->face, &bad, &internal);
        describe(&internal, &about);
        if (st == ST_ENOTFINITE || st == ST_ERANGE)
            about.bad = bad < c.n ? c.index[bad] : bad;
    }
    cloudpoints_free(&c);
    if (found != NULL)
        give(found, &about, sizeof about);
    return finish(st, f, out);
}

void surface_face_free(struct surface_face *face)
{
    if (face == NULL)
        return;
    face_free(&face->face);
    mem_free(face);
}

const char *surface_warning_name(enum surface_warning warning)
{
    return (unsigned)warning < SCAN_WARNINGS
               ? scan_warning_name((enum scan_warning)warning)
               : NULL;
}

const char *surface_reason_name(enum surface_reason reason)
{
    return (unsigned)reason < QUALITY_REASONS
               ? quality_reason_name((enum quality_reason)reason)
               : NULL;
}

void surface_face_quality(const struct surface_face *face, struct surface_quality *out)
{
    const struct quality *q = &face->face.quality;
    const struct surface_quality full = {
        .points = face->face.surface.mesh.nv,
        .score = q->score,
        .coverage = q->coverage,
        .density_mm = q->density_mm,
        .noise_mm = q->noise_mm,
        .reasons = q->density_mm > 0 ? quality_reasons(q, &face->face.frame) : 0};

    give(out, &full, sizeof full);
}

void surface_face_points(const struct surface_face *face, double (*out)[3])
{
    const struct mesh *m = &face->face.surface.mesh;

    for (uint32_t v = 0; v < m->nv; v++) {
        out[v][0] = m->xy[v].x / LATTICE_PER_MM;
        out[v][1] = m->xy[v].y / LATTICE_PER_MM;
        out[v][2] = m->z[v] / LATTICE_PER_MM;
    }
}

/* ---- bytes */

size_t surface_encoded_size(const struct surface_face *face)
{
    return codec_size(&face->face);
}

void surface_encode(const struct surface_face *face, void *bytes)
{
    codec_encode(&face->face, bytes);
}

enum surface_status surface_decode(struct surface_work *work, const void *bytes,
                                   size_t length, struct surface_face **out)
{
    struct surface_face *f = face_for(out);

    return finish(f == NULL ? ST_ENOMEM
                            : codec_decode(bytes, length, work->face, &f->face),
                  f, out);
}

/* ---- comparisons */

static void give_comparison(const struct face_result *r, struct surface_comparison *out)
{
    const struct surface_comparison full = {.decision =
                                                (enum surface_decision)r->decision,
                                            .score = r->score,
                                            .threshold = r->threshold,
                                            .expected = r->expected,
                                            .false_match_rate = r->fmr_at_score,
                                            .overlap = r->overlap};

    give(out, &full, sizeof full);
}

enum surface_status surface_compare(struct surface_work *work,
                                    const struct surface_face *tmpl,
                                    const struct surface_face *probe,
                                    struct surface_comparison *out)
{
    struct face_result r = {.decision = FACE_INCONCLUSIVE};
    const enum status st =
        face_compare(&tmpl->face, &probe->face, (double)NAN, NULL, work->face, &r);

    give_comparison(&r, out);
    return public(st);
}

void surface_best_of(const struct surface_work *work, uint32_t n,
                     struct surface_comparison *c)
{
    struct surface_comparison full;
    struct face_result r = {0};

    take(&full, c, sizeof full);
    r.decision = (enum face_decision)full.decision;
    r.score = full.score;
    r.threshold = full.threshold;
    r.expected = full.expected;
    r.fmr_at_score = full.false_match_rate;
    r.overlap = full.overlap;
    face_best_of(&r, n, work->face);
    give_comparison(&r, c);
}

enum surface_status surface_disparity(struct surface_work *work,
                                      const struct surface_face *tmpl,
                                      const struct surface_face *probe,
                                      struct surface_disparity *out)
{
    struct surface_disparity full = {0};
    struct face_result r = {.decision = FACE_INCONCLUSIVE};
    struct minimal m;
    const enum status st =
        face_minimal(&tmpl->face, &probe->face, NULL, work->face, &r, &m);

    if (st == ST_OK) {
        full.disparity_mm = m.disparity.plain_mm;
        full.volume_mm3 = m.disparity.volume_mm3;
        full.area_mm2 = m.disparity.area_mm2;
        memcpy(full.transform, m.transform, sizeof full.transform);
        memcpy(full.align_transform, r.align.transform, sizeof full.align_transform);
        full.turn_deg = r.align.turn_deg;
        full.shift_mm = r.align.shift_mm;
    }
    give(out, &full, sizeof full);
    return public(st);
}

enum surface_status surface_gaps(const struct surface_face *tmpl,
                                 const double (*points)[3], size_t n,
                                 const double transform[16], double *gap_mm)
{
    struct dvec3 *pts = mem_array(n != 0 ? n : 1, sizeof *pts);
    enum status st = ST_ENOMEM;

    for (size_t i = 0; i < n; i++)
        gap_mm[i] = (double)NAN;
    for (size_t i = 0; i < n && pts != NULL; i++)
        pts[i] = (struct dvec3){points[i][0], points[i][1], points[i][2]};
    if (pts != NULL)
        st = heatmap_gaps(&tmpl->face.surface, pts, n, transform, gap_mm);
    mem_free(pts);
    return public(st);
}

const char *surface_region_name(enum surface_region region)
{
    return (unsigned)region < GRID_REGIONS ? grid_region_name((enum grid_region)region)
                                           : NULL;
}

enum surface_status surface_parts(struct surface_work *work,
                                  const struct surface_face *tmpl,
                                  const struct surface_face *probe,
                                  struct surface_parts *out)
{
    struct surface_parts full = {0};
    struct face_field field = {.region = {0}};
    const enum status st = face_field(&tmpl->face, &probe->face, work->face, &field);

    memcpy(full.region, field.region, sizeof full.region);
    memcpy(full.gap_mm, field.gap_mm, sizeof full.gap_mm);
    memcpy(full.part, field.part, sizeof full.part);
    give(out, &full, sizeof full);
    return public(st);
}

enum surface_status surface_asymmetry(struct surface_work *work,
                                      const struct surface_face *face,
                                      struct surface_asymmetry *out)
{
    struct surface_asymmetry full = {0};
    struct asymmetry a = {.offset_mm = 0};
    const enum status st = face_asymmetry(&face->face, work->face, &a);

    if (st == ST_OK) {
        full.conclusive = asymmetry_conclusive(&a);
        full.disparity_mm = a.final.plain_mm;
        full.first_mm = a.initial.plain_mm;
        memcpy(full.normal, a.normal, sizeof full.normal);
        full.offset_mm = a.offset_mm;
    }
    give(out, &full, sizeof full);
    return public(st);
}
