/* The basis of shape: the modes that faces were made of, from scans in any pose with holes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "align_pose.h"
#include "brute.h"
#include "corpus.h"
#include "errinfo.h"
#include "face.h"
#include "model.h"
#include "surface.h"
#include "toy.h"
#include "train_set.h"
#include "train_shape.h"

#define SCANS 160

static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
static struct face face[SCANS];
static struct model model;

/* What the faces are made of: a hill on either cheek, a chin, a nose. */
static double mode(uint32_t k, double x, double y)
{
    static const double at[4][4] = {
        {32, -16, 18, 3}, {-32, -16, 18, 3}, {0, -58, 16, 2}, {0, 4, 14, 1.5}};
    const double u = (x - at[k][0]) / at[k][2], v = (y - at[k][1]) / at[k][2];
    const double w = 1 + u * u + v * v;

    return at[k][3] / (w * w);
}

static double height(const void *arg, double x, double y)
{
    const double *a = arg;
    double z = toy_height(x, y);

    for (uint32_t k = 0; k < 4; k++)
        z += a[k] * mode(k, x, y);
    return z;
}

/* Of variance 1. */
static double coefficient(struct brute_rng *rng)
{
    return sqrt(12) * (brute_real(rng) - 0.5);
}

static void make_faces(struct brute_rng *rng)
{
    for (uint32_t i = 0; i < SCANS; i++) {
        struct align_pose pose;
        double a[4];

        for (uint32_t k = 0; k < 4; k++)
            a[k] = coefficient(rng);
        toy_pose(20 * brute_real(rng) - 10, 20 * brute_real(rng) - 10,
                 20 * brute_real(rng) - 10, (struct dvec3){3, 40, -7}, &pose);
        toy_scan(height, a, 1500, &pose, rng, &face[i].surface);
        face[i].frame.pose = align_pose_after(&pose, &still);
    }
}

/* The covariance of two cells' heights: as made, with mirror images; as learned. */
static double made(uint32_t c, uint32_t d)
{
    double sum = 0;

    for (uint32_t k = 0; k < 4; k++)
        for (int side = -1; side < 2; side += 2)
            sum += mode(k, side * grid_x(c), grid_y(c)) *
                   mode(k, side * grid_x(d), grid_y(d)) / 2;
    return sum;
}

static double learned(uint32_t c, uint32_t d)
{
    double sum = 0;

    for (uint32_t k = 0; k < model.shape.n; k++)
        sum += (double)model.shape.mode[c][k] * (double)model.shape.mode[d][k];
    return sum;
}

static void test_modes(void **state)
{
    const struct corpus corpus = {.nscan = SCANS};
    const struct train_set set = {&corpus, face};
    struct brute_rng rng = {11};
    static struct model before;
    struct errinfo e;
    double error = 0, whole = 0, rest = 0, cells = 0;

    (void)state;
    toy_model(&model);
    before = model;
    make_faces(&rng);
    assert_int_equal(train_shape(&set, &model, &e), ST_OK);
    assert_int_equal(model.shape.n, TRAIN_SHAPE_MODES);
    before.shape = model.shape;
    assert_memory_equal(&before, &model, sizeof model); /* nothing else changed */
    for (uint32_t c = 0; c < GRID_N; c++) {
        const double x = grid_x(c) / 52, y = grid_y(c) / 66;

        assert_true(!isnan(model.mean[c]) || model.shape.rest[c] == 0.0f);
        if (x * x + y * y > 1)
            continue;
        assert_true(model.shape.rest[c] > 0.0f);
        rest += (double)model.shape.rest[c];
        cells++;
        for (uint32_t d = 0; d < GRID_N; d += 7) {
            const double want = made(c, d), miss = learned(c, d) - want;

            if (model.shape.rest[d] <= 0.0f)
                continue;
            whole += want * want;
            error += miss * miss;
        }
    }
    print_message("covariance off by %.1f %%, rest %.3f mm\n", 100 * sqrt(error / whole),
                  rest / cells);
    assert_true(sqrt(error / whole) < 0.25); /* 160 samples: 3 / sqrt(160) */
    assert_true(rest / cells < 0.3);
}

/* Scans that were refused do not count, and the others may be too few. */
static void test_few(void **state)
{
    const struct corpus corpus = {.nscan = SCANS};
    const struct train_set set = {&corpus, face};
    struct errinfo e;

    (void)state;
    for (uint32_t i = 2 * TRAIN_SHAPE_MODES - 1; i < SCANS; i++)
        face[i].surface.mesh.nv = 0;
    assert_int_equal(train_shape(&set, &model, &e), ST_EINVAL);
    assert_non_null(strstr(e.msg, "shape"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_modes),
        cmocka_unit_test(test_few),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);

    for (uint32_t i = 0; i < SCANS; i++)
        surface_free(&face[i].surface);
    return failed;
}
