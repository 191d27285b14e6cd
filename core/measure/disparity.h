/* disparity.h -- the volume between two surfaces over their general triangulation.
 * Paper 1 sections 2 (definition (1), (2)) and 3.5, Fig. 9 (a-f). */
#ifndef CORE_DISPARITY_H
#define CORE_DISPARITY_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include "holes.h"
#include "mesh.h"
#include "surface.h"

struct location; /* locate.h */

/* disparity_prism(area, a, b, c): the volume between two planes over a triangle of the given
 * area: the integral of |gap|, where a, b, c are the signed gaps at the corners.  Covers
 * every sign case of Fig. 9: one sign throughout (pyramid, prism), zeros, and the wedge
 * where the surfaces cross.  The order of the corners and of the surfaces does not change
 * the result. */
double disparity_prism(double area, double a, double b, double c);

/* One of the two surfaces. */
struct disparity_side {
    const struct surface *surface;
    const double *gap; /* [nv] disparity_gaps() */
};

/* disparity_gaps(own, other, loc, above, gap): the gap at own's vertices, as struct
 * disparity_vertex has it.
 * loc    own's vertices located in other's mesh
 * above  own is surface b
 * gap    [own->mesh.nv] on entry other's height at each vertex (locate_heights())
 * O(nv). */
void disparity_gaps(const struct surface *own, const struct surface *other,
                    const struct location *loc, bool above, double *gap);

/* disparity_prism_weighted(area, gap, u): the integral of u |gap| over a triangle of the given
 * area, u (not negative) and the signed gap linear between their values at the corners:
 * definition (1) in closed form, where the sign of the gap changes too. */
double disparity_prism_weighted(double area, const double gap[3], const double u[3]);

/* u(x, y) of definition (1), taken at each vertex of the general triangulation and linear
 * between them: at (x, y), where surface a has the height z; lattice units.  Finite and not
 * negative; it may depend on nothing but arg and the point. */
struct disparity_weight {
    float (*at)(const void *arg, double x, double y, double z);
    const void *arg;
};

/* The gap at a vertex of the general triangulation. */
struct disparity_vertex {
    double gap;    /* height of b minus height of a, lattice units; NAN outside a hull,
                      else INFINITY where a surface only bridges missing points */
    float spacing; /* of the surface that the vertex is from; of both, the larger */
    float u;       /* the weight; 0 without a finite gap, or without a weight */
};

enum disparity_kind { DISPARITY_COMMON, DISPARITY_BRIDGED, DISPARITY_OUTSIDE };

/* disparity_kind(general, vertex, h, twice): the kind of the triangle with the half-edges h,
 * h + 1, h + 2, as disparity_measure() defines it; not for ghosts.  *twice becomes twice its
 * area, exact. */
static inline enum disparity_kind disparity_kind(const struct mesh *general,
                                                 const struct disparity_vertex *vertex,
                                                 uint32_t h, double *twice)
{
    const uint32_t *v = &general->org[h];
    const struct disparity_vertex *a = &vertex[v[0]], *b = &vertex[v[1]],
                                  *c = &vertex[v[2]];
    const double sum = a->gap + b->gap + c->gap;
    const bool wide =
        holes_wide(general->xy[v[0]], general->xy[v[1]], general->xy[v[2]],
                   (double)a->spacing + (double)b->spacing + (double)c->spacing, twice);

    if (__builtin_expect(isnan(sum), 0))
        return DISPARITY_OUTSIDE;
    if (__builtin_expect(wide | !(sum < (double)INFINITY), 0))
        return DISPARITY_BRIDGED;
    return DISPARITY_COMMON;
}

struct disparity {
    double volume_mm3;  /* sum of |gap| over the common triangles, u = 1 */
    double area_mm2;    /* their area */
    double plain_mm;    /* volume / area; 0 when the area is 0 */
    double weighted_mm; /* integral of u |gap| over that of u, over the same; or 0 */
    double weight_mm2;  /* the integral of u; area_mm2 without a weight */
    double overlap;     /* area over a's measured area, 0..1 */
    double bridged_mm2; /* area left out because a surface only bridges missing points */
    double outside_mm2; /* area of the triangles not wholly inside both hulls */
    uint32_t common, bridged, outside; /* how many triangles of each kind */
};

/* disparity_measure(general, b_vertex, a, b, weight, per_mm, vertex, out): the disparity of
 * the surfaces a and b.
 * general, b_vertex  from merge_build() of the meshes of a and b
 * weight   may be NULL: u = 1
 * per_mm   lattice units per millimetre
 * vertex   [general->nv] scratch, set on return
 *
 * Each triangle of the general triangulation is one of three:
 *   outside  a corner lies outside the other mesh's hull;
 *   bridged  else, a corner is where the other mesh only bridges missing points: strictly
 *            inside a bridging triangle of it, or on an edge or vertex of it all of whose
 *            triangles bridge; or the triangle itself is too wide for the spacings at its
 *            corners (holes_wide()): then neither mesh has a point where the triangle has
 *            its gap;
 *   common   else.  Only these count.
 * Sums are compensated (Neumaier) and in the order of the triangles, areas are whole
 * numbers.  O(general->nv). */
void disparity_measure(const struct mesh *general, const uint32_t *b_vertex,
                       const struct disparity_side *a, const struct disparity_side *b,
                       const struct disparity_weight *weight, double per_mm,
                       struct disparity_vertex *vertex, struct disparity *out);

#endif
