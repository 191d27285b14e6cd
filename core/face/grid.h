/* grid.h -- the cells of the canonical face frame, and the regions they make up.
 * The frame: x to the image's right, y up, z towards the scanner, millimetres; the origin
 * near the nose tip, x = 0 the symmetry plane (frame.h).  Gaps are averaged over square
 * cells of its plane, which removes white noise and keeps the shape. */
#ifndef CORE_GRID_H
#define CORE_GRID_H
#include <math.h>
#include <stdint.h>

#define GRID_NX     32
#define GRID_NY     41
#define GRID_N      (GRID_NX * GRID_NY)
#define GRID_MM     4.0
#define GRID_LEFT   (-64.0)
#define GRID_BOTTOM (-94.0)
#define GRID_NONE   UINT32_MAX

/* grid_cell(x, y): the cell that holds a point of the frame, or GRID_NONE.  Cells are
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

/* grid_mirror(cell): the cell at the mirrored place. */
static inline uint32_t grid_mirror(uint32_t cell)
{
    return cell + GRID_NX - 1 - 2 * (cell % GRID_NX);
}

/* Regions of a face: rectangles of the frame and their mirror images. */
enum grid_region {
    GRID_NOSE,     /* |x| < 18, y -12 to 34 */
    GRID_EYES,     /* 18 < |x| < 50, y 14 to 46, and between them */
    GRID_FOREHEAD, /* y above 46 */
    GRID_CHEEKS,   /* beside nose and mouth, y -50 to 14; the sides up to 46 */
    GRID_MOUTH,    /* |x| < 34, y -50 to -12 */
    GRID_CHIN,     /* y below -50 */
    GRID_REGIONS
};

enum grid_region grid_region_of(uint32_t cell);
const char *grid_region_name(enum grid_region r); /* "nose", "eyes", ...; static */

#endif
