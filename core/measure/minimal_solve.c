#include "minimal_solve.h"

#include <math.h>
#include <string.h>

#include "pose.h"
#include "solve.h"

/* In terms of the mean of |gap|: below SHARP |gap| is rounded off; its curvature is spread
 * over SOFT.  0.05 to 0.2 and 0.3 to 0.6 fare alike. */
#define MINIMAL_SHARP 0.1
#define MINIMAL_SOFT  0.4

/* Newton steps between two samplings of the surfaces (2: 95.7 % of the non-mated pairs,
 * 3: 96.7, 4: 96.3). */
#define MINIMAL_NEWTON 3

typedef minimal_lanes lane4;
typedef int32_t mask4 __attribute__((vector_size(4 * MINIMAL_LANES)));

static inline lane4 minimal_solve_load(const float *p)
{
    lane4 v;

    memcpy(&v, p, sizeof v);
    return v;
}

/* a where mask, else b. */
static inline lane4 minimal_solve_choose(mask4 mask, lane4 a, lane4 b)
{
    return (lane4)(((mask4)a & mask) | ((mask4)b & ~mask));
}

static inline lane4 absolute(lane4 a)
{
    return (lane4)((mask4)a & INT32_MAX);
}

static double total(lane4 v)
{
    return ((double)v[0] + (double)v[1]) + ((double)v[2] + (double)v[3]);
}

double minimal_mean(const struct minimal_places *p)
{
    lane4 sum = {0}, weight = {0};

    for (uint32_t i = 0; i < p->n; i += MINIMAL_LANES) {
        const lane4 w = minimal_solve_load(p->weight + i);

        sum += w * absolute(minimal_solve_load(p->gap + i));
        weight += w;
    }
    return total(weight) > 0 ? total(sum) / total(weight) : 0;
}

/* Sums over the places after the motion x: Newton's equations, as solve_equations() wants them.
 * |g| counts as Huber's loss, quadratic below sharp.  Its second derivative would be two
 * places in a hundred or none; instead it is spread as 1 / (1 + (g / soft)^2).
 * Returns the loss. */
static double sums(const struct minimal_places *p, const double x[6], float sharp,
                   float soft, struct solve_normal *out)
{
    const float by_sharp = 1.0f / sharp, by_soft = 1.0f / soft;
    lane4 h[21], g[6], loss = {0};
    float f[6];

    memset(h, 0, sizeof h);
    memset(g, 0, sizeof g);
    for (int k = 0; k < 6; k++)
        f[k] = (float)x[k];
    for (uint32_t i = 0; i < p->n; i += MINIMAL_LANES) {
        const lane4 w = minimal_solve_load(p->weight + i);
        lane4 gap = minimal_solve_load(p->gap + i) + f[5], j[6], a, pull, e, *sum = h;
        mask4 far;

        for (int k = 0; k < 5; k++) {
            j[k] = minimal_solve_load(p->by[k] + i);
            gap += f[k] * j[k];
        }
        j[5] = (lane4){1, 1, 1, 1};
        a = absolute(gap);
        far = a > sharp;
        loss +=
            w * minimal_solve_choose(far, a - 0.5f * sharp, 0.5f * by_sharp * gap * gap);
        pull =
            w * minimal_solve_choose(far, (lane4)(((mask4)gap & INT32_MIN) | (mask4)j[5]),
                                     by_sharp * gap);
        e = by_soft * gap;
        e = w * by_soft / (1.0f + e * e);
        for (int k = 0; k < 6; k++) {
            const lane4 t = e * j[k];

            g[k] += pull * j[k];
            for (int l = k; l < 6; l++)
                *sum++ += t * j[l];
        }
    }
    for (int k = 0; k < 21; k++)
        out->h[k] = total(h[k]);
    for (int k = 0; k < 6; k++)
        out->g[k] = total(g[k]);
    return total(loss);
}

static double length(const double x[6])
{
    double sum = 0;

    for (int k = 0; k < 6; k++)
        sum += x[k] * x[k] * (k < 3 ? POSE_LEVER_MM * POSE_LEVER_MM : 1);
    return sqrt(sum);
}

double minimal_solve(const struct minimal_places *p, double mean, double limit,
                     double x[6])
{
    double best = INFINITY, from[6] = {0};

    memset(x, 0, 6 * sizeof *x);
    for (int i = 0; i < MINIMAL_NEWTON; i++) {
        struct solve_normal normal;
        const double loss = sums(p, x, (float)(MINIMAL_SHARP * mean),
                                 (float)(MINIMAL_SOFT * mean), &normal);
        double d[6], scale = MINIMAL_BACK;

        if (loss < best) {
            best = loss;
            memcpy(from, x, sizeof from);
            if (!solve_equations(&normal, SOLVE_DAMPING, d))
                break;
            scale = length(d) > limit ? limit / length(d) : 1;
        } else {
            for (int k = 0; k < 6; k++)
                d[k] = x[k] - from[k];
        }
        for (int k = 0; k < 6; k++)
            x[k] = from[k] + scale * d[k];
    }
    return length(x);
}
