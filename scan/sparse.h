/* sparse.h -- a surface of few points as many points, for what looks at cells one by one. */
#ifndef SCAN_SPARSE_H
#define SCAN_SPARSE_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct surface; /* surface.h */

/* sparse_points(f, out, n): the points of f, and others in its triangles, except where these
 * only bridge missing points, so dense that no cell (grid.h) under the surface is without.
 * *out: mm, to be released by mem_free(); NULL on failure.  O(nv).  Returns ST_OK, ST_ENOMEM. */
enum status sparse_points(const struct surface *f, struct dvec3 **out, size_t *n);

#endif
