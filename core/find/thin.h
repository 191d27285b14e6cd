/* thin.h -- fewer points, spread evenly over the view from the front. */
#ifndef CORE_THIN_H
#define CORE_THIN_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

/* A point in the view, mm. */
struct thin_point {
    float x, y, z;
    uint32_t index; /* the point's number */
    float
        off; /* mm along z from the point to the mean of the points that it stands for */
};

/* thin_points(p, n, most, near_mm): Keeps at most `most` of the n points, one in each square of
 * the view: the one nearest the middle.  Searches for the size of the squares that keeps 95 % or more
 * of `most`, or 85 % if there are hardly more points.  The order stays.  With `most` points or fewer
 * keeps all.  The result does not depend on the points' order.
 *   p        off is 0
 *   n        receives the number kept
 *   near_mm  a point stands for the points of its square within near_mm of it along z, whose noise the
 *            mean averages out; 0: for itself alone
 * Cost: O(n), about 7 passes; 16 bytes a point, and 0.3 MB.
 * Returns ST_OK; ST_ENOMEM: nothing is changed. */
enum status thin_points(struct thin_point *p, size_t *n, size_t most, double near_mm);

#endif
