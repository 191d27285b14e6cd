/* verdict.h -- what a decision is called. */
#ifndef VERIFY_VERDICT_H
#define VERIFY_VERDICT_H
#include "face.h"

/* verdict_decision(d): "match", "no_match", "inconclusive". */
const char *verdict_decision(enum face_decision d);

#endif
