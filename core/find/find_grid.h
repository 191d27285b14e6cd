/* find_grid.h -- a cloud as the means of its points over small cubes. */
#ifndef CORE_FIND_GRID_H
#define CORE_FIND_GRID_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct find_grid {
    struct dvec3 corner; /* mm, of the box of all points */
    double size[3];      /* mm, of that box */
    struct dvec3 *at;    /* [n] mean of the points in each cube, mm from the corner */
    uint32_t n;          /* number of cubes that have points */
};

/* find_grid_make(pts, n, unit_mm, middle, g): Divides into cubes the points, in units of unit_mm, that
 * are within FIND_REACH_MM of middle (mm) on each axis.  Ignores all others, and NAN.  Without a point in
 * reach g has no cubes.
 * Cost: O(n), whatever the points.
 * Returns ST_OK; ST_ENOMEM: g is empty. */
enum status find_grid_make(const struct dvec3 *pts, size_t n, double unit_mm,
                           struct dvec3 middle, struct find_grid *g);
void find_grid_free(struct find_grid *g); /* an empty one is allowed */

#endif
