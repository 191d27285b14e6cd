#include "sight.h"

#include <math.h>

/* A scan is of one side where less than this share of the points, on a head's size of cells,
 * lies farther behind the front-most one of its cell.  Of heads from all sides about half do, of
 * one view with a wall behind, whose points share cells with the head's rim, 7 % at most. */
#define SIGHT_CELL_MM     6.0
#define SIGHT_BEHIND_MM   40.0
#define SIGHT_BEHIND_MOST 0.2

#define SIDE 40 /* cells */

/* The cell of a point, -1 where it is off the head. */
static int cell_of(struct dvec3 p, struct dvec3 nose)
{
    const double i = (p.x - nose.x) * (1 / SIGHT_CELL_MM) + SIDE / 2.0;
    const double j = (p.y - nose.y) * (1 / SIGHT_CELL_MM) + SIDE / 2.0;

    if (!((i >= 0) & (i < SIDE) & (j >= 0) & (j < SIDE)))
        return -1;
    return (int)j * SIDE + (int)i;
}

bool sight_single(const struct dvec3 *pts, size_t n, struct dvec3 nose, double side)
{
    double front[SIDE * SIDE];
    size_t on = 0, behind = 0;

    for (int i = 0; i < SIDE * SIDE; i++)
        front[i] = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        const int c = cell_of(pts[i], nose);

        if (c >= 0 && side * pts[i].z > front[c])
            front[c] = side * pts[i].z;
    }
    for (size_t i = 0; i < n; i++) {
        const int c = cell_of(pts[i], nose);

        if (c < 0)
            continue;
        on++;
        behind += side * pts[i].z < front[c] - SIGHT_BEHIND_MM;
    }
    return (double)behind < SIGHT_BEHIND_MOST * (double)on;
}
