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

enum surface_status surface_build(struct surface_work *work,
                                  const struct surface_cloud *cloud,
                                  struct surface_face **out, struct surface_found *found)
{
    struct surface_face *f = face_renew(out);
    struct surface_found about = {0};
    enum status st = f == NULL ? ST_ENOMEM : check_cloud(cloud);

    if (st == ST_OK)
        st = libsurface_build(work, cloud, NULL, f, &about);
    if (found != NULL)
        *found = about;
    return face_finish(st, f, out);
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

static void give_frames(const struct frames *f, enum status st,
                        struct surface_frame *frame)
{
    for (uint32_t i = 0; i < f->n; i++) {
        const struct frames_one *one = &f->one[i];

        frame[i] = (struct surface_frame){.status = status_to(one->st),
                                          .score = one->score,
                                          .gap_mm = i == f->base ? 0 : one->at.gap_mm,
                                          .found = one->found};
        if (st == ST_OK)
            frame[i].adds = one->adds;
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
    struct surface_face *face = face_renew(out);
    struct surface_found about = {0};
    enum status st = f == NULL || face == NULL          ? ST_ENOMEM
                     : n == 0 || n > SURFACE_FRAMES_MAX ? ST_EINVAL
                                                        : ST_OK;

    *base = 0;
    if (f != NULL)
        memset(f, 0, sizeof *f);
    if (st == ST_OK) {
        st = fuse(f, work, n, cloud, face, &about);
        give_frames(f, st, frame);
        *base = f->base;
        frames_free(f);
    }
    mem_free(f);
    if (found != NULL)
        *found = about;
    return face_finish(st, face, out);
}

enum surface_status surface_check(struct surface_work *work,
                                  const struct surface_cloud *cloud,
                                  struct surface_face **out, enum surface_status *refused,
                                  struct surface_found *why, struct surface_found *found)
{
    struct scan_search search = {.done = false};
    struct surface_face *f = face_renew(out);
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
    *refused = status_to(st);
    *why = about;
    if (st >= ST_ELIMIT && st <= ST_EQUALITY)
        st = libsurface_build(work, &loose, &search, f, &about);
    *found = about;
    return face_finish(st, f, out);
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
