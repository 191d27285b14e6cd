/* population_scans.h -- a population adapted to scans of real people. */
#ifndef LAB_POPULATION_SCANS_H
#define LAB_POPULATION_SCANS_H
#include <stddef.h>
#include "population.h"
#include "status.h"

/* A scan as gaps from a population's mean face. */
struct population_scan {
    uint32_t subject;
    float gap[GRID_N]; /* mm, free of motion; NAN: unknown */
};

/* population_scans_gap(p, z, gap): Computes the gaps of a scan from its heights z (heights.h; mm at its
 * canonical frame).  Cells more than 12 mm from the mean face count as unknown, as in encode.h.  The motion of
 * the mean face that explains most of the others (least squares) is removed.
 * Returns the number of known cells; 0 if they are too few to be of use, then all are unknown. */
uint32_t population_scans_gap(const struct population *p, const float z[GRID_N],
                              float gap[GRID_N]);

/* population_scans_share(nsubject): Returns the default weight of scans of that many subjects,
 * nsubject / (nsubject + 200). */
double population_scans_share(uint32_t nsubject);

/* population_scans_blend(p, scan, n, weight): with W, B and S for change, identity and shape,
 *     W becomes (1 - weight) W + weight E[(g - h)(g - h)'] / 2   over scans g, h of one subject,
 *     B         (1 - weight) B + weight (E[m m'] - what W brings)   over subjects' means m,
 *     S         (1 - weight) S + weight E[g g']   over scans.
 * Each pair of cells has its own weight, smaller where fewer scans show both: as if W, B and S
 * had been learned from as many more scans as the weight implies.  Each subject counts once, but
 * in W as often as it has scans, less one.
 * scan  by subjects, in any order of them
 * O(n cells^2).  Returns ST_OK, ST_ENOMEM. */
enum status population_scans_blend(struct population *p,
                                   const struct population_scan *scan, size_t n,
                                   double weight);

#endif
