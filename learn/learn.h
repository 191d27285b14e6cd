/* learn.h -- learn the model's tables from the gaps of many comparisons (cells.h).
 * A sample is GRID_N floats: the gap per cell in mm, NAN where less than LEARN_COVERED mm^2
 * of the cell are covered.
 * Deterministic: sums in a fixed order, no random numbers. */
#ifndef LEARN_LEARN_H
#define LEARN_LEARN_H
#include <stddef.h>
#include <stdint.h>
#include "grid.h"
#include "model.h"
#include "status.h"

struct cells; /* cells.h */

#define LEARN_COVERED 4.0f

/* learn_sample(c, out): a comparison's cells as a sample. */
void learn_sample(const struct cells *c, float *out);

/* learn_cells(sample, m, out): a sample as cells on m's mean face, for fit_solve() and
 * score_of(). */
void learn_cells(const float *sample, const struct model *m, struct cells *out);

/* learn_modes(gap, n, k, most, out): from n mated samples and their mirror images, the k modes
 * that explain most of the squared gap, and the deviation of the rest.  Missing cells are filled
 * in from the modes of the round before (expectation maximisation: Roweis, "EM Algorithms for
 * PCA and SPCA", NIPS 1997; here with orthogonal iteration).  Cells covered by less than
 * LEARN_MIN_SHARE of the samples are left out (rest 0).  Gaps are capped at most mm.
 * Cost  O(n k GRID_N).  Returns ST_OK; ST_EINVAL n < 2 k or k > MODEL_MODES; ST_ENOMEM. */
#define LEARN_MIN_SHARE 0.15
#define LEARN_MAX_GAP   5.0 /* between two scans of one person */
enum status learn_modes(const float *gap, size_t n, uint32_t k, double most,
                        struct model_basis *out);

/* learn_smooth(b, length_mm, share, k): add k modes for changes that no sample shows: smooth
 * deformations (squared-exponential covariance of that length) with share times the
 * deviation of b's own modes at each place, as a face moves most where it was seen to move.
 * They take out most of an unseen expression, and little of nose and forehead, which hardly
 * move.  Returns ST_OK; ST_EINVAL: more than
 * MODEL_MODES in all; ST_ENOMEM. */
enum status learn_smooth(struct model_basis *b, double length_mm, double share,
                         uint32_t k);

/* learn_weight(rest, genuine, n, m, weight): u(x, y).
 * rest     n samples: what fit_solve() left of n gaps with m's change
 * genuine  [n] 1: a mated pair, 0: a non-mated one
 * Logistic regression on the capped rest (m->cap_mm) with non-negative weights, in which both
 * kinds have the same total weight; then smoothed over neighbouring cells, made symmetric,
 * multiplied by learn_rigid() and scaled as struct model says.
 * Returns ST_OK; ST_EINVAL one kind is missing; ST_ENOMEM. */
enum status learn_weight(const float *rest, const uint8_t *genuine, size_t n,
                         const struct model *m, float *weight);

/* learn_rigid(cell): how little soft tissue can move at the cell, 0..1.  Bone and cartilage
 * lie under nose, glabella and upper forehead; brows, cheeks, mouth and jaw move.  A prior:
 * no collection of scans shows every expression. */
double learn_rigid(uint32_t cell);

#endif
