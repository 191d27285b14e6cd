/* mirror.h -- scans that are recognisable as a mirror image. */
#ifndef CORE_MIRROR_H
#define CORE_MIRROR_H
#include <stdbool.h>

struct cloudpoints; /* cloudpoints.h */

/* mirror_told(c): Returns true if c, which a scanner in front of a face has seen, is definitely a mirror
 * image.  The normals of a surface point towards the scanner, and the rows and columns of an
 * organised cloud run down and to the right; in a mirror image one of both is reversed.
 * Nearly all known normals must point away, or the order of the pixels must be as clearly reversed,
 * and the other must not contradict.  Normals in all directions, and an order that is no image's,
 * tell nothing.  Cost: O(n). */
bool mirror_told(const struct cloudpoints *c);

#endif
