#include "calibrate.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "calibration.h"
#include "rates.h"

#define LEAST_SUPPORT 5.0 /* comparisons that a knot rests on */

/* A knot at the score, unless it would not rise above the last one. */
static void add_knot(const struct rates *r, double score, struct calibration *c)
{
    const struct calibration_knot *last = &c->knot[c->n - 1];
    const double rate = rates_fmr(r, score);

    if (rate > 0 && score > last->score && rate < last->rate)
        c->knot[c->n++] = (struct calibration_knot){score, rate};
}

enum status calibrate_learn(const struct rates *r, double fmr, struct calibration *c)
{
    static const double rate[] = {0.95, 0.8,   0.5,   0.2,   0.1,    0.05,   0.02,
                                  0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001};
    const double n = (double)rates_nimpostor(r);
    bool placed = false;

    memset(c, 0, sizeof *c);
    if (!rates_supported(fmr, rates_nimpostor(r)))
        return ST_ETOOFEW;
    c->threshold = rates_at(r, fmr);
    if (!isfinite(c->threshold) || !(rates_fmr(r, c->threshold) > 0))
        return ST_ETOOFEW;
    c->knot[c->n++] = (struct calibration_knot){rates_at(r, 1) - 1, 1};
    for (size_t i = 0; i < sizeof rate / sizeof *rate; i++) {
        const double score = rates_at(r, rate[i]);

        if (!placed && score >= c->threshold) {
            add_knot(r, c->threshold, c);
            placed = true;
        }
        if (rate[i] * n >= LEAST_SUPPORT && isfinite(score))
            add_knot(r, score, c);
    }
    if (!placed)
        add_knot(r, c->threshold, c);
    return calibration_valid(c) ? ST_OK : ST_ETOOFEW;
}

uint32_t calibrate_subjects(double fmr)
{
    const double pairs = (double)rates_needed(fmr);
    const double least = ceil((1 + sqrt(1 + 8 * pairs)) / 2 - 1e-9); /* n (n - 1) / 2 */

    return least < UINT32_MAX ? (uint32_t)least : UINT32_MAX;
}
