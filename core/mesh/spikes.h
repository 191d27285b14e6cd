/* spikes.h -- single points that a scanner put far off the surface. */
#ifndef CORE_SPIKES_H
#define CORE_SPIKES_H
#include <stdint.h>
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* spikes_flatten(m, s, count): Sets the height of each spike to the plane through its
 * neighbours that are no spikes, or to their median if the plane leads beyond their heights.
 * The surface is then about the same as without these points, and need not be
 * triangulated again.  A spike lies above, or below, three quarters of its neighbours by more
 * than 1 mm and 45 degrees; one of them is its neighbour in the spanning tree, so that few
 * points need a full test.
 *   count  receives the number of heights changed
 * Cost: O(m->nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status spikes_flatten(struct mesh *m, struct scratch *s, uint32_t *count);

#endif
