/* find_grid.h -- a cloud as the means of its points over small cubes. */
#ifndef CORE_FIND_GRID_H
#define CORE_FIND_GRID_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

/* The largest side, mm, of what may be a head with shoulders, and of a room; leaving out one
 * point in STRAY_IN at either end, or, where that finds nothing, one in STRAYS_IN.  The
 * smallest crops are 130 mm, of a child of five 90, busts 500.  Nothing farther than REACH from the median is looked
 * at. */
#define FIND_HEAD_MIN_MM 80
#define FIND_ROOM_MIN_MM 900
#define FIND_ROOM_MAX_MM 6000
#define FIND_STRAY_IN    100
#define FIND_STRAYS_IN   10
#define FIND_REACH_MM    4000

#define FIND_GRID_MM 5

struct find_grid {
    struct dvec3 corner; /* mm, of the box of all */
    double size[3];      /* mm, of that box */
    struct dvec3 *at;    /* [n] the mean of the points in a cube, mm from the corner */
    uint32_t n;          /* cubes that have points */
};

/* find_grid_make(pts, n, unit_mm, middle, g): the points within FIND_REACH_MM of middle (mm) on
 * each axis, in units of unit_mm; the others are left out, as is what is no number.
 * Linear in n, whatever the points.  Returns ST_OK, ST_ENOMEM: g is empty then.  None in reach: g
 * has no cubes.
 * find_grid_free(g): also of an empty one. */
enum status find_grid_make(const struct dvec3 *pts, size_t n, double unit_mm,
                           struct dvec3 middle, struct find_grid *g);
void find_grid_free(struct find_grid *g);

#endif
