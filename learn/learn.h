/* learn.h -- the model's tables from the gaps of many comparisons (cells.h).
 * A sample is GRID_N floats: the gap per cell in mm, NAN where less than LEARN_COVERED mm^2
 * of a cell are covered.
 * Everything is deterministic: fixed order, no random numbers. */
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

/* learn_cells(sample, m, out): and back, on m's mean face: for fit_solve() and score_of()
 * where only samples were kept. */
void learn_cells(const float *sample, const struct model *m, struct cells *out);

/* learn_modes(gap, n, k, out): what varies: from n samples of the same person twice, and
 * their mirror images, the k modes that explain most of the squared gap, and what they
 * leave.  Missing cells are filled by what the modes so far make of the others
 * (expectation maximisation: Roweis, "EM Algorithms for PCA and SPCA", NIPS 1997; here by
 * orthogonal iteration).  Cells covered by less than LEARN_MIN_SHARE of the samples are
 * left out (rest 0).  Gaps count up to LEARN_MAX_GAP mm.
 * Cost  O(n k GRID_N).  Returns ST_OK; ST_EINVAL n < 2 k or k > MODEL_MODES; ST_ENOMEM. */
#define LEARN_MIN_SHARE 0.15
#define LEARN_MAX_GAP   5.0
enum status learn_modes(const float *gap, size_t n, uint32_t k, struct model_basis *out);

/* learn_smooth(b, length_mm, share, k): add k modes for changes that nobody has shown yet:
 * any smooth deformation (squared-exponential covariance of that length) may happen, with
 * share times the deviation that b's own modes have there: a face moves most where it has
 * been seen to move.  What an unseen expression does is then mostly taken out, while nose
 * and forehead, which hardly move, are kept.  Returns ST_OK; ST_EINVAL: more than
 * MODEL_MODES in all; ST_ENOMEM. */
enum status learn_smooth(struct model_basis *b, double length_mm, double share,
                         uint32_t k);

/* learn_weight(rest, genuine, n, m, weight): u(x, y): from what fit_solve() left of n
 * comparisons (samples) with m's change and cap, genuine[i] telling which are of one
 * person: logistic regression with weights that are not negative, both kinds counting
 * alike, smoothed over neighbouring cells and made symmetric; then times how rigid the
 * place is by anatomy (learn_rigid()); scaled as struct model says.
 * Returns ST_OK; ST_EINVAL: a kind is missing; ST_ENOMEM. */
enum status learn_weight(const float *rest, const uint8_t *genuine, size_t n,
                         const struct model *m, float *weight);

/* learn_rigid(cell): 0..1: how little soft tissue can move there.  Bone and cartilage lie
 * under nose, glabella and upper forehead; brows, cheeks, mouth and jaw move.  A prior that
 * no collection of scans can give, as none shows every expression. */
double learn_rigid(uint32_t cell);

#endif
