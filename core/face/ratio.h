/* ratio.h -- the score that decides: the logarithm of a likelihood ratio, how much more likely
 * two scans are of one person than of two.
 * Each scan enters by its encoding A, b (encode.h).  Of one person both share the identity y,
 * of two people each has its own, y and y', which are as alike as people of one population
 * are: of correlation rho (the model's kinship), since impostors are mostly of the same sex,
 * age and ancestry.  With evidence(M, b) = (b' M^-1 b - ln det M) / 2,
 *     score = evidence(I + A + A', b + b')
 *             - evidence([[A + cI, -rho cI], [-rho cI, A' + cI]], [b, b'])
 *             + d/2 ln(1 - rho^2),   c = 1 / (1 - rho^2).
 * (Kenny, "Bayesian Speaker Verification with Heavy-Tailed Priors", Odyssey 2010, for rho 0.)
 * In doubles, by + - * / and sqrt alone; the logarithm is our own: the same digits everywhere. */
#ifndef CORE_RATIO_H
#define CORE_RATIO_H
#include "encode.h"
#include "mem.h"

#define RATIO_MOST 9999.0

/* The part that depends on the probe only, to compare it with many templates. */
struct ratio_probe;

/* ratio_probe(p, rho, s): Prepares the encoding p, which is borrowed.  The result is in s, and valid
 * until s is used again.
 * Cost: O(n^3), n modes: 0.15 ms.
 * Returns NULL if out of memory. */
struct ratio_probe *ratio_probe(const struct encoding *p, double rho, struct scratch *s);

/* ratio_score(r, t, expected): Returns the score of the probe against the encoding t; symmetric up to
 * rounding; about -100 to 60, always between -RATIO_MOST and RATIO_MOST; -RATIO_MOST also if t
 * is damaged (not positive definite).
 *   expected  receives the mean score of two such scans of one person (exact with rho 0)
 * Both are 0 if an encoding has no modes (n = 0) or another number of them.
 * Cost: two Cholesky factors, 0.1 ms. */
double ratio_score(struct ratio_probe *r, const struct encoding *t, double *expected);

/* ratio_slopes(r, t, tmpl, probe): Computes the derivatives of the score by b of t and of the probe.
 * The score is expected + (b_t' tmpl + b_probe' probe) / 2.  Returns the score. */
double ratio_slopes(struct ratio_probe *r, const struct encoding *t,
                    double tmpl[MODEL_MODES], double probe[MODEL_MODES]);

/* ratio_half_ln_det(h, stride, n): Returns half of ln det of the n x n matrix whose factor (lsq_factor()) is h: the
 * sum of the logarithms of the diagonal, as the logarithm of a product that is kept in range. */
double ratio_half_ln_det(const double *h, uint32_t stride, uint32_t n);

#endif
