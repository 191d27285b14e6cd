/* spikes.h -- points that a scanner put off the surface. */
#ifndef CORE_SPIKES_H
#define CORE_SPIKES_H
#include "status.h"

struct mesh;    /* mesh.h */
struct scratch; /* mem.h */

/* spikes_flatten(m, s): find the points that stand out of the surface alone, and lay each
 * on the median height of its neighbours that do not: the surface then runs as if they had
 * been left out, without triangulating again.  A point stands out when it differs in height
 * by more than 1 mm and 45 degrees from three quarters of its neighbours, all to one side,
 * one of them its neighbour in the spanning tree (so that few points are looked at).
 * O(m->nv).  Returns ST_OK, ST_ENOMEM. */
enum status spikes_flatten(struct mesh *m, struct scratch *s);

#endif
