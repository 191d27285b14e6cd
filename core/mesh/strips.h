/* strips.h -- points put in the order in which delaunay.c divides and conquers them.
 * The plane is cut into vertical strips of about equal count; a strip's points are sorted
 * by y, then x.  A square of a strip then holds a few points, so the seams of
 * all merges together stay short (Dwyer 1987; see delaunay.h).
 * Internal to core. */
#ifndef CORE_STRIPS_H
#define CORE_STRIPS_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

#define STRIPS_MAX 4096

struct strip {
    uint32_t first;  /* its points: first .. first of the next strip - 1; at least two */
    uint32_t lo, hi; /* its first and last point by (x, y) */
};

struct strips {
    uint32_t count;
    struct strip at[STRIPS_MAX + 1]; /* at[count].first: the number of points */
};

/* strips_scratch(n): bytes of scratch strips_sort() needs for n points. */
size_t strips_scratch(size_t n);

/* strips_sort(pts, n, block, out, xy, z): fill xy[], z[] and out.
 * Points with the same (x, y) become one, their height the mean rounded down.  No column
 * (points of the same x) is shared by two strips, so strips are separated by vertical
 * lines.  The result depends on the set of points, not on their order.
 * Cost  O(n): radix sort, 2 passes per coordinate for faces, plus one by strip.
 * Returns ST_OK; ST_ERANGE a coordinate lies off the lattice; ST_EDEGENERATE fewer than
 * two distinct points.  n >= 1. */
enum status strips_sort(const struct ivec3 *pts, size_t n, void *block,
                        struct strips *out, struct ivec2 *xy, int32_t *z);

#endif
