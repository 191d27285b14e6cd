/* find_nose.h -- places of a cloud that stick out as the tip of a nose does.  Internal to
 * find.h. */
#ifndef SCAN_FIND_NOSE_H
#define SCAN_FIND_NOSE_H
#include <stdint.h>
#include "status.h"

struct find_grid; /* find_grid.h */

struct find_nose {
    float at[3];   /* mm from the grid's corner */
    float axis[3]; /* of length 1: outwards, from the centroid of what is around it */
    float out_mm;  /* how far it sticks out */
};

/* find_nose_all(g, most, out, n): those that stick out most, at most so many, the farthest
 * first.  Cost: linear in the cells and voxels of g.  Returns ST_OK, ST_ENOMEM. */
enum status find_nose_all(const struct find_grid *g, uint32_t most, struct find_nose *out,
                          uint32_t *n);

#endif
