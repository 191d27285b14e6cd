/* shape_cells.h -- the kinds of the cells of a fitted face, skin or occlusion; and how well
 * the face explains the points.  Internal to core. */
#ifndef CORE_SHAPE_CELLS_H
#define CORE_SHAPE_CELLS_H
#include "grid.h"

struct shape_fit;  /* shape_work.h */
struct shape_work; /* shape_work.h */

/* shape_cells_rate(w, over, fit): Sets fit's cells and their counts, support,
 * eyes, forehead, detail and likeness.
 *   over  height of the points over fit->height, mm; NAN: no points */
void shape_cells_rate(const struct shape_work *w, const float over[GRID_N],
                      struct shape_fit *fit);

#endif
