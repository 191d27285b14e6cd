/* object.h -- things that are no faces, and simulated scans of them: what the gate has to
 * refuse.  Everything follows from kind and seed. */
#ifndef SIM_OBJECT_H
#define SIM_OBJECT_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

enum object {
    OBJECT_CONE, /* from its point */
    OBJECT_BOTTLE,
    OBJECT_TEAPOT,
    OBJECT_VASE,
    OBJECT_FIST,
    OBJECT_FOOT,
    OBJECT_HEAD, /* from behind */
    OBJECT_COW,
    OBJECT_EGG, /* with a ridge */
    OBJECT_TWO_FACES,
    OBJECT_SIDES_SWAPPED, /* a face */
    OBJECT_KINDS
};

/* object_scan(kind, seed, points, out): the points, mm, that a scanner looking along -z sees
 * of a thing of this kind, of the size of a hand to that of a head with neck, turned by a few
 * degrees, with a scanner's noise.  out has room for `points`.  Returns how many: most or
 * all of them. */
size_t object_scan(uint32_t kind, uint64_t seed, uint32_t points, struct dvec3 *out);

#endif
