#include "decision.h"

#include <stddef.h>

const double decision_threshold_mm = 0.71;
const double decision_min_overlap = 0.3;

/* Disparities (mm) and the share of impostors at or below them: quantiles of 16,136
 * comparisons of different people, close relatives left out (docs/decision.md). */
static const struct knot {
    double mm, rate;
} knots[] = {
    {0.6788, 0.0005}, {0.7151, 0.001}, {0.7383, 0.002}, {0.7881, 0.005}, {0.8474, 0.01},
    {0.9267, 0.02},   {1.0499, 0.05},  {1.1731, 0.1},   {1.3391, 0.2},   {1.7431, 0.5},
    {2.2846, 0.8},    {3.0013, 0.95},  {4.0, 1.0},
};

#define KNOTS (sizeof knots / sizeof *knots)

/* Below the first knot the rate halves with each of these, as it does, or faster, between
 * the knots above it. */
#define HALVING_MM 0.05

double decision_fmr(double disparity_mm)
{
    double rate = knots[0].rate, mm = disparity_mm < 0 ? 0 : disparity_mm;
    size_t i = 1;

    if (!(mm < knots[KNOTS - 1].mm))
        return 1;
    if (mm < knots[0].mm) {
        double steps = (knots[0].mm - mm) / HALVING_MM;

        for (; steps >= 1; steps -= 1)
            rate /= 2;
        return rate * (1 - steps / 2);
    }
    while (mm >= knots[i].mm)
        i++;
    return knots[i - 1].rate + (knots[i].rate - knots[i - 1].rate) *
                                   (mm - knots[i - 1].mm) /
                                   (knots[i].mm - knots[i - 1].mm);
}
