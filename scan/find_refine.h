/* find_refine.h -- a pose moved to where the mean face fits the points best.  Internal to
 * find.h. */
#ifndef SCAN_FIND_REFINE_H
#define SCAN_FIND_REFINE_H
#include <stdint.h>
#include "align_pose.h"

struct find_near;  /* find_near.h */
struct frame_mean; /* frame.h */

struct find_fit {
    struct align_pose pose; /* mm from the place -> canonical frame */
    double key, likeness, covered;
};

/* find_refine(mean, near, fit): from fit->pose; point-to-plane steps of the foremost voxels,
 * each cell once, with Tukey's weights from coarse to fine.  find_refine_judge(): the rest of
 * fit at its pose. */
void find_refine(const struct frame_mean *mean, const struct find_near *near,
                 struct find_fit *fit);

#endif
