/* mirror.h -- does a scan say by itself that it is a mirror image? */
#ifndef CORE_MIRROR_H
#define CORE_MIRROR_H
#include <stdbool.h>

struct cloudpoints; /* cloudpoints.h */

/* mirror_told(c): c has what a scanner in front of a face sees of it.  Then the normals of a surface point towards that scanner, and the rows and
 * columns of an organised cloud run down and to the right; in a mirror image the one or the
 * other is the other way round.  True if that is plain: nearly all normals that are known
 * point away, or the pixels' order is as plainly reversed, and the other does not contradict.
 * Normals in all directions and an order that is no image's say nothing.  O(n). */
bool mirror_told(const struct cloudpoints *c);

#endif
