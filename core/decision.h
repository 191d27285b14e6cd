/* decision.h -- from a disparity in millimetres to a decision, and what it is worth. */
#ifndef CORE_DECISION_H
#define CORE_DECISION_H
#include <stdbool.h>
#include <stdint.h>

#define DECISION_KNOTS 32

/* A calibration: learned from comparisons of different people (docs/decision.md). */
struct decision {
    double threshold_mm; /* at or below it: a match */
    double halving_mm;   /* below the first knot the rate halves with each of these */
    uint32_t n;          /* knots, 2..DECISION_KNOTS; both columns strictly rising */
    struct decision_knot {
        double mm, rate; /* the share (0..1) of impostors at or below mm; the last is 1 */
    } knot[DECISION_KNOTS];
};

/* decision_valid(d): finite, positive, rising, the last rate 1: for what comes from a file
 * or a database. */
bool decision_valid(const struct decision *d);

/* decision_fmr(d, score_mm): the share of impostor comparisons with a disparity at or
 * below score_mm (false match rate), 0..1: straight lines between the knots; monotone.
 * Below the first knot it is an extrapolation.  NaN gives 1. */
double decision_fmr(const struct decision *d, double score_mm);

#endif
