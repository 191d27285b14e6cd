/* render.h -- a mesh as a scanner before it sees it: the height of its front-most surface in each
 * cell of the canonical frame (grid.h).  For morphable models, whose meshes have parts in front
 * of each other (lips, teeth, lids, eyes); heights_of() (heights.h) is for scans, which have
 * not.
 * The mesh is sampled every RENDER_MM along the frame's z, front-most first.  Slits of up to
 * RENDER_SLIT samples along y, as between lips, are bridged where both sides are of about one
 * height.  A cell's height is the mean of its 2 x 2 samples within RENDER_LAYER_MM of their
 * median; NAN where fewer than two are. */
#ifndef LAB_RENDER_H
#define LAB_RENDER_H
#include <stdint.h>
#include "grid.h"

#define RENDER_MM   (GRID_MM / 2)
#define RENDER_SLIT 3
#define RENDER_STEP_MM                                                                   \
    8.0f /* least difference of the sides of a slit that is not bridged */
#define RENDER_LAYER_MM 4.0f

struct render_mesh {
    const float *at; /* x, y, z of each vertex: mm, in the canonical frame; finite */
    const uint32_t (*corner)[3]; /* [nt] the vertices' numbers, in any order */
    uint32_t nt;
};

/* render_heights(m, out): O(nt + samples). */
void render_heights(const struct render_mesh *m, float out[GRID_N]);

#endif
