/* model_digest.h -- what tells models (model.h) apart. */
#ifndef CORE_MODEL_DIGEST_H
#define CORE_MODEL_DIGEST_H
#include <stdint.h>

struct model;

/* model_mean_id(m): a number for m's mean face: a canonical frame belongs to the mean face
 * that it was found by.  Never 0. */
uint32_t model_mean_id(const struct model *m);

/* model_digest(m): what tells models apart: FNV-1a (64 bits) over all that a disparity
 * depends on, which is everything but the name and the calibration.  About 1 ms; of
 * model_default the first time only. */
uint64_t model_digest(const struct model *m);

#endif
