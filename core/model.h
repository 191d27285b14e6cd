/* model.h -- what was learned from many faces: everything a comparison knows about people
 * that is not in the two scans.  Shipped as a table (core/default.model), relearned from an
 * owner's scans by `surfacectl train`. */
#ifndef CORE_MODEL_H
#define CORE_MODEL_H
#include "decision.h"

struct model {
    struct decision decision; /* the calibration that belongs to it */
};

extern const struct model model_default;

#endif
