/* rates.h -- error rates of comparisons, and how well they are known.
 * A comparison is accepted at a threshold when its score is at or below it (a disparity:
 * the smaller the more alike).  INFINITY, for one that says nothing (inconclusive), is never
 * accepted.  Terms as in ISO/IEC 19795-1: FMR, the share of impostor comparisons accepted;
 * FNMR, the share of genuine ones refused; TAR = 1 - FNMR; EER, where both are equal. */
#ifndef LEARN_RATES_H
#define LEARN_RATES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct rates_score {
    double mm;                /* 0 or above, INFINITY; never NaN */
    uint32_t template, probe; /* whose; the same subject: a genuine comparison */
};

/* Rule of 3: of n independent comparisons without an error, the rate is below 3 / n with
 * 95 % confidence; so no smaller rate can be stated, nor a threshold for one be chosen.
 * rates_least(n) is 3 / n, INFINITY for none; rates_needed(rate) the n that support it. */
double rates_least(size_t n);
bool rates_supported(double rate, size_t n); /* rate >= 3 / n */
size_t rates_needed(double rate);            /* 0 < rate <= 1 */

#define RATES_TARGETS 3
extern const double rates_target[RATES_TARGETS]; /* FMR: 0.01, 0.001, 0.0001 */

/* Rates that rest on nothing are NaN.  What the number of comparisons supports is for the
 * caller to ask. */
struct rates_figures {
    double eer,
        eer_mm; /* linear between the scores round the crossing, of which eer_mm is
                           the larger one; where more is inconclusive, the least FNMR */
    double tar[RATES_TARGETS]; /* at the largest score that keeps the FMR at the target */
    double tar_mm[RATES_TARGETS]; /* that score; -1: none does */
    double fmr, fnmr;             /* at the given threshold */
};

struct rates;

/* rates_new(s, n, nsubject, out): sort n comparisons (copied) of subjects 0..nsubject-1.
 * out  released by rates_free(); NULL on error.  O(n log n).
 * Returns ST_OK, ST_EINVAL (a NaN, a subject out of range), ST_ENOMEM. */
enum status rates_new(const struct rates_score *s, size_t n, uint32_t nsubject,
                      struct rates **out);
void rates_free(struct rates *r); /* NULL is allowed */
size_t rates_ngenuine(const struct rates *r);
size_t rates_nimpostor(const struct rates *r);

/* rates_fmr(r, mm), rates_fnmr(r, mm): at a threshold; O(log n). */
double rates_fmr(const struct rates *r, double mm);
double rates_fnmr(const struct rates *r, double mm);

/* rates_at(r, fmr): the largest score of any comparison, not INFINITY, at which the FMR is
 * at most that; -1 where there is none; O(n log n).  Of tied scores all are accepted or none. */
double rates_at(const struct rates *r, double fmr);

/* rates_figures(r, threshold_mm, out): O(n). */
void rates_figures(const struct rates *r, double threshold_mm, struct rates_figures *out);

/* rates_bootstrap(r, threshold_mm, replicates, seed, low, high): 95 % intervals of the
 * figures, the 2.5 and 97.5 per cent points over replicates in which the *subjects* are
 * drawn with replacement: a genuine comparison counts as often as its subject was drawn,
 * an impostor comparison as often as the one times as often as the other.  What one
 * person's scans have in common is so accounted for; what the errors never seen could be
 * is not: see the rule of 3.  eer_mm and tar_mm are bounded too.
 * Deterministic in its arguments; replicates where a figure rests on nothing are left out.
 * Cost  replicates x O(n).  Returns ST_OK, ST_EINVAL (no replicates), ST_ENOMEM. */
#define RATES_REPLICATES 1000
enum status rates_bootstrap(const struct rates *r, double threshold_mm,
                            unsigned replicates, uint64_t seed, struct rates_figures *low,
                            struct rates_figures *high);

/* rates_at_bootstrap(r, fmr, replicates, seed, low, high): the same interval of
 * rates_at(r, fmr), with the same draws; a bound is -1 where no score keeps the rate. */
enum status rates_at_bootstrap(const struct rates *r, double fmr, unsigned replicates,
                               uint64_t seed, double *low, double *high);

/* rates_random(state): splitmix64, for sampling that is the same everywhere. */
uint64_t rates_random(uint64_t *state);
/* rates_below(state, n): a number 0..n-1, each as likely; n > 0. */
uint32_t rates_below(uint64_t *state, uint32_t n);

#endif
