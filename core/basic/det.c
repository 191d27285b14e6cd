#include "det.h"

#include <math.h>
#include <string.h>

static const double rate[DET_POINTS] = {0.5,  0.2,  0.1,  0.05, 0.02, 0.01, 5e-3, 2e-3,
                                        1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5};

/* The interval holds the rate, also one that is no error of few people. */
static void widen(const struct det *d, struct det_point *p)
{
    p->low = fmin(p->low, p->fnmr);
    p->high = fmin(1, fmax(fmax(p->high, p->fnmr), rates_least(d->people)));
}

static enum status det_at(const struct rates *r, double threshold, uint64_t seed,
                          const struct det *d, struct det_point *out)
{
    struct rates_figures low, high;
    const enum status st =
        rates_bootstrap(r, threshold, (double)NAN, RATES_REPLICATES, seed, &low, &high);

    if (st != ST_OK)
        return st;
    *out = (struct det_point){.score = threshold,
                              .fmr = rates_fmr(r, threshold),
                              .fnmr = rates_fnmr(r, threshold),
                              .low = low.fnmr,
                              .high = high.fnmr};
    widen(d, out);
    return ST_OK;
}

static enum status curve(const struct rates *r, size_t pairs, uint64_t seed,
                         struct det *d)
{
    double fmr[DET_POINTS], low[DET_POINTS], high[DET_POINTS];
    size_t n = 0;
    enum status st;

    while (n < DET_POINTS && rates_supported(rate[n], pairs) &&
           isfinite(rates_at(r, rate[n])))
        n++;
    for (size_t k = 0; k < n; k++)
        fmr[k] = rate[n - 1 - k]; /* rising */
    st = rates_bootstrap_det(r, fmr, n, RATES_REPLICATES, seed, low, high);
    for (size_t k = 0; k < n && st == ST_OK; k++) {
        const double at = rates_at(r, rate[k]);

        d->point[k] = (struct det_point){.score = at,
                                         .fmr = rate[k],
                                         .fnmr = rates_fnmr(r, at),
                                         .low = low[n - 1 - k],
                                         .high = high[n - 1 - k]};
        widen(d, &d->point[k]);
    }
    d->n = st == ST_OK ? (uint32_t)n : 0;
    return st;
}

enum status det_learn(const struct rates *r, size_t pairs, double own, double shipped,
                      uint64_t seed, struct det *out)
{
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = rates_people(r, &out->people)) != ST_OK || out->people < DET_PEOPLE)
        return st;
    if ((st = curve(r, pairs, seed, out)) == ST_OK && out->n > 0)
        st = det_at(r, own, seed, out, &out->own);
    if (st == ST_OK && out->n > 0)
        st = det_at(r, shipped, seed, out, &out->shipped);
    return st;
}

static bool is_point(const struct det_point *p)
{
    return isfinite(p->score) && p->fmr >= 0 && p->fmr <= 1 && p->low >= 0 &&
           p->low <= p->fnmr && p->fnmr <= p->high && p->high <= 1;
}

bool det_valid(const struct det *d)
{
    if (d->n > DET_POINTS || (d->n > 0 && (d->people < DET_PEOPLE || !is_point(&d->own) ||
                                           !is_point(&d->shipped))))
        return false;
    for (uint32_t i = 0; i < d->n; i++)
        if (!is_point(&d->point[i]) ||
            (i > 0 && !(d->point[i].score >= d->point[i - 1].score &&
                        d->point[i].fmr < d->point[i - 1].fmr &&
                        d->point[i].fnmr >= d->point[i - 1].fnmr)))
            return false;
    return true;
}
