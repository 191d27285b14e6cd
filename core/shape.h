/* shape.h -- what a face may look like: the model's mean face and its modes of shape (model.h)
 * fitted to points, robustly and together with the pose.  Where points stand in front of all
 * that the fit can explain, something covers the face; where little is explained at all, the
 * points are no face.
 * The points become a height for each cell of the canonical frame (grid.h), of the front-most
 * ones alone; then
 *     height - mean = modes a + rigid motion + rest
 * is solved for a and the motion by fit.h with the prior of the modes, again and again, while
 * the limit beyond which a cell counts nothing shrinks (SHAPE_PASSES).  Points in front of the
 * surface are trusted less than those behind.
 * Morphable models: Blanz and Vetter, "A Morphable Model for the Synthesis of 3D Faces",
 * SIGGRAPH 1999; fitted to what is partly covered: Egger et al., "Occlusion-aware 3D
 * Morphable Models", IJCV 126, 2018. */
#ifndef CORE_SHAPE_H
#define CORE_SHAPE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "align_pose.h"
#include "fit.h"
#include "grid.h"
#include "mem.h"
#include "model.h"
#include "status.h"

/* What the points in a cell of the mean face are. */
enum shape_cell {
    SHAPE_EMPTY, /* no points; or off the mean face */
    SHAPE_SKIN,  /* explained */
    SHAPE_COVER, /* what covers the face: connected cells in front of it, the holes beside
                    them, and one cell around */
    SHAPE_APART  /* not explained, and no cover: behind the fitted face, or strays */
};

struct shape_fit {
    struct align_pose pose;      /* points -> canonical frame, mm */
    double a[MODEL_MODES];       /* coefficients of the modes */
    float height[GRID_N];        /* of the fitted face, mm; NAN off it */
    uint8_t cell[GRID_N];        /* enum shape_cell */
    uint32_t skin, cover, apart; /* cells of each kind */
    double support; /* S, at most 1: (cells within SHAPE_NEAR_MM - 2 cells behind the face
                        - 4 |a|^2) / cells of the mean face */
    double
        likeness; /* ln of the relief (frame.h) of the skin over what is not explained, both
                        root mean squares: how much more than a rest there is to the face */
};

/* Ready to fit, and a worker's reusable memory.  One thread at a time. */
struct shape_work {
    uint32_t cells;           /* of the mean face */
    float mean[GRID_N];       /* mm; NAN: the cell is not used */
    float normal[GRID_N][3];  /* of the mean face; normal[i][2] scales heights to gaps */
    float scale[GRID_N];      /* each cell's rest over the mean of all */
    float over_rest[GRID_N];  /* SHAPE_REST_TYPICAL_MM over it, less for a small one */
    struct model_basis basis; /* the modes and the rest as gaps at right angles to it */
    struct fit_basis fit;     /* that, prepared */
    const struct model_basis *modes; /* of height, the model's */
    struct scratch points, solve;
};

/* shape_prepare(m, out): out for m, borrowed.  *out must stay where it is.
 * shape_free(w): its memory. */
void shape_prepare(const struct model *m, struct shape_work *out);
void shape_free(struct shape_work *w);

/* shape_fit(w, pts, n, start, nstart, hard, out): the fit of most support, from nstart > 0
 * starting poses (points -> canonical frame), each right to about 12 mm and 10 degrees.
 * pts   mm; any n; those far from the face do not matter, but cost a look at each
 * hard  if less than SHAPE_GOOD of the cells with points are skin, try again from each part
 *       of the face that glasses, a mask or hair do not cover, and from either half
 * The order of the points matters by rounding alone, unless more than SHAPE_POINTS are near
 * the face: of these every so manieth is taken.
 * Cost  O(n) for each start, and one fit, or 6 if hard: each about 1 ms with 3,000 points and
 * 2 with SHAPE_POINTS.
 * Returns ST_OK, ST_ENOMEM. */
enum status shape_fit(struct shape_work *w, const struct dvec3 *pts, size_t n,
                      const struct align_pose *start, uint32_t nstart, bool hard,
                      struct shape_fit *out);

/* shape_judge(w, pts, n, pose, out): the same at a pose that is known: cheap, for a face whose
 * frame has been found (frame.h).  out->pose = *pose.  About 0.15 ms for 3,000 points.
 * Returns ST_OK, ST_ENOMEM. */
enum status shape_judge(struct shape_work *w, const struct dvec3 *pts, size_t n,
                        const struct align_pose *pose, struct shape_fit *out);

#endif
