/* decision.h -- the calibration: a threshold for the score, and false match rates. */
#ifndef CORE_DECISION_H
#define CORE_DECISION_H
#include <stdbool.h>
#include <stdint.h>

#define DECISION_KNOTS 32

/* Learned from non-mated comparisons (docs/decision.md). */
struct decision {
    double threshold_mm; /* a score at or below it is a match */
    double halving_mm;   /* below the first knot the rate halves every halving_mm */
    uint32_t n;          /* knots, 2..DECISION_KNOTS; both columns strictly rising */
    struct decision_knot {
        double mm,
            rate; /* the share (0..1) of non-mated scores at or below mm; the last is 1 */
    } knot[DECISION_KNOTS];
};

/* decision_valid(d): are all numbers finite and positive, both columns rising, the last rate
 * 1?  To check what comes from a file or a database. */
bool decision_valid(const struct decision *d);

/* decision_fmr(d, score_mm): the false match rate at a threshold of score_mm, 0..1: linear
 * between the knots, extrapolated below the first; monotone.  NaN gives 1. */
double decision_fmr(const struct decision *d, double score_mm);

#endif
