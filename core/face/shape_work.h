/* shape_work.h -- the memory of fits of a face's shape (shape.h), and their result. */
#ifndef CORE_SHAPE_WORK_H
#define CORE_SHAPE_WORK_H
#include <stdint.h>
#include "pose.h"
#include "grid.h"
#include "mem.h"
#include "model.h"
#include "shape_solve.h"

/* Likeness: residuals count up to REST mm; more in cells in which faces hardly differ, though
 * not below a rest of LEAST, and unchanged at a rest of TYPICAL.  Both mean squares (mm^2) are
 * raised a little, so that neither noise nor a flat object decides.  In held-out scans
 * uncovered faces have 2.08 and more, masks 1.65; non-face objects and reliefs
 * with a support of 0.25 have 1.02 at most. */
#define SHAPE_REST_MM         3.0
#define SHAPE_REST_LEAST_MM   0.2
#define SHAPE_REST_TYPICAL_MM 0.54
#define SHAPE_REST_MM2        0.05
#define SHAPE_RELIEF_MM2      0.5

/* The kind of the points in a cell of the mean face. */
enum shape_cell {
    SHAPE_EMPTY, /* no points; or off the mean face */
    SHAPE_SKIN,  /* explained */
    SHAPE_COVER, /* occlusion: connected cells in front of the face, the holes beside
                    them, and one cell around */
    SHAPE_APART  /* not explained, and no cover: behind the fitted face, or strays */
};

#define SHAPE_EYE_UNKNOWN 0.0

struct shape_fit {
    struct pose pose;      /* points -> canonical frame, mm, shrunk by size */
    double size;           /* size of the head, over the mean face's */
    double a[MODEL_MODES]; /* coefficients of the modes */
    float height[GRID_N];  /* height of the fitted face, mm; NAN off it */
    float z[GRID_N];       /* height of the points, mm; NAN: none */
    uint8_t cell[GRID_N];  /* enum shape_cell */
    /* root mean square of what the fit leaves of the cells with points that nothing covers, each
     * up to SHAPE_RESIDUAL_MM */
    double residual_mm;
    uint32_t skin, cover, apart; /* cells of each kind */
    double worth; /* fit score, for the choice among fits to the same points (shape.h) */
    double explained; /* worth, and the part that an occlusion explains, in cells */
    double support; /* S, at most 1: (cells within SHAPE_NEAR_MM - 2 cells behind the face
                        - 4 |a|^2) / cells of the mean face */
    /* the lesser of two: the likeness of the surface around an eye to the mean
     * face's.  If less than SHAPE_EYE_LEAST of it is skin: SHAPE_EYE_UNKNOWN if the other is
     * like an eye, else -1 */
    double eyes;
    /* the likeness of the forehead to the fitted one; -1, as for the eyes */
    double forehead;
    double detail; /* fine relief, as a multiple of the mean face's (shape_detail()) */
    /* ln of the relief of the skin over the residual, both root mean squares */
    double likeness;
};

/* Ready to fit, and a worker's reusable memory.  One thread at a time. */
struct shape_work {
    uint32_t cells;     /* number of cells of the mean face */
    float mean[GRID_N]; /* mm; NAN: the cell is not used */
    float normal[GRID_N]
                [3]; /* normals of the mean face; normal[i][2] scales heights to gaps */
    float scale[GRID_N];      /* each cell's rest over the mean of all */
    float over_rest[GRID_N];  /* SHAPE_REST_TYPICAL_MM over it, less for a small one */
    float fine[GRID_N];       /* the mean face's fine relief, mm; 0: none */
    struct shape_basis basis; /* the modes and the motions, prepared */
    const struct model_basis *modes; /* the model's modes of heights */
    struct scratch points, solve;
};

/* shape_work_prepare(m, out): Prepares fits by m, which is borrowed.  *out must not move. */
void shape_work_prepare(const struct surface_model *m, struct shape_work *out);
void shape_work_free(struct shape_work *w);
void shape_work_wipe(struct shape_work *w, size_t keep); /* as measure_work_wipe() */

#endif
