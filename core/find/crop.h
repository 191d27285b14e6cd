/* crop.h -- of the points of a scan those of the face that a scanner in front of it would
 * see, where nothing covers it. */
#ifndef CORE_CROP_H
#define CORE_CROP_H
#include <stddef.h>
#include <stdint.h>
#include "pose.h"
#include "status.h"

/* mm: a point kept by thinning becomes the mean, over the face, of the points in its place that
 * are so near to it, spikes not.  Of a depth camera the mated score becomes 0.094 instead of
 * 0.099. */
#define CROP_MEAN_MM 2.5

struct cloudpoints; /* cloudpoints.h */
struct shape_fit;   /* shape.h */

/* Where the face is. */
struct crop_view {
    struct pose pose;    /* points -> canonical frame; may shrink (shape.h) */
    const float *height; /* [GRID_N] of the face there, mm; NAN off it */
    const uint8_t *cell; /* [GRID_N] enum shape_cell */
};

/* What became of the points. */
struct crop_count {
    size_t face; /* seen from the front, on the face's skin and the rim round it */
    /* where something covers it: of what does, however far before it, and below */
    size_t other;
    size_t kept; /* of face, after thinning */
};

/* crop_face(c, v, most, out): c, in mm, becomes the points of the face, at most `most`.
 * c  c->at and c->normal are then in the canonical frame, the order as before; c->index says
 *    each point's place among those read.  On failure c is unchanged
 * Left out are, in this order: what is farther from the face's outline than CROP_RIM cells, or
 * before or behind the face there; what points before it hide from the front; what covers the
 * face (strays stay: the comparison weighs them); and what is more than enough, thinned
 * evenly: the points kept become, along z, the means of those that they stand for (thin.h).
 * The result does not depend on the order.  O(n); memory 20 bytes a point, freed at the end.
 * Returns ST_OK, ST_ENOMEM. */
enum status crop_face(struct cloudpoints *c, const struct crop_view *v, size_t most,
                      struct crop_count *out);

/* crop_thin(c, most): at most `most` of c's points, spread evenly over the view from the
 * front, where they are; else as crop_face(). */
enum status crop_thin(struct cloudpoints *c, size_t most);

#endif
