/* headpose.h -- where the face is in a head's points from all sides, by trying: many noses
 * and directions, each looked at as a scan from its front.  Slow (about a second) and
 * independent of the program's own search, which is tested with what is rendered by it. */
#ifndef TOOLS_HEADPOSE_H
#define TOOLS_HEADPOSE_H
#include <stdbool.h>
#include <stddef.h>
#include "vec.h"

struct surface_work; /* face.h */

/* headpose_find(p, n, crop, w, to): to: from the points, mm, to the canonical frame; row-major
 * 4 x 4.  crop: they are a frontal scan of a face alone.  False where no face was found. */
bool headpose_find(const struct dvec3 *p, size_t n, bool crop, struct surface_work *w,
                   double to[16]);

#endif
