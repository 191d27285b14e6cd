#include "shape_detail.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

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

void shape_detail_prepare(const float mean[GRID_N], float fine[GRID_N])
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
