/* solve.h -- robust sums of residuals: weighted normal equations in six unknowns, solved by
 * Cholesky. */
#ifndef CORE_SOLVE_H
#define CORE_SOLVE_H
#include <stdbool.h>

/* Gauss-Newton: the longest step, and damping that keeps undetermined unknowns in place.  Chosen
 * empirically. */
#define SOLVE_MAX_TURN_RAD 0.25
#define SOLVE_MAX_SHIFT_MM 25.0
#define SOLVE_DAMPING      1e-4

/* The sum of w J J^T (upper triangle, row by row) and of w r J over the residuals. */
struct solve_normal {
    double h[21], g[6];
};

/* Residuals of an alignment, and their robust sum. */
enum solve_loss {
    SOLVE_LOSS_L1,   /* |r|, r the gap at right angles to the template's triangle */
    SOLVE_LOSS_TUKEY /* u times Tukey's biweight of r at ALIGN_TUKEY_MM */
};

struct solve_sum {
    struct solve_normal normal;
    double cost;   /* mm.  L1: mean of |r|, capped; a point without a gap costs
                      ALIGN_NO_GAP_MM.  Tukey: weighted mean of the loss over the points
                      that have a gap */
    double within; /* share of the points that have a gap, 0..1 */
};

static inline void solve_add(struct solve_normal *a, const double j[6], double r,
                             double w)
{
    double wj[6];
    double *h = a->h;

    for (int i = 0; i < 6; i++)
        wj[i] = w * j[i];
    for (int i = 0; i < 6; i++) {
        for (int k = i; k < 6; k++)
            *h++ += wj[i] * j[k];
        a->g[i] += wj[i] * r;
    }
}

/* solve_equations(a, damping, x): Sets x to the minimum of sum w (r + J x)^2.
 *   damping  every diagonal element is multiplied by 1 + damping, and grows by damping times
 *          the mean of its kind (the first three unknowns, or the last three), so that
 *          unknowns which the residuals do not determine stay near 0
 * Returns false, with x zero, if the matrix is singular nevertheless. */
bool solve_equations(const struct solve_normal *a, double damping, double x[6]);

#endif
