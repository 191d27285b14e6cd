#include "shape_work.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "shape_map.h"

/* A grid with a rim of zeros. */
enum { REACH = SHAPE_FINE, SIDE = 2 * REACH + 1, WIDE = GRID_NX + 2 * REACH };
struct wide {
    float at[GRID_NY + 2 * REACH][WIDE];
};

/* The sums over the squares round all cells: rows, then columns. */
static void sum_squares(const struct wide *g, float out[GRID_N])
{
    float row[GRID_NY + 2 * REACH][GRID_NX];

    for (uint32_t j = 0; j < GRID_NY + 2 * REACH; j++)
        for (uint32_t i = 0; i < GRID_NX; i++) {
            float sum = 0.0f;

            for (uint32_t k = 0; k < SIDE; k++)
                sum += g->at[j][i + k];
            row[j][i] = sum;
        }
    for (uint32_t j = 0; j < GRID_NY; j++)
        for (uint32_t i = 0; i < GRID_NX; i++) {
            float sum = 0.0f;

            for (uint32_t k = 0; k < SIDE; k++)
                sum += row[j + k][i];
            out[j * GRID_NX + i] = sum;
        }
}

/* The fine relief of z, NAN: none, then 0; and how many cells of each square have a height. */
static void fine_relief(const float z[GRID_N], float out[GRID_N], float count[GRID_N])
{
    struct wide height, seen;

    memset(&height, 0, sizeof height);
    memset(&seen, 0, sizeof seen);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t x = i % GRID_NX + REACH, y = i / GRID_NX + REACH;

        height.at[y][x] = isnan(z[i]) ? 0.0f : z[i];
        seen.at[y][x] = isnan(z[i]) ? 0.0f : 1.0f;
    }
    sum_squares(&height, out);
    sum_squares(&seen, count);
    for (uint32_t i = 0; i < GRID_N; i++)
        out[i] = isnan(z[i]) ? 0.0f : z[i] - out[i] / count[i];
}

/* The fine relief of the mean face, mm, of which NAN is not used; 0 where it has none, as at its rim. */
static void mean_relief(const float mean[GRID_N], float fine[GRID_N])
{
    float count[GRID_N];

    fine_relief(mean, fine, count);
    for (uint32_t i = 0; i < GRID_N; i++)
        fine[i] =
            count[i] < (float)(SIDE * SIDE) ? 0.0f : fine[i]; /* at a rim: its slope */
}

double shape_detail(const float fine[GRID_N], const float weight[GRID_N],
                    const float over[GRID_N])
{
    float own[GRID_N], count[GRID_N];
    double sum = 0, all = 0;

    fine_relief(over, own, count);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float by = isnan(over[i]) ? 0.0f : weight[i] * fine[i];

        sum += (double)(by * (fine[i] + own[i]));
        all += (double)(by * fine[i]);
    }
    return all > 0 ? sum / all : 0;
}

/* How much each cell's rest is, against the others'. */
static void compare_rests(struct shape_work *w)
{
    const float least = (float)(SHAPE_REST_LEAST_MM * SHAPE_REST_LEAST_MM);
    float mean = 0.0f;

    for (uint32_t i = 0; i < GRID_N; i++)
        mean += isnan(w->mean[i]) ? 0.0f : w->modes->rest[i] / (float)w->cells;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float rest = w->modes->rest[i];

        w->scale[i] = isnan(w->mean[i]) ? 0.0f : rest / mean;
        w->over_rest[i] = (float)SHAPE_REST_TYPICAL_MM / sqrtf(rest * rest + least);
    }
}

void shape_work_prepare(const struct surface_model *m, struct shape_work *out)
{
    memset(out, 0, sizeof *out);
    out->modes = &m->shape;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const bool used = !isnan(m->mean[i]) && m->shape.rest[i] > 0.0f;

        out->mean[i] = used ? m->mean[i] : (float)NAN;
        out->cells += used;
    }
    compare_rests(out);
    mean_relief(out->mean, out->fine);
    for (uint32_t i = 0; i < GRID_N; i++) {
        float x, y, flat;

        if (isnan(out->mean[i]))
            continue;
        shape_map_slope(out->mean, i, &x, &y);
        flat = 1.0f / sqrtf(1.0f + (x * x + y * y));
        out->normal[i][0] = -x * flat;
        out->normal[i][1] = -y * flat;
        out->normal[i][2] = flat;
    }
    shape_solve_prepare(&m->shape, out->mean, (const float(*)[3])out->normal,
                        &out->basis);
}

void shape_work_free(struct shape_work *w)
{
    scratch_free(&w->points);
    scratch_free(&w->solve);
}

void shape_work_wipe(struct shape_work *w, size_t keep)
{
    scratch_wipe(&w->points, keep);
    scratch_wipe(&w->solve, keep);
}
