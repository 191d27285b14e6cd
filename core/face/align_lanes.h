/* align_lanes.h -- the robust sums of align_field.h and align_grid.h, four points at a time in
 * single precision.  Sums are over lanes, each in the order of the points, and then over the lanes:
 * the same digits with vector instructions and without.  Internal to core. */
#ifndef CORE_ALIGN_LANES_H
#define CORE_ALIGN_LANES_H
#include <math.h>
#include <stdint.h>
#include "solve.h"

/* Residuals, mm.  |r| is rounded off below SOFT, so that L1's weight 1 / |r| stays finite;
 * beyond TUKEY a residual counts nothing: it belongs to another expression, to hair or to a
 * spike; one residual adds at most CAP to a pose's cost; a point without a gap adds NO_GAP,
 * so that sliding apart does not pay.  Chosen empirically. */
#define ALIGN_SOFT_MM   0.05
#define ALIGN_TUKEY_MM  2.5
#define ALIGN_CAP_MM    5.0
#define ALIGN_NO_GAP_MM 3.0

#define ALIGN_LANES 4
typedef float align_lanes __attribute__((vector_size(4 * ALIGN_LANES)));
typedef int32_t align_masks __attribute__((vector_size(4 * ALIGN_LANES)));

static inline align_lanes align_lanes_all(float v)
{
    return (align_lanes){v, v, v, v};
}

/* mask ? v : 0 */
static inline align_lanes align_lanes_only(align_masks mask, align_lanes v)
{
    return (align_lanes)(mask & (align_masks)v);
}

static inline align_lanes align_lanes_least(align_lanes a, align_lanes b)
{
    const align_masks less = a < b;

    return (align_lanes)((less & (align_masks)a) | (~less & (align_masks)b));
}

static inline align_lanes align_lanes_sqrt(align_lanes a)
{
    return (align_lanes){sqrtf(a[0]), sqrtf(a[1]), sqrtf(a[2]), sqrtf(a[3])};
}

static inline double align_lanes_total(align_lanes v)
{
    return ((double)v[0] + (double)v[1]) + ((double)v[2] + (double)v[3]);
}

/* Points and the surface under them, mm. */
struct align_under {
    align_masks there;     /* true: there is a surface */
    align_lanes x, y, z;   /* the points, from the centre of rotations */
    align_lanes normal[3]; /* unit normal of the surface */
    align_lanes gap;       /* gap at right angles to the surface */
    align_lanes weight;    /* u */
};

struct align_lanes_sums {
    align_lanes h[21], g[6], cost, share;
    align_masks within;
};

/* What residuals add: their weights in the normal equations, their costs, and the shares by
 * which the costs are divided. */
struct align_pull {
    align_lanes weight, cost, share;
};

static inline struct align_pull align_lanes_pull(const struct align_under *s,
                                                 enum solve_loss loss)
{
    const align_lanes a = (align_lanes)((align_masks)s->gap & INT32_MAX);
    const align_lanes one = align_lanes_all(1.0f);
    const align_lanes u = align_lanes_only(s->there, s->weight);
    align_lanes v;

    if (loss == SOLVE_LOSS_L1)
        return (struct align_pull){
            align_lanes_only(
                s->there,
                -1.0f / align_lanes_least(-a, -align_lanes_all((float)ALIGN_SOFT_MM))),
            align_lanes_only(s->there,
                             align_lanes_least(a, align_lanes_all((float)ALIGN_CAP_MM))),
            align_lanes_only(s->there, one)};
    v = align_lanes_least(a * ((float)(1 / ALIGN_TUKEY_MM)), one);
    v = one - v * v;
    return (struct align_pull){u * v * v, u * (float)ALIGN_TUKEY_MM * (one - v * v * v),
                               u};
}

static inline void align_lanes_add(struct align_lanes_sums *to,
                                   const struct align_under *s, enum solve_loss loss)
{
    const align_lanes *n = s->normal;
    const struct align_pull pull = align_lanes_pull(s, loss);
    const align_lanes j[6] = {s->y * n[2] - s->z * n[1],
                              s->z * n[0] - s->x * n[2],
                              s->x * n[1] - s->y * n[0],
                              n[0],
                              n[1],
                              n[2]};
    align_lanes *h = to->h;

    for (int i = 0; i < 6; i++) {
        const align_lanes wj = pull.weight * j[i];

        for (int k = i; k < 6; k++)
            *h++ += wj * j[k];
        to->g[i] += wj * s->gap;
    }
    to->cost += pull.cost;
    to->share += pull.share;
    to->within -= s->there;
}

/* align_lanes_finish(sums, count, loss, out): Completes the sum over count points, with or without a gap. */
static inline void align_lanes_finish(const struct align_lanes_sums *sums, uint32_t count,
                                      enum solve_loss loss, struct solve_sum *out)
{
    const align_masks w = sums->within;
    const double within = w[0] + w[1] + w[2] + w[3];
    double share = align_lanes_total(sums->share);

    for (int i = 0; i < 21; i++)
        out->normal.h[i] = align_lanes_total(sums->h[i]);
    for (int i = 0; i < 6; i++)
        out->normal.g[i] = align_lanes_total(sums->g[i]);
    out->within = count > 0 ? within / count : 0;
    out->cost = align_lanes_total(sums->cost);
    if (loss == SOLVE_LOSS_L1) {
        out->cost += ALIGN_NO_GAP_MM * (count - within);
        share = count;
    }
    out->cost = share > 0.0 ? out->cost / share : (double)INFINITY;
}

#endif
