#include "surface_basic.h"

#include <math.h>
#include <stdbool.h>

#define LARGEST 1e4

static bool is_score(double x)
{
    return fabs(x) < LARGEST; /* false for NAN */
}

static bool tail_valid(const struct surface_calibration *c)
{
    const struct surface_tail *t = &c->tail;

    return t->people == 0 || (t->rate > 0 && t->rate <= c->knot[c->n - 1].rate &&
                              t->decade > 0 && is_score(t->decade));
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
    return tail_valid(c);
}

void surface_calibration_continue(struct surface_calibration *c,
                                  const struct surface_calibration *by)
{
    c->tail = by->tail;
    c->tail.rate = c->knot[c->n - 1].rate;
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

/* ---- identification */

/* e^-x for x >= 0, by + - * / only: the same digits on every machine.  The series is of a 1024th of x,
 * and ten squarings take its 1024th power. */
static double exp_minus(double x)
{
    const double part = x / 1024;
    double sum = 1;

    if (!(x < 700))
        return 0;
    for (int k = 12; k > 0; k--)
        sum = 1 - sum * part / k;
    for (int k = 0; k < 10; k++)
        sum *= sum;
    return sum;
}

/* 1 - (1 - rate)^n, of rates p and q as p + q - p q, which small rates do not lose digits by. */
static double of_many(double rate, uint32_t n)
{
    double all = 0;

    for (; n > 0; n /= 2) {
        if (n % 2 != 0)
            all += rate - all * rate;
        rate += rate - rate * rate;
    }
    return all;
}

static double fpir(const struct surface_calibration *c, uint32_t people, double score,
                   bool by_law)
{
    const double beyond = score - c->knot[c->n - 1].score, ln10 = 2.302585092994045684;

    if (!(by_law && beyond >= 0))
        return of_many(surface_calibration_rate(c, score), people);
    return of_many(c->tail.rate * exp_minus(ln10 * beyond / c->tail.decade), people);
}

double surface_search_fpir(const struct surface_calibration *c, uint32_t people,
                           double score, int *extrapolated)
{
    const bool law = c->tail.people > 0;

    if (extrapolated != NULL)
        *extrapolated = law && score >= c->knot[c->n - 1].score;
    return fpir(c, people, score, law);
}

double surface_search_threshold(const struct surface_calibration *c, uint32_t people)
{
    const bool law = people <= c->tail.people;
    int64_t low = (int64_t)floor(c->threshold * 1000), high = (int64_t)(LARGEST * 1000);

    if (fpir(c, people, c->threshold, law) <= SURFACE_FPIR)
        return c->threshold;
    if (fpir(c, people, LARGEST, law) > SURFACE_FPIR)
        return (double)INFINITY;
    while (high - low > 1) { /* low: too many matches */
        const int64_t mid = low + (high - low) / 2;

        if (fpir(c, people, (double)mid / 1000, law) <= SURFACE_FPIR)
            high = mid;
        else
            low = mid;
    }
    return (double)high / 1000;
}

uint32_t surface_search_people(const struct surface_calibration *c)
{
    uint32_t most = 0;

    for (uint32_t bit = UINT32_C(1) << 31; bit > 0; bit /= 2)
        if (fpir(c, most + bit, LARGEST, most + bit <= c->tail.people) <= SURFACE_FPIR)
            most += bit;
    return most;
}
