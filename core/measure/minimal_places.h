/* minimal_places.h -- the gaps between two surfaces at a pose, with how they change with it:
 * what minimal_solve() works on.
 * A place is a vertex of either surface, with the vertical gap to the other one below or above
 * it.  The moved probe keeps the triangles of its scan, which a small turn hardly changes:
 * nothing is triangulated here. */
#ifndef CORE_MINIMAL_PLACES_H
#define CORE_MINIMAL_PLACES_H
#include <stddef.h>
#include <stdint.h>
#include "minimal_solve.h"
#include "pose.h"
#include "vec.h"

struct surface; /* surface.h */

/* FEW of the probe's vertices are used by the first steps; how many steps at most, and the length
 * of the last, mm.  Of non-mated pairs 97 % end within 1 % of the least known value with 1,500,
 * 96 with 750, 94 with 500; a seventh step gains nothing. */
#define MINIMAL_FEW      750
#define MINIMAL_STEPS    6
#define MINIMAL_SHORT_MM 0.1

/* From the centre, mm. */
struct minimal_spot {
    float x, y;
};

struct minimal_side {
    const struct surface *surface;
    struct minimal_spot *spot; /* [nv] */
    float *height;             /* [nv] along z, likewise */
    uint32_t *under; /* [nv] the other side's triangle under or over the vertex, or where
                        the walk to it ended; UINT32_MAX: not looked for yet */
};

struct minimal_pair {
    struct minimal_side tmpl, probe; /* the probe as it was moved last */
    struct dvec3 centre;             /* turns are about it (template, mm) */
    struct dvec3 *point;             /* [probe nv] as it was scanned, mm */
    minimal_lanes
        *normal;     /* [probe nv] likewise: mean over the triangles round the vertex,
                              times twice their area, mm^2 */
    uint32_t stride; /* of minimal_places_few() */
    struct minimal_places places;
};

/* minimal_places_layout(p, block): p's arrays in block, for the surfaces of its sides; returns
 * the bytes needed.  With block NULL only that. */
size_t minimal_places_layout(struct minimal_pair *p, unsigned char *block);

/* minimal_places_begin(p): once, before the others; p->centre is known. */
void minimal_places_begin(struct minimal_pair *p);

/* minimal_places_few(p, pose): the gap at some MINIMAL_FEW of the probe's vertices.  The weight
 * is the area of the triangles round it, as the template's z sees them.  Returns the sum of the
 * weights. */
double minimal_places_few(struct minimal_pair *p, const struct pose *pose);

/* minimal_places_all(p, pose): the gap at every vertex of either surface, first the probe's.
 * The weight is the area of those triangles round it that have a gap at each corner, so
 * likewise.  Returns the sum of the weights. */
double minimal_places_all(struct minimal_pair *p, const struct pose *pose);

#endif
