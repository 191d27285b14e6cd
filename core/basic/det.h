/* det.h -- the detection error trade-off (DET) of a population: the FNMR at each FMR (rates.h), with its uncertainty. */
#ifndef CORE_DET_H
#define CORE_DET_H
#include <stdbool.h>
#include <stdint.h>
#include "rates.h"

#define DET_POINTS 15
#define DET_PEOPLE 30 /* with fewer people no FNMR below 10 % is supported (rule of 3) */

struct det_point {
    double score;     /* the threshold */
    double fmr, fnmr; /* 0..1 */
    /* 95 % interval of the FNMR, over people; high is not below the least rate that so many people support */
    double low, high;
};

struct det {
    uint32_t people;               /* number of people with a mated comparison */
    uint32_t n;                    /* points; 0: fewer people than DET_PEOPLE */
    struct det_point own, shipped; /* at these thresholds; unset if n is 0 */
    /* By rising score; fmr is the one that is kept: 0.5, 0.2, 0.1, 0.05, ... as far as the pairs support it. */
    struct det_point point[DET_POINTS];
};

/* det_learn(r, pairs, own, shipped, seed, out): Computes the DET of the comparisons of r.
 *   pairs         of people that were compared
 *   own, shipped  thresholds
 * Cost: that of three rates_bootstrap().
 * Returns ST_OK, ST_ENOMEM. */
enum status det_learn(const struct rates *r, size_t pairs, double own, double shipped,
                      uint64_t seed, struct det *out);

/* det_valid(d): Returns true if the members are as described above. */
bool det_valid(const struct det *d);

#endif
