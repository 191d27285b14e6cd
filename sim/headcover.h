/* headcover.h -- simulated covers of a face, drawn by the seed. */
#ifndef SIM_HEADCOVER_H
#define SIM_HEADCOVER_H
#include <stdbool.h>
#include <stdint.h>
#include "head.h"

enum headcover {
    HEADCOVER_NONE,
    HEADCOVER_GLASSES, /* rim, bridge, temples; the lenses reflect, or nothing comes back */
    HEADCOVER_MASK,    /* taut over nose, mouth and chin; with pleats, or a ridge */
    HEADCOVER_SCARF,   /* over mouth or chin and neck, in folds */
    HEADCOVER_HAND,    /* on one cheek: palm, four fingers, the wrist */
    HEADCOVER_FRINGE, /* hair over the forehead, often to one side; half of it lost */
    HEADCOVER_BEARD,
    HEADCOVER_CAP, /* over the skull to the brow, with a peak */
    HEADCOVERS
};

/* headcover_add(h, kind, seed, one_layer): Appends the points of a cover to h, HEAD_COVER_MM apart.
 * h          in the canonical frame, its spacing measured
 * one_layer  as in headview_make(): of a frontal crop, beyond which nothing is added */
void headcover_add(struct head *h, enum headcover kind, uint64_t seed, bool one_layer);

#endif
