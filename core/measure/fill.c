#include "fill.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"
#include "surface.h"

/* Points missing in a hole, by its area and rim, below which it is left alone.  Points at random
 * leave such gaps: of sound simulated scans of 3,000 points one in six has one, of 20,000
 * points each; with 3 it would be three times as many. */
#define FILL_LEAST 5

/* Looks at a surface, the first included, until nothing is missing: 2, rarely 3. */
#define FILL_PASSES 8

#define ROW 0.8660254037844386 /* height of an equilateral triangle of side 1 */
#define PI  3.141592653589793

/* Square lattice units a point, at least: nearer points would round to the same. */
#define FINEST 4

struct fill_work {
    const struct mesh *scan; /* that heights are interpolated in */
    const struct surface *s; /* that is looked at: the scan, later with restored points */
    const struct mesh *m;    /* its mesh */
    double cell;             /* measured area a vertex over the square of the spacing */
    uint32_t *queue;         /* [nt] triangles of one hole */
    uint8_t *seen;           /* [nt] */
    uint32_t most, cap, hole_cap;
    struct fill *out;
};

/* Point i of row j of the grid; odd rows are shifted by half a side. */
static struct ivec2 grid_point(int64_t i, int64_t j, double side)
{
    return (struct ivec2){
        (int32_t)floor(((double)i + (j % 2 != 0 ? 0.5 : 0)) * side + 0.5),
        (int32_t)floor((double)j * side * ROW + 0.5)};
}

/* The list of n elements with room for one more; *cap is how many it has room for.  NULL: no
 * memory, and the list is as it was. */
static void *fill_grow(void *list, uint32_t n, uint32_t *cap, size_t size)
{
    const uint32_t larger = 2 * n + 64;
    void *p;

    if (n < *cap)
        return list;
    if ((p = mem_array(larger, size)) == NULL)
        return NULL;
    if (n > 0)
        memcpy(p, list, n * size);
    mem_free(list);
    *cap = larger;
    return p;
}

/* Squares of distances up to 2^51: exact. */
static int64_t fill_square(struct ivec2 a, struct ivec2 b)
{
    const int64_t dx = a.x - b.x, dy = a.y - b.y;

    return dx * dx + dy * dy;
}

/* Square of the distance of q, in triangle t, to the nearest vertex.  In a Delaunay
 * triangulation every vertex but the nearest has a neighbour that is nearer to q. */
static int64_t nearest(const struct mesh *m, uint32_t t, struct ivec2 q)
{
    uint32_t v = m->org[3 * t], last;
    int64_t best = fill_square(m->xy[v], q);

    do {
        uint32_t h = m->out[v];
        const uint32_t first = h;

        last = v;
        do {
            const uint32_t to = mesh_dest(m, h);

            if (to != m->nv && fill_square(m->xy[to], q) < best) {
                best = fill_square(m->xy[to], q);
                v = to;
            }
            h = mesh_turn(m, h);
        } while (h != first);
    } while (v != last);
    return best;
}

/* Is q in the counter-clockwise triangle t?  Points on an edge that two triangles share
 * belong to one of them: that whose edge runs down, or to the left. */
static bool contains(const struct mesh *m, uint32_t t, struct ivec2 q)
{
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
        const struct ivec2 a = m->xy[m->org[h]], b = m->xy[mesh_dest(m, h)];
        const int64_t side = orient2d(a, b, q);

        if (side < 0 || (side == 0 && (b.y > a.y || (b.y == a.y && b.x > a.x))))
            return false;
    }
    return true;
}

/* The height of the scan's surface at q, in triangle t of w->m. */
static double height_at(const struct fill_work *w, uint32_t t, struct ivec2 q)
{
    const struct mesh *m = w->scan;
    struct location at = {3 * t, LOCATE_INSIDE};

    if (m != w->m) {
        uint32_t h = m->out[0];

        while (mesh_is_ghost(m, h / 3))
            h = mesh_turn(m, h);
        at = locate_point(m, h, m->xy[0], q, NULL);
    }
    return locate_height(m, at, q);
}

static enum status restore_point(struct fill_work *w, uint32_t t, struct ivec2 q)
{
    struct fill *out = w->out;
    struct ivec3 *pts;

    if (out->n >= w->most)
        return ST_ELIMIT;
    if ((pts = fill_grow(out->pts, out->n, &w->cap, sizeof *pts)) == NULL)
        return ST_ENOMEM;
    pts[out->n++] = (struct ivec3){q.x, q.y, (int32_t)floor(height_at(w, t, q) + 0.5)};
    out->pts = pts;
    return ST_OK;
}

/* From where to where the triangle t crosses the height y, which it does. */
static void crossing(const struct mesh *m, uint32_t t, double y, double *left,
                     double *right)
{
    *left = INFINITY;
    *right = -INFINITY;
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
        const struct ivec2 a = m->xy[m->org[h]], b = m->xy[mesh_dest(m, h)];
        const double s = a.y == b.y ? 0 : (y - a.y) / ((double)b.y - a.y);
        const double x = a.x + s * ((double)b.x - a.x);

        if (s < 0 || s > 1 || (a.y == b.y && y != a.y))
            continue;
        *left = fmin(*left, x);
        *right = fmax(*right, x);
    }
}

/* The points of the grid in triangle t, row by row. */
static enum status restore_triangle(struct fill_work *w, uint32_t t, double side)
{
    const struct mesh *m = w->m;
    const uint32_t *v = &m->org[3 * t];
    const double apart = FILL_APART * side, row = ROW * side;
    const double low = fmin(fmin(m->xy[v[0]].y, m->xy[v[1]].y), m->xy[v[2]].y);
    const double high = fmax(fmax(m->xy[v[0]].y, m->xy[v[1]].y), m->xy[v[2]].y);

    for (int64_t j = (int64_t)floor(low / row); j <= (int64_t)ceil(high / row); j++) {
        double left, right;

        crossing(m, t, fmin(fmax((double)j * row, low), high), &left, &right);
        /* One point more at either end: grid_point() rounds. */
        for (int64_t i = (int64_t)floor(left / side) - 1;
             i <= (int64_t)ceil(right / side) + 1; i++) {
            const struct ivec2 q = grid_point(i, j, side);
            enum status st;

            if (contains(m, t, q) && (double)nearest(m, t, q) >= apart * apart &&
                (st = restore_point(w, t, q)) != ST_OK)
                return st;
        }
    }
    return ST_OK;
}

/* Adds to the queue's n triangles those that bridge and are connected to them; returns how
 * many there are then. */
static uint32_t flood(struct fill_work *w, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t h = 3 * w->queue[k]; h < 3 * w->queue[k] + 3; h++) {
            const uint32_t t = w->m->twin[h] / 3;

            if (w->s->bridge[t] && !w->seen[t]) {
                w->seen[t] = 1;
                w->queue[n++] = t;
            }
        }
    return n;
}

static double area_of(const struct mesh *m, uint32_t t)
{
    return 0.5 * (double)orient2d(m->xy[m->org[3 * t]], m->xy[m->org[3 * t + 1]],
                                  m->xy[m->org[3 * t + 2]]);
}

static double square_spacing(const struct surface *s, uint32_t v)
{
    return (double)s->spacing[v] * (double)s->spacing[v];
}

/* Fill the hole of the queue's n triangles, if points are missing there. */
static enum status fill_restore(struct fill_work *w, uint32_t n)
{
    struct fill *out = w->out;
    struct fill_hole *hole;
    const uint32_t before = out->n;
    double area = 0, cell = 0, round = 0, edges = 0;
    enum status st = ST_OK;

    for (uint32_t k = 0; k < n; k++) {
        area += area_of(w->m, w->queue[k]);
        for (uint32_t h = 3 * w->queue[k]; h < 3 * w->queue[k] + 3; h++)
            if (!w->s->bridge[w->m->twin[h] / 3]) {
                cell += w->cell * square_spacing(w->s, w->m->org[h]);
                round += area_of(w->m, w->m->twin[h] / 3);
                edges++;
            }
    }
    cell = fmax(cell / edges, FINEST);
    if (area / fmax(cell, 2 * round / edges) - edges / 2 + 1 < FILL_LEAST)
        return ST_OK;
    if (area / cell > w->most + edges) /* before they are all looked at */
        return ST_ELIMIT;
    for (uint32_t k = 0; k < n && st == ST_OK; k++)
        st = restore_triangle(w, w->queue[k], sqrt(cell / ROW));
    if (st != ST_OK || out->n == before)
        return st;
    if ((hole = fill_grow(out->hole, out->nholes, &w->hole_cap, sizeof *hole)) == NULL)
        return ST_ENOMEM;
    hole[out->nholes++] = (struct fill_hole){area, 2 * sqrt(area / PI), out->n - before};
    out->hole = hole;
    return ST_OK;
}

/* One look at all holes of s; returns what fill_holes() does. */
static enum status pass(const struct surface *s, struct scratch *scratch,
                        struct fill_work *w)
{
    const struct mesh *m = &s->mesh;
    enum status st = ST_OK;
    double beyond = 0, squares = 0;
    uint32_t n = 0;

    w->s = s;
    w->m = m;
    for (uint32_t v = 0; v < m->nv; v++)
        squares += square_spacing(s, v);
    w->cell = s->measured / squares;
    w->queue = scratch_need(scratch, m->nt * (sizeof *w->queue + sizeof *w->seen));
    if (w->queue == NULL)
        return ST_ENOMEM;
    w->seen = (uint8_t *)(w->queue + m->nt);
    memset(w->seen, 0, m->nt);
    for (uint32_t t = 0; t < m->nt; t++)
        if (mesh_is_ghost(m, t)) {
            w->seen[t] = 1;
            w->queue[n++] = t;
        }
    for (uint32_t k = n, all = flood(w, n); k < all; k++)
        beyond += area_of(m, w->queue[k]);
    w->out->beyond = beyond;
    for (uint32_t t = 0; t < m->nt && st == ST_OK; t++)
        if (s->bridge[t] && !w->seen[t]) {
            w->seen[t] = 1;
            w->queue[0] = t;
            st = fill_restore(w, flood(w, 1));
        }
    return st;
}

/* The surface of the points of s and those restored so far. */
static enum status fill_join(const struct surface *s, const struct fill *f,
                             struct scratch *scratch, struct surface *out)
{
    const struct mesh *m = &s->mesh;
    struct ivec3 *pts = mem_array((size_t)m->nv + f->n, sizeof *pts);
    enum status st;

    if (pts == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v++)
        pts[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
    if (f->n > 0)
        memcpy(pts + m->nv, f->pts, f->n * sizeof *pts);
    st = surface_prepare(pts, (size_t)m->nv + f->n, false, scratch, out);
    mem_free(pts);
    return st;
}

enum status fill_holes(const struct surface *s, uint32_t most, struct scratch *scratch,
                       struct fill *out)
{
    struct fill_work w = {.scan = &s->mesh, .most = most, .out = out};
    struct surface filled = {0};
    enum status st;
    uint32_t before = 0;

    fill_free(out);
    st = pass(s, scratch, &w);
    for (int k = 1; st == ST_OK && out->n > before && k < FILL_PASSES; k++) {
        before = out->n;
        if ((st = fill_join(s, out, scratch, &filled)) == ST_OK)
            st = pass(&filled, scratch, &w);
    }
    surface_free(&filled);
    return st;
}

void fill_free(struct fill *f)
{
    mem_free(f->pts);
    mem_free(f->hole);
    *f = (struct fill){0};
}

void fill_error(double diameter_mm, double *rms_mm, double *most_mm)
{
    static const double size[FILL_SIZES] = FILL_SIZE_MM;
    static const double rms[FILL_SIZES] = FILL_RMS_MM, most[FILL_SIZES] = FILL_95_MM;
    const double d = fmax(diameter_mm, size[0]);
    int k = 1;
    double s;

    *rms_mm = *most_mm = (double)NAN;
    if (!(d <= size[FILL_SIZES - 1]))
        return;
    while (d > size[k])
        k++;
    s = (d - size[k - 1]) / (size[k] - size[k - 1]);
    *rms_mm = rms[k - 1] + s * (rms[k] - rms[k - 1]);
    *most_mm = most[k - 1] + s * (most[k] - most[k - 1]);
}
