/* minimal_places.h -- the gaps between two surfaces at a pose, with how they change with it:
 * what minimal_solve() works on.
 * A place is a vertex of either surface, with the vertical gap to the other one below or above
 * it.  The moved probe keeps the triangles of its scan, which a small turn hardly changes:
 * nothing is triangulated here. */
#ifndef CORE_MINIMAL_PLACES_H
#define CORE_MINIMAL_PLACES_H
#include <stddef.h>
#include <stdint.h>
#include "align_field.h"
#include "align_pose.h"
#include "minimal_solve.h"
#include "vec.h"

struct surface; /* surface.h */

struct minimal_spot {
    float x, y;
};

struct minimal_pair {
    const struct surface *tmpl, *probe;
    struct align_field field;  /* the template's, without weights */
    struct dvec3 centre;       /* turns are about it (template, mm) */
    struct align_point *point; /* [probe nv] */
    minimal_lanes *normal;     /* [probe nv] in its scan: mean over the triangles round
                                        the vertex, times twice their area, mm^2 */
    struct minimal_spot *spot; /* [probe nv] at the pose: from the centre, mm */
    float *height;             /* [probe nv] likewise, along z */
    uint32_t *under;           /* [tmpl nv] the probe's triangle there */
    uint32_t stride;           /* of minimal_places_few() */
    struct minimal_places places;
};

/* minimal_places_layout(p, block): p's arrays in block, for p->tmpl and p->probe; returns the
 * bytes needed.  With block NULL only that. */
size_t minimal_places_layout(struct minimal_pair *p, unsigned char *block);

/* minimal_places_begin(p): once, before the others. */
void minimal_places_begin(struct minimal_pair *p);

/* minimal_places_few(p, pose): the gap at some MINIMAL_FEW of the probe's vertices.  The weight
 * is the area of the triangles round it, as the template's z sees them.  Returns the sum of the
 * weights. */
double minimal_places_few(struct minimal_pair *p, const struct align_pose *pose);

/* minimal_places_all(p, pose): the gap at every vertex of either surface.  The weight is the
 * area of those triangles round it that have a gap at each corner, so likewise.  Returns the sum
 * of the weights. */
double minimal_places_all(struct minimal_pair *p, const struct align_pose *pose);

#endif
