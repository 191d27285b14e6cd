/* decision.h -- from a disparity in millimetres to a decision, and what it is worth.
 * Every constant was learned from simulated scans; how, and what they reach on other
 * subjects: docs/decision.md.  The owner's own scans are a better teacher. */
#ifndef CORE_DECISION_H
#define CORE_DECISION_H

/* Default threshold: about one impostor in 1,000 has a disparity at or below it. */
extern const double decision_threshold_mm;

/* A comparison over less than this share of the template's measured area, or of its weight
 * (weight.h), says nothing. */
extern const double decision_min_overlap;

/* decision_fmr(disparity_mm): the share of impostor comparisons with a disparity at or
 * below disparity_mm (false match rate), 0..1: a table of quantiles, straight between them;
 * monotone.  Below 0.05 % the tail is an extrapolation.  NaN gives 1. */
double decision_fmr(double disparity_mm);

#endif
