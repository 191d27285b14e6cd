/* holes.h -- which triangles only bridge missing points.
 * Paper 2 (missing points): a Delaunay triangulation fills the convex hull, so a scan with
 * holes or a concave outline gets long triangles that were never measured.  They are found
 * relative to the local point spacing, which the spanning tree's edges give for free. */
#ifndef CORE_HOLES_H
#define CORE_HOLES_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* holes_spacing(m, s, spacing): spacing[v] = the local point spacing round v in lattice
 * units, from the spanning tree's edges near v.  Needs m->parent.  O(nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status holes_spacing(const struct mesh *m, struct scratch *s, float *spacing);

/* holes_bridges(m, spacing, a, b, c): does the triangle of the vertices a, b, c of m bridge
 * missing points?  A pure function of the three points and their spacings, so it serves
 * for triangles of m and for cells of a general triangulation alike. */
bool holes_bridges(const struct mesh *m, const float *spacing, uint32_t a, uint32_t b,
                   uint32_t c);

/* holes_mark(m, spacing, bridge): bridge[t] = 1 for each triangle of m that bridges
 * missing points, ghosts included, 0 for the others.  Returns the measured area: that of
 * the triangles that do not, in square lattice units. */
double holes_mark(const struct mesh *m, const float *spacing, uint8_t *bridge);

#endif
