#include "find_nose.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "find_grid.h"
#include "mem.h"
#include "tuning.h"

#define REACH  2 /* cells on either side */
#define AROUND ((2 * REACH + 1) * (2 * REACH + 1) * (2 * REACH + 1))
#define BINS   128
#define DENSE  4095

/* Sums over the voxels of a cell or of several, of their places p: n, p, p p^T (xx, xy, xz,
 * yy, yz, zz). */
enum { N, X, Y, Z, XX, XY, XZ, YY, YZ, ZZ, SUMS };

struct sums {
    float s[SUMS];
};

static void add(struct sums *to, const float p[3])
{
    to->s[N] += 1;
    for (int i = 0; i < 3; i++)
        to->s[X + i] += p[i];
    to->s[XX] += p[0] * p[0];
    to->s[XY] += p[0] * p[1];
    to->s[XZ] += p[0] * p[2];
    to->s[YY] += p[1] * p[1];
    to->s[YZ] += p[1] * p[2];
    to->s[ZZ] += p[2] * p[2];
}

/* Where a cell lies, in cells, and its middle, mm from the grid's corner. */
static void middle_of(const struct find_grid *g, uint32_t cell, int32_t at[3],
                      float middle[3])
{
    find_grid_place(g, cell, at);
    for (int i = 0; i < 3; i++)
        middle[i] = ((float)at[i] + 0.5f) * (float)FIND_GRID_CELL_MM;
}

static void sum_cell(const struct find_grid *g, uint32_t cell, struct sums *out)
{
    int32_t at[3];
    float middle[3];

    memset(out, 0, sizeof *out);
    middle_of(g, cell, at, middle);
    for (uint32_t v = g->first[cell]; v < g->first[cell + 1]; v++) {
        const float *p = g->voxel[v].at;

        add(out, (const float[3]){p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]});
    }
}

/* The cells around one, their sums and means as seen from its middle. */
struct around {
    uint32_t n, voxels;
    float mean[3][AROUND];
    struct sums sums[AROUND];
};

static void look_around(const struct find_grid *g, const struct sums *sums, uint32_t cell,
                        float middle[3], struct around *out)
{
    int32_t at[3], there[3];

    middle_of(g, cell, at, middle);
    out->n = out->voxels = 0;
    for (int32_t z = at[2] - REACH; z <= at[2] + REACH; z++)
        for (int32_t y = at[1] - REACH; y <= at[1] + REACH; y++) {
            const struct find_run run =
                find_grid_run(g, at[0] - REACH, at[0] + REACH, y, z);

            for (uint32_t c = run.first; c < run.end; c++) {
                struct sums *to = &out->sums[out->n];
                float d[3];

                middle_of(g, c, there, d);
                *to = sums[c];
                out->voxels += g->first[c + 1] - g->first[c];
                for (int i = 0; i < 3; i++)
                    d[i] -= middle[i];
                to->s[XX] += 2 * d[0] * to->s[X] + to->s[N] * d[0] * d[0];
                to->s[YY] += 2 * d[1] * to->s[Y] + to->s[N] * d[1] * d[1];
                to->s[ZZ] += 2 * d[2] * to->s[Z] + to->s[N] * d[2] * d[2];
                to->s[XY] += d[0] * to->s[Y] + d[1] * to->s[X] + to->s[N] * d[0] * d[1];
                to->s[XZ] += d[0] * to->s[Z] + d[2] * to->s[X] + to->s[N] * d[0] * d[2];
                to->s[YZ] += d[1] * to->s[Z] + d[2] * to->s[Y] + to->s[N] * d[1] * d[2];
                for (int i = 0; i < 3; i++) {
                    to->s[X + i] += to->s[N] * d[i];
                    out->mean[i][out->n] = to->s[X + i] / to->s[N];
                }
                out->n++;
            }
        }
}

/* The eigenvector of the least eigenvalue of the covariance of what was summed: its adjugate
 * has the same ones, and powers of that leave the one. */
static void normal_of(const struct sums *a, float out[3])
{
    const float e = 1 / a->s[N];
    const float x = a->s[X] * e, y = a->s[Y] * e, z = a->s[Z] * e;
    const float xx = a->s[XX] * e - x * x + 1, xy = a->s[XY] * e - x * y;
    const float xz = a->s[XZ] * e - x * z, yy = a->s[YY] * e - y * y + 1;
    const float yz = a->s[YZ] * e - y * z, zz = a->s[ZZ] * e - z * z + 1;
    float m[6] = {yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
                  xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy};
    float l;

    for (int k = 0; k < 4; k++) {
        const float t = 1 / (m[0] + m[3] + m[5]);
        const float p = m[0] * t, q = m[1] * t, r = m[2] * t, s = m[3] * t, u = m[4] * t,
                    v = m[5] * t;

        m[0] = p * p + q * q + r * r;
        m[1] = p * q + q * s + r * u;
        m[2] = p * r + q * u + r * v;
        m[3] = q * q + s * s + u * u;
        m[4] = q * r + s * u + u * v;
        m[5] = r * r + u * u + v * v;
    }
    if (m[0] >= m[3] && m[0] >= m[5])
        memcpy(out, (const float[3]){m[0], m[1], m[2]}, 3 * sizeof *out);
    else if (m[3] >= m[5])
        memcpy(out, (const float[3]){m[1], m[3], m[4]}, 3 * sizeof *out);
    else
        memcpy(out, (const float[3]){m[2], m[4], m[5]}, 3 * sizeof *out);
    l = 1 / sqrtf(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int i = 0; i < 3; i++)
        out[i] *= l;
}

/* How far p, seen from the middle, sticks out of what is around it, and where to. */
static float protrusion(const struct around *a, const float p[3], float axis[3])
{
    struct sums all = {{0}};
    float normal[3], d[3], out = 0, l = 0;

    for (uint32_t c = 0; c < a->n; c++) {
        const float x = a->mean[0][c] - p[0], y = a->mean[1][c] - p[1],
                    z = a->mean[2][c] - p[2];

        if (x * x + y * y + z * z > (float)(FIND_BALL_MM * FIND_BALL_MM))
            continue;
        for (int k = 0; k < SUMS; k++)
            all.s[k] += a->sums[c].s[k];
    }
    if (all.s[N] < FIND_BALL_VOXELS)
        return 0;
    normal_of(&all, normal);
    for (int i = 0; i < 3; i++) {
        d[i] = p[i] - all.s[X + i] / all.s[N];
        out += d[i] * normal[i];
        l += d[i] * d[i];
    }
    l = l > 0 ? 1 / sqrtf(l) : 0;
    for (int i = 0; i < 3; i++)
        axis[i] = d[i] * l;
    return fabsf(out);
}

/* Is the protrusion of voxel v the largest within FIND_APART_MM? */
static bool highest(const struct find_grid *g, const float *out, uint32_t cell,
                    uint32_t v)
{
    const float *p = g->voxel[v].at;
    int32_t at[3];
    float middle[3];

    middle_of(g, cell, at, middle);
    for (int32_t z = at[2] - 1; z <= at[2] + 1; z++)
        for (int32_t y = at[1] - 1; y <= at[1] + 1; y++) {
            const struct find_run run = find_grid_run(g, at[0] - 1, at[0] + 1, y, z);

            for (uint32_t i = g->first[run.first]; i < g->first[run.end]; i++) {
                const float *q = g->voxel[i].at;
                const float d = (p[0] - q[0]) * (p[0] - q[0]) +
                                (p[1] - q[1]) * (p[1] - q[1]) +
                                (p[2] - q[2]) * (p[2] - q[2]);

                if (d <= (float)(FIND_APART_MM * FIND_APART_MM) &&
                    (out[i] > out[v] || (i < v && out[i] == out[v])))
                    return false;
            }
        }
    return true;
}

struct work {
    struct sums *sums; /* of cells */
    float *out;        /* of voxels */
    uint32_t *order;   /* voxels that stick out, the farthest first */
    struct around around;
};

static struct work *make_work(const struct find_grid *g)
{
    struct work *w = NULL;
    unsigned char *block = NULL;

    for (int pass = 0; pass < 2; pass++) {
        size_t at = 0;

        w = mem_take(block, &at, 1, sizeof *w);
        if (pass == 0) {
            (void)mem_take(NULL, &at, g->ncells, sizeof *w->sums);
            (void)mem_take(NULL, &at, g->nvoxels, sizeof *w->out);
            (void)mem_take(NULL, &at, g->nvoxels, sizeof *w->order);
            if ((block = mem_array(at, 1)) == NULL)
                return NULL;
        } else {
            w->sums = mem_take(block, &at, g->ncells, sizeof *w->sums);
            w->out = mem_take(block, &at, g->nvoxels, sizeof *w->out);
            w->order = mem_take(block, &at, g->nvoxels, sizeof *w->order);
        }
    }
    return w;
}

/* Voxels with a protrusion, by falling protrusion (in steps, those of one step in order). */
static uint32_t sort(const float *out, uint32_t n, uint32_t *order)
{
    uint32_t at[BINS + 1] = {0}, sum = 0;

    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t v = 0; v < n; v++) {
            const float t = out[v] * (float)(BINS / FIND_OUT_MAX_MM);
            const uint32_t bin = BINS - 1 - (uint32_t)(t < BINS - 1 ? t : BINS - 1);

            if (out[v] < (float)FIND_OUT_MIN_MM)
                continue;
            if (pass == 0)
                at[bin]++;
            else
                order[at[bin]++] = v;
        }
        for (uint32_t b = 0; pass == 0 && b < BINS; b++) {
            const uint32_t here = at[b];

            at[b] = sum;
            sum += here;
        }
    }
    return sum;
}

static uint32_t cell_of(const struct find_grid *g, uint32_t v)
{
    uint32_t a = 0, b = g->ncells;

    while (b - a > 1) {
        const uint32_t m = a + (b - a) / 2;

        if (g->first[m] <= v)
            a = m;
        else
            b = m;
    }
    return a;
}

static uint32_t points_in(const struct find_grid *g, uint32_t c)
{
    uint32_t n = 0;

    for (uint32_t v = g->first[c]; v < g->first[c + 1]; v++)
        n += g->voxel[v].n;
    return n;
}

/* The points that a cell must have to be one of the FIND_CELLS densest, and FIND_CELL_POINTS
 * at least. */
static uint32_t dense_from(const struct find_grid *g)
{
    uint32_t count[DENSE + 1] = {0}, n = 0, from = DENSE;

    for (uint32_t c = 0; c < g->ncells; c++) {
        const uint32_t k = points_in(g, c);

        count[k < DENSE ? k : DENSE]++;
    }
    for (; from > FIND_CELL_POINTS && n + count[from] <= FIND_CELLS; from--)
        n += count[from];
    return from;
}

static void measure(const struct find_grid *g, struct work *w)
{
    const uint32_t from = dense_from(g);
    uint32_t left = FIND_CELLS;

    memset(w->out, 0, g->nvoxels * sizeof *w->out);
    for (uint32_t c = 0; c < g->ncells; c++)
        sum_cell(g, c, &w->sums[c]);
    for (uint32_t c = 0; c < g->ncells && left > 0; c++) {
        float middle[3], axis[3];

        if (points_in(g, c) < from)
            continue;
        left--;
        look_around(g, w->sums, c, middle, &w->around);
        if (w->around.voxels < FIND_BALL_VOXELS || w->around.voxels > FIND_SOLID_VOXELS)
            continue;
        for (uint32_t v = g->first[c]; v < g->first[c + 1]; v++) {
            const float *p = g->voxel[v].at;

            w->out[v] = protrusion(
                &w->around,
                (const float[3]){p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]},
                axis);
        }
    }
}

enum status find_nose_all(const struct find_grid *g, uint32_t most, struct find_nose *out,
                          uint32_t *n)
{
    struct work *w = make_work(g);
    uint32_t found;

    *n = 0;
    if (w == NULL)
        return ST_ENOMEM;
    measure(g, w);
    found = sort(w->out, g->nvoxels, w->order);
    for (uint32_t i = 0; i < found && i < FIND_LOOKS && *n < most; i++) {
        const uint32_t v = w->order[i], c = cell_of(g, v);
        const float *p = g->voxel[v].at;
        struct find_nose *o = &out[*n];
        float middle[3];

        if (!highest(g, w->out, c, v))
            continue;
        look_around(g, w->sums, c, middle, &w->around);
        memcpy(o->at, p, sizeof o->at);
        o->out_mm = protrusion(
            &w->around,
            (const float[3]){p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]},
            o->axis);
        (*n)++;
    }
    mem_free(w);
    return ST_OK;
}
