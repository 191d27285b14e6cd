#include "headview.h"

#include <math.h>
#include <stdlib.h>

#include "holes.h"
#include "lattice.h"
#include "locate.h"
#include "mem.h"

/* Squares of the z-buffer.  A point of the skin fills those within SPLAT spacings, so that even
 * points at random leave no gap; it hides what lies DEEP spacings and more behind it, because
 * on steep places neighbours differ in height.  What covers the skin is dense, and hides all
 * behind it. */
#define SQUARE 1.5
#define SPLAT  1.5
#define DEEP   3.5

/* mm: what lies so far behind others all round it is hidden, as an eyeball behind its lid: of a
 * slope, however steep, the higher ones lie on one side.  Of DEEP alone a head's view scored
 * 0.10 instead of 0.07. */
#define BEHIND 0.8

struct buffer {
    double x0, y0;
    int nx, ny;
    float *skin, *cover;
};

static int column(const struct buffer *b, double x)
{
    return (int)((x - b->x0) / SQUARE);
}

static int row(const struct buffer *b, double y)
{
    return (int)((y - b->y0) / SQUARE);
}

static void splat(struct buffer *b, struct dvec3 p, float *top, double radius)
{
    for (int j = row(b, p.y - radius); j <= row(b, p.y + radius); j++)
        for (int i = column(b, p.x - radius); i <= column(b, p.x + radius); i++) {
            float *z = &top[j * b->nx + i];

            *z = fmaxf(*z, (float)p.z);
        }
}

static void headview_fill(const struct head *h, const struct headview *v,
                          struct buffer *b)
{
    const double most = fmax(SPLAT * h->spacing, HEAD_COVER_MM) + SQUARE;

    b->x0 = v->x0 - most;
    b->y0 = v->y0 - most;
    b->nx = column(b, v->x1 + most) + 1;
    b->ny = row(b, v->y1 + most) + 1;
    b->skin = head_alloc((size_t)b->nx * (size_t)b->ny, sizeof *b->skin);
    b->cover = head_alloc((size_t)b->nx * (size_t)b->ny, sizeof *b->cover);
    for (int i = 0; i < b->nx * b->ny; i++)
        b->skin[i] = b->cover[i] = -INFINITY;
    for (size_t i = 0; i < h->n; i++)
        if (h->part[i] == HEAD_SKIN)
            splat(b, h->at[i], b->skin, SPLAT * h->spacing);
        else
            splat(b, h->at[i], b->cover, HEAD_COVER_MM * 0.6);
}

static void headview_look(const struct head *h, bool one_layer, struct headview *v)
{
    const double deep = DEEP * h->spacing;
    struct buffer b;

    headview_fill(h, v, &b);
    for (size_t i = 0; i < h->n; i++) {
        const struct dvec3 p = h->at[i];
        const int at = row(&b, p.y) * b.nx + column(&b, p.x);

        if (h->part[i] == HEAD_SKIN)
            v->seen[i] = p.z > b.cover[at] && (one_layer || p.z > b.skin[at] - deep);
        else
            v->seen[i] = p.z > b.cover[at] - 2 && p.z > b.skin[at] - deep;
    }
    free(b.skin);
    free(b.cover);
}

/* ---- the points seen, by squares of the view */

static double reach(const struct head *h)
{
    return fmax(1.6 * h->spacing, 1.6 * HEAD_COVER_MM);
}

static uint32_t square_of(const struct headview *v, double x, double y)
{
    const double size = reach(v->head);
    const double i = (x - v->x0) / size, j = (y - v->y0) / size;

    return i < 0 || j < 0 || i >= v->nx || j >= v->ny ? UINT32_MAX
                                                      : (uint32_t)j * v->nx + (uint32_t)i;
}

/* Count, then place. */
static void sort(struct headview *v)
{
    const struct head *h = v->head;

    for (size_t i = 0; i < h->n; i++)
        if (v->seen[i])
            v->first[square_of(v, h->at[i].x, h->at[i].y) + 2]++;
    for (uint32_t k = 2; k < v->nx * v->ny + 2; k++)
        v->first[k] += v->first[k - 1];
    for (size_t i = 0; i < h->n; i++)
        if (v->seen[i])
            v->item[v->first[square_of(v, h->at[i].x, h->at[i].y) + 1]++] = (uint32_t)i;
}

/* Calls `each` with the index of every point seen in the squares round (x, y). */
static void near(const struct headview *v, double x, double y,
                 void (*each)(void *to, uint32_t i), void *to)
{
    const double size = reach(v->head);

    for (int k = 0; k < 9; k++) {
        const uint32_t s =
            square_of(v, x + size * (k % 3 - 1), y + size * (double)(k / 3 - 1));

        for (uint32_t i = s != UINT32_MAX ? v->first[s] : 1;
             s != UINT32_MAX && i < v->first[s + 1]; i++)
            each(to, v->item[i]);
    }
}

/* ---- what others hide that lie all round it */

#define HIDDEN 2 /* seen so far */

struct round {
    const struct head *h;
    struct dvec3 p;
    unsigned eighths; /* of the circle about p, where points lie before it */
};

static void look_round(void *to, uint32_t i)
{
    struct round *r = to;
    const struct dvec3 d = vec_sub(r->h->at[i], r->p);

    if (r->h->part[i] == HEAD_SKIN && d.z > BEHIND &&
        d.x * d.x + d.y * d.y < reach(r->h) * reach(r->h))
        r->eighths |= 1U << ((int)((atan2(d.y, d.x) * (VEC_DEGREES / 45)) + 8) & 7);
}

/* Is no half of the circle empty? */
static bool all_round(unsigned eighths)
{
    const unsigned none = (~eighths & 255) * 257;

    return (none & none >> 1 & none >> 2 & none >> 3 & 255) == 0;
}

static void hide(struct headview *v)
{
    for (size_t i = 0; i < v->head->n; i++) {
        struct round r = {v->head, v->head->at[i], 0};

        if (!v->seen[i] || v->head->part[i] != HEAD_SKIN)
            continue;
        near(v, r.p.x, r.p.y, look_round, &r);
        v->seen[i] = all_round(r.eighths) ? HIDDEN : 1;
    }
    for (size_t i = 0; i < v->head->n; i++)
        v->seen[i] = v->seen[i] == 1;
}

void headview_make(const struct head *h, bool one_layer, struct headview *v)
{
    *v = (struct headview){
        .head = h, .x0 = INFINITY, .y0 = INFINITY, .x1 = -INFINITY, .y1 = -INFINITY};
    for (size_t i = 0; i < h->n; i++) {
        v->x0 = fmin(v->x0, h->at[i].x);
        v->y0 = fmin(v->y0, h->at[i].y);
        v->x1 = fmax(v->x1, h->at[i].x);
        v->y1 = fmax(v->y1, h->at[i].y);
    }
    v->nx = (uint32_t)((v->x1 - v->x0) / reach(h)) + 1;
    v->ny = (uint32_t)((v->y1 - v->y0) / reach(h)) + 1;
    v->seen = head_alloc(h->n, 1);
    v->first = head_alloc((size_t)v->nx * v->ny + 2, sizeof *v->first);
    v->item = head_alloc(h->n, sizeof *v->item);
    headview_look(h, one_layer, v);
    sort(v);
    if (!one_layer)
        hide(v);
}

void headview_free(struct headview *v)
{
    for (int k = 0; k < HEAD_VOID; k++)
        surface_free(&v->of[k].surface);
    free(v->seen);
    free(v->first);
    free(v->item);
}

/* ---- the surface between the points */

struct query {
    const struct headview *v;
    double x, y, least; /* the square of the distance to the nearest */
    uint32_t nearest;
};

static void keep_nearest(void *to, uint32_t i)
{
    struct query *q = to;
    const double dx = q->v->head->at[i].x - q->x, dy = q->v->head->at[i].y - q->y;

    if (q->v->seen[i] && dx * dx + dy * dy < q->least) {
        q->least = dx * dx + dy * dy;
        q->nearest = i;
    }
}

static int32_t units(double mm)
{
    return (int32_t)lrint(mm * LATTICE_PER_MM);
}

/* The points seen of a part, one at least.  Too few, or all on a line, have no surface. */
static void triangulate(const struct headview *v, enum head_part part,
                        struct headview_surface *s)
{
    const struct head *h = v->head;
    struct ivec3 *p = head_alloc(h->n, sizeof *p);
    struct scratch scratch = {0};
    uint32_t t = 0;
    size_t n = 0;

    for (size_t i = 0; i < h->n; i++)
        if (v->seen[i] && h->part[i] == part)
            p[n++] =
                (struct ivec3){units(h->at[i].x), units(h->at[i].y), units(h->at[i].z)};
    if (surface_prepare(p, n, false, &scratch, &s->surface) == ST_OK) {
        while (mesh_is_ghost(&s->surface.mesh, t))
            t++;
        s->he = 3 * t;
        s->at = s->surface.mesh.xy[s->surface.mesh.org[s->he]];
    }
    s->made = true;
    free(p);
    scratch_free(&scratch);
}

/* NAN: beside the surface, or in a gap of it. */
static double height(struct headview_surface *s, double x, double y)
{
    const struct mesh *m = &s->surface.mesh;
    const struct ivec2 to = {units(x), units(y)};
    struct location loc;

    if (m->nv == 0)
        return (double)NAN;
    loc = locate_point(m, s->he, s->at, to, NULL);
    if (loc.where == LOCATE_OUTSIDE || !holes_measured(m, s->surface.bridge, loc))
        return (double)NAN;
    s->he = loc.he;
    s->at = to;
    return locate_height(m, loc, to) / LATTICE_PER_MM;
}

/* At an edge, where the triangles of the nearest point's surface lead off it, that point's. */
enum head_part headview_at(struct headview *v, double x, double y, double *z)
{
    struct query q = {.v = v, .x = x, .y = y, .least = INFINITY};
    enum head_part part;
    double most, nearest;

    near(v, x, y, keep_nearest, &q);
    *z = isfinite(q.least) ? (double)NAN : -INFINITY;
    if (!isfinite(q.least) || v->head->part[q.nearest] == HEAD_VOID)
        return HEAD_VOID;
    part = (enum head_part)v->head->part[q.nearest];
    most = part == HEAD_SKIN ? 1.4 * v->head->spacing : 1.6 * HEAD_COVER_MM;
    if (q.least > most * most)
        return HEAD_VOID;
    if (!v->of[part].made)
        triangulate(v, part, &v->of[part]);
    nearest = v->head->at[q.nearest].z;
    *z = height(&v->of[part], x, y);
    if (isnan(*z) && part == HEAD_SKIN)
        return HEAD_VOID;
    if (!(fabs(*z - nearest) <= 1 + 2.5 * sqrt(q.least)))
        *z = nearest;
    return part;
}
