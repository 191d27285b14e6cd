#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "ctl_explain.h"
#include "heatmap.h"
#include "vec.h"

const double ctl_explain_levels[EXPLAIN_QUANTILES] = {0.5, 0.75, 0.9, 0.95, 0.99, 1};

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* Of n sorted numbers, n > 0: the smallest that no less than the share `level` reaches. */
static double quantile(const double *sorted, size_t n, double level)
{
    const double rank = ceil(level * (double)n);

    return sorted[rank < 1 ? 0 : (size_t)rank - 1];
}

/* s: the n gaps there are; they are reordered. */
static void summarise(double *s, size_t n, struct explain_gap *out)
{
    size_t beyond = 0;

    memset(out, 0, sizeof *out);
    out->compared = n;
    out->median_mm = out->beyond = NAN;
    for (size_t k = 0; k < EXPLAIN_QUANTILES; k++)
        out->quantile_mm[k] = NAN;
    if (n == 0)
        return;
    qsort(s, n, sizeof *s, by_size);
    out->median_mm = quantile(s, n, 0.5);
    for (size_t i = 0; i < n; i++) {
        const double at = (s[i] / EXPLAIN_SCALE_MM + 1) / 2 * EXPLAIN_BINS;

        out->bin[at < 0 ? 0 : at >= EXPLAIN_BINS ? EXPLAIN_BINS - 1 : (size_t)at]++;
        s[i] = fabs(s[i]);
        beyond += s[i] > EXPLAIN_BEYOND_MM;
    }
    out->beyond = (double)beyond / (double)n;
    qsort(s, n, sizeof *s, by_size);
    for (size_t k = 0; k < EXPLAIN_QUANTILES; k++)
        out->quantile_mm[k] = quantile(s, n, ctl_explain_levels[k]);
}

enum status ctl_explain_gap(struct explanation *x)
{
    const double *t = x->result.align.transform;
    double *there = mem_array(x->n, sizeof *there);
    size_t n = 0;

    x->gap = mem_array(x->n, sizeof *x->gap);
    if (there == NULL || x->gap == NULL) {
        mem_free(there);
        return ST_ENOMEM;
    }
    heatmap_gaps(&x->tmpl.surface, x->pts, x->n, t, x->gap);
    for (size_t i = 0; i < x->n; i++) {
        const struct dvec3 p = x->pts[i];

        x->pts[i] = (struct dvec3){t[0] * p.x + t[1] * p.y + t[2] * p.z + t[3],
                                   t[4] * p.x + t[5] * p.y + t[6] * p.z + t[7],
                                   t[8] * p.x + t[9] * p.y + t[10] * p.z + t[11]};
        if (!isnan(x->gap[i]))
            there[n++] = x->gap[i];
    }
    summarise(there, n, &x->sum);
    mem_free(there);
    return ST_OK;
}

void ctl_explain_color(double gap_mm, uint8_t rgb[3])
{
    static const double stop[5][3] = {
        {24, 61, 145}, {90, 150, 214}, {236, 236, 230}, {233, 128, 90}, {158, 16, 36}};
    const double at = (fmax(-1, fmin(1, gap_mm / EXPLAIN_SCALE_MM)) + 1) * 2;
    const int k = at < 3 ? (int)at : 3;

    for (int i = 0; i < 3; i++)
        rgb[i] =
            isnan(gap_mm)
                ? 150
                : (uint8_t)lround(stop[k][i] + (at - k) * (stop[k + 1][i] - stop[k][i]));
}
