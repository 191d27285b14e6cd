/* fuse.h -- the frames of one capture session as one surface.
 * One frame is the base.  The others are registered to it by the six motions of the canonical
 * frame; then its points are located in each of them along the spanning tree, and the height there
 * interpolated, as paper 1 does for two meshes (sections 3.3 and 3.4).  The height of a point
 * becomes a robust mean of all frames: the noise falls with the square root of their number.
 * All sums are in a fixed order: the same digits everywhere. */
#ifndef CORE_FUSE_H
#define CORE_FUSE_H
#include <stdint.h>
#include "grid.h"
#include "status.h"
#include "vec.h"

struct surface_face; /* face.h */
struct surface_work; /* face.h */

/* The largest median gap of two registered frames.  No noise explains more: another expression, or another
 * object than the face. */
#define FUSE_GAP_MM 2.0

/* The place of a frame over the base. */
struct fuse_place {
    double transform[16]; /* frame (mm) -> base (mm), row-major 4 x 4, rigid */
    double
        gap_mm; /* median of the cells' gaps at transform; INFINITY: too few in common */
};

/* fuse_worth(f, w): Returns the information of f about a face: its cells over the variance of its noise. */
double fuse_worth(const struct surface_face *f, const struct surface_work *w);

/* fuse_cells(f, w, z): Computes the heights of f in the cells of its canonical frame (heights.h), for
 * fuse_register().  Returns ST_OK, ST_ENOMEM. */
enum status fuse_cells(const struct surface_face *f, struct surface_work *w,
                       float z[GRID_N]);

/* fuse_register(base, z, f, w, out, own): Lays f on the base, whose cells are z, starting from
 * coinciding canonical frames: reweighted Gauss-Newton steps on the gaps of the cells, at right
 * angles to the mean face, by the six motions.  own receives the heights of f there, in the base's
 * cells.  Returns ST_OK, ST_ENOMEM. */
enum status fuse_register(const struct surface_face *base, const float z[GRID_N],
                          const struct surface_face *f, struct surface_work *w,
                          struct fuse_place *out, float own[GRID_N]);

/* fuse_points(base, n, f, at, w, out, npts): Makes the points of the fused surface, in the base's frame, mm:
 * the base's points, numbered as in its mesh; then points of the other frames in cells that no earlier
 * frame has measured.  (Missing cells do not distinguish people.)  The height of each is the robust
 * mean of all frames that have measured there: the weight of a frame is the square of 1 / its residual,
 * and less if it is far from the median.
 *   f, at  [n] the other frames, and their places over the base
 *   out    receives *npts points, to be released by mem_free(); NULL on failure
 *   noise_mm  [n + 1] receives the white noise of the base, and of its means with one, two ... others
 * Cost: two locations for each of the other frames.
 * Returns ST_OK, ST_ENOMEM. */
enum status fuse_points(const struct surface_face *base, uint32_t n,
                        const struct surface_face *const f[],
                        const struct fuse_place at[], struct surface_work *w,
                        struct dvec3 **out, size_t *npts, double noise_mm[]);

#endif
