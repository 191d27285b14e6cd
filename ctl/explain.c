#include "explain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "heatmap.h"
#include "mem.h"

const double explain_levels[EXPLAIN_QUANTILES] = {0.5, 0.75, 0.9, 0.95, 0.99, 1};

/* ---- how a field is spread */

struct sample {
    double mm, weight;
};

static int by_value(const void *a, const void *b)
{
    const double x = ((const struct sample *)a)->mm, y = ((const struct sample *)b)->mm;

    return (x > y) - (x < y);
}

/* The smallest value that no less than the share `level` of the weight reaches; s is
 * sorted, and all weighs `all`. */
static double quantile(const struct sample *s, size_t n, double all, double level)
{
    double sum = 0;

    for (size_t i = 0; i + 1 < n; i++) {
        sum += s[i].weight;
        if (sum >= level * all * (1 - 1e-12))
            return s[i].mm;
    }
    return s[n - 1].mm;
}

/* s is reordered and loses its signs. */
static void spread(struct sample *s, size_t n, double end_mm, double limit_mm,
                   struct explain_spread *out)
{
    double all = 0;

    memset(out, 0, sizeof *out);
    out->n = n;
    out->end_mm = end_mm;
    out->limit_mm = limit_mm;
    out->median_mm = out->mean_mm = out->beyond = NAN;
    for (size_t k = 0; k < EXPLAIN_QUANTILES; k++)
        out->quantile_mm[k] = NAN;
    for (size_t i = 0; i < n; i++)
        all += s[i].weight;
    if (n == 0)
        return;
    qsort(s, n, sizeof *s, by_value);
    out->median_mm = quantile(s, n, all, 0.5);
    out->mean_mm = out->beyond = 0;
    for (size_t i = 0; i < n; i++) {
        const double at = (s[i].mm / end_mm + 1) / 2 * EXPLAIN_BINS;
        const double share = s[i].weight / all;

        out->bin[at < 0               ? 0
                 : at >= EXPLAIN_BINS ? EXPLAIN_BINS - 1
                                      : (size_t)at] += share;
        s[i].mm = fabs(s[i].mm);
        out->mean_mm += s[i].mm * share;
        out->beyond += s[i].mm > limit_mm ? share : 0;
    }
    qsort(s, n, sizeof *s, by_value);
    for (size_t k = 0; k < EXPLAIN_QUANTILES; k++)
        out->quantile_mm[k] = quantile(s, n, all, explain_levels[k]);
}

static enum status find_spreads(struct explanation *x)
{
    struct sample *s = mem_array(x->n > GRID_N ? x->n : GRID_N, sizeof *s);
    size_t n = 0;

    if (s == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < x->n; i++)
        if (!isnan(x->value[EXPLAIN_GAP][i]))
            s[n++] = (struct sample){x->value[EXPLAIN_GAP][i], 1};
    spread(s, n, EXPLAIN_GAP_MM, EXPLAIN_BEYOND_MM, &x->gap);
    n = 0;
    for (size_t i = 0; i < GRID_N; i++)
        if (x->field.weight[i] > 0.0f)
            s[n++] =
                (struct sample){(double)x->field.rest_mm[i], (double)x->field.weight[i]};
    spread(s, n, explain_end(x, EXPLAIN_REST), x->result.threshold_mm, &x->rest);
    mem_free(s);
    return ST_OK;
}

/* ---- at a point */

/* The rest and the part at a point of the template: linear between the middles of the cells
 * that count; NAN where none of the four does. */
static void sample_cells(const struct explanation *x, struct dvec3 p, double *rest,
                         double *part)
{
    const struct face_field *f = &x->field;
    const struct dvec3 q = align_pose_apply(&x->tmpl.frame.pose, p);
    const double scale = (double)x->cells / x->result.threshold_mm;
    double sum = 0;

    *rest = *part = 0;
    for (int k = 0; k < 4; k++) {
        const double cx = q.x + (k % 2 - 0.5) * GRID_MM,
                     cy = q.y + (k / 2 - 0.5) * GRID_MM;
        const uint32_t i = grid_cell(cx, cy);
        double share;

        if (i == GRID_NONE || f->weight[i] <= 0.0f)
            continue;
        share =
            (1 - fabs(q.x - grid_x(i)) / GRID_MM) * (1 - fabs(q.y - grid_y(i)) / GRID_MM);
        sum += share;
        *rest += share * (double)f->rest_mm[i];
        *part += share * (double)f->local_mm[i] * (double)f->weight[i] * scale;
    }
    *rest = sum > 0 ? *rest / sum : (double)NAN;
    *part = sum > 0 ? *part / sum : (double)NAN;
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
        value[EXPLAIN_REST][i] = value[EXPLAIN_PART][i] = NAN;
        if (!isnan(value[EXPLAIN_GAP][i]))
            sample_cells(x, pts[i], &value[EXPLAIN_REST][i], &value[EXPLAIN_PART][i]);
    }
    return ST_OK;
}

/* ---- all of it */

double explain_end(const struct explanation *x, enum explain_kind kind)
{
    return kind == EXPLAIN_GAP    ? EXPLAIN_GAP_MM
           : kind == EXPLAIN_REST ? EXPLAIN_TIMES * x->result.threshold_mm
                                  : EXPLAIN_TIMES;
}

enum status explain_fields(struct explanation *x, struct face_work *w)
{
    enum status st =
        face_field(&x->tmpl, &x->probe, x->result.align.transform, w, &x->field);

    for (size_t i = 0; i < GRID_N; i++)
        x->cells += x->field.weight[i] > 0.0f;
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
