/* score.h -- the score that decides, from the gap per cell.
 * The model's modes of change within a person are fitted to the gap and taken out (fit.h).
 * The capped rest is averaged with the learned weight u over the covered cells:
 *     amount(r) = sum u min(|r|, cap) / sum u
 *     score     = amount(rest) - SCORE_ROUGH amount(rest - blurred rest), at least 0.
 * The second term is the roughness of the pair, which changes from cell to cell: noise of
 * sensors and sampling, not shape.  Without it each scanner would need its own threshold.
 * The less of the weight is covered, the better the modes explain any gap: where the covered
 * share w is below SCORE_WHOLE the score is multiplied by 1 + SCORE_THIN (SCORE_WHOLE - w).
 * The cap limits the effect of one bad place.
 * What each part brings: docs/accuracy.md. */
#ifndef CORE_SCORE_H
#define CORE_SCORE_H
#include "align_pose.h"
#include "cells.h"
#include "fit.h"
#include "grid.h"
#include "model.h"

/* The learned u as a weight of the papers' measure (struct disparity_weight): arg is a struct
 * score_weight, the place (lattice units) one of the surface whose frame it has; 0 off the
 * grid. */
struct score_weight {
    const float *u;          /* [GRID_N] */
    struct align_pose frame; /* surface -> canonical frame */
};
float score_weight_at(const void *arg, double x, double y, double z);

struct score {
    double mm;        /* the score */
    double weight;    /* share of a whole face's weight that was covered, 0..1 */
    double change_mm; /* root mean square of the change taken out */
    double rough_mm;  /* the pair's roughness: amount(rest - blurred rest) */
    /* score of each region alone, not raised; NAN where less than SCORE_REGION_MIN of
     * its weight is covered */
    double region_mm[GRID_REGIONS];
    double region_weight[GRID_REGIONS]; /* its share of a whole face's weight, 0..1 */
};

/* score_of(m, change, c, s, fit, out): the score of the gap c.
 * change  fit_prepare() of m->change
 * fit     filled: the change and the rest
  Returns ST_OK, ST_ENOMEM. */
enum status score_of(const struct model *m, const struct fit_basis *change,
                     const struct cells *c, struct scratch *s, struct fit *fit,
                     struct score *out);

/* Three parts of a face, each with the nose and the eyes: an expression moves the surroundings
 * of the mouth, those of the brows, or both.  UPPER: all above the lower lids.  LOWER: all
 * below the brows.  MIDDLE: what both have in common, with the brows' lower edge. */
enum score_part { SCORE_UPPER, SCORE_LOWER, SCORE_MIDDLE, SCORE_PARTS };

/* score_prepare_part(m, p, out): m->change for a part, for many scores; borrows m. */
void score_prepare_part(const struct model *m, enum score_part p, struct fit_basis *out);

/* score_of_part(m, p, change, c, s, mm): the score of a part alone, on the scale of the whole
 * face's.  The change is fitted to that part alone: what happens elsewhere has no effect.
 * change  score_prepare_part()
 * mm      INFINITY: less than SCORE_PART_SEEN of the part's weight is covered
 * Cost: less than score_of() by as much as the part is smaller.  Returns ST_OK, ST_ENOMEM. */
enum status score_of_part(const struct model *m, enum score_part p,
                          const struct fit_basis *change, const struct cells *c,
                          struct scratch *s, double *mm);

/* score_cells(m, c, fit, s, out): what score_of() averaged, from its own results: s is
 * their score.  The sum of weight is 1 (0 where nothing is covered), and the sum of
 * weight times local_mm is the score, which is 0 where that sum is negative. */
struct score_cells {
    float weight[GRID_N];   /* the cell's share of the covered weight, 0..1 */
    float local_mm[GRID_N]; /* its own score; below 0 where it is roughness alone */
};
void score_cells(const struct model *m, const struct cells *c, const struct fit *fit,
                 const struct score *s, struct score_cells *out);

#endif
