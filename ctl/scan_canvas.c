#include "scan_canvas.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "lattice.h"
#include "mem.h"
#include "scan.h"

#define SIDE    520 /* pixels of the longer side */
#define OUTSIDE 200 /* of so many points one may lie outside, on each side */
#define MARGIN  0.04
#define AROUND  1.5 /* a face, in its sizes, is what is drawn of a room */
#define GREY    0xb8b8b8

/* Of the canonical frame, mm. */
#define FACE_LEFT   (-90.0)
#define FACE_BOTTOM (-115.0)
#define FACE_WIDE   180.0
#define FACE_HIGH   215.0
#define FACE_FAR    (-95.0) /* where the colours end */
#define FACE_NEAR   8.0

/* A point that stands there is one that covers the face, or that it hides behind. */
#define COVER_BEFORE_MM 60.0
#define COVER_BEHIND_MM 15.0

struct drawing {
    struct scan_canvas *to;
    float *depth; /* [h * w] of what was painted last */
    double far, near;
};

/* ---- pixels */

static enum status begin(struct drawing *d, double x, double y, double wide, double high)
{
    struct scan_canvas *c = d->to;
    size_t n;

    c->step = fmax(wide, high) / SIDE;
    c->w = (uint32_t)ceil(wide / c->step);
    c->h = (uint32_t)ceil(high / c->step);
    c->x = x + 0.5 * c->step;
    c->y = y + 0.5 * c->step;
    n = (size_t)c->w * c->h;
    c->rgba = mem_array(n, sizeof *c->rgba);
    d->depth = mem_array(n, sizeof *d->depth);
    if (c->rgba == NULL || d->depth == NULL)
        return ST_ENOMEM;
    memset(c->rgba, 0, n * sizeof *c->rgba);
    for (size_t i = 0; i < n; i++)
        d->depth[i] = -INFINITY;
    return ST_OK;
}

static void paint(uint8_t rgba[4], uint32_t rgb)
{
    for (int i = 0; i < 3; i++)
        rgba[i] = (uint8_t)(rgb >> (16 - 8 * i));
    rgba[3] = 255;
}

/* From dark blue, far away, to yellow. */
static void paint_depth(const struct drawing *d, double z, double light, uint8_t rgba[4])
{
    static const double stop[][3] = {
        {38, 40, 110}, {40, 100, 150}, {50, 160, 140}, {150, 205, 90}, {250, 232, 120}};
    const int last = (int)(sizeof stop / sizeof *stop) - 1;
    const double at = last * fmax(0, fmin(1, (z - d->far) / (d->near - d->far)));
    const int k = (int)fmin(at, last - 1);

    for (int i = 0; i < 3; i++)
        rgba[i] = (uint8_t)lround(
            light * (stop[k][i] + (at - k) * (stop[k + 1][i] - stop[k][i])));
    rgba[3] = 255;
}

/* A point as a square of so many pixels to each side; grey ones lie behind all others. */
static void paint_point(const struct drawing *d, struct dvec3 p, int side, bool grey)
{
    const struct scan_canvas *c = d->to;
    const double u = (p.x - c->x) / c->step, v = (p.y - c->y) / c->step;
    const float z = grey ? -INFINITY : (float)p.z;

    if (!(u > -1 && v > -1 && u < c->w && v < c->h))
        return;
    for (long y = lround(v) - side; y <= lround(v) + side; y++)
        for (long x = lround(u) - side; x <= lround(u) + side; x++) {
            const size_t i = (size_t)y * c->w + (size_t)x;

            if (x < 0 || y < 0 || x >= (long)c->w || y >= (long)c->h || d->depth[i] > z)
                continue;
            if (grey) {
                paint(c->rgba[i], GREY);
                continue;
            }
            d->depth[i] = z;
            paint_depth(d, p.z, 1, c->rgba[i]);
        }
}

/* So that neighbours of n points all over the canvas nearly touch. */
static int point_side(const struct scan_canvas *c, size_t n)
{
    const double apart = sqrt((double)c->w * c->h / ((double)n + 1));

    return (int)fmin(3, 0.45 * apart);
}

static enum status finish(struct drawing *d, enum status st)
{
    mem_free(d->depth);
    if (st != ST_OK)
        scan_canvas_free(d->to);
    return st;
}

/* ---- the points as delivered */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

struct range {
    double lo, hi;
};

/* Where nearly all points lie along an axis (0 to 2), and all of the face. */
static void measure_range(const struct scan_drawn *d, int axis, double *room,
                          struct range *all, struct range *face)
{
    *face = (struct range){INFINITY, -INFINITY};
    for (size_t i = 0; i < d->n; i++) {
        const struct dvec3 p = d->at[i];
        const double x = axis == 0 ? p.x : axis == 1 ? p.y : p.z;

        room[i] = x;
        if (d->used[i])
            *face = (struct range){fmin(face->lo, x), fmax(face->hi, x)};
    }
    qsort(room, d->n, sizeof *room, by_value);
    all->lo = fmin(room[d->n / OUTSIDE], face->lo);
    all->hi = fmax(room[d->n - 1 - d->n / OUTSIDE], face->hi);
}

enum status scan_canvas_points(const struct scan_drawn *d, struct scan_canvas *out)
{
    struct drawing to = {.to = out};
    double *room = mem_array(d->n, sizeof *room);
    struct range all[3], face[3];
    double wide;
    int side;
    enum status st;

    *out = (struct scan_canvas){.rgba = NULL};
    if (room == NULL)
        return ST_ENOMEM;
    for (int i = 0; i < 3; i++)
        measure_range(d, i, room, &all[i], &face[i]);
    mem_free(room);
    if (d->face != NULL) {
        const double size = fmax(face[0].hi - face[0].lo, face[1].hi - face[1].lo);

        for (int i = 0; i < 2; i++)
            all[i] = (struct range){fmax(all[i].lo, face[i].lo - AROUND * size),
                                    fmin(all[i].hi, face[i].hi + AROUND * size)};
    }
    wide = fmax(1e-9, fmax(all[0].hi - all[0].lo, all[1].hi - all[1].lo));
    st = begin(&to, all[0].lo - MARGIN * wide, all[1].lo - MARGIN * wide,
               all[0].hi - all[0].lo + 2 * MARGIN * wide,
               all[1].hi - all[1].lo + 2 * MARGIN * wide);
    to.far = d->face != NULL ? face[2].lo : all[2].lo;
    to.near = fmax(to.far + 1e-9, d->face != NULL ? face[2].hi : all[2].hi);
    side = st == ST_OK ? point_side(out, d->n) : 0;
    for (int grey = 1; st == ST_OK && grey >= 0; grey--)
        for (size_t i = 0; i < d->n; i++)
            if (grey == (d->face != NULL && !d->used[i]))
                paint_point(&to, d->at[i], side, grey);
    return finish(&to, st);
}

/* ---- the face */

struct corner {
    double x, y, z, light;
};

/* Every pixel whose middle lies in the triangle. */
static void fill(const struct drawing *d, const struct corner *p, const struct corner *q,
                 const struct corner *r)
{
    const struct scan_canvas *c = d->to;
    const double twice = (q->x - p->x) * (r->y - p->y) - (q->y - p->y) * (r->x - p->x);
    const double x0 = fmax(0, ceil(fmin(p->x, fmin(q->x, r->x))));
    const double x1 = fmin(c->w - 1.0, fmax(p->x, fmax(q->x, r->x)));
    const double y0 = fmax(0, ceil(fmin(p->y, fmin(q->y, r->y))));
    const double y1 = fmin(c->h - 1.0, fmax(p->y, fmax(q->y, r->y)));

    if (twice <= 0)
        return;
    for (double y = y0; y <= y1; y++)
        for (double x = x0; x <= x1; x++) {
            const double a = ((q->x - x) * (r->y - y) - (q->y - y) * (r->x - x)) / twice;
            const double b = ((r->x - x) * (p->y - y) - (r->y - y) * (p->x - x)) / twice;
            const double e = 1 - a - b, z = a * p->z + b * q->z + e * r->z;
            const size_t i = (size_t)y * c->w + (size_t)x;

            if (a < 0 || b < 0 || e < 0 || z <= (double)d->depth[i])
                continue;
            d->depth[i] = (float)z;
            paint_depth(d, z, a * p->light + b * q->light + e * r->light, c->rgba[i]);
        }
}

static bool drawn(const struct surface *s, uint32_t t)
{
    return !mesh_is_ghost(&s->mesh, t) && !s->bridge[t];
}

/* The vertices of the surface in the canonical frame, and how they are lit. */
static void place(const struct drawing *d, const struct face *f, struct dvec3 *normal,
                  struct corner *corner)
{
    const struct mesh *m = &f->surface.mesh;
    const struct dvec3 sun = {-0.35, 0.55, 0.758};

    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 p =
            pose_apply(&f->frame.pose, (struct dvec3){m->xy[v].x / LATTICE_PER_MM,
                                                      m->xy[v].y / LATTICE_PER_MM,
                                                      m->z[v] / LATTICE_PER_MM});

        corner[v] = (struct corner){p.x, p.y, p.z, 1};
        normal[v] = (struct dvec3){0, 0, 0};
    }
    for (uint32_t t = 0; t < m->nt; t++) {
        const struct corner *p, *q, *r;
        struct dvec3 n;

        if (!drawn(&f->surface, t))
            continue;
        p = &corner[m->org[3 * t]];
        q = &corner[m->org[3 * t + 1]];
        r = &corner[m->org[3 * t + 2]];
        n = vec_cross((struct dvec3){q->x - p->x, q->y - p->y, q->z - p->z},
                      (struct dvec3){r->x - p->x, r->y - p->y, r->z - p->z});
        for (uint32_t h = 3 * t; h < 3 * t + 3; h++)
            normal[m->org[h]] = vec_along(normal[m->org[h]], 1, n);
    }
    for (uint32_t v = 0; v < m->nv; v++) {
        const double length = sqrt(vec_dot(normal[v], normal[v]));

        corner[v].x = (corner[v].x - d->to->x) / d->to->step;
        corner[v].y = (corner[v].y - d->to->y) / d->to->step;
        if (length > 0)
            corner[v].light =
                fmin(1, 0.45 + 0.6 * fmax(0, vec_dot(normal[v], sun) / length));
    }
}

static enum status draw_surface(const struct drawing *d, const struct face *f)
{
    const struct mesh *m = &f->surface.mesh;
    struct dvec3 *normal = mem_array(m->nv, sizeof *normal);
    struct corner *corner = mem_array(m->nv, sizeof *corner);
    const enum status st = normal != NULL && corner != NULL ? ST_OK : ST_ENOMEM;

    if (st == ST_OK)
        place(d, f, normal, corner);
    for (uint32_t t = 0; st == ST_OK && t < m->nt; t++)
        if (drawn(&f->surface, t))
            fill(d, &corner[m->org[3 * t]], &corner[m->org[3 * t + 1]],
                 &corner[m->org[3 * t + 2]]);
    mem_free(normal);
    mem_free(corner);
    return st;
}

/* From the file to the canonical frame. */
static struct dvec3 canonical(const struct scan_drawn *d, size_t i)
{
    const struct dvec3 p = vec_transform(d->found->view, d->at[i]);

    return d->face != NULL ? pose_apply(&d->face->frame.pose, p) : p;
}

/* The holes of the surface on the mean face, by what stands there. */
static void draw_holes(const struct drawing *d, const struct scan_drawn *s)
{
    const struct scan_canvas *c = d->to;
    const float *height = s->mean->height;
    bool stands[GRID_N] = {false};

    for (size_t i = 0; s->found->occluded > 0 && i < s->n; i++) {
        const struct dvec3 p = canonical(s, i);
        const uint32_t cell = grid_cell(p.x, p.y);

        if (!s->used[i] && cell != GRID_NONE &&
            p.z < (double)height[cell] + COVER_BEFORE_MM &&
            p.z > (double)height[cell] - COVER_BEHIND_MM)
            stands[cell] = true;
    }
    for (size_t i = 0; i < (size_t)c->w * c->h; i++) {
        const uint32_t cell = grid_cell(c->x + (double)(i % c->w) * c->step,
                                        c->y + (double)(i / c->w) * c->step);

        if (c->rgba[i][3] == 0 && cell != GRID_NONE && !isnan(height[cell]))
            paint(c->rgba[i], stands[cell] ? SCAN_CANVAS_COVERED : SCAN_CANVAS_EMPTY);
    }
}

enum status scan_canvas_face(const struct scan_drawn *s, struct scan_canvas *out)
{
    struct drawing d = {.to = out, .far = FACE_FAR, .near = FACE_NEAR};
    enum status st;

    *out = (struct scan_canvas){.rgba = NULL};
    st = begin(&d, FACE_LEFT, FACE_BOTTOM, FACE_WIDE, FACE_HIGH);
    if (st == ST_OK && s->face != NULL) {
        if ((st = draw_surface(&d, s->face)) == ST_OK)
            draw_holes(&d, s);
    } else if (st == ST_OK && s->found->found) {
        for (size_t i = 0; i < s->n; i++)
            paint_point(&d, canonical(s, i), 1, false);
    }
    return finish(&d, st);
}

void scan_canvas_free(struct scan_canvas *c)
{
    mem_free(c->rgba);
    *c = (struct scan_canvas){.rgba = NULL};
}
