/* surface.h -- a scanned surface, prepared for everything that compares surfaces: its
 * points triangulated (paper 1, 3.1), with their spanning tree (3.3), the spikes laid flat
 * and the triangles known that only bridge missing points (paper 2).
 * Spikes, tree and spacing belong to the scan: they are found once, seen from the side of
 * the scanner, and do not change as the surface moves.  So a measure at a pose depends on
 * the pose smoothly, up to the triangulations themselves.
 * Units: lattice units (lattice.h).  A prepared surface is immutable and may be read by any
 * number of threads. */
#ifndef CORE_SURFACE_H
#define CORE_SURFACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "mesh.h"
#include "status.h"
#include "vec.h"

struct scratch; /* mem.h */

/* All zero is an empty one. */
struct surface {
    struct mesh mesh; /* triangulation with its spanning tree; the spikes are flat */
    float *spacing;   /* [nv] holes_spacing() */
    uint8_t *bridge;  /* [nt] holes_mark() */
    double measured;  /* area of the triangles that do not bridge, square lattice units */
    uint32_t spikes;  /* points laid flat by surface_prepare() */
    uint32_t cap;     /* capacity of block, in points */
    void *block;      /* holds spacing and bridge */
};

/* surface_prepare(pts, n, flatten, s, out): Makes the surface through lattice points in any order.
 *   flatten  true: flatten spikes (spikes.h)
 *   out      empty, or a former surface, whose memory is reused; on failure
 *            out->mesh.nv is 0, and out may still hold memory
 * Cost: O(n log n), about twice a triangulation.
 * Returns as delaunay_build(). */
enum status surface_prepare(const struct ivec3 *pts, size_t n, bool flatten,
                            struct scratch *s, struct surface *out);

/* surface_derive(out, s): Computes spacing, bridge and measured from out->mesh, which has its tree:
 * for a decoded surface, whose spikes are flat.
 * Cost: O(nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status surface_derive(struct surface *out, struct scratch *s);

/* surface_move(from, transform, pts, s, out): Moves the surface `from` by transform (mm,
 * row-major 4 x 4, rigid or a reflection) and puts it back on the lattice.  Keeps vertex numbers,
 * tree and spacing.  Triangulates the moved points again (delaunay_numbered(): points that fall on one
 * place move next to each other), so that the tree's edges need not be edges of the mesh; marks gap
 * triangles again, by the spacing of `from`.
 *   pts, s  two scratches
 * Cost: O(nv): for rotations up to 10 degrees a quarter of a triangulation (repair.h), for others
 * one from scratch.
 * Returns ST_OK; ST_ERANGE: a point left the lattice; ST_EDEGENERATE: the surface is seen
 * edge-on; ST_ENOMEM. */
enum status surface_move(const struct surface *from, const double transform[16],
                         struct scratch *pts, struct scratch *s, struct surface *out);

void surface_free(struct surface *s); /* resets s to the empty state; NULL is allowed */

#endif
