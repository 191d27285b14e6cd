/* aspect.h -- the proportions of a face in a depth image, of which a wrong focal length scales x and y
 * against z. */
#ifndef CORE_ASPECT_H
#define CORE_ASPECT_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct shape_fit;  /* shape.h */
struct shape_work; /* shape.h */

/* aspect_of(w, pts, n, fit, times): Estimates by how much the face is too wide and too high for its depth.
 *   pts    mm, in a camera's axes: z along its axis
 *   fit    the fit to them, of a face that looks at the camera
 *   times  the focal length over the one that was used, by which faces have their proportions; its
 *          standard deviation over people is 0.04
 * The face is fitted twice, narrower and wider by ASPECT_BY; the difference of what the two explain falls
 * with the width of the face.
 * Cost: O(n), and two fits of a shape, 1 to 2 ms each; 24 bytes a point near the face, freed at the end.
 * Returns ST_OK, ST_ENOMEM. */
enum status aspect_of(struct shape_work *w, const struct dvec3 *pts, size_t n,
                      const struct shape_fit *fit, double *times);

#endif
