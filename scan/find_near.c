#include "find_near.h"

#include <math.h>
#include <string.h>

#include "find_grid.h"
#include "tuning.h"

static void add_run(const struct find_grid *g, struct find_run run, struct find_near *to)
{
    for (uint32_t v = g->first[run.first]; v < g->first[run.end] && to->n < FIND_NEAR_MAX;
         v++) {
        const struct find_voxel *p = &g->voxel[v];
        const float x = p->at[0] - to->from[0], y = p->at[1] - to->from[1],
                    z = p->at[2] - to->from[2];

        if (x * x + y * y + z * z > (float)(FIND_NEAR_MM * FIND_NEAR_MM))
            continue;
        to->x[to->n] = x;
        to->y[to->n] = y;
        to->z[to->n] = z;
        to->points[to->n++] = p->n;
    }
}

void find_near_get(const struct find_grid *g, const float from[3], struct find_near *out)
{
    int32_t lo[3], hi[3];

    memcpy(out->from, from, sizeof out->from);
    out->n = 0;
    for (int i = 0; i < 3; i++) {
        lo[i] = (int32_t)floorf((from[i] - (float)FIND_NEAR_MM) *
                                (float)(1 / FIND_GRID_CELL_MM));
        hi[i] = (int32_t)floorf((from[i] + (float)FIND_NEAR_MM) *
                                (float)(1 / FIND_GRID_CELL_MM));
    }
    for (int32_t z = lo[2]; z <= hi[2]; z++)
        for (int32_t y = lo[1]; y <= hi[1]; y++)
            add_run(g, find_grid_run(g, lo[0], hi[0], y, z), out);
}
