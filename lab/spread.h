/* spread.h -- how gaps from the mean face vary: a covariance over the cells in use that does not change if the
 * face is mirrored, as anatomy is symmetric on the whole.  Each sample counts half as it is and half mirrored.
 * For the gaps a and b of two cells that are each other's mirror image, take (a + b) / sqrt 2 and
 * (a - b) / sqrt 2.  In these the covariance consists of two blocks, of even and of odd patterns.  It then
 * takes half of the numbers, eigenproblems cost a quarter, and modes are exactly symmetric or antisymmetric. */
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

/* A mode of one block. */
struct spread_mode {
    double variance; /* mm^2, 0 or above */
    double *pattern; /* [n] in its block's coordinates, of length 1 */
    bool odd;
};

/* spread_new(n, out): Makes a covariance that is 0.  Returns ST_OK; ST_ENOMEM: out is empty. */
enum status spread_new(uint32_t n, struct spread *out);

/* spread_free(s): Releases the blocks, and resets s to the empty state. */
void spread_free(struct spread *s);

/* spread_split(c, gap, part): Computes a sample's even and odd coordinates, part[0] and part[1] of [n].  A cell
 * without a gap (NAN) counts as 0, the mean face. */
void spread_split(const struct spread_cells *c, const float gap[GRID_N], double *part[2]);

/* spread_join(c, odd, pattern, by, out, step): Writes a block's pattern, times by, as gaps; 0 in other cells.
 *   out  the gap of cell i is at out[i * step] */
void spread_join(const struct spread_cells *c, bool odd, const double *pattern, double by,
                 float *out, uint32_t step);

/* spread_add_pattern(s, odd, x, by): Adds by x x' to a block.  Cost: O(n^2). */
void spread_add_pattern(struct spread *s, bool odd, const double *x, double by);

/* spread_add(s, other, by): Adds by other to s. */
void spread_add(struct spread *s, const struct spread *other, double by);

/* spread_variance(s, i): Returns the variance of the gap at the i-th cell in use. */
double spread_variance(const struct spread *s, uint32_t i);

/* spread_remove(s, odd, x, n): Removes the variance along n patterns of a block, which become orthonormal, or 0
 * if they depend on those before.  Cost: O(n s->n^2). */
void spread_remove(struct spread *s, bool odd, double *x, uint32_t n);

/* spread_lead(s, k, mode): Finds the k modes of the largest variance, falling.  s becomes empty.
 *   mode  patterns in one block, to be released by free(mode->pattern)
 * Returns ST_OK; ST_EINVAL: k exceeds the number of modes, or a number is not finite; ST_ENOMEM. */
enum status spread_lead(struct spread *s, uint32_t k, struct spread_mode *mode);

/* spread_against(s, noise): Changes to coordinates in which noise is the identity: s becomes L^-1 s L'^-1, with
 * L L' = noise.  The lower triangles of noise become L.  Cost: O(n^3).
 * Returns ST_OK; ST_EINVAL: noise is not positive definite. */
enum status spread_against(struct spread *s, struct spread *noise);

/* spread_back(l, mode, k): Changes modes found after spread_against() back to the former coordinates.  Their
 * patterns are then no longer orthogonal or of length 1. */
void spread_back(const struct spread *l, struct spread_mode *mode, uint32_t k);

#endif
