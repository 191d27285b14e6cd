/* quality.h -- what a scan is worth: spikes, noise, density, coverage, and the gate that
 * refuses what is no face or too poor a scan of one. */
#ifndef CORE_QUALITY_H
#define CORE_QUALITY_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct face;    /* face.h */
struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* quality_extent(pts, n, s): do the points extend like a face?  Lattice units at
 * LATTICE_PER_MM.  The longest side of the bounding box must reach 60 mm, and that of the
 * middle 98 % of the points along each axis must not pass 500 mm: a few stray points do
 * not matter.  O(n).  Returns ST_OK, ST_EUNITS, ST_ENOMEM.  n >= 1. */
enum status quality_extent(const struct ivec3 *pts, size_t n, struct scratch *s);

/* quality_spikes(m, s): find the points that stand out of the surface alone, and lay each
 * on the median height of its neighbours that do not: the surface then runs as if they had
 * been left out, without triangulating again.  A point stands out when it differs in height
 * by more than 1 mm and 45 degrees from three quarters of its neighbours, all to one side,
 * one of them its neighbour in the spanning tree (so that few points are looked at).
 * O(m->nv).  Returns ST_OK, ST_ENOMEM. */
enum status quality_spikes(struct mesh *m, struct scratch *s);

/* quality_rate(f, s): fill f->quality from the model (mesh, tree and holes are there) and
 * gate it.  O(nv).
 * Returns ST_OK; ST_ENOTFACE no relief: within 3 mm (root mean square) of a plane, or
 * deeper than wide; ST_EQUALITY noise above 3 mm, or less than a tenth of the outline
 * measured; ST_ENOMEM. */
enum status quality_rate(struct face *f, struct scratch *s);

#endif
