/* sight.h -- points that were measured from one side. */
#ifndef CORE_SIGHT_H
#define CORE_SIGHT_H
#include <stdbool.h>
#include <stddef.h>
#include "vec.h"

/* sight_single(pts, n, nose, side): Returns true if a head in n points (mm) was seen by one scanner that
 * looks along z, from large z (side 1) or small z (-1).  Then hardly any of the points lies behind
 * others, unlike those of a head from all sides.  Cost: O(n).
 *   nose  the middle of the head's front */
bool sight_single(const struct dvec3 *pts, size_t n, struct dvec3 nose, double side);

#endif
