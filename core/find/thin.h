/* thin.h -- fewer points, spread evenly over the view from the front. */
#ifndef CORE_THIN_H
#define CORE_THIN_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

/* A point in the view, mm, and which one it is. */
struct thin_point {
    float x, y, z;
    uint32_t index;
    float off; /* mm along z from it to the mean of the points that it stands for */
};

/* thin_points(p, n, most, near_mm): keeps at most `most` of the n points, one of each square of
 * the view: the one nearest the middle.  The size of the squares is searched for: of many points
 * 95 % or more of those that may be are kept, of hardly more than that 85 %.  Their order stays.
 * With most points or fewer all are kept.  A point kept stands for those of its square within
 * near_mm of it along z, whose noise the mean averages out; near_mm = 0: for itself alone.
 * off must be 0 before.  The result does not depend on the points' order.
 * Returns ST_OK, with the number kept in *n; ST_ENOMEM: nothing was changed.  Cost: O(n), about
 * 7 looks at every point; 16 bytes a point, and 0.3 MB. */
enum status thin_points(struct thin_point *p, size_t *n, size_t most, double near_mm);

#endif
