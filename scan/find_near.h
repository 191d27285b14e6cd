/* find_near.h -- the voxels round a place.  Internal to find.h. */
#ifndef SCAN_FIND_NEAR_H
#define SCAN_FIND_NEAR_H
#include <stdint.h>

struct find_grid; /* find_grid.h */

#define FIND_NEAR_MAX 8192 /* a head has 4,000 */

struct find_near {
    float from[3]; /* the place, mm from the grid's corner */
    uint32_t n;
    float x[FIND_NEAR_MAX], y[FIND_NEAR_MAX], z[FIND_NEAR_MAX]; /* mm from the place */
    uint32_t points[FIND_NEAR_MAX];                             /* in each */
};

/* find_near_get(g, from, out): those within FIND_NEAR_MM of from; of more than FIND_NEAR_MAX,
 * as they are in a solid, the first. */
void find_near_get(const struct find_grid *g, const float from[3], struct find_near *out);

#endif
