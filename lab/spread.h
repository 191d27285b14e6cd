/* spread.h -- how gaps from the mean face vary: a covariance over the cells in use, the same for
 * a face and for its mirror image, as anatomy is on the whole.  Each sample counts half as it is
 * and half mirrored.
 * With (a + b) / sqrt 2 and (a - b) / sqrt 2 for the gaps a and b of two cells that are each
 * other's mirror image, such a covariance falls into two blocks, of even patterns and of odd
 * ones.  So half of the numbers do, eigenproblems cost a quarter, and modes are symmetric or
 * antisymmetric exactly. */
#ifndef LAB_SPREAD_H
#define LAB_SPREAD_H
#include <stdbool.h>
#include <stdint.h>
#include "grid.h"
#include "status.h"

/* The cells in use: those left of the plane of symmetry, each with its mirror image. */
struct spread_cells {
    uint32_t n;
    uint32_t at[GRID_N / 2]; /* rising */
};

struct spread {
    uint32_t n;
    double *block[2]; /* [n][n] of even patterns, and of odd ones; mm^2 */
};

/* A mode: of a block, with the variance along it. */
struct spread_mode {
    double variance; /* mm^2, 0 or above */
    double *pattern; /* [n] in its block's coordinates, of length 1 */
    bool odd;
};

/* spread_new(n, out): all 0.  Returns ST_OK, ST_ENOMEM (out is empty). */
enum status spread_new(uint32_t n, struct spread *out);
void spread_free(struct spread *s); /* it is empty again */

/* spread_split(c, gap, part): a sample in the blocks' coordinates; a cell without a gap (NAN)
 * counts as 0: as the mean face.  part[0], part[1]: [n]. */
void spread_split(const struct spread_cells *c, const float gap[GRID_N], double *part[2]);

/* spread_join(c, odd, pattern, by, out): by times a pattern of a block, as gaps; 0 elsewhere.
 * out  every step-th float: of each cell of the grid */
void spread_join(const struct spread_cells *c, bool odd, const double *pattern, double by,
                 float *out, uint32_t step);

/* spread_add_pattern(s, odd, x, by): s += by x x', in one block.  O(n^2). */
void spread_add_pattern(struct spread *s, bool odd, const double *x, double by);

/* spread_add(s, other, by): s += by other. */
void spread_add(struct spread *s, const struct spread *other, double by);

/* spread_variance(s, i): of the gap at the i-th cell in use. */
double spread_variance(const struct spread *s, uint32_t i);

/* spread_remove(s, odd, x, n): what varies along n patterns of a block, not all of which need be
 * independent, is removed.  They become orthonormal, or 0.  O(n s->n^2). */
void spread_remove(struct spread *s, bool odd, double *x, uint32_t n);

/* spread_lead(s, k, mode): the k modes of the largest variance, falling; patterns to be released
 * by spread_release(mode, k).  s is used up: it becomes empty.  Returns ST_OK, ST_EINVAL k is more
 * than there are or a number is not finite, ST_ENOMEM. */
enum status spread_lead(struct spread *s, uint32_t k, struct spread_mode *mode);
void spread_release(struct spread_mode *mode, uint32_t k);

/* spread_against(s, noise): s in coordinates in which noise is the identity: L^-1 s L'^-1, where
 * L L' = noise, of which the lower triangles become L.
 * spread_back(l, mode, k): modes found there in the coordinates from before, their patterns no
 * longer orthogonal or of length 1.
 * O(n^3).  Returns ST_OK; ST_EINVAL noise is not positive definite. */
enum status spread_against(struct spread *s, struct spread *noise);
void spread_back(const struct spread *l, struct spread_mode *mode, uint32_t k);

#endif
