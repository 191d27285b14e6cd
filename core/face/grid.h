/* grid.h -- the cells of the canonical face frame, and the regions they make up.
 * The frame: x to the image's right, y up, z towards the scanner, millimetres; the origin
 * near the nose tip, x = 0 the symmetry plane (frame.h).  Gaps are averaged over square
 * cells of its plane, which removes white noise and keeps the shape. */
#ifndef CORE_GRID_H
#define CORE_GRID_H
#include <math.h>
#include <stdint.h>
#include "surface_face.h"

#define GRID_NX     SURFACE_CELLS_X
#define GRID_NY     SURFACE_CELLS_Y
#define GRID_N      SURFACE_CELLS
#define GRID_MM     SURFACE_CELL_MM
#define GRID_LEFT   SURFACE_CELLS_LEFT
#define GRID_BOTTOM SURFACE_CELLS_BOTTOM
#define GRID_NONE   UINT32_MAX

/* grid_cell(x, y): Returns the cell that holds a point of the frame, or GRID_NONE.  Cells are
 * numbered by rows from the lower left. */
static inline uint32_t grid_cell(double x, double y)
{
    const double i = (x - GRID_LEFT) * (1.0 / GRID_MM);
    const double j = (y - GRID_BOTTOM) * (1.0 / GRID_MM);

    if (!((i >= 0.0) & (i < GRID_NX) & (j >= 0.0) & (j < GRID_NY)))
        return GRID_NONE;
    return (uint32_t)j * GRID_NX + (uint32_t)i;
}

static inline double grid_x(uint32_t cell)
{
    return GRID_LEFT + GRID_MM * (cell % GRID_NX + 0.5);
}

static inline double grid_y(uint32_t cell)
{
    return GRID_BOTTOM + GRID_MM * (cell / GRID_NX + 0.5);
}

/* grid_mirror(cell): Returns the cell at the mirrored place. */
static inline uint32_t grid_mirror(uint32_t cell)
{
    return cell + GRID_NX - 1 - 2 * (cell % GRID_NX);
}

/* The regions are rectangles of the frame and their mirror images, mm: the nose |x| < 18, y -12 to
 * 34; the eyes 18 < |x| < 50, y 14 to 46, and between them; the forehead y above 46; the cheeks
 * beside nose and mouth, y -50 to 14, the sides up to 46; the mouth |x| < 34, y -50 to -12; the
 * chin y below -50. */
enum surface_region grid_region_of(uint32_t cell);

#endif
