#include "frame.h"

#include <math.h>
#include <string.h>

#include "solve.h"
#include "lattice.h"
#include "model.h"
#include "model_digest.h"

/* Common cells below which the likeness is unknown: a third of a face. */
#define FRAME_LIKENESS_CELLS 350

/* Where a face keeps its shape from one scan to the next: 1 / variance of the gap. */
static void rigidity(const struct model_basis *b, float *out)
{
    float most = 0.0f;

    for (uint32_t i = 0; i < GRID_N; i++) {
        float v = b->rest[i] * b->rest[i];

        for (uint32_t k = 0; k < b->n; k++)
            v += b->mode[i][k] * b->mode[i][k];
        out[i] = b->rest[i] > 0.0f ? 1.0f / v : 0.0f;
        most = out[i] > most ? out[i] : most;
    }
    for (uint32_t i = 0; i < GRID_N && most > 0.0f; i++)
        out[i] /= most;
}

enum status frame_mean_make(const struct surface_model *m, struct frame_mean *out)
{
    struct ivec2 xy[GRID_N];
    int32_t z[GRID_N];
    struct surface points = {.mesh = {.xy = xy, .z = z}};

    out->mean_id = model_mean_id(m);
    rigidity(&m->change, out->rigid);
    memcpy(out->height, m->mean, sizeof out->height);
    if (align_grid_make(out->height, out->rigid, &out->grid) == 0)
        return ST_EDEGENERATE;
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(m->mean[i]))
            continue;
        xy[points.mesh.nv] = (struct ivec2){(int32_t)(grid_x(i) * LATTICE_PER_MM),
                                            (int32_t)(grid_y(i) * LATTICE_PER_MM)};
        z[points.mesh.nv++] = (int32_t)lrint((double)m->mean[i] * LATTICE_PER_MM);
    }
    pose_find_axes(&points, &out->axes);
    return ST_OK;
}

enum status frame_find(const struct frame_mean *mean, const struct surface *face,
                       struct align_work *w, struct frame *out)
{
    const struct align_how how = {.grid = &mean->grid, .axes = &mean->axes};
    struct align_result found;
    const enum status st = align_search(NULL, face, &how, w, &found);

    if (st != ST_OK)
        return st;
    pose_from_matrix(found.transform, &out->pose);
    out->mean_id = mean->mean_id;
    out->cost_mm = found.cost_mm;
    out->within = found.within;
    return ST_OK;
}

/* Sums over the cells that the face and the mean face cover, of heights z and h. */
struct relief {
    double common[5][5]; /* x^a y^b */
    double z[3][3], h[3][3];
    double zz, zh, hh;
};

typedef double pair __attribute__((vector_size(16)));
typedef int64_t pair_mask __attribute__((vector_size(16)));

/* Cell i of n in a row or column as a number of order 1. */
static inline double place(uint32_t i, uint32_t n)
{
    return ((double)i + 0.5) * (2.0 / n) - 1;
}

static inline double both(pair v)
{
    return v[0] + v[1];
}

/* Add row j: the mean heights are z / n, and h (NAN: none). */
static void add_row(struct relief *to, uint32_t j, const double *z, const double *n,
                    const float *h)
{
    pair common[5] = {{0}}, zs[3] = {{0}}, hs[3] = {{0}}, zz = {0}, zh = {0}, hh = {0};
    double y = 1;

    for (uint32_t i = 0; i < GRID_NX; i += 2) {
        const pair at = {place(i, GRID_NX), place(i + 1, GRID_NX)};
        const pair number = {n[i], n[i + 1]}, mean = {(double)h[i], (double)h[i + 1]};
        const pair_mask in = (number > 0) & (mean == mean);
        const pair a = (pair)(in & (pair_mask)((pair){z[i], z[i + 1]} / number));
        const pair b = (pair)(in & (pair_mask)mean);
        pair x = (pair)(in & (pair_mask)(pair){1, 1});

        zz += a * a;
        zh += a * b;
        hh += b * b;
        for (int k = 0; k < 5; k++, x *= at) {
            common[k] += x;
            if (k < 3) {
                zs[k] += x * a;
                hs[k] += x * b;
            }
        }
    }
    to->zz += both(zz);
    to->zh += both(zh);
    to->hh += both(hh);
    for (int b = 0; b < 5; b++, y *= place(j, GRID_NY))
        for (int a = 0; a + b < 5; a++) {
            to->common[a][b] += both(common[a]) * y;
            if (a + b < 3) {
                to->z[a][b] += both(zs[a]) * y;
                to->h[a][b] += both(hs[a]) * y;
            }
        }
}

/* The normal equations of the best quadric, of the terms 1, x, y, x^2, xy, y^2. */
static void quadric(const struct relief *r, double at[3][3], struct solve_normal *out)
{
    static const int a[6] = {0, 1, 0, 2, 1, 0}, b[6] = {0, 0, 1, 0, 1, 2};
    double *h = out->h;

    for (int i = 0; i < 6; i++) {
        for (int k = i; k < 6; k++)
            *h++ = r->common[a[i] + a[k]][b[i] + b[k]];
        out->g[i] = at[a[i]][b[i]];
    }
}

double frame_likeness_heights(const struct frame_mean *mean, const double z[GRID_N],
                              const double n[GRID_N])
{
    struct relief r = {0};
    struct solve_normal a, b; /* of the face, and of the mean face */
    double x[6], y[6];

    for (uint32_t j = 0; j < GRID_NY; j++)
        add_row(&r, j, &z[j * GRID_NX], &n[j * GRID_NX], &mean->height[j * GRID_NX]);
    quadric(&r, r.z, &a);
    quadric(&r, r.h, &b);
    if (r.common[0][0] < FRAME_LIKENESS_CELLS || !solve_equations(&a, 0, x) ||
        !solve_equations(&b, 0, y))
        return (double)NAN;
    /* x = -H^-1 g gives the products of the reliefs without another pass over the cells. */
    for (int k = 0; k < 6; k++) {
        r.zz += a.g[k] * x[k];
        r.zh += a.g[k] * y[k];
        r.hh += b.g[k] * y[k];
    }
    return r.zz > FRAME_RELIEF_MIN_MM2 * r.common[0][0] &&
                   r.hh > FRAME_RELIEF_MIN_MM2 * r.common[0][0]
               ? r.zh / sqrt(r.zz * r.hh)
               : 0;
}
