/* libsurface.c -- the library's public functions, over core/find and core/face.  Names follow
 * the header as it is installed: surface_*. */
#include "libsurface.h"

#include <math.h>
#include <string.h>

#include "cloudpoints.h"
#include "codec.h"
#include "face.h"
#include "frames.h"
#include "heatmap.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "model.h"
#include "mst.h"
#include "scan.h"
#include "status.h"

/* Of the program's other statuses the core returns none. */
static enum surface_status library(enum status st)
{
    const bool others = st == ST_ESIZE || (st >= ST_ENOTFOUND && st <= ST_EUNSYNCED);

    return others && st != ST_EBUSY ? SURFACE_EINTERNAL : (enum surface_status)st;
}

const char *surface_version(void)
{
    return SURFACE_VERSION;
}

const char *surface_message(enum surface_status st)
{
    const enum status known = (enum status)st;

    return status_message(library(known) == st ? known : ST_COUNT);
}

/* ---- model and calibration */

enum surface_status surface_model_parse(const char *text, size_t length,
                                        struct surface_model **out, uint32_t *line)
{
    struct surface_model *m = mem_array(1, sizeof *m);
    const enum status st = m != NULL ? model_parse(text, length, m, line) : ST_ENOMEM;

    if (st != ST_OK)
        mem_free(m);
    *out = st == ST_OK ? m : NULL;
    return library(st);
}

void surface_model_free(struct surface_model *model)
{
    mem_free(model);
}

const struct surface_calibration *
surface_model_calibration(const struct surface_model *model)
{
    return model != NULL ? &model->calibration : &model_default.calibration;
}

/* ---- building */

/* Is the cloud's description possible? */
static enum status check_cloud(const struct surface_cloud *c)
{
    const uint64_t pixels = (uint64_t)c->width * c->height;
    const bool whole = c->width == 0 || c->place != NULL || pixels == c->n;

    if (c->n > SURFACE_MAX_POINTS)
        return ST_ELIMIT;
    return (c->points != NULL || c->n == 0) && (c->width != 0 || c->height == 0) &&
                   whole && (c->width == 0 || pixels >= c->n) &&
                   (c->kept == NULL) == (c->kept_place == NULL) && isfinite(c->unit_mm) &&
                   c->unit_mm >= 0 &&
                   (c->flags & ~(uint32_t)(SURFACE_FRONTAL | SURFACE_ENROLMENT |
                                           SURFACE_PINHOLE)) == 0
               ? ST_OK
               : ST_EINVAL;
}

/* A copy of the points that have a value, to work on, in the caller's memory where it is given; in
 * a depth image (0, 0, 0) is none. */
static enum status copy_cloud(const struct surface_cloud *from, struct cloudpoints *c)
{
    const bool image = from->width != 0, frontal = (from->flags & SURFACE_FRONTAL) != 0;
    const size_t room = from->n != 0 ? from->n : 1;

    *c = (struct cloudpoints){.at = (struct dvec3 *)from->kept,
                              .index = from->kept_place,
                              .unit_mm = from->unit_mm,
                              .width = from->width,
                              .height = from->height,
                              .pinhole = (from->flags & SURFACE_PINHOLE) != 0};
    if (from->kept == NULL) {
        c->at = mem_array(room, sizeof *c->at);
        c->index = mem_array(room, sizeof *c->index);
    }
    if (from->normals != NULL)
        c->normal = mem_array(room, sizeof *c->normal);
    if (c->at == NULL || c->index == NULL ||
        (c->normal == NULL) != (from->normals == NULL))
        return ST_ENOMEM;
    for (size_t i = 0; i < from->n; i++) {
        const double *p = from->points[i];
        const struct dvec3 at = {p[0], p[1], p[2]};
        const bool finite = isfinite(at.x) && isfinite(at.y) && isfinite(at.z);

        if ((!finite && !frontal) || (image && at.x == 0 && at.y == 0 && at.z == 0))
            continue;
        if (c->normal != NULL)
            memcpy(&c->normal[c->n], from->normals[i], sizeof *c->normal);
        c->at[c->n] = at;
        c->index[c->n++] = from->place != NULL ? from->place[i] : (uint32_t)i;
    }
    return ST_OK;
}

static void free_copy(const struct surface_cloud *from, struct cloudpoints *c)
{
    if (from->kept == NULL) {
        mem_free(c->at);
        mem_free(c->index);
    }
    mem_free(c->normal);
}

/* c: a copy of `from`, of so many points, and now what the search has left of it. */
static void tell_points(const struct surface_cloud *from, const struct cloudpoints *c,
                        size_t points, enum status st, size_t bad,
                        struct surface_found *about)
{
    about->points = points;
    about->kept = c->n;
    if (st == ST_ENOTFINITE || st == ST_ERANGE)
        about->bad = from->place == NULL && bad < c->n ? c->index[bad] : bad;
}

static struct scan_options options(const struct surface_cloud *from)
{
    return (struct scan_options){.axes = from->flags & SURFACE_FRONTAL ? SCAN_AXES_SCANNER
                                                                       : SCAN_AXES_AUTO,
                                 .enrolment = (from->flags & SURFACE_ENROLMENT) != 0,
                                 .stop = from->stop};
}

/* scan_build() on a copy of the cloud. */
static enum status libsurface_build(struct surface_work *work,
                                    const struct surface_cloud *from,
                                    struct scan_search *search, struct surface_face *f,
                                    struct surface_found *about)
{
    struct scan_options how = options(from);
    struct cloudpoints c;
    size_t bad = 0, points;
    enum status st = copy_cloud(from, &c);

    *about = (struct surface_found){0};
    how.search = search;
    if (st == ST_OK) {
        points = c.n;
        st = scan_build(&c, &how, work, f, &bad, about);
        tell_points(from, &c, points, st, bad, about);
    }
    free_copy(from, &c);
    return st;
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

static enum surface_status libsurface_finish(enum status st, struct surface_face *f,
                                             struct surface_face **out)
{
    if (st == ST_OK)
        *out = f;
    else
        surface_face_free(f);
    return library(st);
}

enum surface_status surface_build(struct surface_work *work,
                                  const struct surface_cloud *cloud,
                                  struct surface_face **out, struct surface_found *found)
{
    struct surface_face *f = face_for(out);
    struct surface_found about = {0};
    enum status st = f == NULL ? ST_ENOMEM : check_cloud(cloud);

    if (st == ST_OK)
        st = libsurface_build(work, cloud, NULL, f, &about);
    if (found != NULL)
        *found = about;
    return libsurface_finish(st, f, out);
}

/* ---- several frames */

static enum status add_frame(struct frames *f, const struct surface_cloud *from)
{
    struct frames_one *one = &f->one[f->n];
    struct cloudpoints c;
    size_t bad = 0, points;
    enum status st = copy_cloud(from, &c);

    if (st == ST_OK) {
        points = c.n;
        st = frames_add(f, &c, &bad);
        tell_points(from, &c, points, one->st, bad, &one->found);
    }
    free_copy(from, &c);
    return st;
}

/* The points that the base kept, on the fused face. */
static enum status keep_fused(const struct surface_face *f, size_t n, double (*kept)[3])
{
    static const double still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double *gap = mem_array(n, sizeof *gap);
    enum status st = ST_ENOMEM;

    if (gap != NULL)
        st = heatmap_gaps(&f->surface, (const struct dvec3 *)kept, n, still, gap);
    for (size_t i = 0; st == ST_OK && i < n; i++)
        kept[i][2] -= isnan(gap[i]) ? 0 : gap[i];
    mem_free(gap);
    return st;
}

static void give_frames(const struct frames *f, struct surface_frame *frame)
{
    for (uint32_t i = 0; i < f->n; i++) {
        const struct frames_one *one = &f->one[i];

        frame[i] = (struct surface_frame){.status = library(one->st),
                                          .score = one->score,
                                          .gap_mm = i == f->base ? 0 : one->at.gap_mm,
                                          .found = one->found};
    }
}

/* f: all zero. */
static enum status fuse(struct frames *f, struct surface_work *work, uint32_t n,
                        const struct surface_cloud *cloud, struct surface_face *out,
                        struct surface_found *about)
{
    enum status st = ST_OK;

    f->w = work;
    for (uint32_t i = 0; st == ST_OK && i < n; i++) {
        f->how = options(&cloud[i]);
        f->how.frame = n > 1;
        if ((st = check_cloud(&cloud[i])) == ST_OK)
            st = add_frame(f, &cloud[i]);
    }
    if (st == ST_OK)
        st = frames_fuse(f, out, about);
    return st == ST_OK && cloud[f->base].kept != NULL
               ? keep_fused(out, about->kept, cloud[f->base].kept)
               : st;
}

enum surface_status surface_fuse(struct surface_work *work, uint32_t n,
                                 const struct surface_cloud *cloud,
                                 struct surface_frame *frame, uint32_t *base,
                                 struct surface_face **out, struct surface_found *found)
{
    struct frames *f = mem_array(1, sizeof *f);
    struct surface_face *face = face_for(out);
    struct surface_found about = {0};
    enum status st = f == NULL || face == NULL          ? ST_ENOMEM
                     : n == 0 || n > SURFACE_FRAMES_MAX ? ST_EINVAL
                                                        : ST_OK;

    *base = 0;
    if (f != NULL)
        memset(f, 0, sizeof *f);
    if (st == ST_OK) {
        st = fuse(f, work, n, cloud, face, &about);
        give_frames(f, frame);
        *base = f->base;
        frames_free(f);
    }
    mem_free(f);
    if (found != NULL)
        *found = about;
    return libsurface_finish(st, face, out);
}

enum surface_status surface_check(struct surface_work *work,
                                  const struct surface_cloud *cloud,
                                  struct surface_face **out, enum surface_status *refused,
                                  struct surface_found *why, struct surface_found *found)
{
    struct scan_search search = {.done = false};
    struct surface_face *f = face_for(out);
    struct surface_found about = {0};
    struct surface_cloud strict, loose = *cloud;
    enum status st;

    loose.flags &= ~(uint32_t)SURFACE_ENROLMENT;
    strict = loose;
    strict.flags |= SURFACE_ENROLMENT;
    strict.kept = NULL; /* the points are needed again */
    strict.kept_place = NULL;
    if ((st = f == NULL ? ST_ENOMEM : check_cloud(&loose)) == ST_OK)
        st = libsurface_build(work, &strict, &search, f, &about);
    *refused = library(st);
    *why = about;
    if (st >= ST_ELIMIT && st <= ST_EQUALITY)
        st = libsurface_build(work, &loose, &search, f, &about);
    *found = about;
    return libsurface_finish(st, f, out);
}

enum surface_status surface_rebuild(struct surface_work *work, struct surface_face **face)
{
    struct surface_face *f = face_for(face);

    return libsurface_finish(f != NULL ? face_rebuild(f, work) : ST_ENOMEM, f, face);
}

void surface_face_free(struct surface_face *face)
{
    face_free(face);
    mem_free(face);
}

const char *surface_warning_name(enum surface_warning warning)
{
    static const char *const name[SURFACE_WARNINGS] = {
        [SURFACE_SEVERAL] = "several_faces",   [SURFACE_MIRRORED] = "mirrored",
        [SURFACE_BEHIND] = "points_elsewhere", [SURFACE_TURNED] = "turned",
        [SURFACE_OCCLUDED] = "occluded",       [SURFACE_THINNED] = "thinned",
        [SURFACE_STEPPED] = "stepped",         [SURFACE_FOCAL] = "focal_length"};

    return (unsigned)warning < SURFACE_WARNINGS ? name[warning] : NULL;
}

const char *surface_reason_name(enum surface_reason reason)
{
    static const char *const name[SURFACE_REASONS] = {[SURFACE_SPARSE] = "sparse",
                                                      [SURFACE_NOISY] = "noisy",
                                                      [SURFACE_INCOMPLETE] = "incomplete",
                                                      [SURFACE_OBLIQUE] = "turned"};

    return (unsigned)reason < SURFACE_REASONS ? name[reason] : NULL;
}

uint32_t surface_quality_reasons(const struct surface_quality *q,
                                 const struct surface_face *face)
{
    return quality_reasons(q, face != NULL ? &face->frame : NULL);
}

struct surface_quality surface_face_quality(const struct surface_face *face)
{
    return face->quality;
}

void surface_face_rate(struct surface_face *face, const struct surface_quality *q)
{
    face->quality = *q;
}

uint32_t surface_face_points(const struct surface_face *face, double (*out)[3])
{
    const struct mesh *m = &face->surface.mesh;

    for (uint32_t v = 0; out != NULL && v < m->nv; v++) {
        const struct dvec3 p = lattice_to_mm(m->xy[v], m->z[v]);

        memcpy(out[v], &p, sizeof p);
    }
    return m->nv;
}

uint32_t surface_face_triangles(const struct surface_face *face, uint32_t (*out)[3])
{
    const struct mesh *m = &face->surface.mesh;

    for (uint32_t t = 0, n = 0; out != NULL && t < m->nt; t++)
        if (!mesh_is_ghost(m, t))
            memcpy(out[n++], &m->org[3 * t], sizeof *out);
    return mesh_real(m);
}

uint32_t surface_face_measured(const struct surface_face *face, uint32_t (*out)[3])
{
    const struct surface *s = &face->surface;
    uint32_t n = 0;

    for (uint32_t t = 0; t < s->mesh.nt; t++)
        if (s->bridge[t] == 0) { /* nor a ghost */
            if (out != NULL)
                memcpy(out[n], &s->mesh.org[3 * t], sizeof *out);
            n++;
        }
    return n;
}

void surface_face_frame(const struct surface_face *face, double transform[16])
{
    const struct pose rigid = pose_unscaled(&face->frame.pose);

    pose_to_matrix(&rigid, transform);
}

size_t surface_face_memory(const struct surface_face *face)
{
    const struct surface *s = &face->surface;

    return sizeof *face + (size_t)s->mesh.cap * 68 + s->mesh.nv * sizeof *s->spacing +
           s->mesh.nt * sizeof *s->bridge;
}

enum surface_status surface_face_check(const struct surface_face *face)
{
    const struct mesh *m = &face->surface.mesh;

    return library(mesh_check(m, true) == ST_OK ? mst_check(m) : ST_ECORRUPT);
}

/* ---- bytes */

enum surface_status surface_decode(struct surface_work *work, const void *bytes,
                                   size_t length, struct surface_face **out)
{
    struct surface_face *f = face_for(out);

    return libsurface_finish(f == NULL ? ST_ENOMEM : codec_decode(bytes, length, work, f),
                             f, out);
}

/* ---- comparisons */

enum surface_status surface_compare(struct surface_work *work,
                                    const struct surface_face *tmpl,
                                    const struct surface_face *probe,
                                    struct surface_comparison *out)
{
    return library(face_compare(tmpl, probe, (double)NAN, work, out));
}

enum surface_status surface_compare_again(struct surface_work *work,
                                          const struct surface_face *tmpl,
                                          const struct surface_face *probe,
                                          struct surface_comparison *io)
{
    return library(face_compare_again(tmpl, probe, work, io));
}

enum surface_status surface_compare_mirrored(struct surface_work *work,
                                             const struct surface_face *tmpl,
                                             const struct surface_face *probe,
                                             struct surface_comparison *out)
{
    return library(face_compare_mirrored(tmpl, probe, work, out));
}

void surface_best_of(const struct surface_work *work, uint32_t n,
                     struct surface_comparison *c)
{
    face_best_of(c, n, work);
}

void surface_shown(const struct surface_comparison *c, double steps, double *score,
                   double *threshold)
{
    face_shown(c, steps, score, threshold);
}

enum surface_status surface_disparity(struct surface_work *work,
                                      const struct surface_face *tmpl,
                                      const struct surface_face *probe,
                                      struct surface_disparity *out)
{
    return library(face_minimal(tmpl, probe, work, out));
}

enum surface_status surface_weigh(struct surface_work *work,
                                  const struct surface_face *tmpl,
                                  const struct surface_face *probe,
                                  struct surface_disparity *least)
{
    return library(face_weigh(tmpl, probe, work, least));
}

enum surface_status surface_gaps(const struct surface_face *tmpl,
                                 const double (*points)[3], size_t n,
                                 const double transform[16], double *gap_mm)
{
    return library(
        heatmap_gaps(&tmpl->surface, (const struct dvec3 *)points, n, transform, gap_mm));
}

const char *surface_region_name(enum surface_region region)
{
    static const char *const name[SURFACE_REGIONS] = {
        [SURFACE_NOSE] = "nose",         [SURFACE_EYES] = "eyes",
        [SURFACE_FOREHEAD] = "forehead", [SURFACE_CHEEKS] = "cheeks",
        [SURFACE_MOUTH] = "mouth",       [SURFACE_CHIN] = "chin"};

    return (unsigned)region < SURFACE_REGIONS ? name[region] : NULL;
}

enum surface_status surface_parts(struct surface_work *work,
                                  const struct surface_face *tmpl,
                                  const struct surface_face *probe,
                                  struct surface_parts *out)
{
    return library(face_field(tmpl, probe, work, out));
}

enum surface_status surface_asymmetry(struct surface_work *work,
                                      const struct surface_face *face,
                                      struct surface_asymmetry *out)
{
    return library(face_asymmetry(face, work, out));
}
