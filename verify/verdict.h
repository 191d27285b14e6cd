/* verdict.h -- what a decision is called, and how often chance brings a score. */
#ifndef VERIFY_VERDICT_H
#define VERIFY_VERDICT_H
#include <stdint.h>
#include "face.h"

/* verdict_decision(d): "match", "no_match", "inconclusive". */
const char *verdict_decision(enum face_decision d);

/* verdict_fmr(r, n): the false match rate at r's score where it is the best of n templates': that
 * at least one of n independent comparisons scores as high.  n > 0. */
double verdict_fmr(const struct face_result *r, uint32_t n);

#endif
