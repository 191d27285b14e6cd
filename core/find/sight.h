/* sight.h -- were points measured from one side? */
#ifndef CORE_SIGHT_H
#define CORE_SIGHT_H
#include <stdbool.h>
#include <stddef.h>
#include "vec.h"

/* sight_single(pts, n, nose, side): is a head in n points (mm) seen by a scanner that looks along
 * z, from large z (side 1) or small (-1)?  Then hardly any of the points lies behind others of
 * them, as those of a head from all sides do.  nose: the middle of what is looked at.  O(n). */
bool sight_single(const struct dvec3 *pts, size_t n, struct dvec3 nose, double side);

#endif
