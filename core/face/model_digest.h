/* model_digest.h -- identifiers of models (model.h). */
#ifndef CORE_MODEL_DIGEST_H
#define CORE_MODEL_DIGEST_H
#include <stdint.h>

struct surface_model;

/* model_mean_id(m): Identifies m's mean face, and with it the canonical frames that were
 * found by that mean face.  Never 0. */
uint32_t model_mean_id(const struct surface_model *m);

/* model_digest(m): Identifies m: FNV-1a (64 bits) over everything that a score depends on,
 * which is all but the name and the calibration.  About 1 ms; for model_default only the
 * first time. */
uint64_t model_digest(const struct surface_model *m);

#endif
