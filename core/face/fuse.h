/* fuse.h -- the frames of one capture session as one surface.
 * One frame is the base, and its points stay where they are seen.  The others are registered to it
 * by the six motions of the canonical frame, located in it along its spanning tree and interpolated
 * at its points as paper 1 does for two meshes (sections 3.3 and 3.4); then each height becomes a
 * robust mean of all frames: of n frames of equal noise about a square root of n times less is
 * left.
 * All sums are in a fixed order: the same digits everywhere. */
#ifndef CORE_FUSE_H
#define CORE_FUSE_H
#include <stdint.h>
#include "grid.h"
#include "status.h"
#include "vec.h"

struct surface_face; /* face.h */
struct surface_work; /* face.h */

/* With fewer cells in common than a quarter of a face two frames are not registered; nor beyond a
 * median gap that no noise explains: another expression, or another place than the face's. */
#define FUSE_CELLS  230
#define FUSE_GAP_MM 2.0

/* Where a frame lies over the base. */
struct fuse_place {
    double transform[16]; /* frame (mm) -> base (mm), row-major 4 x 4, rigid */
    double gap_mm;        /* the median there of the cells' gaps; INFINITY: too few in common */
};

/* fuse_worth(f, w): how much f tells of a face: its cells over the variance of its noise. */
double fuse_worth(const struct surface_face *f, const struct surface_work *w);

/* fuse_cells(f, w, z): the heights of f in the cells of its canonical frame (heights.h), for
 * fuse_register().  Returns ST_OK, ST_ENOMEM. */
enum status fuse_cells(const struct surface_face *f, struct surface_work *w,
                       float z[GRID_N]);

/* fuse_register(base, z, f, w, out): lays f on the base, whose cells are z, from where their
 * canonical frames coincide: reweighted Gauss-Newton steps on the gaps of the cells, at right
 * angles to the mean face, by the six motions.  Returns ST_OK, ST_ENOMEM. */
enum status fuse_register(const struct surface_face *base, const float z[GRID_N],
                          const struct surface_face *f, struct surface_work *w,
                          struct fuse_place *out);

/* fuse_heights(base, n, f, at, w, pts): the points of the base, numbered as in its mesh, with the
 * robust mean of the heights of all.
 * f, at  [n] the other frames, and where each lies over the base
 * pts    [points of the base]
 * A frame weighs by the square of 1 / its residual, and less where it is far from the median of
 * all.  Where a frame has not measured anything, or only bridges missing points, it does not
 * count.  O(n nv).  Returns ST_OK, ST_ENOMEM. */
enum status fuse_heights(const struct surface_face *base, uint32_t n,
                         const struct surface_face *const f[],
                         const struct fuse_place at[], struct surface_work *w,
                         struct dvec3 *pts);

#endif
