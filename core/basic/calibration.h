/* calibration.h -- from a score to a decision: the threshold, and the false match rate at any
 * score. */
#ifndef CORE_CALIBRATION_H
#define CORE_CALIBRATION_H
#include <stdbool.h>
#include "libsurface.h"

/* calibration_valid(c): is it as above, its numbers finite, its scores between -1e4 and 1e4?
 * To check what comes from a file or a database. */
bool calibration_valid(const struct surface_calibration *c);

/* calibration_fmr(c, score): the false match rate at a threshold of score: 1 below the first
 * knot, linear between the knots, and from the last one on that one's: never below what the
 * non-mated comparisons support.  Monotone.  NAN gives 1. */
double calibration_fmr(const struct surface_calibration *c, double score);

#endif
