/* calibrate.h -- a threshold and its table of rates from comparisons of different people. */
#ifndef LEARN_CALIBRATE_H
#define LEARN_CALIBRATE_H
#include <stdint.h>
#include "status.h"

struct decision; /* decision.h */
struct rates;    /* rates.h */

/* calibrate_learn(r, fmr, d): the threshold and the table from comparisons of different
 * people.  The threshold is the largest score at which at most the share fmr of them is
 * accepted; the knots are quantiles that rest on five comparisons or more each, and the
 * threshold; below them the rate halves at the pace it has between the lowest ones, which
 * overstates it where the tail grows thinner, as tails do.
 * ST_ETOOFEW: too few comparisons for the rate, by the rule of 3. */
enum status calibrate_learn(const struct rates *r, double fmr, struct decision *d);

/* calibrate_subjects(fmr): how many people with a template each it takes for as many pairs
 * as the rule of 3 asks for: the two comparisons of a pair say much the same. */
uint32_t calibrate_subjects(double fmr);

#endif
