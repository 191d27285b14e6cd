/* How much of a face's fine relief a surface has, against the definition, and what changes it. */
#include "brute.h"
#include "shape_work.h"
#include "toy.h"
#include "unit.h"

static struct surface_model model;
static struct shape_work work;
static float z[GRID_N]; /* NAN: not seen */

/* All of the mean face, seen. */
static void see_all(void)
{
    memcpy(z, work.mean, sizeof z);
}

/* Of the surface z. */
static double detail(void)
{
    float over[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        over[i] = z[i] - work.mean[i];
    return shape_detail(work.fine, work.over_rest, over);
}

/* v less the mean of it over the square round cell i, of the cells that `on` says; *all: the
 * square is whole. */
static double above(const double *v, const bool *on, uint32_t i, bool *all)
{
    double sum = 0;
    int n = 0;

    for (int y = -SHAPE_FINE; y <= SHAPE_FINE; y++)
        for (int x = -SHAPE_FINE; x <= SHAPE_FINE; x++) {
            const int at[2] = {(int)(i % GRID_NX) + x, (int)(i / GRID_NX) + y};
            const int k = at[1] * GRID_NX + at[0];

            if (at[0] < 0 || at[1] < 0 || at[0] >= GRID_NX || at[1] >= GRID_NY || !on[k])
                continue;
            sum += v[k];
            n++;
        }
    *all = n == (2 * SHAPE_FINE + 1) * (2 * SHAPE_FINE + 1);
    return v[i] - sum / n;
}

/* By the definition. */
static double reference(void)
{
    static double mean[GRID_N], over[GRID_N];
    static bool face[GRID_N], seen[GRID_N];
    double sum = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        face[i] = !isnan(work.mean[i]);
        seen[i] = !isnan(z[i]);
        mean[i] = (double)work.mean[i];
        over[i] = (double)z[i] - mean[i];
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        bool whole, any;
        double m;

        if (!seen[i])
            continue;
        m = above(mean, face, i, &whole);
        if (!whole)
            continue;
        sum += (double)work.over_rest[i] * m * (m + above(over, seen, i, &any));
        all += (double)work.over_rest[i] * m * m;
    }
    return all > 0 ? sum / all : 0;
}

/* Any heights, seen anywhere. */
TEST(test_definition)
{
    struct brute_rng rng = {brute_seed("detail")};

    for (int k = 0; k < 200; k++) {
        const double share = k == 0 ? 0 : brute_real(&rng);

        see_all();
        for (uint32_t i = 0; i < GRID_N; i++)
            z[i] = brute_real(&rng) < share ? z[i] + (float)(6 * brute_real(&rng) - 3)
                                            : (float)NAN;
        assert_true(fabs(detail() - reference()) < 1e-4);
    }
}

BEFORE_ALL(set_up)
{
    toy_model(&model);
    shape_work_prepare(&model, &work);
}
