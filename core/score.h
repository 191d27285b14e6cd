/* score.h -- the disparity that decides, from the gap per cell.
 * What the model knows of change within a person is fitted to the gap and taken out
 * (fit.h); of what is left, the capped amount is averaged with the learned weight u:
 *     amount(r) = sum u min(|r|, cap) / sum u      over the covered cells
 *     disparity = amount(rest) - SCORE_ROUGH amount(rest - blurred rest), or 0 below that.
 * The second term is the pair's own roughness, what changes from cell to cell: noise of the
 * sensors and of the sampling, which is no shape; so one threshold serves several scanners.
 * The less of the weight is covered, the better the modes explain anything: below
 * SCORE_WHOLE the disparity of all is raised, by SCORE_THIN for all of it, so that one
 * threshold serves parts of faces too.
 * The cap keeps one bad place from outvoting the face.
 * Figures: docs/accuracy.md. */
#ifndef CORE_SCORE_H
#define CORE_SCORE_H
#include "cells.h"
#include "fit.h"
#include "grid.h"
#include "model.h"

struct score {
    double mm;
    double weight;    /* share of a whole face's weight that was covered, 0..1 */
    double change_mm; /* root mean square of what was taken out */
    double region_mm[GRID_REGIONS]; /* the same disparity of each region alone; NAN where
                                       less than a third of its cells is covered */
    double region_weight[GRID_REGIONS]; /* of the region's weight in a whole face, 0..1 */
};

/* score_of(m, change, c, s, fit, out): change is fit_prepare() of m->change; fit receives
 * the change and the rest.  Returns ST_OK, ST_ENOMEM. */
enum status score_of(const struct model *m, const struct fit_basis *change,
                     const struct cells *c, struct scratch *s, struct fit *fit,
                     struct score *out);

/* score_cells(m, c, fit, s, out): what score_of() averaged, from its own results: s is
 * their score.  The sum of weight is 1 (0 where nothing is covered), and the sum of
 * weight times local_mm is the disparity, which is 0 where that sum is negative. */
struct score_cells {
    float weight[GRID_N];   /* the cell's share of the covered weight, 0..1 */
    float local_mm[GRID_N]; /* its own disparity; below 0 where it is roughness alone */
};
void score_cells(const struct model *m, const struct cells *c, const struct fit *fit,
                 const struct score *s, struct score_cells *out);

#endif
