/* minimal_places.h -- sample points of two surfaces at a pose: their gaps, and the gaps' derivatives
 * by the pose, for minimal_solve().
 * A sample point is a vertex of either surface, with the vertical gap to the other surface below or
 * above it.  The moved probe keeps the triangles of its scan, which a small rotation hardly changes:
 * nothing is triangulated here. */
#ifndef CORE_MINIMAL_PLACES_H
#define CORE_MINIMAL_PLACES_H
#include <stddef.h>
#include <stdint.h>
#include "minimal_solve.h"
#include "pose.h"
#include "vec.h"

struct surface; /* surface.h */

/* The number of the probe's vertices that the first steps use.  Of non-mated pairs 97 % end within
 * 1 % of the least known value with 1,500, 96 % with 750, 94 % with 500. */
#define MINIMAL_FEW 750

/* A place from the centre, mm. */
struct minimal_spot {
    float x, y;
};

struct minimal_side {
    const struct surface *surface;
    struct minimal_spot *spot; /* [nv] places of the vertices */
    float *height;             /* [nv] heights of the vertices, from the centre, mm */
    uint32_t *
        under; /* [nv] the other side's triangle under or over the vertex, or the end of the
                        walk to it; UINT32_MAX: not searched for yet */
};

struct minimal_pair {
    struct minimal_side tmpl, probe; /* the probe at the last pose */
    struct dvec3 centre;             /* of rotations (template, mm) */
    struct dvec3 *point;             /* [probe nv] unmoved vertices, mm */
    minimal_lanes
        *normal;     /* [probe nv] unmoved normals: the mean over the triangles around the
                              vertex, times twice their area, mm^2 */
    uint32_t stride; /* between the vertices of minimal_places_few() */
    struct minimal_places places;
};

/* minimal_places_layout(p, block): Lays p's arrays, for the surfaces of its sides, into block.
 *   block  NULL: only the size is wanted
 * Returns the bytes needed. */
size_t minimal_places_layout(struct minimal_pair *p, unsigned char *block);

/* minimal_places_begin(p): Prepares the sides of p, whose centre is known, for the functions below. */
void minimal_places_begin(struct minimal_pair *p);

/* minimal_places_few(p, pose): Samples about MINIMAL_FEW of the probe's vertices, moved by pose.  The weight
 * of a vertex is the area, projected along the template's z, of the triangles around it.
 * Returns the sum of the weights. */
double minimal_places_few(struct minimal_pair *p, const struct pose *pose);

/* minimal_places_all(p, pose): Samples every vertex of either surface, the probe's first.  The weight of
 * a vertex is the area, projected along the template's z, of those of its triangles whose three
 * corners all have a gap.
 * Returns the sum of the weights. */
double minimal_places_all(struct minimal_pair *p, const struct pose *pose);

#endif
