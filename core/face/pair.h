/* pair.h -- what is compared of two faces.  What is discrete in a face's frame is decided for both
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
    struct encoding other; /* of the face that is taken at the other's size */
    struct encoding again; /* of the probe, by pair_again() */
};

/* pair_make(tmpl, probe, w, out): both faces at one size: where they were taken for heads of different
 * ones, at that of the two at which both scans together explain more of what they show.  Symmetric.
 * out borrows both faces, and stays where it is.
 * Next to nothing where the sizes agree; else two fits and one encoding: 2 ms.
 * Returns ST_OK, ST_ENOMEM. */
enum status pair_make(const struct surface_face *tmpl, const struct surface_face *probe,
                      struct surface_work *w, struct pair *out);

/* pair_again(probe, transform, w, io): the probe laid on the mean face anew, from the template's frame:
 * where its surface is once it is moved by transform (4 x 4, row-major, rigid) onto the template's.
 * A fit and an encoding.  Returns ST_OK, ST_ENOMEM. */
enum status pair_again(const struct surface_face *probe, const double transform[16],
                       struct surface_work *w, struct pair *io);

/* pair_heights(s, w, z): the heights of a side in the canonical frame (heights.h), which
 * s->encoding encodes.  Returns ST_OK, ST_ENOMEM. */
enum status pair_heights(const struct pair_side *s, struct surface_work *w,
                         float z[GRID_N]);

#endif
