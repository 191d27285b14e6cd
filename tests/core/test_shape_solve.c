/* A face's shape and motion by least squares: compared with a dense solver, also where a solution
 * follows another; too few cells. */
#include "brute.h"
#include "dense.h"
#include "pose.h"
#include "shape_solve.h"
#include "shape_work.h"
#include "toy.h"
#include "unit.h"

#define MOST (6 + MODEL_MODES)

static struct surface_model model;
static struct shape_work work; /* its basis and normals */
static struct shape_solve solve;
static struct draw rng;
static float over[GRID_N], weight[GRID_N];

/* A row by definition: how the height at cell i changes with each turn by 1 mm at the lever's length
 * and each shift by 1 mm, negated; and with each coefficient. */
static void row_of(uint32_t i, uint32_t modes, double *row)
{
    const double p[3] = {grid_x(i), grid_y(i), (double)work.mean[i] + POSE_LEVER_MM};
    const float *normal = work.normal[i];
    const double m[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};

    for (int k = 0; k < 6; k++) {
        double x[6] = {0};

        x[k] = k < 3 ? 1 / POSE_LEVER_MM : 1;
        row[k] = -(m[0] * (x[1] * p[2] - x[2] * p[1] + x[3]) +
                   m[1] * (x[2] * p[0] - x[0] * p[2] + x[4]) +
                   m[2] * (x[0] * p[1] - x[1] * p[0] + x[5])) /
                 m[2];
    }
    for (uint32_t k = 0; k < modes; k++)
        row[6 + k] = (double)model.shape.mode[i][k];
}

static void naive(const struct shape_prior *prior, uint32_t modes, double y[MOST])
{
    static double m[MOST * MOST];
    const uint32_t n = 6 + modes;
    double row[MOST];

    memset(m, 0, sizeof m);
    memset(y, 0, MOST * sizeof *y);
    for (uint32_t i = 0; i < GRID_N; i++) {
        double by = (double)weight[i];

        if (isnan(work.mean[i]) || !(weight[i] > 0.0f))
            continue;
        by /= (double)model.shape.rest[i] * (double)model.shape.rest[i];
        row_of(i, modes, row);
        for (uint32_t k = 0; k < n; k++) {
            for (uint32_t j = 0; j < n; j++)
                m[k * n + j] += by * row[k] * row[j];
            y[k] += by * row[k] * (double)over[i];
        }
    }
    for (uint32_t k = 0; k < n; k++)
        m[k * n + k] += k < 6 ? prior->x : prior->a;
    (void)dense_solve(m, n, y, 1);
}

static void check(const struct shape_prior *prior)
{
    const uint32_t modes = prior->modes < model.shape.n ? prior->modes : model.shape.n;
    struct shape_solution got;
    double y[MOST], scale = 1;

    naive(prior, modes, y);
    shape_solve(&work.basis, over, weight, prior, &solve, &got);
    for (uint32_t k = 0; k < 6 + modes; k++)
        scale = fmax(scale, fabs(y[k]));
    for (uint32_t k = 0; k < 6; k++)
        assert_true(fabs(got.x[k] * (k < 3 ? POSE_LEVER_MM : 1) - y[k]) < 2e-4 * scale);
    for (uint32_t k = 0; k < MODEL_MODES; k++)
        assert_true(k < modes ? fabs(got.a[k] - y[6 + k]) < 2e-4 * scale : got.a[k] == 0);
}

/* Weights of which a share is 1, a share 0; what has none is no number. */
static void draw(double one, double none)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        const double p = draw_uniform(&rng, 0, 1);

        weight[i] = p < one          ? 1.0f
                    : p < one + none ? 0.0f
                                     : (float)draw_uniform(&rng, 0, 1);
        over[i] = weight[i] > 0.0f ? (float)draw_uniform(&rng, -2, 2) : (float)NAN;
    }
}

/* From the whole face's sum, from none, and from the one before; with more modes than it had. */
TEST(test_against_naive)
{
    for (int round = 0; round < 12; round++) {
        solve.width = 0;
        draw(0.1 * (round % 5), 0.1 * (round % 4));
        check(&(struct shape_prior){10, 0.01, 8});
        for (int k = 0; k < 4; k++) {
            for (uint32_t i = (uint32_t)k; i < GRID_N; i += 7) {
                weight[i] = k == 2 ? 0.0f : (float)draw_uniform(&rng, 0, 1);
                over[i] = weight[i] > 0.0f ? (float)k - 1.5f : (float)NAN;
            }
            check(&(struct shape_prior){k < 2 ? 100 : 1, 0.01, MODEL_MODES});
        }
        draw(0.9, 0.05);
        check(&(struct shape_prior){20, 1, MODEL_MODES});
        draw(0.05, 0.9);
        check(&(struct shape_prior){20, 1, 8});
    }
}

TEST(test_few)
{
    const struct shape_prior prior = {1, 1, MODEL_MODES};
    struct shape_solution s;

    for (uint32_t keep = SHAPE_LEAST - 1; keep <= SHAPE_LEAST; keep++) {
        memset(weight, 0, sizeof weight);
        for (uint32_t r = 0; r < keep; r++) {
            weight[work.basis.cell[r]] = 0.5f;
            over[work.basis.cell[r]] = 1.0f;
        }
        shape_solve(&work.basis, over, weight, &prior, &solve, &s);
        assert_true((s.x[5] != 0) == (keep == SHAPE_LEAST));
    }
}

TEST(test_bend)
{
    float height[GRID_N];
    double a[MODEL_MODES];

    for (uint32_t k = 0; k < MODEL_MODES; k++)
        a[k] = draw_uniform(&rng, -1, 1);
    for (uint32_t n = 0; n <= model.shape.n; n++) {
        for (uint32_t i = 0; i < GRID_N; i++)
            height[i] = -7;
        shape_bend(&work.basis, work.mean, a, n, height);
        for (uint32_t i = 0; i < GRID_N; i++) {
            double want = isnan(work.mean[i]) ? -7 : (double)work.mean[i];

            for (uint32_t k = 0; k < n && !isnan(work.mean[i]); k++)
                want += a[k] * (double)model.shape.mode[i][k];
            assert_true(fabs((double)height[i] - want) < 1e-4);
        }
    }
}

BEFORE_ALL(set_up)
{
    rng.x = brute_seed("shape_solve");
    toy_model(&model);
    shape_work_prepare(&model, &work);
}

AFTER_ALL(tear_down)
{
    shape_work_free(&work);
}
