#include "fit.h"

#include <math.h>
#include <string.h>

#include "pose.h"
#include "cells.h"
#include "lsq.h"

/* A covered cell is a row: the modes, padded to a multiple of LANES, and a tail: the six
 * motions, its gap, a zero.  The normal equations are the upper triangle of the sum of
 * w row row^T, which is nearly all of the work.  Three things keep it small:
 * - the modes' part over all cells at full weight is known from fit_prepare(); only cells
 *   with another weight are added, times the difference;
 * - so are rows whose weight changes in a pass;
 * - sums are done in tiles of TILE x LANES, which stay in registers, over blocks of rows,
 *   which stay in the first-level cache. */
#define LANES NORMAL_LANES
#define GAP   6 /* its place in the tail */
#define WIDTH (MODEL_MODES + LANES)

_Static_assert(MODEL_MODES % LANES == 0, "modes fill whole tiles");
_Static_assert(WIDTH <= NORMAL_WIDTH, "a row has room");

typedef float lane4 __attribute__((vector_size(16)));

struct fit_work {
    float tail[GRID_N][LANES];
    float over[GRID_N];    /* 1 / deviation of each row */
    float full[GRID_N];    /* its weight: over^2 times how far the cell is covered */
    float weight[GRID_N];  /* that times Huber's */
    uint32_t cell[GRID_N]; /* of each row */
    struct lsq_rows block;
    float sum[WIDTH][WIDTH];
    double h[WIDTH][WIDTH], g[WIDTH];
    uint32_t n, modes, unknowns; /* modes: padded */
};

static uint32_t fit_padded(uint32_t n)
{
    return (n + LANES - 1) / LANES * LANES;
}

/* One row more in the block, its modes and its tail (NULL: no tail). */
static void fit_put_row(struct lsq_rows *b, const float *modes, uint32_t n,
                        const float *tail, float rise)
{
    float *row = b->row[b->n], *times = b->times[b->n];

    memcpy(row, modes, n * sizeof *row);
    if (tail != NULL)
        memcpy(row + n, tail, LANES * sizeof *row);
    n += tail != NULL ? LANES : 0;
    for (uint32_t k = 0; k < n; k++)
        times[k] = row[k] * rise;
    b->n++;
}

void fit_prepare(const struct model_basis *b, struct fit_basis *out)
{
    const uint32_t n = fit_padded(b->n);
    struct lsq_rows block;

    block.n = 0;
    out->b = b;
    memset(out->gram, 0, sizeof out->gram);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float over = b->rest[i] > 0.0f ? 1.0f / b->rest[i] : 0.0f;

        out->used[i] = over > 0.0f;
        if (out->used[i])
            fit_put_row(&block, b->mode[i], n, NULL, over * over);
        if (block.n == NORMAL_ROWS || i == GRID_N - 1)
            lsq_add(&block, 0, n, out->gram[0], MODEL_MODES);
    }
}

/* The rows of the covered cells: all but their modes, which stay where they are. */
static void fit_load(struct fit_work *w, const struct fit_basis *p, const struct cells *c)
{
    const struct model_basis *b = p->b;

    w->n = 0;
    w->modes = fit_padded(b->n);
    w->unknowns = w->modes + 6;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float *m = c->normal[i];
        float *tail = w->tail[w->n];
        double nx, ny, nz, x, y, z, flat;

        if (c->area[i] < CELLS_COVERED || !p->used[i])
            continue;
        nx = (double)m[0];
        ny = (double)m[1];
        nz = (double)m[2];
        flat = 1.0 / sqrt(nx * nx + ny * ny + nz * nz);
        nx *= flat;
        ny *= flat;
        nz *= flat;
        x = grid_x(i);
        y = grid_y(i);
        z = (double)c->z[i] + POSE_LEVER_MM;
        /* Turns in units of 1 mm at the lever's length, so that all unknowns are alike. */
        tail[0] = (float)((z * ny - y * nz) / POSE_LEVER_MM);
        tail[1] = (float)((x * nz - z * nx) / POSE_LEVER_MM);
        tail[2] = (float)((y * nx - x * ny) / POSE_LEVER_MM);
        tail[3] = (float)-nx;
        tail[4] = (float)-ny;
        tail[5] = (float)-nz;
        tail[GAP] = c->gap[i];
        tail[GAP + 1] = 0.0f;
        w->over[w->n] = 1.0f / b->rest[i];
        w->full[w->n] = w->over[w->n] * w->over[w->n] * cells_cover(c, i);
        w->weight[w->n] = w->full[w->n];
        w->cell[w->n++] = i;
    }
}

/* The sum at the rows' first weights: the modes' part from the sum over all cells, corrected
 * for cells that weigh less; the tails' part from the rows. */
static void add_first(struct fit_work *w, const struct fit_basis *p)
{
    const struct model_basis *b = p->b;
    struct lsq_rows *const k = &w->block;
    uint32_t r = 0;

    for (uint32_t i = 0; i < w->modes; i++)
        memcpy(w->sum[i], p->gram[i], w->modes * sizeof(float));
    for (uint32_t i = 0; i < w->modes + LANES; i++)
        memset(&w->sum[i][w->modes], 0, LANES * sizeof(float));
    k->n = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float over = p->used[i] ? 1.0f / b->rest[i] : 0.0f;
        const bool covered = r < w->n && w->cell[r] == i;
        const float rise = (covered ? w->weight[r] : 0.0f) - over * over;

        r += covered;
        if (rise != 0.0f)
            fit_put_row(k, b->mode[i], w->modes, NULL, rise);
        if (k->n == NORMAL_ROWS || i == GRID_N - 1)
            lsq_add(k, 0, w->modes, w->sum[0], WIDTH);
    }
    for (r = 0; r < w->n; r++) {
        fit_put_row(k, b->mode[w->cell[r]], w->modes, w->tail[r], w->weight[r]);
        if (k->n == NORMAL_ROWS || r == w->n - 1)
            lsq_add(k, w->modes, w->modes + LANES, w->sum[0], WIDTH);
    }
}

/* What is left of a row once y is taken out. */
static float left(const float *modes, const float *tail, uint32_t n, const float *y)
{
    lane4 s[2], a[2], b[2];

    memcpy(a, tail, sizeof a);
    memcpy(b, y + n, sizeof b);
    s[0] = a[0] * b[0];
    s[1] = a[1] * b[1];
    for (uint32_t k = 0; k < n; k += LANES) {
        memcpy(a, modes + k, sizeof a);
        memcpy(b, y + k, sizeof b);
        s[0] += a[0] * b[0];
        s[1] += a[1] * b[1];
    }
    s[0] += s[1];
    return (s[0][0] + s[0][2]) + (s[0][1] + s[0][3]);
}

/* Weigh the rows by what y leaves of them, and bring the sum up to date.  False: nothing
 * changed. */
static bool reweight(struct fit_work *w, const struct model_basis *b, const float *y)
{
    bool changed = false;

    for (uint32_t r = 0; r < w->n; r++) {
        const float *modes = b->mode[w->cell[r]];
        const float z = fabsf(left(modes, w->tail[r], w->modes, y)) * w->over[r];
        const float now =
            w->full[r] * (z > (float)FIT_HUBER ? (float)FIT_HUBER / z : 1.0f);
        const float rise = now - w->weight[r];

        if (fabsf(rise) > (float)FIT_STILL * w->full[r]) {
            changed = true;
            w->weight[r] = now;
            fit_put_row(&w->block, modes, w->modes, w->tail[r], rise);
        }
        if (w->block.n == NORMAL_ROWS || r == w->n - 1)
            lsq_add(&w->block, 0, w->modes + LANES, w->sum[0], WIDTH);
    }
    return changed;
}

/* The lower Cholesky factor of the sum plus the prior of the modes, 1, and the tie, in h.  False: not
 * positive definite. */
static bool factor(struct fit_work *w, double tie)
{
    const uint32_t n = w->unknowns;

    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k <= i; k++)
            w->h[k][i] = (double)w->sum[k][i]; /* h[column][row] */
        w->h[i][i] += i < w->modes ? 1 : tie;
        w->g[i] = (double)w->sum[i][w->modes + GAP];
    }
    return lsq_factor(w->h[0], WIDTH, n, n);
}

/* The deviation of an unknown is the length of its column of the inverse factor; those of
 * the motions, which come last, need only the factor's last corner. */
static void deviations(const struct fit_work *w, struct fit *out)
{
    for (uint32_t i = 0; i < 6; i++) {
        double v[6] = {0.0}, sum = 0.0;

        v[i] = 1.0;
        for (uint32_t k = i; k < 6; k++) {
            const double *col = &w->h[w->modes + k][w->modes];

            v[k] /= col[k];
            sum += v[k] * v[k];
            for (uint32_t j = k + 1; j < 6; j++)
                v[j] -= v[k] * col[j];
        }
        out->deviation[i] = sqrt(sum) / (i < 3 ? POSE_LEVER_MM : 1.0);
    }
}

enum status fit_solve(const struct fit_basis *p, const struct cells *c, double tie,
                      int passes, struct scratch *s, struct fit *out)
{
    struct fit_work *w = scratch_need(s, sizeof *w);
    float y[WIDTH] = {0.0f};
    bool solved = false;

    memset(out, 0, sizeof *out);
    if (w == NULL)
        return ST_ENOMEM;
    fit_load(w, p, c);
    out->cells = w->n;
    for (int i = 0; i < 6; i++)
        out->deviation[i] = INFINITY;
    y[w->modes + GAP] = 1.0f; /* the gap itself */
    for (int pass = 0; w->n >= FIT_MIN_CELLS && pass <= passes; pass++) {
        if (pass == 0)
            add_first(w, p);
        else if (!reweight(w, p->b, y))
            break;
        if (!(solved = factor(w, tie)))
            break;
        lsq_forward(w->h[0], WIDTH, w->unknowns, w->unknowns, w->g);
        lsq_backward(w->h[0], WIDTH, w->unknowns, w->g);
        for (uint32_t k = 0; k < w->unknowns; k++)
            y[k] = (float)-w->g[k];
        memcpy(out->a, w->g, p->b->n * sizeof *out->a);
        for (uint32_t i = 0; i < 6; i++)
            out->x[i] = w->g[w->modes + i] / (i < 3 ? POSE_LEVER_MM : 1.0);
    }
    if (solved)
        deviations(w, out);
    for (uint32_t r = 0; r < w->n; r++)
        out->rest[w->cell[r]] = left(p->b->mode[w->cell[r]], w->tail[r], w->modes, y);
    return ST_OK;
}
