#include "shape_work.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "shape_detail.h"
#include "shape_map.h"

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
    shape_detail_prepare(out->mean, out->fine);
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
