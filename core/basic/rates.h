/* rates.h -- error rates of comparisons, with their uncertainty.
 * A comparison matches at a threshold if its score is at or above it (a higher score: more
 * alike).  The score -INFINITY never matches: a scan was refused.  Terms as in
 * ISO/IEC 19795-1: FMR, the share of non-mated (impostor) comparisons that match; FNMR, the
 * share of mated (genuine) comparisons that do not; TAR = 1 - FNMR; EER, the rate at which both are equal. */
#ifndef CORE_RATES_H
#define CORE_RATES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "surface_basic.h"

struct rates_score {
    double score;             /* any sign, -INFINITY; never NaN or INFINITY */
    uint32_t template, probe; /* numbers of the subjects; equal: a genuine comparison */
};

/* Rule of 3: after n independent comparisons without an error the rate is below 3 / n with
 * 95 % confidence, so n comparisons support no smaller rate. */
double rates_least(size_t n);                /* 3 / n, INFINITY for n = 0 */
bool rates_supported(double rate, size_t n); /* rate >= 3 / n */
size_t rates_needed(double rate);            /* the n that supports 0 < rate <= 1 */

#define RATES_TARGETS 3
extern const double rates_target[RATES_TARGETS]; /* FMR: 0.01, 0.001, 0.0001 */

/* Figures of comparisons.  A rate of no comparisons is NaN.  rates_supported() tells which can be
 * stated. */
struct rates_figures {
    double
        eer; /* linear between the two scores at the crossing; if more genuine scores are
                   -INFINITY, the least FNMR */
    double tar[RATES_TARGETS]; /* at tar_score */
    double tar_score
        [RATES_TARGETS]; /* smallest score that keeps the FMR at the target; INFINITY: none */
    double fmr, fnmr; /* at the given threshold */
    double at; /* smallest score that keeps the FMR at the given one; INFINITY: none */
};

struct rates;

/* rates_new(s, n, nsubject, out): Sorts n comparisons (copied) of subjects 0..nsubject-1.
 *   out  to be released by rates_free(); NULL on error
 * Cost: O(n log n).
 * Returns ST_OK; ST_EINVAL: a NaN, or a subject out of range; ST_ENOMEM. */
enum status rates_new(const struct rates_score *s, size_t n, uint32_t nsubject,
                      struct rates **out);

/* rates_new_tail(s, n, probes, nsubject, out): Like rates_new(), for the non-mated comparisons of each subject with all
 * probes of the others, of which only those with the highest scores are given.
 *   probes  [nsubject] number of probes of each
 * Of the result only rates_nimpostor(), and rates_fmr() and rates_extend() at the scores given, are of use. */
enum status rates_new_tail(const struct rates_score *s, size_t n, const uint32_t *probes,
                           uint32_t nsubject, struct rates **out);

void rates_free(struct rates *r); /* NULL is allowed */
size_t rates_ngenuine(const struct rates *r);
size_t rates_nimpostor(const struct rates *r);

/* rates_people(r, out): Counts the subjects with a mated comparison.  Cost: O(n).  Returns ST_OK, ST_ENOMEM. */
enum status rates_people(const struct rates *r, uint32_t *out);

/* rates_fmr(r, score): Returns the FMR at a threshold.  Cost: O(log n). */
double rates_fmr(const struct rates *r, double score);

/* rates_fnmr(r, score): Returns the FNMR at a threshold.  Cost: O(log n). */
double rates_fnmr(const struct rates *r, double score);

/* rates_at(r, fmr): Returns the smallest score at which the FMR is at most fmr; INFINITY: none.
 * Equal scores match together.  Cost: O(log n). */
double rates_at(const struct rates *r, double fmr);

/* rates_figures(r, threshold, out): Computes all figures but at.  Cost: O(n). */
void rates_figures(const struct rates *r, double threshold, struct rates_figures *out);

/* rates_bootstrap(r, threshold, at, replicates, seed, low, high): Computes 95 % intervals of all
 * figures: the 2.5 and 97.5 % quantiles over replicates, in which the *subjects* are drawn
 * with replacement.  A mated comparison counts as often as its subject was drawn, a non-mated
 * comparison as often as the product of both.  The intervals account for what scans of one person
 * have in common, not for errors that never occurred (rule of 3).
 * Deterministic in its arguments.  A replicate in which a figure has no comparisons does not
 * count for it.
 *   at  the FMR of the figure at; NAN: not wanted
 * Cost: O(replicates n).
 * Returns ST_OK; ST_EINVAL: no replicates; ST_ENOMEM. */
#define RATES_REPLICATES 1000
enum status rates_bootstrap(const struct rates *r, double threshold, double at,
                            unsigned replicates, uint64_t seed, struct rates_figures *low,
                            struct rates_figures *high);

/* rates_bootstrap_det(r, fmr, m, replicates, seed, low, high): Computes 95 % intervals of the FNMR at the smallest
 * score that keeps the FMR at each of m rising rates, by the replicates of rates_bootstrap().
 *   low, high  [m]; NAN where there is no comparison
 * Cost: O(replicates (n + m)).
 * Returns ST_OK; ST_EINVAL: no replicates; ST_ENOMEM. */
enum status rates_bootstrap_det(const struct rates *r, const double *fmr, size_t m,
                                unsigned replicates, uint64_t seed, double *low,
                                double *high);

/* rates_random(state): Returns the next number of splitmix64, on every machine the same. */
uint64_t rates_random(uint64_t *state);

/* rates_below(state, n): Returns a number uniform on 0..n-1; n > 0. */
uint32_t rates_below(uint64_t *state, uint32_t n);

/* rates_calibrate(r, fmr, c): Computes the calibration from the non-mated scores of r.  The threshold is the
 * smallest score with a false match rate of at most fmr.  The knots are the threshold and
 * quantiles that rest on five comparisons or more each.
 * Returns ST_OK; ST_ETOOFEW: too few comparisons for the rate (rule of 3). */
enum status rates_calibrate(const struct rates *r, double fmr,
                            struct surface_calibration *c);

/* rates_extend(r, pairs, seed, c): Continues the table of rates_calibrate() beyond the threshold, to the least rate
 * that so many pairs of people support (rule of 3).  Few comparisons score that high, so a knot's rate is
 * the upper end of its 95 % interval (rates_bootstrap()).  The last knot lies just above the highest score and
 * has the least rate.  Identifications need these rates.  The threshold and the knots up to it do not
 * change.
 *   r      that of rates_calibrate(), or then one by rates_new_tail() of more people: its knots take the place of those
 *          beyond its lowest score
 *   pairs  that were compared; both comparisons of a pair count once
 * Cost: O(RATES_REPLICATES n).
 * Returns ST_OK, ST_ENOMEM. */
enum status rates_extend(const struct rates *r, size_t pairs, uint64_t seed,
                         struct surface_calibration *c);

/* rates_subjects(fmr): Returns the number of subjects, with a template each, that have as many
 * pairs as the rule of 3 asks for.  Both comparisons of a pair count once: they are nearly
 * the same. */
uint32_t rates_subjects(double fmr);

#endif
