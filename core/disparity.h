/* disparity.h -- the volume between two surfaces over their general triangulation.
 * Paper 1 sections 2 (definition (1), (2)) and 3.5, Fig. 9 (a-f). */
#ifndef CORE_DISPARITY_H
#define CORE_DISPARITY_H
#include <stdint.h>
#include "status.h"

struct location; /* locate.h */
struct mesh;     /* mesh.h */
struct scratch;  /* mem.h */

/* disparity_cell(area, a, b, c): volume between two planes over a triangle of the given
 * area, where a, b, c are the signed gaps at its corners: the integral of |gap|.  Every
 * sign case of Fig. 9: one sign throughout (pyramid, prism), zeros, and the wedge where
 * the surfaces cross. */
double disparity_cell(double area, double a, double b, double c);

/* A surface as the measure needs it. */
struct disparity_side {
    const struct mesh *mesh;
    const float *spacing;       /* holes_spacing() */
    const uint8_t *bridge;      /* holes_mark() */
    double measured;            /* holes_mark()'s area, square lattice units */
    const struct location *loc; /* each of its vertices located in the other's mesh */
    const double *other;        /* each of its vertices interpolated in the other's mesh */
};

/* u(x, y) of definition (1), in lattice units; taken at each cell's centroid. */
struct disparity_weight {
    double (*at)(const void *arg, double x, double y);
    const void *arg;
};

struct disparity {
    double volume_mm3;        /* sum of |gap| over the common cells, u = 1 */
    double area_mm2;          /* their area */
    double plain_mm;          /* volume / area; 0 when the area is 0 */
    double weighted_mm;       /* sum of u |gap| / sum of u over the same cells */
    double overlap;           /* area over a's measured area, 0..1 */
    double bridged_mm2;       /* area left out because a side only bridges missing points */
    double outside_mm2;       /* area of the cells not wholly inside both hulls */
    uint32_t cells, bridged, outside; /* how many of each */
};

/* disparity_measure(general, b_vertex, a, b, weight, per_mm, gap, out)
 * general, b_vertex  from merge_build(a->mesh, b->mesh, ...)
 * weight   may be NULL: u = 1
 * per_mm   lattice units per millimetre
 * gap      [general->nv] scratch; on return height of b minus height of a, lattice units
 * A cell counts when its corners lie in both hulls and it bridges missing points of
 * neither.  Sums are compensated (Neumaier) and in a fixed order.  O(general->nv). */
void disparity_measure(const struct mesh *general, const uint32_t *b_vertex,
                       const struct disparity_side *a, const struct disparity_side *b,
                       const struct disparity_weight *weight, double per_mm, double *gap,
                       struct disparity *out);

#endif
