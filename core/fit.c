#include "fit.h"

#include <math.h>
#include <string.h>

#define HUBER 2.5

/* A covered cell is a row: the modes, the six motions, its gap; padded to a multiple of
 * LANES.  The normal equations are the upper triangle of the sum of w row row^T: nearly all
 * of the work.  It is done in tiles of TILE x LANES that stay in registers while a block of
 * rows, which stays in the first-level cache, passes by; and when rows are weighted anew,
 * only those whose weight changed are added again, by the difference. */
#define LANES 8
#define TILE  4
#define ROWS  32
#define WIDTH ((MODEL_MODES + 6 + 1 + LANES - 1) / LANES * LANES)

typedef float lane4 __attribute__((vector_size(16)));

struct work {
    float row[GRID_N][WIDTH];
    float block[2][ROWS][WIDTH]; /* rows, and rows times what their weights rose by */
    float over[GRID_N];          /* 1 / deviation of each row */
    float full[GRID_N];   /* its weight: over^2 times how far the cell is covered */
    float weight[GRID_N]; /* that times Huber's */
    float rise[GRID_N];   /* of the weights since the sum was last made */
    float sum[WIDTH][WIDTH];
    double h[WIDTH][WIDTH], g[WIDTH];
    uint32_t cell[GRID_N]; /* of each row */
    uint32_t n, modes, unknowns, width;
};

/* The rows of the covered cells. */
static void load(struct work *w, const struct model_basis *b, const struct cells *c)
{
    w->n = 0;
    w->modes = b->n;
    w->unknowns = b->n + 6;
    w->width = (w->unknowns + 1 + LANES - 1) / LANES * LANES;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float *m = c->normal[i];
        float *row = w->row[w->n];
        double nx, ny, nz, x, y, z, flat;

        if (c->area[i] < CELLS_COVERED || b->rest[i] <= 0.0f)
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
        z = (double)c->z[i] + FIT_LEVER_MM;
        memcpy(row, b->mode[i], b->n * sizeof *row);
        row += b->n;
        /* Turns in units of 1 mm at the lever's length, so that all unknowns are alike. */
        row[0] = (float)((z * ny - y * nz) / FIT_LEVER_MM);
        row[1] = (float)((x * nz - z * nx) / FIT_LEVER_MM);
        row[2] = (float)((y * nx - x * ny) / FIT_LEVER_MM);
        row[3] = (float)-nx;
        row[4] = (float)-ny;
        row[5] = (float)-nz;
        row[6] = c->gap[i];
        for (uint32_t k = b->n + 7; k < w->width; k++)
            w->row[w->n][k] = 0.0f;
        w->over[w->n] = 1.0f / b->rest[i];
        w->full[w->n] = w->over[w->n] * w->over[w->n] * cells_cover(c, i);
        w->cell[w->n++] = i;
    }
}

/* sum[k..k+3][l..l+7] += the products of a block of rows. */
static void add_tile(struct work *w, uint32_t rows, uint32_t k, uint32_t l)
{
    lane4 t[TILE][2];

    for (uint32_t i = 0; i < TILE; i++)
        memcpy(t[i], &w->sum[k + i][l], sizeof t[i]);
    for (uint32_t r = 0; r < rows; r++) {
        const float *a = &w->block[1][r][k];
        lane4 b[2];

        memcpy(b, &w->block[0][r][l], sizeof b);
        for (uint32_t i = 0; i < TILE; i++) {
            t[i][0] += a[i] * b[0];
            t[i][1] += a[i] * b[1];
        }
    }
    for (uint32_t i = 0; i < TILE; i++)
        memcpy(&w->sum[k + i][l], t[i], sizeof t[i]);
}

static void add_block(struct work *w, uint32_t rows)
{
    for (uint32_t k = 0; k < w->width; k += TILE)
        for (uint32_t l = k / LANES * LANES; l < w->width; l += LANES)
            add_tile(w, rows, k, l);
}

/* Bring the sum up to date with the weights. */
static void add_rows(struct work *w)
{
    uint32_t rows = 0;

    for (uint32_t r = 0; r < w->n; r++) {
        if (w->rise[r] == 0.0f)
            continue;
        memcpy(w->block[0][rows], w->row[r], w->width * sizeof(float));
        for (uint32_t k = 0; k < w->width; k++)
            w->block[1][rows][k] = w->row[r][k] * w->rise[r];
        if (++rows == ROWS) {
            add_block(w, rows);
            rows = 0;
        }
    }
    add_block(w, rows);
}

/* The lower Cholesky factor of the sum plus the priors, in h; column by column, so that
 * the inner loop has no chain of additions.  False: not positive definite. */
static bool factor(struct work *w, double tie)
{
    const uint32_t n = w->unknowns;

    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k <= i; k++)
            w->h[k][i] = (double)w->sum[k][i]; /* h[column][row] */
        w->h[i][i] += i < w->modes ? 1.0 : tie;
        w->g[i] = (double)w->sum[i][n];
    }
    for (uint32_t k = 0; k < n; k++) {
        double *col = w->h[k], over;

        if (!(col[k] > 1e-9))
            return false;
        over = 1.0 / sqrt(col[k]);
        for (uint32_t i = k; i < n; i++)
            col[i] *= over;
        for (uint32_t j = k + 1; j < n; j++) {
            const double c = col[j];

            for (uint32_t i = j; i < n; i++)
                w->h[j][i] -= c * col[i];
        }
    }
    return true;
}

/* v becomes the solution of L L^T y = v. */
static void substitute(const struct work *w, double *v)
{
    const uint32_t n = w->unknowns;

    for (uint32_t k = 0; k < n; k++) {
        v[k] /= w->h[k][k];
        for (uint32_t i = k + 1; i < n; i++)
            v[i] -= v[k] * w->h[k][i];
    }
    for (uint32_t k = n; k-- > 0;) {
        for (uint32_t i = k + 1; i < n; i++)
            v[k] -= w->h[k][i] * v[i];
        v[k] /= w->h[k][k];
    }
}

/* What row r has left once y is taken out. */
static float left(const struct work *w, uint32_t r, const float *y)
{
    const float *row = w->row[r];
    float s[LANES] = {0.0f};

    for (uint32_t k = 0; k < w->width; k += LANES)
        for (uint32_t i = 0; i < LANES; i++)
            s[i] += row[k + i] * y[k + i];
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

static void deviations(struct work *w, struct fit *out)
{
    for (uint32_t i = 0; i < 6; i++) {
        double v[WIDTH] = {0.0};

        v[w->modes + i] = 1.0;
        substitute(w, v);
        out->deviation[i] = sqrt(v[w->modes + i]) / (i < 3 ? FIT_LEVER_MM : 1.0);
    }
}

enum status fit_solve(const struct model_basis *b, const struct cells *c, double tie,
                      int passes, struct scratch *s, struct fit *out)
{
    struct work *w = scratch_need(s, sizeof *w);
    float y[WIDTH] = {0.0f};

    memset(out, 0, sizeof *out);
    if (w == NULL)
        return ST_ENOMEM;
    load(w, b, c);
    out->cells = w->n;
    for (int i = 0; i < 6; i++)
        out->deviation[i] = INFINITY;
    memset(w->sum, 0, sizeof w->sum);
    for (uint32_t r = 0; r < w->n; r++)
        w->weight[r] = w->rise[r] = w->full[r];
    y[w->unknowns] = 1.0f; /* the gap's own column */
    for (int pass = 0; w->n >= FIT_MIN_CELLS && pass <= passes; pass++) {
        add_rows(w);
        if (!factor(w, tie))
            break;
        substitute(w, w->g);
        for (uint32_t k = 0; k < w->unknowns; k++)
            y[k] = (float)-w->g[k];
        for (uint32_t r = 0; r < w->n && pass < passes; r++) {
            const float z = fabsf(left(w, r, y)) * w->over[r];
            const float now = w->full[r] * (z > (float)HUBER ? (float)HUBER / z : 1.0f);

            w->rise[r] = now - w->weight[r];
            w->weight[r] = now;
        }
        memcpy(out->a, w->g, w->modes * sizeof *out->a);
        for (uint32_t i = 0; i < 6; i++)
            out->x[i] = w->g[w->modes + i] / (i < 3 ? FIT_LEVER_MM : 1.0);
        if (pass == passes)
            deviations(w, out);
    }
    for (uint32_t r = 0; r < w->n; r++)
        out->rest[w->cell[r]] = left(w, r, y);
    return ST_OK;
}
