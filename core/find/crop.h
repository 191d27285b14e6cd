/* crop.h -- the points of the face in a scan: those that a scanner in front of it would see, and
 * that nothing covers. */
#ifndef CORE_CROP_H
#define CORE_CROP_H
#include <stddef.h>
#include <stdint.h>
#include "pose.h"
#include "status.h"

/* mm: a point kept by thinning becomes the mean of the points in its square that are so near to
 * it; spikes are not.  The mated score of a depth camera becomes 0.094 instead of 0.099. */
#define CROP_MEAN_MM 2.5

struct cloudpoints; /* cloudpoints.h */
struct shape_fit;   /* shape.h */

/* The place of the face. */
struct crop_view {
    struct pose pose;    /* points -> canonical frame; may shrink (shape.h) */
    const float *height; /* [GRID_N] of the face there, mm; NAN off it */
    const uint8_t *cell; /* [GRID_N] enum shape_cell */
};

/* Numbers of points. */
struct crop_count {
    size_t face;  /* on the face's skin and the rim around it, visible from the front */
    size_t other; /* of an occluder, however far before the face, and below it */
    size_t kept;  /* of face, after thinning */
};

/* crop_face(c, v, most, out): Reduces c, in mm, to at most `most` points of the face.
 *   c  c->at and c->normal receive the canonical frame, in the same order; c->index each
 *      point's number among those read.  Unchanged on failure
 * Removes in this order: points farther from the face's outline than CROP_RIM cells, or
 * before or behind the face there; points that others hide from the front; occluders (strays
 * stay: the comparison weighs them); and the points beyond `most`, thinned evenly: those
 * kept become, along z, the means of those that they stand for (thin.h).
 * The result does not depend on the order.
 * Cost: O(n); 20 bytes a point, freed at the end.
 * Returns ST_OK, ST_ENOMEM. */
enum status crop_face(struct cloudpoints *c, const struct crop_view *v, size_t most,
                      struct crop_count *out);

/* crop_thin(c, most): Reduces c to at most `most` points, spread evenly over the view from the
 * front.  Their places and axes stay.  Cost and return as crop_face(). */
enum status crop_thin(struct cloudpoints *c, size_t most);

#endif
