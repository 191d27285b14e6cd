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
#include "status.h"

#define RATIO_MOST 9999.0

/* What depends on the probe alone: computed once, to compare it with many templates. */
struct ratio_probe;

/* ratio_probe(p, rho, s): prepares p, which is borrowed.  The result is in s, and valid until s is
 * used again.  NULL: out of memory.  O(n^3), n modes: 0.15 ms.
 * ratio_score(r, t, expected): the score of the probe against the encoding t; symmetric but for
 * rounding; about -100 to 60, always between -RATIO_MOST and RATIO_MOST; -RATIO_MOST also where t
 * is damaged (not positive definite).  Two Cholesky factors: 0.1 ms.
 * expected  the mean score of two such scans of one person (exact with rho 0): how much they can
 *           tell at all
 * Both are 0 where an encoding has no modes (n = 0) or another number of them. */
struct ratio_probe *ratio_probe(const struct encoding *p, double rho, struct scratch *s);
double ratio_score(struct ratio_probe *r, const struct encoding *t, double *expected);

/* ratio_slopes(r, t, tmpl, probe): the derivatives of the score by b of t and of the probe.
 * The score is expected + (b_t' tmpl + b_probe' probe) / 2.  Returns the score. */
double ratio_slopes(struct ratio_probe *r, const struct encoding *t,
                    double tmpl[MODEL_MODES], double probe[MODEL_MODES]);

/* ratio_ln(x): the natural logarithm of a positive, finite x; to 1e-15 of its size or better. */
double ratio_ln(double x);

#endif
