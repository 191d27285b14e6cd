#include "crop.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "cloudpoints.h"
#include "grid.h"
#include "mem.h"
#include "select.h"
#include "shape.h"
#include "shape_map.h"
#include "thin.h"

/* Cells (12 mm) round the outline of the mean face that belong to a scan of it. */
#define CROP_RIM 3

/* mm before and behind the fitted face within which points are the face's; on the rim, where
 * the sides of a face fall off, of the height at its edge.  From 4 to 10 fare alike. */
#define CROP_BEFORE_MM     8.0
#define CROP_BEHIND_MM     8.0
#define CROP_RIM_BEFORE_MM 20.0
#define CROP_RIM_BEHIND_MM 40.0

/* A point is hidden from the front where another one in its cell lies farther before the
 * fitted face than it, by more than STEP mm and SLOPE times the distance between the two; by
 * NOISE times the lower quartile of what two points of a cell differ by, where that is more.  Of
 * points all over a head the mated score becomes 0.063 (2 mm and a slope of 1: 0.080; 5 mm:
 * 0.114); where nothing is hidden it grows by 0.001. */
#define CROP_SEEN_STEP_MM 1.5
#define CROP_SEEN_SLOPE   0.5
#define CROP_SEEN_NOISE   8.0

/* ---- the face with a rim */

#define RIM    CROP_RIM
#define NX     (GRID_NX + 2 * RIM)
#define NY     (GRID_NY + 2 * RIM)
#define ROOM   (NX * NY)
#define LEFT   (GRID_LEFT - RIM * GRID_MM)
#define BOTTOM (GRID_BOTTOM - RIM * GRID_MM)

/* Per cell of the face and its rim a plane, and how far before and behind it, along z, there
 * are points of the face; the last one stands for all other places, where there are none. */
struct room {
    float z[ROOM + 1], zx[ROOM + 1], zy[ROOM + 1]; /* z: at x = 0, y = 0 */
    float before[ROOM + 1], behind[ROOM + 1];
    bool skin[ROOM + 1]; /* of the face alone */
    bool other[ROOM + 1];
};

/* The cell of the grid nearest to (i, j) where the face has a height, within the rim;
 * GRID_NONE: there is none. */
static uint32_t nearest(const float height[GRID_N], int i, int j)
{
    uint32_t best = GRID_NONE;
    int least = RIM * RIM + 1;

    for (int b = -RIM; b <= RIM && least > 0; b++) {
        for (int a = -RIM; a <= RIM; a++) {
            const int x = i + a, y = j + b, d = a * a + b * b;

            if (d >= least || x < 0 || x >= GRID_NX || y < 0 || y >= GRID_NY ||
                isnan(height[y * GRID_NX + x]))
                continue;
            least = d;
            best = (uint32_t)(y * GRID_NX + x);
        }
    }
    return best;
}

/* The plane in cell k of the room: that of the face, or level where the face ends. */
static void measure_cell(const struct crop_view *v, uint32_t cell, bool rim, int k,
                         struct room *r)
{
    const float z = v->height[cell];
    float steep = 1;

    r->z[k] = z;
    if (!rim) {
        shape_map_slope(v->height, cell, &r->zx[k], &r->zy[k]);
        r->z[k] -= r->zx[k] * (float)grid_x(cell) + r->zy[k] * (float)grid_y(cell);
        steep = sqrtf(1 + r->zx[k] * r->zx[k] + r->zy[k] * r->zy[k]);
    }
    r->before[k] = steep * (float)(rim ? CROP_RIM_BEFORE_MM : CROP_BEFORE_MM);
    r->behind[k] = steep * (float)(rim ? CROP_RIM_BEHIND_MM : CROP_BEHIND_MM);
    r->skin[k] = !rim && v->cell[cell] == SHAPE_SKIN;
    r->other[k] = v->cell[cell] == SHAPE_COVER;
}

static void measure_room(const struct crop_view *v, struct room *r)
{
    *r = (struct room){0};
    for (int k = 0; k < ROOM; k++) {
        const int i = k % NX - RIM, j = k / NX - RIM;
        const uint32_t cell = nearest(v->height, i, j);

        if (cell != GRID_NONE)
            measure_cell(v, cell, cell != (uint32_t)(j * GRID_NX + i), k, r);
    }
}

/* The cell of the room that (x, y) is in, or ROOM. */
static uint32_t cell_of(double x, double y)
{
    const double i = (x - LEFT) * (1 / GRID_MM), j = (y - BOTTOM) * (1 / GRID_MM);

    if (!((i >= 0) & (i < NX) & (j >= 0) & (j < NY)))
        return ROOM;
    return (uint32_t)j * NX + (uint32_t)i;
}

/* ---- what is seen from the front */

/* Of the points of a cell the foremost one, and two others that are chosen by where they lie in
 * it, whatever their order in the scan. */
struct seen {
    struct thin_point front, left, low;
};

static bool less(float a, float b, float then_a, float then_b, float last_a, float last_b)
{
    return a != b ? a < b : then_a != then_b ? then_a < then_b : last_a < last_b;
}

static void crop_look(const struct thin_point *p, size_t n, struct seen seen[ROOM])
{
    static const struct thin_point none = {INFINITY, INFINITY, -INFINITY, 0, 0};

    for (size_t i = 0; i < ROOM; i++)
        seen[i] = (struct seen){none, none, none};
    for (size_t i = 0; i < n; i++) {
        const struct thin_point q = p[i];
        struct seen *s = &seen[cell_of(q.x, q.y)];

        if (less(-q.z, -s->front.z, q.x, s->front.x, q.y, s->front.y))
            s->front = q;
        if (less(q.x, s->left.x, q.y, s->left.y, q.z, s->left.z))
            s->left = q;
        if (less(q.y, s->low.y, q.x, s->low.x, q.z, s->low.z))
            s->low = q;
    }
}

/* How far behind the foremost point of a cell others may lie by noise alone: a multiple of what
 * two points of a cell of skin differ by, less than three in four pairs, as of two layers half
 * of the pairs are of one. */
static double least_step(const struct room *r, const struct seen seen[ROOM])
{
    double d[ROOM], typical = 0;
    size_t n = 0;

    for (int k = 0; k < ROOM; k++)
        if (r->skin[k] && seen[k].left.index != seen[k].low.index)
            d[n++] = fabs((double)seen[k].left.z - (double)seen[k].low.z);
    if (n > 0)
        typical = select_kth(d, n, n / 4);
    return fmax(CROP_SEEN_NOISE * typical, CROP_SEEN_STEP_MM);
}

static bool hidden(const struct thin_point *p, const struct thin_point *front, float step)
{
    const float x = p->x - front->x, y = p->y - front->y;

    return front->z - p->z > step + (float)CROP_SEEN_SLOPE * sqrtf(x * x + y * y);
}

/* Keeps those of the n points, their z that over the face, that no other hides; returns how
 * many they are. */
static size_t remove_hidden(const struct room *r, struct thin_point *p, size_t n)
{
    struct seen seen[ROOM];
    size_t kept = 0;
    float step;

    crop_look(p, n, seen);
    step = (float)least_step(r, seen);
    for (size_t i = 0; i < n; i++)
        if (!hidden(&p[i], &seen[cell_of(p[i].x, p[i].y)].front, step))
            p[kept++] = p[i];
    return kept;
}

/* ---- the crop */

/* Room for a point each, and c->index, which may not have been needed so far; NULL: out of
 * memory. */
static struct thin_point *crop_prepare(struct cloudpoints *c)
{
    struct thin_point *p = mem_array(c->n, sizeof *p);

    if (p != NULL && c->index == NULL) {
        if ((c->index = mem_array(c->n, sizeof *c->index)) == NULL) {
            mem_free(p);
            return NULL;
        }
        for (size_t i = 0; i < c->n; i++)
            c->index[i] = (uint32_t)i;
    }
    return p;
}

static struct thin_point seen_from(const struct pose *view, struct dvec3 p, size_t i)
{
    const struct dvec3 q = pose_apply(view, p);

    return (struct thin_point){(float)q.x, (float)q.y, (float)q.z, (uint32_t)i, 0};
}

/* c becomes these of its points, moved by view and each to the mean of those that it stands
 * for. */
static void crop_take(struct cloudpoints *c, const struct pose *view,
                      const struct thin_point *p, size_t n)
{
    struct pose turn = *view;

    memset(turn.t, 0, sizeof turn.t);
    for (size_t k = 0; k < n; k++) { /* p[k].index >= k */
        const uint32_t i = p[k].index;

        c->at[k] = pose_apply(view, c->at[i]);
        c->at[k].z += (double)p[k].off;
        if (c->normal != NULL)
            c->normal[k] = pose_apply(&turn, c->normal[i]);
        c->index[k] = c->index[i];
    }
    c->n = n;
}

/* The points of the face and its rim, their z that over the face; and the number of those where
 * something covers it. */
static size_t take_face(const struct cloudpoints *c, const struct pose *view,
                        const struct room *r, struct thin_point *p, size_t *other)
{
    size_t n = 0;

    *other = 0;
    for (size_t i = 0; i < c->n; i++) {
        const struct thin_point q = seen_from(view, c->at[i], i);
        const uint32_t cell = cell_of(q.x, q.y);

        p[n] = q;
        p[n].z = q.z - (r->z[cell] + r->zx[cell] * q.x + r->zy[cell] * q.y);
        *other += r->other[cell] & (p[n].z > -r->behind[cell]);
        n += (p[n].z < r->before[cell]) & (p[n].z > -r->behind[cell]);
    }
    return n;
}

/* Returns how many are left of n. */
static size_t remove_other(const struct room *r, struct thin_point *p, size_t n)
{
    size_t kept = 0;

    for (size_t i = 0; i < n; i++)
        if (!r->other[cell_of(p[i].x, p[i].y)])
            p[kept++] = p[i];
    return kept;
}

enum status crop_face(struct cloudpoints *c, const struct crop_view *v, size_t most,
                      struct crop_count *out)
{
    struct thin_point *p = crop_prepare(c);
    struct room room;
    enum status st;
    size_t n;

    if (p == NULL)
        return ST_ENOMEM;
    measure_room(v, &room);
    n = take_face(c, &v->pose, &room, p, &out->other);
    n = remove_hidden(&room, p, n);
    out->face = n = remove_other(&room, p, n);
    if ((st = thin_points(p, &n, most, CROP_MEAN_MM)) == ST_OK)
        crop_take(c, &v->pose, p, out->kept = n);
    mem_free(p);
    return st;
}

enum status crop_thin(struct cloudpoints *c, size_t most)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    struct thin_point *p = crop_prepare(c);
    size_t n = c->n;
    enum status st;

    if (p == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < n; i++)
        p[i] = seen_from(&still, c->at[i], i);
    if ((st = thin_points(p, &n, most, 0)) == ST_OK)
        crop_take(c, &still, p, n);
    mem_free(p);
    return st;
}
