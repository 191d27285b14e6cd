#include "shape_solve.h"

#include <math.h>
#include <string.h>

#include "pose.h"

static uint32_t shape_solve_padded(uint32_t n)
{
    return (n + NORMAL_LANES - 1) / NORMAL_LANES * NORMAL_LANES;
}

/* One row more in the block, with a weight. */
static void shape_solve_put_row(struct lsq_rows *to, const float *row, uint32_t width,
                                float weight)
{
    float *times = to->times[to->n];

    memcpy(to->row[to->n], row, width * sizeof *row);
    for (uint32_t k = 0; k < width; k++)
        times[k] = weight * row[k];
    to->n++;
}

/* How the height of a cell changes with the six motions of the points, negated; turns in units of
 * 1 mm at the lever's length, so that all unknowns are alike. */
static void put_motion(uint32_t cell, float height, const float normal[3], double over,
                       float *row)
{
    const double nx = (double)normal[0], ny = (double)normal[1], nz = (double)normal[2];
    const double x = grid_x(cell), y = grid_y(cell), z = (double)height + POSE_LEVER_MM;
    const double by = over / nz, turn = by / POSE_LEVER_MM;

    row[0] = (float)(turn * (z * ny - y * nz));
    row[1] = (float)(turn * (x * nz - z * nx));
    row[2] = (float)(turn * (y * nx - x * ny));
    row[3] = (float)(by * -nx);
    row[4] = (float)(by * -ny);
    row[5] = (float)(by * -nz);
    row[6] = row[7] = 0.0f;
}

void shape_solve_prepare(const struct model_basis *modes, const float mean[GRID_N],
                         const float normal[GRID_N][3], struct shape_basis *out)
{
    const uint32_t width = NORMAL_LANES + shape_solve_padded(modes->n);
    struct lsq_rows block;

    memset(out, 0, sizeof *out);
    out->modes = modes->n;
    block.n = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float over = 1.0f / modes->rest[i];
        float *row = out->row[out->cells];

        if (isnan(mean[i]))
            continue;
        put_motion(i, mean[i], normal[i], (double)over, row);
        for (uint32_t k = 0; k < modes->n; k++)
            row[NORMAL_LANES + k] = over * modes->mode[i][k];
        out->rest[out->cells] = modes->rest[i];
        out->cell[out->cells++] = i;
        shape_solve_put_row(&block, row, width, 1.0f);
        if (block.n == NORMAL_ROWS)
            lsq_add(&block, 0, width, out->gram[0], SHAPE_WIDTH);
    }
    lsq_add(&block, 0, width, out->gram[0], SHAPE_WIDTH);
}

/* Starts the sum from where the fewest rows are to be added: as it is, the whole face's, or none. */
static void shape_solve_start(const struct shape_basis *b, const float weight[GRID_N],
                              uint32_t width, struct shape_solve *w)
{
    uint32_t now = 0, whole = 0, none = 0;

    for (uint32_t r = 0; r < b->cells; r++) {
        now += weight[r] != w->weight[r];
        whole += weight[r] != 1.0f;
        none += weight[r] != 0.0f;
    }
    if (width <= w->width && now <= whole && now <= none)
        return;
    w->width = width;
    for (uint32_t r = 0; r < b->cells; r++)
        w->weight[r] = whole <= none ? 1.0f : 0.0f;
    for (uint32_t k = 0; k < width; k++)
        if (whole <= none)
            memcpy(w->sum[k], b->gram[k], width * sizeof(float));
        else
            memset(w->sum[k], 0, width * sizeof(float));
}

/* Brings the sum up to date. */
static void add_rows(const struct shape_basis *b, const float weight[GRID_N],
                     struct shape_solve *w)
{
    w->block.n = 0;
    for (uint32_t r = 0; r < b->cells; r++) {
        if (weight[r] == w->weight[r])
            continue;
        shape_solve_put_row(&w->block, b->row[r], w->width, weight[r] - w->weight[r]);
        w->weight[r] = weight[r];
        if (w->block.n == NORMAL_ROWS)
            lsq_add(&w->block, 0, w->width, w->sum[0], SHAPE_WIDTH);
    }
    lsq_add(&w->block, 0, w->width, w->sum[0], SHAPE_WIDTH);
}

/* The rows times their gaps. */
static void add_gaps(const struct shape_basis *b, const float over[GRID_N],
                     const float weight[GRID_N], uint32_t width, struct shape_solve *w,
                     double g[SHAPE_WIDTH])
{
    float sum[SHAPE_WIDTH];

    for (uint32_t r = 0; r < b->cells; r++) {
        const float gap = weight[r] * over[r] / b->rest[r];

        w->gap[r] = weight[r] > 0.0f ? gap : 0.0f; /* it may be no number */
    }
    lsq_times(b->row[0], SHAPE_WIDTH, b->cells, w->gap, width, sum);
    for (uint32_t k = 0; k < width; k++)
        g[k] = (double)sum[k];
}

void shape_solve(const struct shape_basis *b, const float over[GRID_N],
                 const float weight[GRID_N], const struct shape_prior *prior,
                 struct shape_solve *w, struct shape_solution *out)
{
    const uint32_t modes = prior->modes < b->modes ? prior->modes : b->modes;
    const uint32_t width = NORMAL_LANES + shape_solve_padded(modes);
    float t[GRID_N], gap[GRID_N]; /* by rows */
    double g[SHAPE_WIDTH];
    uint32_t cells = 0;

    memset(out, 0, sizeof *out);
    for (uint32_t r = 0; r < b->cells; r++) {
        t[r] = weight[b->cell[r]];
        gap[r] = over[b->cell[r]];
        cells += t[r] > 0.0f;
    }
    if (cells < SHAPE_LEAST)
        return;
    shape_solve_start(b, t, width, w);
    add_rows(b, t, w);
    add_gaps(b, gap, t, width, w, g);
    for (uint32_t k = 0; k < width; k++) {
        for (uint32_t i = k; i < width; i++)
            w->h[k][i] = (double)w->sum[k][i]; /* h[column][row] */
        w->h[k][k] += k < NORMAL_LANES ? prior->x : prior->a;
    }
    if (!lsq_factor(w->h[0], SHAPE_WIDTH, width, width))
        return;
    lsq_forward(w->h[0], SHAPE_WIDTH, width, width, g);
    lsq_backward(w->h[0], SHAPE_WIDTH, width, g);
    for (uint32_t i = 0; i < 6; i++)
        out->x[i] = g[i] / (i < 3 ? POSE_LEVER_MM : 1.0);
    memcpy(out->a, g + NORMAL_LANES, modes * sizeof *g);
}

void shape_bend(const struct shape_basis *b, const float mean[GRID_N], const double *a,
                uint32_t n, float height[GRID_N])
{
    float by[SHAPE_WIDTH] = {0.0f}, sum[GRID_N];

    for (uint32_t k = 0; k < n; k++)
        by[k] = (float)a[k];
    lsq_dot(b->row[0] + NORMAL_LANES, SHAPE_WIDTH, b->cells, by, shape_solve_padded(n),
            sum);
    for (uint32_t r = 0; r < b->cells; r++)
        height[b->cell[r]] = mean[b->cell[r]] + b->rest[r] * sum[r];
}
