/* shape.h -- the model's mean face and its modes of shape (model.h) fitted to points, robustly and
 * together with the pose.  Points in front of everything that the fit can explain are an occlusion;
 * points of which little is explained are no face.
 * The points become a height for each cell of the canonical frame (grid.h), of the front-most
 * ones alone; then
 *     height - mean = modes a + rigid motion + rest
 * is solved for a and the motion by shape_solve.h with the prior of the modes, again and again, while
 * the limit beyond which a cell counts nothing shrinks (SHAPE_PASSES).  Points in front of the
 * surface are trusted less than those behind.
 * Morphable models: Blanz and Vetter, "A Morphable Model for the Synthesis of 3D Faces",
 * SIGGRAPH 1999; fitted to partly covered faces: Egger et al., "Occlusion-aware 3D
 * Morphable Models", IJCV 126, 2018. */
#ifndef CORE_SHAPE_H
#define CORE_SHAPE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "pose.h"
#include "shape_work.h"
#include "status.h"

/* Sizes of heads, over the mean face's: children from five years on, and large adults; taken if
 * they explain GAIN cells of a whole face more. */
#define SHAPE_SIZE_GAIN 24.0
/* clang-format off */
#define SHAPE_SIZES { 0.84, 1.16, 0.77, 0.71 }
/* clang-format on */

struct surface; /* surface.h */

/* shape_fit(w, pts, n, start, nstart, hard, out): Finds the fit of most support, from nstart > 0
 * starting poses (points -> canonical frame), each right to about 12 mm and 10 degrees.
 *   pts   mm; any n; points far from the face do not matter, but cost a test each
 *   hard  true: tries again unless SHAPE_GOOD of the cells with points are skin and the fit score is
 *         SHAPE_GOOD_WORTH, or nothing covers the face and all but SHAPE_LITTLE cells are explained:
 *         from parts of the face that an occlusion may have left free (above it, below it, either
 *         half, all but the eyes), then at the sizes of children and of large adults.  Such a fit is
 *         taken if it explains SHAPE_GAIN cells more (SHAPE_SIZE_GAIN of a whole face for sizes): as
 *         skin, or as an occlusion in front of the prediction by the rest of the face
 *   out   the pose is a similarity: rotation and shift in mm, both over out->size
 * The order of the points matters by rounding alone, unless more than SHAPE_POINTS are near
 * the face: every n-th of these is taken.
 * Cost: O(n) for each start, and one fit of about 0.8 ms with 3,000 points and 1.2 with SHAPE_POINTS; if
 * hard, eight quick ones of about half of that, and one more for each part and size that these
 * recommend.
 * Returns ST_OK, ST_ENOMEM. */
enum status shape_fit(struct shape_work *w, const struct dvec3 *pts, size_t n,
                      const struct pose *start, uint32_t nstart, bool hard,
                      struct shape_fit *out);

/* shape_fit_harder(w, pts, n, start, fit): Makes *fit, the result of shape_fit() from this start and not
 * hard, the hard one.  Returns ST_OK, ST_ENOMEM. */
enum status shape_fit_harder(struct shape_work *w, const struct dvec3 *pts, size_t n,
                             const struct pose *start, struct shape_fit *fit);

/* shape_seek(w, pts, n, start, close, out): Fits quickly, by few modes.
 *   start  right to about 25 mm and 20 degrees; if close, a pose found by a rough fit
 *   close  false: roughly, and sets only pose, a, height and worth of *out
 * Returns ST_OK, ST_ENOMEM. */
enum status shape_seek(struct shape_work *w, const struct dvec3 *pts, size_t n,
                       const struct pose *start, bool close, struct shape_fit *out);

/* shape_place(w, f, start, out): Fits a surface of a face alone, from a starting pose, like
 * shape_fit(), not hard: for the canonical frame of a face.
 * Cost: about 0.8 ms.
 * Returns ST_OK, ST_ENOMEM. */
enum status shape_place(struct shape_work *w, const struct surface *f,
                        const struct pose *start, struct shape_fit *out);

#endif
