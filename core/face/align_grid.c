#include "align_grid.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "align_lanes.h"

#define LANES ALIGN_LANES
typedef align_lanes lanes;
typedef align_masks masks;

/* Where the middle of the first cell lies. */
#define LEFT   ((float)(GRID_LEFT + GRID_MM / 2))
#define BOTTOM ((float)(GRID_BOTTOM + GRID_MM / 2))

/* ---- the patches */

/* The heights at the corners of a patch: lower left and right, upper left and right.  False:
 * more than one is missing. */
static bool corners(const float z[GRID_N], uint32_t cell, float k[4])
{
    uint32_t missing = 0, which = 0;

    for (uint32_t i = 0; i < 4; i++) {
        k[i] = z[cell + (i & 1) + (i >> 1) * GRID_NX];
        which = isnan(k[i]) ? i : which;
        missing += isnan(k[i]) ? 1 : 0;
    }
    if (missing == 1) /* a parallelogram */
        k[which] = k[which ^ 1] + k[which ^ 2] - k[which ^ 3];
    return missing <= 1;
}

uint32_t align_grid_make(const float z[GRID_N], const float u[GRID_N],
                         struct align_grid *g)
{
    uint32_t n = 0;

    memset(g, 0, sizeof *g);
    for (uint32_t cell = 0; cell < GRID_N - GRID_NX; cell++) {
        struct align_patch *p = &g->patch[cell];
        float k[4], x, y;

        if (cell % GRID_NX == GRID_NX - 1 || !corners(z, cell, k))
            continue;
        *p = (struct align_patch){k[0], k[1] - k[0], k[2] - k[0],
                                  k[3] - k[2] - (k[1] - k[0])};
        x = (p->zx + 0.5f * p->zxy) * (float)(1 / GRID_MM);
        y = (p->zy + 0.5f * p->zxy) * (float)(1 / GRID_MM);
        g->flat[cell] = 1.0f / sqrtf(1.0f + x * x + y * y);
        g->weight[cell] =
            0.25f * (u[cell] + u[cell + 1] + u[cell + GRID_NX] + u[cell + GRID_NX + 1]);
        n++;
    }
    return n;
}

/* ---- the sum, LANES points at a time */

static inline lanes gather(const float *v, masks at)
{
    return (lanes){v[at[0]], v[at[1]], v[at[2]], v[at[3]]};
}

static inline void transpose(lanes c[4])
{
    const lanes a = __builtin_shufflevector(c[0], c[1], 0, 4, 1, 5);
    const lanes b = __builtin_shufflevector(c[2], c[3], 0, 4, 1, 5);
    const lanes d = __builtin_shufflevector(c[0], c[1], 2, 6, 3, 7);
    const lanes e = __builtin_shufflevector(c[2], c[3], 2, 6, 3, 7);

    c[0] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
    c[1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
    c[2] = __builtin_shufflevector(d, e, 0, 1, 4, 5);
    c[3] = __builtin_shufflevector(d, e, 2, 3, 6, 7);
}

/* The pose in single precision, for points relative to `from`. */
struct motion {
    struct dvec3 from;
    lanes r[9], t[3];
};

static void motion_of(const struct pose *pose, struct dvec3 from, struct motion *m)
{
    const struct dvec3 t = pose_apply(pose, from);

    m->from = from;
    for (int i = 0; i < 9; i++)
        m->r[i] = align_lanes_all((float)pose->r[i]);
    m->t[0] = align_lanes_all((float)t.x);
    m->t[1] = align_lanes_all((float)t.y);
    m->t[2] = align_lanes_all((float)t.z);
}

/* LANES points, moved. */
static inline void moved(const struct motion *m, const struct align_point *const p[LANES],
                         lanes q[3])
{
    float d[3][LANES];
    lanes x, y, z;

    for (int i = 0; i < LANES; i++) {
        d[0][i] = (float)(p[i]->p.x - m->from.x);
        d[1][i] = (float)(p[i]->p.y - m->from.y);
        d[2][i] = (float)(p[i]->p.z - m->from.z);
    }
    memcpy(&x, d[0], sizeof x);
    memcpy(&y, d[1], sizeof y);
    memcpy(&z, d[2], sizeof z);
    for (int i = 0; i < 3; i++)
        q[i] = m->r[3 * i] * x + m->r[3 * i + 1] * y + m->r[3 * i + 2] * z + m->t[i];
}

/* The surface under LANES places. */
struct under {
    masks there; /* is it? */
    lanes z, zx, zy, flat, weight;
};

static inline void align_grid_find(const struct align_grid *g, lanes x, lanes y,
                                   struct under *s)
{
    lanes i = (x - LEFT) * (float)(1 / GRID_MM);
    lanes j = (y - BOTTOM) * (float)(1 / GRID_MM);
    const masks inside = (i >= 0.0f) & (i < (float)(GRID_NX - 1)) & (j >= 0.0f) &
                         (j < (float)(GRID_NY - 1));
    masks column, row, cell;
    lanes c[4];

    i = align_lanes_only(inside, i);
    j = align_lanes_only(inside, j);
    column = __builtin_convertvector(i, masks);
    row = __builtin_convertvector(j, masks);
    i -= __builtin_convertvector(column, lanes);
    j -= __builtin_convertvector(row, lanes);
    cell = ((row * GRID_NX + column) & inside) | (~inside & GRID_N);
    for (int k = 0; k < 4; k++)
        memcpy(&c[k], &g->patch[cell[k]], sizeof c[k]);
    transpose(c);
    s->flat = gather(g->flat, cell);
    s->weight = gather(g->weight, cell);
    s->there = s->flat > 0.0f;
    s->z = c[0] + c[1] * i + (c[2] + c[3] * i) * j;
    s->zx = (c[1] + c[3] * j) * (float)(1 / GRID_MM);
    s->zy = (c[2] + c[3] * i) * (float)(1 / GRID_MM);
}

static inline void align_grid_add(struct align_lanes_sums *to, const lanes q[3],
                                  const struct under *s, struct dvec3 c,
                                  enum solve_loss loss)
{
    const struct align_under under = {
        .there = s->there,
        .x = q[0] - (float)c.x,
        .y = q[1] - (float)c.y,
        .z = q[2] - (float)c.z,
        .normal = {-s->zx * s->flat, -s->zy * s->flat, s->flat},
        .gap = (q[2] - s->z) * s->flat,
        .weight = s->weight,
    };

    align_lanes_add(to, &under, loss);
}

void align_grid_sum(const struct align_grid *g, const struct align_point *pts, uint32_t n,
                    uint32_t stride, const struct pose *pose, struct dvec3 c,
                    enum solve_loss loss, struct solve_sum *sum)
{
    const uint32_t count = n / stride + (n % stride != 0);
    struct align_lanes_sums all_of = {0};
    struct motion m;

    motion_of(pose, pts[0].p, &m);
    for (uint32_t i = 0; i < count; i += LANES) {
        const struct align_point *p[LANES];
        struct under s;
        lanes q[3];

        for (uint32_t k = 0; k < LANES; k++)
            p[k] = &pts[(i + k < count ? i + k : i) * stride];
        moved(&m, p, q);
        align_grid_find(g, q[0], q[1], &s);
        for (uint32_t k = 0; k < LANES; k++)
            s.there[k] &= -(int32_t)(i + k < count);
        align_grid_add(&all_of, q, &s, c, loss);
    }
    align_lanes_finish(&all_of, count, loss, sum);
}
