/* shape_detail.h -- how much of a face's fine relief a surface has: the wings of the nose, the
 * corners of the eyes, the lips, the edges of the brow.  A few smooth humps and hollows in the
 * right places have none of it, while faces share it whatever they were scanned or made with. */
#ifndef CORE_SHAPE_DETAIL_H
#define CORE_SHAPE_DETAIL_H
#include "grid.h"

/* Cells: fine relief is the height less the mean over a square that reaches so far to each
 * side, 20 mm wide.  Squares of 12 and of 28 mm separated faces from surfaces sought
 * against the gate as well or a little less well. */
#define SHAPE_FINE 2

/* shape_detail_prepare(mean, fine): Computes the fine relief, mm, of the mean face (NAN: not used); 0 if
 * it is unknown, as at the rim. */
void shape_detail_prepare(const float mean[GRID_N], float fine[GRID_N]);

/* shape_detail(fine, weight, over): Returns the fine relief of a surface that lies over[] mm in front of
 * the mean face (NAN: not seen there), as a multiple of the mean face's: the weighted sum of both
 * multiplied, over the weighted sum of the mean face's squared, over the visible cells.  1 for the mean
 * face itself, 0 for an invisible one.  Noise changes it little, as no measured value is squared.
 * The mean of the square is subtracted from over[], whose slope at the rim of the visible part
 * is small.  Cost: O(cells). */
double shape_detail(const float fine[GRID_N], const float weight[GRID_N],
                    const float over[GRID_N]);

#endif
