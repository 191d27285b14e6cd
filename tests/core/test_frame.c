/* The canonical frame: it moves with the face, the mean face's own frame is the identity, and
 * a map of heights in it is the mean face again. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "brute.h"
#include "clouds.h"
#include "face.h"
#include "fail_alloc.h"
#include "frame.h"
#include "model_digest.h"
#include "toy.h"

#define POINTS 3000

static struct model model;
static struct frame_mean mean;
static struct align_work work;
static struct surface surface;

static double toy(const void *arg, double x, double y)
{
    (void)arg;
    return toy_height(x, y);
}

/* How far apart two motions carry points of a face, at most, mm. */
static double apart(const struct pose *a, const struct pose *b, const struct dvec3 *pts,
                    size_t n)
{
    double most = 0;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = pose_apply(a, pts[i]);
        const struct dvec3 q = pose_apply(b, pts[i]);

        most = fmax(most, hypot(hypot(p.x - q.x, p.y - q.y), p.z - q.z));
    }
    return most;
}

/* a, then b */
static struct pose then(const struct pose *a, const struct pose *b)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct pose back = pose_after(b, &still);

    return pose_after(&back, a);
}

/* The frame of the toy face, scanned in any pose, is the inverse of that pose. */
static void test_toy(void **state)
{
    static const struct dvec3 corners[] = {
        {0, 0, 0}, {50, 0, -40}, {-50, 0, -40}, {0, 60, -30}, {0, -60, -30}};
    struct brute_rng rng = {brute_seed("frame")};

    (void)state;
    for (int k = 0; k < 5; k++) {
        struct pose pose, both;
        const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        struct frame frame;

        toy_pose(6 * k, -4 * k, 3 * k, (struct dvec3){30 * k, -20 * k, 100 * k}, &pose);
        toy_scan(toy, NULL, 3000, &pose, &rng, &surface);
        assert_int_equal(frame_find(&mean, &surface, &work, &frame), ST_OK);
        both = then(&pose, &frame.pose);
        printf("pose %d: off by %.2f mm, cost %.2f mm, within %.2f\n", k,
               apart(&both, &still, corners, 5), frame.cost_mm, frame.within);
        assert_true(apart(&both, &still, corners, 5) < 1);
        assert_int_equal(frame.mean_id, mean.mean_id);
        assert_true(frame.cost_mm < 0.5 && frame.within > 0.8);
        assert_true(pose_rigid(&frame.pose));
    }
}

/* Turning and shifting a whole scan leaves the frame at the same place of the face. */
static void test_moves_along(void **state)
{
    static struct dvec3 pts[POINTS], moved[POINTS];
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};
    double sum = 0;

    (void)state;
    assert_non_null(w);
    for (uint64_t k = 0; k < 8; k++) {
        const size_t n = clouds_scan(k, 0, POINTS, pts);
        struct pose before, both, motion;
        double m[16], off;

        assert_int_equal(face_build(pts, n, w, &f, NULL), ST_OK);
        before = f.frame.pose;
        memcpy(moved, pts, n * sizeof *pts);
        clouds_move(moved, n, k, 15, 120, m);
        pose_from_matrix(m, &motion);
        assert_int_equal(face_build(moved, n, w, &f, NULL), ST_OK);
        both = then(&motion, &f.frame.pose);
        off = apart(&both, &before, pts, n);
        printf("face %d: off by %.2f mm at most\n", (int)k, off);
        sum += off;
        assert_true(off < 0.5);
    }
    assert_true(sum / 8 < 0.2);
    face_free(&f);
    face_work_free(w);
}

/* Heights that are a multiple of the mean face's relief and any quadric. */
static double scaled(const void *arg, double x, double y)
{
    return *(const double *)arg * toy_height(x, y) + 4 + 0.1 * x - 0.2 * y +
           x * (0.004 * x + 0.003 * y) - 0.006 * y * y;
}

/* Neither a quadric nor a scale changes the likeness; for a hollow face it is negative. */
static void test_likeness(void **state)
{
    static const double scale[] = {1, 0.3, 2, -1, 0};
    static double z[GRID_N], n[GRID_N];

    (void)state;
    for (size_t k = 0; k < sizeof scale / sizeof *scale; k++) {
        double l;

        for (uint32_t i = 0; i < GRID_N; i++) {
            n[i] = 1 + i % 3;
            z[i] = n[i] * scaled(&scale[k], grid_x(i), grid_y(i));
        }
        l = frame_likeness_heights(&mean, z, n);
        printf("relief times %.1f: likeness %.6f\n", scale[k], l);
        assert_true(fabs(l - (scale[k] > 0) + (scale[k] < 0)) < 1e-4);
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = n[i] * toy_height(grid_x(i) + 24, grid_y(i)); /* the nose is elsewhere */
    assert_true(frame_likeness_heights(&mean, z, n) < 0.5);
    for (uint32_t i = 0; i < GRID_N; i++)
        n[i] = i / GRID_NX < 12 ? 1 : 0; /* the chin alone */
    assert_true(isnan(frame_likeness_heights(&mean, z, n)));
}

static void test_mean(void **state)
{
    struct model bad = model;
    struct frame_mean m;

    (void)state;
    for (uint32_t i = 0; i < GRID_N; i++) {
        assert_true(mean.rigid[i] >= 0.0f && mean.rigid[i] <= 1.0f);
        assert_true((mean.rigid[i] > 0.0f) == (model.change.rest[i] > 0.0f));
        bad.mean[i] = (float)NAN;
    }
    /* nose firmer than mouth */
    assert_true(mean.rigid[grid_cell(2, 20)] > 2 * mean.rigid[grid_cell(2, -42)]);
    assert_int_equal(mean.mean_id, model_mean_id(&model));
    assert_int_equal(frame_mean_make(&bad, &m), ST_EDEGENERATE);
    for (uint32_t i = 3 * GRID_NX; i < 4 * GRID_NX; i++)
        bad.mean[i] = 0.0f; /* all on a line */
    assert_int_equal(frame_mean_make(&bad, &m), ST_EDEGENERATE);
}

static void test_memory(void **state)
{
    struct brute_rng rng = {8};
    struct frame want, got;
    enum status st = ST_ENOMEM;
    unsigned long n;

    (void)state;
    toy_scan(toy, NULL, 2000, NULL, &rng, &surface);
    assert_int_equal(frame_find(&mean, &surface, &work, &want), ST_OK);
    for (n = 1; st != ST_OK; n++) {
        struct align_work fresh = {0};

        fail_alloc_at(n);
        st = frame_find(&mean, &surface, &fresh, &got);
        fail_alloc_at(0);
        assert_true(st == ST_OK || st == ST_ENOMEM);
        align_work_free(&fresh);
    }
    assert_true(n > 2);
    assert_memory_equal(&want.pose, &got.pose, sizeof want.pose);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_toy),      cmocka_unit_test(test_moves_along),
        cmocka_unit_test(test_likeness), cmocka_unit_test(test_mean),
        cmocka_unit_test(test_memory),
    };
    int failed;

    toy_model(&model);
    if (frame_mean_make(&model, &mean) != ST_OK)
        return 2;
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    align_work_free(&work);
    surface_free(&surface);
    return failed;
}
