#include "explain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "heatmap.h"
#include "mem.h"

const double explain_levels[EXPLAIN_QUANTILES] = {0.5, 0.75, 0.9, 0.95, 0.99, 1};

/* ---- how a field is spread */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* The smallest value that no less than the share `level` of them reach; v is sorted. */
static double quantile(const double *v, size_t n, double level)
{
    return v[(size_t)ceil(level * (double)n - 1e-9) - 1];
}

/* v is reordered and loses its signs. */
static void spread(double *v, size_t n, struct explain_spread *out)
{
    memset(out, 0, sizeof *out);
    out->n = n;
    out->median_mm = out->mean_mm = out->beyond = NAN;
    for (size_t k = 0; k < EXPLAIN_QUANTILES; k++)
        out->quantile_mm[k] = NAN;
    if (n == 0)
        return;
    qsort(v, n, sizeof *v, by_value);
    out->median_mm = quantile(v, n, 0.5);
    out->mean_mm = out->beyond = 0;
    for (size_t i = 0; i < n; i++) {
        const double at = (v[i] / EXPLAIN_GAP_MM + 1) / 2 * EXPLAIN_BINS;
        const double share = 1 / (double)n;

        out->bin[at < 0               ? 0
                 : at >= EXPLAIN_BINS ? EXPLAIN_BINS - 1
                                      : (size_t)at] += share;
        v[i] = fabs(v[i]);
        out->mean_mm += v[i] * share;
        out->beyond += v[i] > EXPLAIN_BEYOND_MM ? share : 0;
    }
    qsort(v, n, sizeof *v, by_value);
    for (size_t k = 0; k < EXPLAIN_QUANTILES; k++)
        out->quantile_mm[k] = quantile(v, n, explain_levels[k]);
}

static enum status find_spreads(struct explanation *x)
{
    double *v = mem_array(x->n > GRID_N ? x->n : GRID_N, sizeof *v);
    size_t n = 0;

    if (v == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < x->n; i++)
        if (!isnan(x->value[EXPLAIN_GAP][i]))
            v[n++] = x->value[EXPLAIN_GAP][i];
    spread(v, n, &x->gap);
    n = 0;
    for (size_t i = 0; i < GRID_N; i++)
        if (!isnan(x->field.gap_mm[i]))
            v[n++] = (double)x->field.gap_mm[i];
    spread(v, n, &x->cell);
    mem_free(v);
    return ST_OK;
}

/* ---- at a point */

/* A cell's values at a point of the template: linear between the middles of the cells that have
 * one; NAN where none of the four does. */
static double sample_cells(const float value[GRID_N], struct dvec3 at)
{
    double v = 0, sum = 0;

    for (int k = 0; k < 4; k++) {
        const double cx = at.x + (k % 2 - 0.5) * GRID_MM,
                     cy = at.y + (k / 2 - 0.5) * GRID_MM;
        const uint32_t i = grid_cell(cx, cy);
        double share;

        if (i == GRID_NONE || isnan(value[i]))
            continue;
        share = (1 - fabs(at.x - grid_x(i)) / GRID_MM) *
                (1 - fabs(at.y - grid_y(i)) / GRID_MM);
        sum += share;
        v += share * (double)value[i];
    }
    return sum > 0 ? v / sum : (double)NAN;
}

enum status explain_at(const struct explanation *x, struct dvec3 *pts, size_t n,
                       double *const value[EXPLAIN_KINDS])
{
    const double *t = x->result.align.transform;

    if (heatmap_gaps(&x->tmpl.surface, pts, n, t, value[EXPLAIN_GAP]) != ST_OK)
        return ST_ENOMEM;
    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = pts[i];

        pts[i] = (struct dvec3){t[0] * p.x + t[1] * p.y + t[2] * p.z + t[3],
                                t[4] * p.x + t[5] * p.y + t[6] * p.z + t[7],
                                t[8] * p.x + t[9] * p.y + t[10] * p.z + t[11]};
        value[EXPLAIN_CELL][i] = value[EXPLAIN_PART][i] = NAN;
        if (!isnan(value[EXPLAIN_GAP][i])) {
            const struct dvec3 q = pose_apply(&x->tmpl.frame.pose, pts[i]);

            value[EXPLAIN_CELL][i] = sample_cells(x->field.gap_mm, q);
            value[EXPLAIN_PART][i] = sample_cells(x->field.part, q);
        }
    }
    return ST_OK;
}

/* ---- all of it */

double explain_end(enum explain_kind kind)
{
    return kind == EXPLAIN_PART ? EXPLAIN_PART_END : EXPLAIN_GAP_MM;
}

enum status explain_fields(struct explanation *x, struct face_work *w)
{
    enum status st = face_field(&x->tmpl, &x->probe, w, &x->field);

    for (int k = 0; k < EXPLAIN_KINDS; k++)
        if ((x->value[k] = mem_array(x->n, sizeof *x->value[k])) == NULL)
            st = ST_ENOMEM;
    if (st == ST_OK)
        st = explain_at(x, x->pts, x->n, x->value);
    return st == ST_OK ? find_spreads(x) : st;
}

void explain_free(struct explanation *x)
{
    for (int k = 0; k < EXPLAIN_KINDS; k++)
        mem_free(x->value[k]);
    mem_free(x->pts);
    face_free(&x->tmpl);
    face_free(&x->probe);
}
