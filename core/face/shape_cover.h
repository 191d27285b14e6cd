/* shape_cover.h -- what covers a fitted face, cell by cell.  Internal to core. */
#ifndef CORE_SHAPE_COVER_H
#define CORE_SHAPE_COVER_H
#include "grid.h"

struct shape_work; /* shape_work.h */

/* mm: a cell is explained by the face up to NEAR; what stands farther than STRONG before it covers it. */
#define SHAPE_NEAR_MM   2.0
#define SHAPE_STRONG_MM 3.0

/* shape_cover_mark(w, gap, z, height, cell): mark the cells of what covers the face.
 * gap     how far in front of the fitted face at right angles, mm; NAN: no points
 * z       height of the points, mm; NAN: none
 * height  of the fitted face, mm; NAN off it
 * cell    enum shape_cell; those of a cover become SHAPE_COVER
 * A cover is
 * - more than SHAPE_STRONG_MM in front of the face (times the cell's rest over the mean of all),
 *   with what is beside it, sideways, of more than SHAPE_WEAK_MM, if there are SHAPE_COVER_CELLS
 *   strong cells; then empty ones up to SHAPE_HOLE cells from a strong one, and what is between
 *   such cells, SHAPE_HOLE at most; then all beside;
 * - above the brows what is as rough as hair;
 * - all below its upper rim, where it covers most of the face below the eyes: a mask. */
void shape_cover_mark(const struct shape_work *w, const float gap[GRID_N],
                      const float z[GRID_N], const float height[GRID_N],
                      uint8_t cell[GRID_N]);

#endif
