/* holes.h -- which triangles only bridge missing points.
 * Paper 2 (missing points): a Delaunay triangulation fills the convex hull, so a scan with
 * holes or a concave outline gets long triangles that were never measured.  They are found
 * relative to the local point spacing, which the spanning tree's edges give for free.
 *
 * The rule: a triangle bridges when its longest side exceeds HOLES_RATIO times the mean
 * spacing at its corners.  The tree takes the short edges, so that a hole hardly widens the
 * spacing at its rim.  Scans sample a surface at random: their natural gaps scatter much.
 * With the ratio 4.25 about 0.1 % of the inner area of sound scans is taken for bridged
 * and about 0.5 % of the area of holes 12 to 44 mm wide is missed, at a tree edge of 1.8 mm
 * on average; a hole must be some 4 spacings wide to be one. */
#ifndef CORE_HOLES_H
#define CORE_HOLES_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

#define HOLES_RATIO 4.25

/* holes_spacing(m, s, spacing): spacing[v] = the local point spacing round v in lattice
 * units: the mean length of the tree's edges within three steps of v, those met on several
 * ways counted as often.  Needs m->parent.  O(nv).  Returns ST_OK, ST_ENOMEM. */
enum status holes_spacing(const struct mesh *m, struct scratch *s, float *spacing);

/* holes_wide(p, q, r, sum): does the triangle pqr bridge missing points, where sum is the
 * sum of the spacings at its corners?  The corners may come from different meshes. */
static inline bool holes_wide(struct ivec2 p, struct ivec2 q, struct ivec2 r, double sum)
{
    /* Differences of 25 bits: the squares are exact in doubles. */
    const double ax = q.x - p.x, ay = q.y - p.y, a = ax * ax + ay * ay;
    const double bx = r.x - q.x, by = r.y - q.y, b = bx * bx + by * by;
    const double cx = p.x - r.x, cy = p.y - r.y, c = cx * cx + cy * cy;
    const double ab = a > b ? a : b;

    return (ab > c ? ab : c) > HOLES_RATIO * HOLES_RATIO / 9 * (sum * sum);
}

/* holes_bridges(m, spacing, a, b, c): holes_wide() for three vertices of m, whether they
 * are a triangle of m or a cell of a general triangulation. */
bool holes_bridges(const struct mesh *m, const float *spacing, uint32_t a, uint32_t b,
                   uint32_t c);

/* holes_mark(m, spacing, bridge): bridge[t] = 1 for each triangle of m that bridges
 * missing points, ghosts included, 0 for the others.  Returns the measured area: that of
 * the triangles that do not, in square lattice units.  O(nv). */
double holes_mark(const struct mesh *m, const float *spacing, uint8_t *bridge);

#endif
