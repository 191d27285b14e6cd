#include "calibrate.h"

#include <math.h>
#include <string.h>

#include "decision.h"
#include "model.h"
#include "rates.h"

#define LEAST_SUPPORT 5.0 /* comparisons that a knot rests on */

/* A knot at mm, unless it would not rise above the last one. */
static void add_knot(const struct rates *r, double mm, struct decision *d)
{
    const double rate = rates_fmr(r, mm);

    if (!(mm > 0 && rate > 0 && rate < 1) ||
        (d->n > 0 && !(mm > d->knot[d->n - 1].mm && rate > d->knot[d->n - 1].rate)))
        return;
    d->knot[d->n++] = (struct decision_knot){mm, rate};
}

/* How far the rate takes to halve: between the first knot and the next with four times its
 * rate, or the last quantile. */
static double halving(const struct decision *d)
{
    uint32_t i = 0;
    double mm;

    while (i + 1 < d->n && d->knot[i].rate < 4 * d->knot[0].rate)
        i++;
    if (i == 0)
        return model_default.decision.halving_mm;
    mm = (d->knot[i].mm - d->knot[0].mm) / log2(d->knot[i].rate / d->knot[0].rate);
    return mm > 0.001 ? mm : 0.001;
}

enum status calibrate_learn(const struct rates *r, double fmr, struct decision *d)
{
    static const double rate[] = {0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01,
                                  0.02,   0.05,   0.1,    0.2,   0.5,   0.8,   0.95};
    const double n = (double)rates_nimpostor(r), last = rates_at(r, 1);
    bool placed = false;

    memset(d, 0, sizeof *d);
    if (!rates_supported(fmr, rates_nimpostor(r)))
        return ST_ETOOFEW;
    d->threshold_mm = rates_at(r, fmr);
    if (!(d->threshold_mm > 0 && rates_fmr(r, d->threshold_mm) > 0))
        return ST_ETOOFEW;
    for (size_t i = 0; i < sizeof rate / sizeof *rate; i++) {
        const double mm = rates_at(r, rate[i]);

        if (!placed && (rate[i] >= fmr || mm >= d->threshold_mm)) {
            add_knot(r, d->threshold_mm, d);
            placed = true;
        }
        if (rate[i] * n >= LEAST_SUPPORT)
            add_knot(r, mm, d);
    }
    if (!placed)
        add_knot(r, d->threshold_mm, d);
    d->halving_mm = halving(d);
    d->knot[d->n] = (struct decision_knot){fmax(last, d->knot[d->n - 1].mm) * 1.05, 1};
    d->n++;
    return decision_valid(d) ? ST_OK : ST_ETOOFEW;
}

uint32_t calibrate_subjects(double fmr)
{
    const double pairs = (double)rates_needed(fmr);
    const double least = ceil((1 + sqrt(1 + 8 * pairs)) / 2 - 1e-9); /* n (n - 1) / 2 */

    return least < UINT32_MAX ? (uint32_t)least : UINT32_MAX;
}
