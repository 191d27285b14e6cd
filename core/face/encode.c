#include "encode.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "pose.h"
#include "quality.h"
#include "shape_map.h"

/* mm: farther from the mean face there is none.  Of real people's scans whose face had been
 * found, 1 cell in 2,000 lay farther. */
#define ENCODE_FAR_MM 12.0f

/* Huber's limit in deviations of the noise. */
#define ENCODE_HUBER 2.5f

/* A step over this.  Of frames of one person from a structured-light camera with steps of 2 mm the mean
 * score is then the expected one; with the deviation of a step, 0.29, it is far below. */
#define ENCODE_STEP 0.8

/* A quarter of a face. */
#define ENCODE_LEAST 230

#define WIDTH NORMAL_WIDTH
#define LANES NORMAL_LANES

_Static_assert(LANES + 2 * MODEL_MODES == WIDTH, "a row is motion, change and identity");

struct encode_work {
    float gap[GRID_N];
    float weight[GRID_N]; /* 0..1 */
    struct lsq_rows rows;
    float sum[WIDTH][WIDTH];
    double h[WIDTH][WIDTH];
    double g[WIDTH], v[WIDTH];
};

static uint32_t encode_padded(uint32_t n)
{
    return (n + LANES - 1) / LANES * LANES;
}

/* The row of cell i, with a weight. */
static void encode_put_row(const struct encode_basis *e, uint32_t i, float weight,
                           struct lsq_rows *to)
{
    float *row = to->row[to->n], *times = to->times[to->n];

    memcpy(row, e->motion[i], sizeof e->motion[i]);
    memcpy(row + e->change, e->m->change.mode[i],
           (e->identity - e->change) * sizeof *row);
    memcpy(row + e->identity, e->m->identity.mode[i],
           (e->width - e->identity) * sizeof *row);
    for (uint32_t k = 0; k < e->width; k++)
        times[k] = weight * row[k];
    to->n++;
}

/* How the gap of cell i changes with the six motions of the face. */
static void motion_of(const struct surface_model *m, uint32_t i, float out[LANES])
{
    const double lever = POSE_LEVER_MM, by = ENCODE_MOTION_MM;
    const double x = grid_x(i), y = grid_y(i), z = (double)m->mean[i] + lever;
    float zx, zy;
    double nx, ny, nz;

    shape_map_slope(m->mean, i, &zx, &zy);
    nz = 1 / sqrt(1 + (double)zx * (double)zx + (double)zy * (double)zy);
    nx = -(double)zx * nz;
    ny = -(double)zy * nz;
    out[0] = (float)(by * (y * nz - z * ny) / lever);
    out[1] = (float)(by * (z * nx - x * nz) / lever);
    out[2] = (float)(by * (x * ny - y * nx) / lever);
    out[3] = (float)(by * nx);
    out[4] = (float)(by * ny);
    out[5] = (float)(by * nz);
    out[6] = out[7] = 0.0f;
}

void encode_prepare(const struct surface_model *m, struct encode_basis *out)
{
    struct lsq_rows rows;

    memset(out, 0, sizeof *out);
    out->m = m;
    out->change = LANES;
    out->identity = out->change + encode_padded(m->change.n);
    out->width = out->identity + encode_padded(m->identity.n);
    rows.n = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (!isnan(m->mean[i]) && m->change.rest[i] > 0.0f) {
            motion_of(m, i, out->motion[i]);
            out->normal_z[i] = (float)((double)out->motion[i][5] / ENCODE_MOTION_MM);
            out->cells++;
            encode_put_row(out, i, 1.0f, &rows);
        }
        if (rows.n == NORMAL_ROWS || i == GRID_N - 1)
            lsq_add(&rows, 0, out->width, out->gram[0], WIDTH);
    }
}

/* The gaps of heights z above others, and which cells count: how many. */
static uint32_t encode_load(const struct encode_basis *e, const float *z,
                            const float *others, struct encode_work *w, uint8_t *there)
{
    uint32_t cells = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const float gap = (z[i] - others[i]) * e->normal_z[i];

        w->gap[i] = w->weight[i] = 0.0f;
        if (!(e->normal_z[i] > 0.0f) || !(fabsf(gap) <= ENCODE_FAR_MM))
            continue;
        w->gap[i] = gap;
        w->weight[i] = 1.0f;
        there[i / 8] |= (uint8_t)(1U << i % 8);
        cells++;
    }
    return cells;
}

/* The sum of the weighted rows: of all cells, less those that are not there; or where that is
 * less work, of those that are. */
static void add_cells(const struct encode_basis *e, uint32_t cells, struct encode_work *w)
{
    const bool whole = cells > e->cells / 2;

    memset(w->sum, 0, sizeof w->sum);
    if (whole)
        memcpy(w->sum, e->gram, sizeof w->sum);
    w->rows.n = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float by = w->weight[i] - (whole ? 1.0f : 0.0f);

        if (e->normal_z[i] > 0.0f && by != 0.0f)
            encode_put_row(e, i, by, &w->rows);
        if (w->rows.n == NORMAL_ROWS || i == GRID_N - 1)
            lsq_add(&w->rows, 0, e->width, w->sum[0], WIDTH);
    }
}

/* The products of the rows with their gaps. */
static void add_gaps(const struct encode_basis *e, struct encode_work *w)
{
    const float *const row = w->rows.row[0];

    memset(w->v, 0, sizeof w->v);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const double by = (double)w->weight[i] * (double)w->gap[i];

        if (by == 0.0)
            continue;
        w->rows.n = 0;
        encode_put_row(e, i, 1.0f, &w->rows);
        for (uint32_t k = 0; k < e->width; k++)
            w->v[k] += by * (double)row[k];
    }
    w->rows.n = 0;
}

/* The normal equations of the coefficients, with their prior. */
static void set_up(const struct encode_basis *e, double variance, struct encode_work *w)
{
    const double over = 1 / variance;

    for (uint32_t k = 0; k < e->width; k++) {
        for (uint32_t i = k; i < e->width; i++)
            w->h[k][i] = over * (double)w->sum[k][i];
        w->h[k][k] += 1;
        w->g[k] = over * w->v[k];
    }
}

/* Weigh the cells by what the coefficients w->g leave of them.  False: none changed. */
static bool reweigh(const struct encode_basis *e, double variance, struct encode_work *w)
{
    const float limit = ENCODE_HUBER * (float)sqrt(variance);
    bool changed = false;
    float by[WIDTH];

    for (uint32_t k = 0; k < e->width; k++)
        by[k] = (float)w->g[k];
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float *row = w->rows.row[0];
        float sum[LANES] = {0.0f}, left;

        if (!(w->weight[i] > 0.0f))
            continue;
        w->rows.n = 0;
        encode_put_row(e, i, 1.0f, &w->rows);
        for (uint32_t k = 0; k < e->width; k += LANES)
            for (uint32_t l = 0; l < LANES; l++)
                sum[l] += row[k + l] * by[k + l];
        left = fabsf(w->gap[i] - (((sum[0] + sum[4]) + (sum[2] + sum[6])) +
                                  ((sum[1] + sum[5]) + (sum[3] + sum[7]))));
        if (left <= limit)
            continue;
        w->weight[i] = limit / left;
        encode_put_row(e, i, w->weight[i] - 1.0f, &w->rows);
        w->rows.n = 0;
        changed = true;
    }
    return changed;
}

/* A and b from the Schur complement: what is left of the normal equations of the identity
 * once motion and change are eliminated, less the prior. */
static void store(const struct encode_basis *e, const struct encode_work *w,
                  struct encoding *out)
{
    float *a = out->a;

    for (uint32_t i = 0; i < out->n; i++) {
        const uint32_t row = e->identity + i;

        for (uint32_t k = 0; k <= i; k++)
            *a++ = (float)(w->h[e->identity + k][row] - (k == i ? 1 : 0));
        out->b[i] = (float)w->g[row];
    }
}

/* The variance of the noise of a scan. */
static double noise_of(const struct encode_basis *e, double residual_mm)
{
    const double noise = e->m->noise_factor * residual_mm;

    return e->m->noise_floor_mm * e->m->noise_floor_mm + noise * noise;
}

/* The normal equations, with motion and change eliminated.  out->n is 0 where there are none. */
static void solve(const struct encode_basis *e, const float z[GRID_N], double residual_mm,
                  struct encode_work *w, struct encoding *out, double *variance)
{
    const uint32_t n = e->width;

    memset(out, 0, sizeof *out);
    *variance = noise_of(e, residual_mm);
    out->residual_mm = (float)residual_mm;
    out->cells = encode_load(e, z, e->m->mean, w, out->there);
    if (out->cells < ENCODE_LEAST)
        return;
    add_cells(e, out->cells, w);
    add_gaps(e, w);
    set_up(e, *variance, w);
    if (!lsq_factor(w->h[0], WIDTH, n, n))
        return;
    lsq_forward(w->h[0], WIDTH, n, n, w->g);
    lsq_backward(w->h[0], WIDTH, n, w->g);
    if (reweigh(e, *variance, w)) {
        add_cells(e, out->cells, w);
        add_gaps(e, w);
    }
    set_up(e, *variance, w);
    if (!lsq_factor(w->h[0], WIDTH, e->identity, n))
        return;
    lsq_forward(w->h[0], WIDTH, e->identity, n, w->g);
    out->n = e->m->identity.n;
}

double encode_noise(double residual_mm, double step_mm)
{
    const double step = ENCODE_STEP * quality_step(step_mm);

    return step > 0 ? sqrt(residual_mm * residual_mm + step * step) : residual_mm;
}

enum status encode_heights(const struct encode_basis *e, const float z[GRID_N],
                           double residual_mm, struct scratch *s, struct encoding *out)
{
    struct encode_work *w = scratch_need(s, sizeof *w);
    double variance;

    memset(out, 0, sizeof *out);
    if (w == NULL)
        return ST_ENOMEM;
    solve(e, z, residual_mm, w, out, &variance);
    store(e, w, out);
    return ST_OK;
}

enum status encode_parts(const struct encode_basis *e, const float z[GRID_N],
                         double residual_mm, const double slope[MODEL_MODES],
                         struct scratch *s, double part[GRID_N])
{
    struct encode_work *w = scratch_need(s, sizeof *w);
    const uint32_t n = e->width, known = e->identity;
    struct encoding unused;
    double by[WIDTH] = {0}, variance;

    if (w == NULL)
        return ST_ENOMEM;
    solve(e, z, residual_mm, w, &unused, &variance);
    if (unused.n == 0)
        return ST_OK;
    /* b' slope is the sum over the cells of h w / s^2 (v - f P^-1 Q) slope, where v and f are a
     * cell's rows of identity and of all else, P and Q their blocks of the normal equations. */
    memcpy(by + known, slope, unused.n * sizeof *by);
    for (uint32_t k = known; k-- > 0;) {
        for (uint32_t i = k + 1; i < n; i++)
            by[k] -= w->h[k][i] * by[i];
        by[k] /= w->h[k][k];
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float *row = w->rows.row[0];
        double sum = 0;

        if (!(w->weight[i] > 0.0f))
            continue;
        w->rows.n = 0;
        encode_put_row(e, i, 1.0f, &w->rows);
        for (uint32_t k = 0; k < n; k++)
            sum += (double)row[k] * by[k];
        part[i] += sum * (double)w->weight[i] * (double)w->gap[i] / (2 * variance);
    }
    w->rows.n = 0;
    return ST_OK;
}

enum status encode_rest(const struct encode_basis *e, const float tmpl[GRID_N],
                        const float probe[GRID_N], const double residual_mm[2],
                        struct scratch *s, float rest[GRID_N])
{
    struct encode_work *w = scratch_need(s, sizeof *w);
    const uint32_t n = e->identity;
    uint8_t there[GRID_N / 8] = {0};
    uint32_t cells;

    for (uint32_t i = 0; i < GRID_N; i++)
        rest[i] = (float)NAN;
    if (w == NULL)
        return ST_ENOMEM;
    if ((cells = encode_load(e, probe, tmpl, w, there)) < ENCODE_LEAST)
        return ST_OK;
    add_cells(e, cells, w);
    add_gaps(e, w);
    /* The coefficients of two scans differ by twice the variance of one: so does the noise. */
    set_up(e, (noise_of(e, residual_mm[0]) + noise_of(e, residual_mm[1])) / 2, w);
    if (!lsq_factor(w->h[0], WIDTH, n, n))
        return ST_OK;
    lsq_forward(w->h[0], WIDTH, n, n, w->g);
    lsq_backward(w->h[0], WIDTH, n, w->g);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float *row = w->rows.row[0];
        double fit = 0;

        if (!(w->weight[i] > 0.0f))
            continue;
        w->rows.n = 0;
        encode_put_row(e, i, 1.0f, &w->rows);
        for (uint32_t k = 0; k < n; k++)
            fit += (double)row[k] * w->g[k];
        rest[i] = (float)((double)w->gap[i] - fit);
    }
    w->rows.n = 0;
    return ST_OK;
}
