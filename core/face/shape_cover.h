/* shape_cover.h -- the occlusion of a fitted face, cell by cell.  Internal to core. */
#ifndef CORE_SHAPE_COVER_H
#define CORE_SHAPE_COVER_H
#include "grid.h"

struct shape_work; /* shape_work.h */

/* mm: a cell is explained by the face up to NEAR; a surface farther than STRONG before it is an occluder. */
#define SHAPE_NEAR_MM   2.0
#define SHAPE_STRONG_MM 3.0

/* shape_cover_mark(w, gap, z, height, cell): Marks the cells of occluders.
 *   gap     distance of the points in front of the fitted face at right angles, mm; NAN: no points
 *   z       height of the points, mm; NAN: none
 *   height  height of the fitted face, mm; NAN off it
 *   cell    enum shape_cell; occluded cells become SHAPE_COVER
 * An occluder is
 * - a surface more than SHAPE_STRONG_MM in front of the face (times the cell's rest over the mean of
 *   all), with the cells beside it, sideways, of more than SHAPE_WEAK_MM, if there are
 *   SHAPE_COVER_CELLS strong cells; then empty cells up to SHAPE_HOLE cells from a strong one, and up to
 *   SHAPE_HOLE cells between such cells; then all cells beside;
 * - above the brows a surface as rough as hair;
 * - everything below its upper rim, if it covers most of the face below the eyes: a mask. */
void shape_cover_mark(const struct shape_work *w, const float gap[GRID_N],
                      const float z[GRID_N], const float height[GRID_N],
                      uint8_t cell[GRID_N]);

#endif
