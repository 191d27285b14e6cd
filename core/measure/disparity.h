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

/* disparity_prism(area, a, b, c): Returns the volume between two planes over a triangle of the given
 * area: the integral of |gap|; a, b, c are the signed gaps at the corners.  Covers
 * every sign case of Fig. 9: one sign throughout (pyramid, prism), zeros, and the wedge
 * of surfaces that cross.  The order of the corners and of the surfaces does not change
 * the result. */
double disparity_prism(double area, double a, double b, double c);

/* One of the two surfaces. */
struct disparity_side {
    const struct surface *surface;
    const double *gap; /* [nv] disparity_gaps() */
};

/* disparity_gaps(own, other, loc, above, gap): Computes the gap at own's vertices, for struct
 * disparity_vertex.
 *   loc    own's vertices located in other's mesh
 *   above  true: own is surface b
 *   gap    [own->mesh.nv] has other's height at each vertex (locate_heights()), and receives the gap
 * Cost: O(nv). */
void disparity_gaps(const struct surface *own, const struct surface *other,
                    const struct location *loc, bool above, double *gap);

/* disparity_prism_weighted(area, gap, u): Returns the integral of u |gap| over a triangle of the given
 * area, with u (not negative) and the signed gap linear between their values at the corners:
 * definition (1) in closed form, also if the sign of the gap changes. */
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
    double gap; /* height of b minus height of a, lattice units; NAN outside a hull,
                      else INFINITY if a surface spans a hole there */
    float
        spacing; /* spacing of the vertex's surface; the larger one for a vertex of both */
    float u;     /* the weight; 0 without a finite gap, or without a weight */
};

/* disparity_common(general, vertex, h, twice): Returns true if the triangle with the half-edges h,
 * h + 1, h + 2 counts (disparity_measure()); not for ghosts.
 *   twice  receives twice its area, exact */
static inline bool disparity_common(const struct mesh *general,
                                    const struct disparity_vertex *vertex, uint32_t h,
                                    double *twice)
{
    const uint32_t *v = &general->org[h];
    const struct disparity_vertex *a = &vertex[v[0]], *b = &vertex[v[1]],
                                  *c = &vertex[v[2]];
    const double sum = a->gap + b->gap + c->gap;
    const bool wide =
        holes_wide(general->xy[v[0]], general->xy[v[1]], general->xy[v[2]],
                   (double)a->spacing + (double)b->spacing + (double)c->spacing, twice);

    return !wide & (sum < (double)INFINITY); /* false for NAN */
}

struct disparity {
    double volume_mm3; /* integral of |gap| over the common triangles */
    double area_mm2;   /* area of the common triangles */
    double plain_mm;   /* volume / area; 0 if the area is 0 */
    double
        weighted_mm; /* integral of u |gap| over integral of u, over the same triangles; or 0 */
    double overlap; /* area / measured area of surface a, 0..1 */
};

/* disparity_measure(general, b_vertex, a, b, weight, per_mm, vertex, out): Measures the disparity of
 * the surfaces a and b.
 *   general, b_vertex  results of merge_build() for the meshes of a and b
 *   weight   NULL: u = 1
 *   per_mm   lattice units per millimetre
 *   vertex   [general->nv] set on return
 * Only common triangles count.  A triangle of the general triangulation is not common if
 *   - a corner lies outside the other mesh's hull;
 *   - at a corner the other mesh spans a hole: the corner is strictly inside a gap triangle, or on an
 *     edge or vertex that has only gap triangles;
 *   - it is too wide for the spacings at its corners (holes_wide()): then neither mesh has a
 *     point where the triangle has its gap.
 * Sums are compensated (Neumaier) and in the order of the triangles, areas are whole
 * numbers.  Cost: O(general->nv). */
void disparity_measure(const struct mesh *general, const uint32_t *b_vertex,
                       const struct disparity_side *a, const struct disparity_side *b,
                       const struct disparity_weight *weight, double per_mm,
                       struct disparity_vertex *vertex, struct disparity *out);

#endif
