/* decision.h -- the calibration: a threshold for the score, and false match rates; and how far
 * the threshold depends on what is compared. */
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

/* What a comparison's threshold depends on. */
struct decision_pair {
    double noise_mm; /* white noise of both scans: the root of the sum of their squares */
    double rough_mm; /* the pair's roughness (score.h) */
    double hidden;   /* share of the probe's face that was not seen (face.h), 0..1 */
};

/* How the calibration's threshold t applies to the pair:
 *     match     where the score is at most factor t + rise_mm
 *     no match  where it is above that by more than doubt t; between them it is inconclusive.
 * factor, doubt  1 and 0 for a probe that shows the face.  The less is seen, the more people
 *     have what is seen in common: a lower threshold keeps the rate of false matches.  As what
 *     covers a face may have been taken for a part of it, a score above it need not be a
 *     non-match.
 * rise_mm  0 for ordinary scans: what noise beyond theirs adds to everybody's score, strangers'
 *     too, so that the rate stays.  It rises with the noise that the scans are said to have,
 *     as far as the pair is rough as such noise makes it: so noise that cells average out
 *     gains nothing.
 * docs/decision.md, "Noise", "Hidden faces". */
struct decision_terms {
    double factor, rise_mm, doubt;
};
struct decision_terms decision_terms(const struct decision_pair *p);

#endif
