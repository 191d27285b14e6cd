#include "decision.h"

#include <math.h>
#include <stddef.h>

#include "tuning.h"

bool decision_valid(const struct decision *d)
{
    if (!(d->n >= 2 && d->n <= DECISION_KNOTS) ||
        !(d->threshold_mm > 0 && d->threshold_mm < 1e3) ||
        !(d->halving_mm > 0 && d->halving_mm < 1e3))
        return false;
    for (uint32_t i = 0; i < d->n; i++) {
        const struct decision_knot k = d->knot[i];

        if (!(k.mm > 0 && k.mm < 1e3 && k.rate > 0 && k.rate <= 1))
            return false;
        if (i > 0 && !(k.mm > d->knot[i - 1].mm && k.rate > d->knot[i - 1].rate))
            return false;
    }
    return d->knot[d->n - 1].rate >= 1;
}

double decision_fmr(const struct decision *d, double score_mm)
{
    const struct decision_knot *k = d->knot;
    const double mm = score_mm < 0 ? 0 : score_mm;
    uint32_t i = 1;

    if (!(mm < k[d->n - 1].mm))
        return 1;
    if (mm < k[0].mm) {
        double steps = (k[0].mm - mm) / d->halving_mm, rate = k[0].rate;

        for (; steps >= 1 && rate > 0; steps -= 1)
            rate /= 2;
        return rate * (1 - steps / 2);
    }
    while (mm >= k[i].mm)
        i++;
    return k[i - 1].rate +
           (k[i].rate - k[i - 1].rate) * (mm - k[i - 1].mm) / (k[i].mm - k[i - 1].mm);
}

static double share(double x, double from, double to)
{
    return fmax(0, fmin(1, (x - from) / (to - from)));
}

static double noise_rise(const struct decision_pair *p)
{
    const double noise = fmin(p->noise_mm, DECISION_NOISE_MOST_MM) - DECISION_NOISE_MM;
    const double rough = p->rough_mm - DECISION_ROUGH_MM;

    return fmax(0, fmin(DECISION_NOISE_RISE * noise, DECISION_ROUGH_RISE * rough));
}

/* How far the rules for hidden faces apply, 0..1. */
static double hiding(const struct decision_pair *p)
{
    return share(p->hidden, DECISION_HIDDEN_SOME, DECISION_HIDDEN_MUCH);
}

bool decision_open(double t, const struct decision_pair *p)
{
    const double usual = t + noise_rise(p);

    return p->score_mm > usual && p->score_mm <= usual + DECISION_PART_RISE * t &&
           hiding(p) <= 0;
}

struct decision_terms decision_terms(double t, const struct decision_pair *p)
{
    const double hidden = hiding(p), noise = noise_rise(p);
    const double factor = 1 - DECISION_HIDDEN_LESS * hidden;
    struct decision_terms out = {.threshold_mm = factor * t + noise,
                                 .doubt_mm = DECISION_HIDDEN_DOUBT * hidden * t,
                                 .rise_mm = noise,
                                 .factor = factor,
                                 .calibrated_mm =
                                     fmax(0, (p->score_mm - noise) / factor)};

    if (decision_open(t, p) && p->part_mm <= DECISION_PART * t + noise) {
        out.threshold_mm += DECISION_PART_RISE * t;
        out.factor = 0;
        out.calibrated_mm = t;
    }
    return out;
}
