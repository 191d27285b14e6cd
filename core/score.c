#include "score.h"

#include <math.h>
#include <string.h>

#include "lattice.h"
#include "tuning.h"

float score_weight_at(const void *arg, double x, double y, double z)
{
    const struct score_weight *w = arg;
    const double mm = 1 / LATTICE_PER_MM;
    const struct dvec3 q =
        align_pose_apply(&w->frame, (struct dvec3){mm * x, mm * y, mm * z});
    const uint32_t i = grid_cell(q.x, q.y);

    return i == GRID_NONE ? 0 : w->u[i];
}

/* The blur: a Gaussian of one cell, cut off at three. */
#define BLUR 3
static const float bell[BLUR + 1] = {1.0f, 0.60653066f, 0.13533528f, 0.011108997f};

/* The weighted sums over some cells: of the amounts, of their rough part, of u. */
struct part {
    double sum, rough, covered, whole;
};

/* A cell more, with its amounts and weights. */
static void add(struct part *p, const struct part *cell)
{
    p->sum += cell->covered * cell->sum;
    p->rough += cell->covered * cell->rough;
    p->covered += cell->covered;
    p->whole += cell->whole;
}

static double mean(const struct part *p)
{
    const double left = p->sum - SCORE_ROUGH * p->rough;

    return p->covered > 0 && left > 0 ? left / p->covered : 0;
}

/* in (GRID_N) blurred along x (step 1, n = GRID_NX) or y (step GRID_NX, n = GRID_NY). */
static void blur_along(const float *in, uint32_t step, uint32_t n, float *out)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t at = i / step % n;
        float s = bell[0] * in[i];

        for (uint32_t d = 1; d <= BLUR; d++) {
            s += at >= d ? bell[d] * in[i - d * step] : 0.0f;
            s += at + d < n ? bell[d] * in[i + d * step] : 0.0f;
        }
        out[i] = s;
    }
}

/* rough: the rest minus the rest blurred over the covered cells. */
static void roughness(const struct cells *c, const float *rest, float *rough)
{
    float seen[GRID_N], half[GRID_N], sum[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        seen[i] = cells_cover(c, i);
    for (uint32_t i = 0; i < GRID_N; i++)
        rough[i] = seen[i] * rest[i];
    blur_along(rough, 1, GRID_NX, half);
    blur_along(half, GRID_NX, GRID_NY, rough);
    blur_along(seen, 1, GRID_NX, half);
    blur_along(half, GRID_NX, GRID_NY, sum);
    for (uint32_t i = 0; i < GRID_N; i++)
        rough[i] = seen[i] > 0.0f ? rest[i] - rough[i] / sum[i] : 0.0f;
}

static double capped(float mm, float cap)
{
    const float a = fabsf(mm);

    return (double)(a < cap ? a : cap);
}

/* Cell i as the sums take it. */
static struct part cell_part(const struct model *m, const struct cells *c,
                             const float *rest, const float *rough, uint32_t i)
{
    const double u = (double)m->weight[i];

    return (struct part){.sum = capped(rest[i], m->cap_mm),
                         .rough = capped(rough[i], m->cap_mm),
                         .covered = u * (double)cells_cover(c, i),
                         .whole = u};
}

/* What the score is multiplied by, by the share of the weight covered. */
static double thin(double weight)
{
    return 1 + SCORE_THIN * fmax(0, SCORE_WHOLE - weight);
}

enum status score_of(const struct model *m, const struct fit_basis *change,
                     const struct cells *c, struct scratch *s, struct fit *fit,
                     struct score *out)
{
    struct part all = {0}, part[GRID_REGIONS] = {{0}};
    float rough[GRID_N];
    double taken = 0;
    uint32_t n = 0;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = fit_solve(change, c, SCORE_TIE, SCORE_PASSES, s, fit)) != ST_OK)
        return st;
    roughness(c, fit->rest, rough);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const struct part one = cell_part(m, c, fit->rest, rough, i);

        if (m->change.rest[i] <= 0.0f)
            continue;
        add(&part[grid_region_of(i)], &one);
        if (one.covered <= 0)
            continue;
        taken += ((double)c->gap[i] - (double)fit->rest[i]) *
                 ((double)c->gap[i] - (double)fit->rest[i]);
        n++;
    }
    for (int r = 0; r < GRID_REGIONS; r++) {
        all.sum += part[r].sum;
        all.rough += part[r].rough;
        all.covered += part[r].covered;
        all.whole += part[r].whole;
    }
    out->weight = all.whole > 0 ? all.covered / all.whole : 0;
    out->mm = mean(&all) * thin(out->weight);
    out->change_mm = n > 0 ? sqrt(taken / n) : 0;
    out->rough_mm = all.covered > 0 ? all.rough / all.covered : 0;
    for (int r = 0; r < GRID_REGIONS; r++) {
        const bool seen = part[r].covered > SCORE_REGION_MIN * part[r].whole;

        out->region_mm[r] = seen ? mean(&part[r]) : (double)NAN;
        out->region_weight[r] = all.whole > 0 ? part[r].whole / all.whole : 0;
    }
    return ST_OK;
}

static bool in_upper(uint32_t cell)
{
    const double x = grid_x(cell), y = grid_y(cell);
    const bool nose = fabs(x) < SCORE_NOSE_X_MM && y > SCORE_NOSE_LOW_MM;

    return nose || y > SCORE_UPPER_MM;
}

static bool in_lower(uint32_t cell)
{
    return grid_y(cell) < SCORE_LOWER_MM;
}

static bool in_middle(uint32_t cell)
{
    return in_upper(cell) && fabs(grid_x(cell)) < SCORE_MIDDLE_X_MM &&
           grid_y(cell) < SCORE_MIDDLE_MM;
}

void score_prepare_part(const struct model *m, enum score_part p, struct fit_basis *out)
{
    static bool (*const in[SCORE_PARTS])(uint32_t) = {in_upper, in_lower, in_middle};

    fit_prepare_part(&m->change, in[p], out);
}

enum status score_of_part(const struct model *m, enum score_part p,
                          const struct fit_basis *change, const struct cells *c,
                          struct scratch *s, double *mm)
{
    struct cells part = *c;
    struct part sum = {0};
    float rough[GRID_N];
    struct fit fit;
    enum status st;

    *mm = INFINITY;
    for (uint32_t i = 0; i < GRID_N; i++)
        if (!change->used[i])
            part.area[i] = 0.0f;
    if ((st = fit_solve(change, &part, SCORE_TIE, SCORE_PASSES, s, &fit)) != ST_OK)
        return st;
    roughness(&part, fit.rest, rough);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const struct part one = cell_part(m, &part, fit.rest, rough, i);

        if (change->used[i])
            add(&sum, &one);
    }
    if (sum.covered > SCORE_PART_SEEN * sum.whole)
        *mm = mean(&sum) * (p == SCORE_MIDDLE ? SCORE_MIDDLE_MORE : 1);
    return ST_OK;
}

void score_cells(const struct model *m, const struct cells *c, const struct fit *fit,
                 const struct score *s, struct score_cells *out)
{
    float rough[GRID_N];
    double sum = 0;

    roughness(c, fit->rest, rough);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const double left =
            capped(fit->rest[i], m->cap_mm) - SCORE_ROUGH * capped(rough[i], m->cap_mm);

        out->weight[i] = m->change.rest[i] > 0.0f ? m->weight[i] * cells_cover(c, i) : 0;
        out->local_mm[i] = out->weight[i] > 0.0f ? (float)(left * thin(s->weight)) : 0.0f;
        sum += (double)out->weight[i];
    }
    for (uint32_t i = 0; i < GRID_N && sum > 0; i++)
        out->weight[i] = (float)((double)out->weight[i] / sum);
}
