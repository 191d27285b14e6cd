/* pair.h -- two faces, prepared for a comparison.  The size of the head is decided for both
 * scans together: heads of one person have one size, so that two sizes are two readings of one head,
 * of which one is wrong, or two people. */
#ifndef CORE_PAIR_H
#define CORE_PAIR_H
#include "encode.h"
#include "face_data.h"
#include "grid.h"
#include "pose.h"
#include "status.h"
#include "surface.h"

struct pair_side {
    const struct surface *surface;
    const struct encoding *encoding;
    struct pose pose; /* surface -> canonical frame, shrunk by the size of the head */
};

struct pair {
    struct pair_side tmpl, probe;
    struct encoding other; /* encoding of the face that is taken at the other's size */
    struct encoding again; /* encoding of the probe, by pair_again() */
};

/* pair_make(tmpl, probe, w, out): Takes both faces at one size.  If they were taken for heads of
 * different sizes, chooses the size at which more of both scans together is explained.  Symmetric.
 *   out  borrows both faces, and must not move
 * Cost: two fits and one encoding, 2 ms; next to nothing if the sizes agree.
 * Returns ST_OK; ST_ENOMEM; ST_EINVAL: the sizes differ, and a face has no surface. */
enum status pair_make(const struct surface_face *tmpl, const struct surface_face *probe,
                      struct surface_work *w, struct pair *out);

/* pair_again(probe, transform, w, io): Lays the probe on the mean face again, from the template's frame.
 *   transform  moves the probe's surface onto the template's (4 x 4, row-major, rigid)
 * Cost: a fit and an encoding.
 * Returns ST_OK, ST_ENOMEM. */
enum status pair_again(const struct surface_face *probe, const double transform[16],
                       struct surface_work *w, struct pair *io);

/* pair_heights(s, w, z): Computes the heights of a side in the canonical frame (heights.h), which
 * s->encoding encodes.  Returns ST_OK, ST_ENOMEM. */
enum status pair_heights(const struct pair_side *s, struct surface_work *w,
                         float z[GRID_N]);

#endif
