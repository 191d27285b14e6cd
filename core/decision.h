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
    double score_mm;
    double part_mm;  /* the lowest score of a part of the face alone (score.h); INFINITY:
                          none, or not asked for (decision_open()) */
    double noise_mm; /* white noise of both scans: the root of the sum of their squares */
    double rough_mm; /* the pair's roughness (score.h) */
    double hidden;   /* share of the probe's face that was not seen (face.h), 0..1 */
};

/* decision_terms(t, p): how a calibration's threshold t applies to the pair.
 * Noise beyond that of ordinary scans adds to everybody's score, strangers' too: the threshold
 *     rises with the noise that the scans are said to have, as far as the pair is rough as such
 *     noise makes it; so noise that cells average out gains nothing.
 * The less of a face is seen, the more people have what is seen in common: the threshold falls
 *     with what is hidden.  As what covers a face may have been taken for a part of it, a score
 *     above it need not be a non-match.
 * An unseen expression moves one part of a face more than the other: where the score is above
 *     the threshold, but not far, and that of a part alone well below, the threshold rises.
 * docs/decision.md, "Noise", "Hidden faces", "Expressions". */
struct decision_terms {
    double threshold_mm; /* a score at or below it is a match */
    double doubt_mm; /* one above it by no more than this is inconclusive; 0 or above */
    double rise_mm, factor; /* the score s is max(0, (s - rise_mm) / factor) on the
                               calibration's scale; factor 0: t, whatever it is */
    /* the score on the calibration's scale: at most t for a match */
    double calibrated_mm;
};
struct decision_terms decision_terms(double t, const struct decision_pair *p);

/* decision_open(t, p): do the terms depend on p->part_mm?  It need not be known otherwise. */
bool decision_open(double t, const struct decision_pair *p);

#endif
