#include "contrived.h"

#include <math.h>

#include "brute.h"
#include "facegen.h"

/* From lo at 0 to hi at 1, by equal ratios. */
static double scale(double gene, double lo, double hi)
{
    return lo * pow(hi / lo, gene);
}

static double unit(struct brute_rng *r)
{
    return (double)brute_int(r, 0, 1 << 24) / (1 << 24);
}

/* The i-th of n points of a feature, on the plane. */
static struct dvec3 place(enum contrived_gene kind, const double *gene, uint32_t i,
                          uint32_t n, struct brute_rng *r)
{
    const uint32_t lines = 1 + (uint32_t)(gene[CONTRIVED_LINES] * 15);
    const double apart = scale(gene[CONTRIVED_APART], 0.001, 40);
    const double pitch = scale(gene[CONTRIVED_PITCH], 0.001, 130.0 * lines / (n + 1));
    const double across = (i % lines - (lines - 1) / 2.0) * apart;
    const double along = (i / lines - n / 2.0 / lines) * pitch;
    const double spot = scale(gene[CONTRIVED_SPOT], 0.01, 60), part = (i + 0.5) / n;

    switch (kind) {
    case CONTRIVED_COLUMNS:
        return (struct dvec3){across, along, 0};
    case CONTRIVED_ROWS:
        return (struct dvec3){along, across, 0};
    case CONTRIVED_FAN:
        if (i == 0)
            return (struct dvec3){0, -60, 0};
        return (struct dvec3){spot * sin(part - 0.5), spot * cos(part - 0.5) - 60, 0};
    case CONTRIVED_HULL:
        return (struct dvec3){140 * part - 70, 90 * (2 * part - 1) * (2 * part - 1) - 90,
                              0};
    case CONTRIVED_CLUSTER:
        return (struct dvec3){10 + spot * unit(r), 10 + spot * unit(r), 0};
    default:
        return (struct dvec3){110 * unit(r) - 55, 150 * unit(r) - 80, 0};
    }
}

void contrived_make(const double *gene, uint64_t seed, uint32_t n, struct dvec3 *out)
{
    struct brute_rng r = {seed};
    struct facegen_face face;
    double shares = 1e-3, sum = 1e-3;
    uint32_t at = 0;

    facegen_face(seed, 0, &face);
    for (int k = CONTRIVED_FACE; k <= CONTRIVED_CLUSTER; k++)
        shares += gene[k];
    for (int k = CONTRIVED_CLUSTER; k >= CONTRIVED_FACE; k--) {
        uint32_t from = at, end;

        sum += gene[k];
        end = k == CONTRIVED_FACE ? n : (uint32_t)(n * sum / shares);
        for (; at < end; at++)
            out[at] = place((enum contrived_gene)k, gene, at - from, end - from, &r);
    }
    for (uint32_t i = 0; i < n; i++)
        out[i].z = facegen_height(&face, out[i].x, out[i].y);
    for (uint32_t i = n; gene[CONTRIVED_ORDER] < 0.5 && i > 1; i--) {
        const uint32_t k = (uint32_t)(brute_rand(&r) % i);
        const struct dvec3 swap = out[k];

        out[k] = out[i - 1];
        out[i - 1] = swap;
    }
    if (gene[CONTRIVED_STRAY] > 0.5)
        out[0].x = 900;
}
