#include "heights.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "lattice.h"
#include "mesh.h"
#include "surface.h"

/* The most that one sample stands for: a quarter of a cell. */
#define HEIGHTS_AREA_MM2 4.0f

/* mm beside the grid: farther no motion of a fit leads. */
#define HEIGHTS_AROUND_MM 40.0f

/* Share of a cell that must be covered. */
#define HEIGHTS_COVERED 0.45f

/* Cosine of the steepest triangle. */
#define HEIGHTS_STEEP 0.2f

/* Parts of a triangle's side, at most: of one that is as large as the grid. */
#define HEIGHTS_PARTS 64

/* A triangle whose circle, in which there is no point, has a radius of more than this many mean
 * distances of points fills a hole: what covered the face was cut out there.  Of points on a grid each
 * circle has 0.71, of points wholly at random 1.4 % of the area has more. */
#define HEIGHTS_HOLE 1.6

struct heights_corner {
    float x, y, z;
};

static void heights_place(const struct mesh *m, const struct pose *pose,
                          struct heights_corner *at)
{
    struct pose mm = *pose; /* of lattice units */

    for (int i = 0; i < 9; i++)
        mm.r[i] /= LATTICE_PER_MM;
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 q =
            pose_apply(&mm, (struct dvec3){m->xy[v].x, m->xy[v].y, m->z[v]});

        at[v] = (struct heights_corner){(float)q.x, (float)q.y, (float)q.z};
    }
}

/* Is the place on the grid, or near it? */
static bool is_near(const struct heights_corner *c)
{
    const float rim = HEIGHTS_AROUND_MM;

    return c->x > (float)GRID_LEFT - rim &&
           c->x < (float)(GRID_LEFT + GRID_NX * GRID_MM) + rim &&
           c->y > (float)GRID_BOTTOM - rim &&
           c->y < (float)(GRID_BOTTOM + GRID_NY * GRID_MM) + rim;
}

/* Into how many parts each side of the triangle is divided, 0: left out; and its area seen along
 * z, doubled. */
static uint32_t parts(const struct heights_corner *a, const struct heights_corner *b,
                      const struct heights_corner *c, float *twice)
{
    const float ux = b->x - a->x, uy = b->y - a->y, uz = b->z - a->z;
    const float vx = c->x - a->x, vy = c->y - a->y, vz = c->z - a->z;
    const float nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const float length = nx * nx + ny * ny + nz * nz;

    *twice = nz;
    if (!(nz > 0.0f) || !(nz * nz > HEIGHTS_STEEP * HEIGHTS_STEEP * length) ||
        !(is_near(a) || is_near(b) || is_near(c)))
        return 0;
    if (nz <= 2 * HEIGHTS_AREA_MM2)
        return 1;
    return (uint32_t)fminf(ceilf(sqrtf(nz / (2 * HEIGHTS_AREA_MM2))), HEIGHTS_PARTS);
}

/* Where samples go. */
struct heights_list {
    float *x, *y, *z, *area;
    size_t n, room;
};

static void heights_add(struct heights_list *l, const struct heights_corner *a,
                        const struct heights_corner *b, const struct heights_corner *c,
                        float u, float v, float area)
{
    const float w = 1.0f - u - v;

    l->x[l->n] = w * a->x + u * b->x + v * c->x;
    l->y[l->n] = w * a->y + u * b->y + v * c->y;
    l->z[l->n] = w * a->z + u * b->z + v * c->z;
    l->area[l->n++] = area;
}

static void add_parts(struct heights_list *l, const struct heights_corner *a,
                      const struct heights_corner *b, const struct heights_corner *c,
                      uint32_t k, float twice)
{
    const float step = 1.0f / (float)k, third = step / 3.0f;
    const float area = twice / 2 * step * step;

    for (uint32_t i = 0; i < k; i++)
        for (uint32_t j = 0; i + j < k; j++) {
            const float u = (float)i * step, v = (float)j * step;

            heights_add(l, a, b, c, u + third, v + third, area);
            if (i + j + 1 < k)
                heights_add(l, a, b, c, u + 2 * third, v + 2 * third, area);
        }
}

/* Does the triangle fill a hole?  holes.h tells holes by the distances round them, which are far apart
 * where few points are: of scans with a point a cell it fills what a pair of glasses left. */
static bool fills(const struct surface *f, const uint32_t v[3])
{
    const struct ivec2 p = f->mesh.xy[v[0]], q = f->mesh.xy[v[1]], r = f->mesh.xy[v[2]];
    const double ax = q.x - p.x, ay = q.y - p.y, a = ax * ax + ay * ay;
    const double bx = r.x - q.x, by = r.y - q.y, b = bx * bx + by * by;
    const double cx = p.x - r.x, cy = p.y - r.y, c = cx * cx + cy * cy;
    const double cross = ax * by - ay * bx, most = HEIGHTS_HOLE * HEIGHTS_HOLE;

    /* The radius is the product of the sides over four times the area. */
    return a * b * c * f->mesh.nv > 4 * most * f->measured * (cross * cross);
}

/* The samples of all triangles; where there is no room they are counted alone. */
static void add_all(const struct surface *f, const struct heights_corner *at,
                    struct heights_list *l)
{
    const struct mesh *m = &f->mesh;
    float twice;

    l->n = 0;
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        const uint32_t k = f->bridge[t] || fills(f, v)
                               ? 0
                               : parts(&at[v[0]], &at[v[1]], &at[v[2]], &twice);

        if (k > 0 && l->n + (size_t)k * k <= l->room)
            add_parts(l, &at[v[0]], &at[v[1]], &at[v[2]], k, twice);
        else
            l->n += (size_t)k * k;
    }
}

enum status heights_take(const struct surface *f, const struct pose *pose,
                         struct scratch *s, struct heights *out)
{
    const struct mesh *m = &f->mesh;
    const size_t corners = mem_round(m->nv * sizeof(struct heights_corner));
    struct heights_list l = {.n = 4 *
                                  (size_t)m->nt}; /* as many as most faces have at most */

    do { /* a larger block does not keep what was in the smaller one */
        size_t used = 0;
        unsigned char *block;
        struct heights_corner *at;

        l.room = (l.n + 15) & ~(size_t)15;
        block = scratch_need(s, corners + 4 * l.room * sizeof(float));
        if (block == NULL)
            return ST_ENOMEM;
        at = mem_take(block, &used, m->nv, sizeof *at);
        l.x = mem_take(block, &used, l.room, sizeof *l.x);
        l.y = mem_take(block, &used, l.room, sizeof *l.y);
        l.z = mem_take(block, &used, l.room, sizeof *l.z);
        l.area = mem_take(block, &used, l.room, sizeof *l.area);
        heights_place(m, pose, at);
        add_all(f, at, &l);
    } while (l.n > l.room);
    *out = (struct heights){l.x, l.y, l.z, l.area, (uint32_t)l.n};
    return ST_OK;
}

/* Of a cell: the area of its samples, and that times their height. */
typedef float tally __attribute__((vector_size(8)));

void heights_at(const struct heights *h, const struct pose *pose, float out[GRID_N])
{
    enum {
        SOME = 64
    }; /* samples at a time, so that the loop that computes has no branch */
    const double *d = pose->r, *t = pose->t;
    const float over = (float)(1 / GRID_MM);
    /* To cells, so that x and y are cut to whole numbers. */
    const float xx = (float)d[0] * over, xy = (float)d[1] * over, xz = (float)d[2] * over;
    const float yx = (float)d[3] * over, yy = (float)d[4] * over, yz = (float)d[5] * over;
    const float zx = (float)d[6], zy = (float)d[7], zz = (float)d[8], z0 = (float)t[2];
    const float x0 = ((float)t[0] - (float)GRID_LEFT) * over;
    const float y0 = ((float)t[1] - (float)GRID_BOTTOM) * over;
    tally sum[GRID_N + 1]; /* the last: off the grid */

    memset(sum, 0, sizeof sum);
    for (uint32_t from = 0; from < h->n; from += SOME) {
        const uint32_t n = h->n - from < SOME ? h->n - from : SOME;
        int32_t cell[SOME];
        float at[SOME];

        for (uint32_t k = 0; k < n; k++) {
            const float x = h->x[from + k], y = h->y[from + k], z = h->z[from + k];
            const float i = xx * x + xy * y + xz * z + x0;
            const float j = yx * x + yy * y + yz * z + y0;
            const bool in =
                (i >= 0.0f) & (i < (float)GRID_NX) & (j >= 0.0f) & (j < (float)GRID_NY);

            cell[k] = in ? (int32_t)(in ? j : 0.0f) * GRID_NX + (int32_t)(in ? i : 0.0f)
                         : GRID_N;
            at[k] = h->area[from + k] * (zx * x + zy * y + zz * z + z0);
        }
        for (uint32_t k = 0; k < n; k++)
            sum[cell[k]] += (tally){h->area[from + k], at[k]};
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        out[i] = sum[i][0] >= HEIGHTS_COVERED * (float)(GRID_MM * GRID_MM)
                     ? sum[i][1] / sum[i][0]
                     : (float)NAN;
}

enum status heights_of(const struct surface *f, const struct pose *pose,
                       struct scratch *s, float out[GRID_N])
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    struct heights h;
    const enum status st = heights_take(f, pose, s, &h);

    if (st == ST_OK)
        heights_at(&h, &still, out);
    return st;
}
