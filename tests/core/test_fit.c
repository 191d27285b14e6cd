/* Splitting a gap into motion, change and rest: compared with a dense solver; too few cells. */
#include "pose.h"
#include "brute.h"
#include "cells.h"
#include "dense.h"
#include "fit.h"
#include "toy.h"
#include "unit.h"

#define MOST (MODEL_MODES + 6)

static struct surface_model model;
static struct fit_basis changed; /* the model's change, prepared */
static struct scratch scratch;
static struct cells cells;
static struct fit fit;
static uint64_t seed;

/* All cells of the mean face are covered, without a gap. */
static void no_gap(struct cells *c)
{
    toy_cells(&model, model.mean, model.mean, c);
}

/* What a motion x of the probe adds to the gap of cell i: the normal component of its turn
 * about the lever's point and of its shift. */
static double moves(const struct cells *c, uint32_t i, const double x[6])
{
    const double p[3] = {grid_x(i), grid_y(i), (double)c->z[i] + POSE_LEVER_MM};
    const double m[3] = {(double)c->normal[i][0], (double)c->normal[i][1],
                         (double)c->normal[i][2]};
    const double len = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    const double d[3] = {x[1] * p[2] - x[2] * p[1] + x[3],
                         x[2] * p[0] - x[0] * p[2] + x[4],
                         x[0] * p[1] - x[1] * p[0] + x[5]};

    return (m[0] * d[0] + m[1] * d[1] + m[2] * d[2]) / len;
}

/* One row by definition: the modes; then, negated, the effect of each turn by 1 mm at the
 * lever's length and of each shift by 1 mm. */
static void row_of(const struct model_basis *b, const struct cells *c, uint32_t i,
                   double *row)
{
    for (uint32_t k = 0; k < b->n; k++)
        row[k] = (double)b->mode[i][k];
    for (uint32_t k = 0; k < 6; k++) {
        double x[6] = {0};

        x[k] = k < 3 ? 1 / POSE_LEVER_MM : 1;
        row[b->n + k] = -moves(c, i, x);
    }
}

/* fit_solve() by definition, in double. */
static void naive(const struct model_basis *b, const struct cells *c, double tie,
                  int passes, double *y, double *rest)
{
    static double m[MOST * MOST], share[GRID_N]; /* of its full weight, by cell */
    const uint32_t n = b->n + 6;
    double row[MOST];

    memset(rest, 0, GRID_N * sizeof *rest);
    for (int pass = 0; pass <= passes; pass++) {
        memset(m, 0, sizeof m);
        memset(y, 0, n * sizeof *y);
        for (uint32_t i = 0; i < GRID_N; i++) {
            const double over = 1 / (double)b->rest[i], z = fabs(rest[i]) * over;
            const double now = z > FIT_HUBER ? FIT_HUBER / z : 1;
            double w;

            if (pass == 0)
                share[i] = 1;
            else if (fabs(now - share[i]) > FIT_STILL)
                share[i] = now;
            w = over * over * (double)cells_cover(c, i) * share[i];
            if (c->area[i] < CELLS_COVERED || b->rest[i] <= 0.0f)
                continue;
            row_of(b, c, i, row);
            for (uint32_t k = 0; k < n; k++) {
                for (uint32_t j = 0; j < n; j++)
                    m[k * n + j] += w * row[k] * row[j];
                y[k] += w * row[k] * (double)c->gap[i];
            }
        }
        for (uint32_t k = 0; k < n; k++)
            m[k * n + k] += k < b->n ? 1 : tie;
        (void)dense_solve(m, n, y, 1);
        for (uint32_t i = 0; i < GRID_N; i++) {
            if (c->area[i] < CELLS_COVERED || b->rest[i] <= 0.0f)
                continue;
            row_of(b, c, i, row);
            rest[i] = (double)c->gap[i];
            for (uint32_t k = 0; k < n; k++)
                rest[i] -= row[k] * y[k];
        }
    }
}

static void noisy(struct draw *rng, double amount)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        if (cells.area[i] > 0.0f)
            cells.gap[i] += (float)(amount * draw_uniform(rng, -0.5, 0.5));
}

/* Random gaps over random parts, and random modes: the coefficients, motion and rest are
 * those of the dense solver. */
TEST(test_against_naive)
{
    struct draw rng = {seed};

    for (int round = 0; round < 24; round++) {
        static struct model_basis b;
        static struct fit_basis p;
        static double rest[GRID_N];
        const double tie = round % 2 == 0 ? 4 : 0.01;
        const int passes = round % 3;
        double y[MOST], scale = 1;

        b = model.change;
        b.n = (uint32_t)brute_int(&rng, 0, round < 12 ? 8 : MODEL_MODES);
        for (uint32_t i = 0; i < GRID_N; i++)
            for (uint32_t k = 0; k < MODEL_MODES; k++)
                b.mode[i][k] = k < b.n ? (float)draw_uniform(&rng, -0.5, 0.5) : 0.0f;
        no_gap(&cells);
        noisy(&rng, 2);
        for (uint32_t i = 0; i < GRID_N; i++)
            if (draw_uniform(&rng, 0, 1) < 0.1 * (round % 5))
                cells.area[i] = (float)draw_uniform(&rng, 0, 8); /* some not covered */
        fit_prepare(&b, &p);
        assert_int_equal(fit_solve(&p, &cells, tie, passes, &scratch, &fit), ST_OK);
        naive(&b, &cells, tie, passes, y, rest);
        for (uint32_t k = 0; k < b.n + 6; k++)
            scale = fmax(scale, fabs(y[k]));
        for (uint32_t k = 0; k < b.n; k++)
            assert_true(fabs(fit.a[k] - y[k]) < 2e-4 * scale);
        for (uint32_t k = 0; k < 6; k++)
            assert_true(fabs(fit.x[k] * (k < 3 ? POSE_LEVER_MM : 1) - y[b.n + k]) <
                        2e-4 * scale);
        for (uint32_t k = b.n; k < MODEL_MODES; k++)
            assert_true(fit.a[k] == 0);
        for (uint32_t i = 0; i < GRID_N; i++)
            assert_true(fabs((double)fit.rest[i] - rest[i]) < 2e-4);
    }
}

TEST(test_few)
{
    static const double motion[6] = {0.004, -0.006, 0.005, 0.3, -0.4, 0.2};

    for (uint32_t keep = FIT_MIN_CELLS + 1; keep-- > FIT_MIN_CELLS - 2;) {
        uint32_t n = 0;

        no_gap(&cells);
        for (uint32_t i = 0; i < GRID_N; i++) {
            cells.gap[i] -= cells.area[i] > 0.0f ? (float)moves(&cells, i, motion) : 0.0f;
            if (cells.area[i] > 0.0f && n++ >= keep)
                cells.area[i] = 0.0f;
        }
        assert_int_equal(fit_solve(&changed, &cells, 1, 2, &scratch, &fit), ST_OK);
        assert_int_equal(fit.cells, keep);
        for (int k = 0; k < 6; k++) {
            assert_true((fit.x[k] != 0) == (keep >= FIT_MIN_CELLS));
            assert_true(isfinite(fit.deviation[k]) == (keep >= FIT_MIN_CELLS));
        }
        for (uint32_t i = 0; i < GRID_N; i++)
            assert_true(keep >= FIT_MIN_CELLS || cells.area[i] < CELLS_COVERED ||
                        fit.rest[i] == cells.gap[i]);
    }
    memset(&cells, 0, sizeof cells);
    assert_int_equal(fit_solve(&changed, &cells, 1, 2, &scratch, &fit), ST_OK);
    assert_int_equal(fit.cells, 0);
}

BEFORE_ALL(set_up)
{
    seed = brute_seed("fit");
    toy_model(&model);
    fit_prepare(&model.change, &changed);
}
