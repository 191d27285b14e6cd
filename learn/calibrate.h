/* calibrate.h -- a calibration (calibration.h) from non-mated comparisons. */
#ifndef LEARN_CALIBRATE_H
#define LEARN_CALIBRATE_H
#include <stdint.h>
#include "status.h"

struct calibration; /* calibration.h */
struct rates;       /* rates.h */

/* calibrate_learn(r, fmr, c): the calibration from r's non-mated scores.  The threshold is the
 * smallest score with a false match rate of at most fmr.  The knots are the threshold and
 * quantiles that rest on five comparisons or more each.
 * Returns ST_OK; ST_ETOOFEW too few comparisons for the rate (rule of 3). */
enum status calibrate_learn(const struct rates *r, double fmr, struct calibration *c);

/* calibrate_subjects(fmr): the number of subjects, with a template each, that have as many
 * pairs as the rule of 3 asks for.  Both comparisons of a pair count once: they are nearly
 * the same. */
uint32_t calibrate_subjects(double fmr);

#endif
