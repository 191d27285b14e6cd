#include "decision.h"

#include <math.h>
#include <stddef.h>

const double decision_threshold_mm = 0.75;
const double decision_min_overlap = 0.3;

/* Disparities (mm) and the share of impostors at or below them, learned. */
static const struct knot {
    double mm, rate;
} table[] = {{0.75, 0.001}, {0.9, 0.01}, {1.5, 0.5}, {3.0, 1.0}};

#define KNOTS (sizeof table / sizeof *table)

double decision_fmr(double mm)
{
    size_t i = 1;
    double t, rate;

    if (!(mm < table[KNOTS - 1].mm))
        return 1.0;
    while (i + 1 < KNOTS && mm > table[i].mm)
        i++;
    t = (mm - table[i - 1].mm) / (table[i].mm - table[i - 1].mm);
    /* straight in the logarithm; below the first knot the same line runs on */
    rate = exp(log(table[i - 1].rate) + t * log(table[i].rate / table[i - 1].rate));
    return rate < 1.0 ? rate : 1.0;
}
