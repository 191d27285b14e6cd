#include "surface_basic.h"

#include <math.h>
#include <stdbool.h>

#define LARGEST 1e4

static bool is_score(double x)
{
    return fabs(x) < LARGEST; /* false for NAN */
}

int surface_calibration_valid(const struct surface_calibration *c)
{
    const struct surface_knot *k = c->knot;

    if (!(c->n >= 2 && c->n <= SURFACE_KNOTS) || !is_score(c->threshold) ||
        !(k[0].rate >= 1 && k[0].rate <= 1))
        return false;
    for (uint32_t i = 0; i < c->n; i++)
        if (!is_score(k[i].score) || !(k[i].rate > 0) ||
            (i > 0 && !(k[i].score > k[i - 1].score && k[i].rate < k[i - 1].rate)))
            return false;
    return true;
}

double surface_calibration_rate(const struct surface_calibration *c, double score)
{
    const struct surface_knot *k = c->knot;
    uint32_t i = 1;

    if (!(score >= k[0].score))
        return 1;
    if (score >= k[c->n - 1].score)
        return k[c->n - 1].rate;
    while (score >= k[i].score)
        i++;
    return k[i - 1].rate + (k[i].rate - k[i - 1].rate) * (score - k[i - 1].score) /
                               (k[i].score - k[i - 1].score);
}
