#include "frame.h"

#include <math.h>
#include <string.h>

#include "lattice.h"
#include "model.h"
#include "model_digest.h"

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
