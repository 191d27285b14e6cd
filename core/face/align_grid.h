/* align_grid.h -- a surface given by a height for each cell of the canonical frame, as the
 * template of a search: the mean face.  Between the centres of four cells it is bilinear, so
 * that a point is located by its coordinates alone, without a walk and without a branch.
 * Internal to core. */
#ifndef CORE_ALIGN_GRID_H
#define CORE_ALIGN_GRID_H
#include <stdint.h>
#include "align_field.h"
#include "grid.h"

/* Between the centres of four cells: z + zx u + zy v + zxy u v, u and v from 0 to 1. */
struct align_patch {
    float z, zx, zy, zxy; /* mm */
};

struct align_grid {
    /* patches by the cell of the lower left corner; the last one stands for every place without
     * one */
    struct align_patch patch[GRID_N + 1];
    float flat[GRID_N + 1];   /* 1 / sqrt(1 + slope^2) in the middle; 0: none */
    float weight[GRID_N + 1]; /* u, the mean of the corners' */
};

/* align_grid_make(z, u, g): Makes g from the heights z (mm; NAN: none) and the weights u of the
 * cells.  If one of four corners has no height, the other three give it one.  Cost: O(GRID_N).
 * Returns the number of patches. */
uint32_t align_grid_make(const float z[GRID_N], const float u[GRID_N],
                         struct align_grid *g);

/* align_grid_sum(g, ...): Like align_field_sum(), of the gaps to g.  Takes the points four at a time
 * in single precision, relative to the first one: accurate to 0.0001 mm. */
void align_grid_sum(const struct align_grid *g, const struct align_point *pts, uint32_t n,
                    uint32_t stride, const struct pose *pose, struct dvec3 c,
                    enum solve_loss loss, struct solve_sum *sum);

#endif
