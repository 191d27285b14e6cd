/* find_refine.h -- a pose moved to where the mean face fits the points best.  Internal to
 * find.h. */
#ifndef SCAN_FIND_REFINE_H
#define SCAN_FIND_REFINE_H
#include <stdbool.h>
#include <stdint.h>
#include "align_pose.h"
#include "find_near.h"
#include "grid.h"

struct frame_mean; /* frame.h */

/* The voxels near the mean face, and the foremost one over each of its cells. */
struct find_front {
    uint32_t n;
    float at[3][FIND_NEAR_MAX];    /* mm from the place */
    float moved[3][FIND_NEAR_MAX]; /* canonical frame */
    uint32_t points[FIND_NEAR_MAX];
    float gap[GRID_N];      /* at right angles to the mean face, mm */
    uint32_t voxel[GRID_N]; /* the foremost, where there is a gap */
};

struct find_fit {
    struct align_pose pose;        /* mm from the place -> canonical frame */
    double key, likeness, covered; /* as in find.h */
    uint64_t points;               /* on the face */
};

/* find_refine(mean, near, fine, f, fit): from fit->pose; point-to-plane steps of the foremost
 * voxels to the mean face, each cell once, with Tukey's weights: what is in front counts less
 * far than what is behind, since it may cover the face.  Coarse: within FIND_TUKEY_COARSE_MM,
 * with half of the voxels and cells; fine: within FIND_TUKEY_FINE_MM.  Then the rest of fit at
 * the pose found.  f: room to work in. */
void find_refine(const struct frame_mean *mean, const struct find_near *near, bool fine,
                 struct find_front *f, struct find_fit *fit);

#endif
