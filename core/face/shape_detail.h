/* shape_detail.h -- how much of a face's fine relief a surface has: the wings of the nose, the
 * corners of the eyes, the lips, the edges of the brow.  A few smooth humps and hollows in the
 * right places have none of it, while faces share it whatever they were scanned or made with. */
#ifndef CORE_SHAPE_DETAIL_H
#define CORE_SHAPE_DETAIL_H
#include "grid.h"

/* Cells: fine relief is what is left once the mean over a square that reaches so far to each
 * side, 20 mm wide, is subtracted.  Squares of 12 and of 28 mm separated faces from surfaces sought
 * against the gate as well or a little less well. */
#define SHAPE_FINE 2

/* shape_detail_prepare(mean, fine): the fine relief of the mean face, mm, of which NAN is not used; 0
 * where it has none, as at its rim. */
void shape_detail_prepare(const float mean[GRID_N], float fine[GRID_N]);

/* shape_detail(fine, weight, over): the fine relief of a surface that lies over[] mm in front of
 * the mean face (NAN: not seen there), as a multiple of the mean face's: both multiplied and
 * summed over what is seen, over the sum of the mean face's squared, weighed.  1 for the mean
 * face itself, 0 where nothing is seen of it.  Noise changes it little, as it is no square of
 * what is measured.  The fine relief is what is left once the mean over a square of
 * 2 SHAPE_FINE + 1 cells is subtracted; here of over[], whose slope at the rim of what is seen
 * is small.  O(cells). */
double shape_detail(const float fine[GRID_N], const float weight[GRID_N],
                    const float over[GRID_N]);

#endif
