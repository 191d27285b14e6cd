/* holes.h -- which triangles only bridge missing points.
 * Paper 2 (missing points): a Delaunay triangulation fills the convex hull, so a scan with
 * holes or a concave outline gets long triangles over unmeasured parts.  They are
 * recognised by the local point spacing, which follows from the spanning tree's edges.
 *
 * The rule: a triangle bridges when its longest side exceeds HOLES_SIDE times the mean
 * spacing at its corners, and the radius of its circle, in which no point lies, exceeds
 * HOLES_CIRCLE times that spacing.  The tree consists of short edges, so a hole hardly
 * widens the spacing at its rim.  How often the rule errs: HOLES_SIDE. */
#ifndef CORE_HOLES_H
#define CORE_HOLES_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

/* A triangle bridges missing points when its longest side and the radius of its circle
 * exceed these multiples of the mean spacing at its corners.  Of points wholly at random the
 * rule takes 0.5 % of the area, of sound simulated scans less than 0.01 % inside the
 * outline; of blobs 12 to 44 mm wide it misses 0.6 % of the area. */
#define HOLES_SIDE   4.0
#define HOLES_CIRCLE 2.8

/* The local spacing counts at most this multiple of the whole scan's.  Without the limit
 * points left over between wide holes took these for their own spacing: with 92 % of a face
 * cut out a third of it counted as measured.  1.3 and 2 fare alike (docs/studies.md). */
#define HOLES_MOST 1.5

struct location; /* locate.h */
struct mesh;     /* mesh.h */
struct scratch;  /* mem.h */

/* holes_spacing(m, s, spacing): Sets spacing[v] to the local point spacing around v in lattice
 * units: the mean length of the tree's edges within three steps of v, each counted once for
 * every walk that reaches it, but at most HOLES_MOST times the mean of all edges.
 * Needs m->parent.  O(nv).  Returns ST_OK, ST_ENOMEM. */
enum status holes_spacing(const struct mesh *m, struct scratch *s, float *spacing);

/* holes_wide(p, q, r, sum, twice): Returns true if the triangle pqr spans a hole.  The corners may come
 * from different meshes.
 *   sum    sum of the spacings at the corners
 *   twice  receives twice the signed area of pqr, exact */
static inline bool holes_wide(struct ivec2 p, struct ivec2 q, struct ivec2 r, double sum,
                              double *twice)
{
    /* Differences of 25 bits: squares and cross product are exact in doubles. */
    const double ax = q.x - p.x, ay = q.y - p.y, a = ax * ax + ay * ay;
    const double bx = r.x - q.x, by = r.y - q.y, b = bx * bx + by * by;
    const double cx = p.x - r.x, cy = p.y - r.y, c = cx * cx + cy * cy;
    const double ab = a > b ? a : b, side = ab > c ? ab : c;
    const double cross = ax * by - ay * bx, mean2 = sum * sum * (1.0 / 9);

    *twice = cross;
    /* The radius is the product of the sides over four times the area. */
    return (side > HOLES_SIDE * HOLES_SIDE * mean2) &
           (a * b * c > 4 * HOLES_CIRCLE * HOLES_CIRCLE * mean2 * (cross * cross));
}

/* holes_mark(m, spacing, bridge): Sets bridge[t] to 1 for each triangle of m that spans a hole,
 * and for each ghost, else to 0.  Cost: O(nv).
 * Returns the measured area, of the triangles with 0, in square lattice units. */
double holes_mark(const struct mesh *m, const float *spacing, uint8_t *bridge);

/* holes_measured(m, bridge, loc): Returns true if loc, which is not outside, lies in a triangle of m
 * that spans no hole, or on an edge or vertex of one. */
bool holes_measured(const struct mesh *m, const uint8_t *bridge, struct location loc);

#endif
