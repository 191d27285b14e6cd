/* surface.h -- a scanned surface, prepared for everything that compares surfaces: its
 * points triangulated (paper 1, 3.1), with their spanning tree (3.3), the spikes laid flat
 * and the triangles known that only bridge missing points (paper 2).
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
    struct mesh mesh; /* with its spanning tree; the spikes laid flat */
    int32_t *raw;    /* [nv] heights as scanned.  The surface is moved by these: what is a
                         spike depends on the side it is seen from */
    float *spacing;  /* [nv] holes_spacing() */
    uint8_t *bridge; /* [nt] holes_mark() */
    double measured; /* area of the triangles that do not bridge, square lattice units */
    void *block;     /* holds raw, spacing and bridge */
    uint32_t cap;    /* points that block has room for */
};

/* surface_prepare(pts, n, flatten, s, out): the surface through lattice points in any order.
 * flatten  lay spikes flat (spikes.h)
 * out      empty, or a former surface, whose memory is used again; on failure
 *          out->mesh.nv is 0, and out may still hold memory
 * Cost  O(n log n), about twice a triangulation.  Returns as delaunay_build(). */
enum status surface_prepare(const struct ivec3 *pts, size_t n, bool flatten,
                            struct scratch *s, struct surface *out);

/* surface_derive(out, s): raw, spacing, bridge and measured from out->mesh, which has its
 * tree: for a surface that was decoded.  O(nv).  Returns ST_OK, ST_ENOMEM. */
enum status surface_derive(struct surface *out, struct scratch *s);

/* surface_move(from, transform, pts, s, out): surface_prepare() of the points of `from` at
 * their raw heights, moved by transform (mm, row-major 4 x 4, rigid; a reflection will do)
 * and put back on the lattice.  pts, s: two scratches.
 * Returns ST_OK; ST_ERANGE a point left the lattice; ST_EDEGENERATE the surface is seen
 * edge-on; ST_ENOMEM. */
enum status surface_move(const struct surface *from, const double transform[16],
                         struct scratch *pts, struct scratch *s, struct surface *out);

void surface_free(struct surface *s); /* s is empty again; NULL is allowed */

#endif
