/* A face made of the modes is found again, with its pose; what covers it is told; what is no
 * face has little support. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "brute.h"
#include "clouds.h"
#include "fail_alloc.h"
#include "shape.h"
#include "toy.h"

#define POINTS 4000

static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
static struct model model;
static struct shape_work work;
static struct dvec3 pts[POINTS];
static float face[GRID_N]; /* heights of a face made of modes */

/* Bilinear between the middles of the cells; NAN off the face. */
static double height_at(const float *h, double x, double y)
{
    const double i = (x - GRID_LEFT) / GRID_MM - 0.5,
                 j = (y - GRID_BOTTOM) / GRID_MM - 0.5;
    const uint32_t c = (uint32_t)i, r = (uint32_t)j, at = r * GRID_NX + c;
    const double u = i - c, v = j - r;

    return (1 - v) * ((1 - u) * (double)h[at] + u * (double)h[at + 1]) +
           v * ((1 - u) * (double)h[at + GRID_NX] + u * (double)h[at + GRID_NX + 1]);
}

/* Points of the surface h, by chance. */
static void scan(const float *h, struct brute_rng *rng)
{
    for (size_t n = 0; n < POINTS;) {
        const double x = -58 + 116 * brute_real(rng), y = -76 + 138 * brute_real(rng);
        const double z = height_at(h, x, y);

        if (!isnan(z))
            pts[n++] = (struct dvec3){x, y, z};
    }
}

/* A new face, as points. */
static void make_face(struct brute_rng *rng)
{
    memcpy(face, model.mean, sizeof face);
    for (uint32_t k = 0; k < model.shape.n; k++) {
        const double a = 2 * brute_real(rng) - 1;

        for (uint32_t i = 0; i < GRID_N; i++)
            face[i] += (float)a * model.shape.mode[i][k];
    }
    scan(face, rng);
}

static void move(const struct align_pose *p)
{
    for (size_t i = 0; i < POINTS; i++)
        pts[i] = align_pose_apply(p, pts[i]);
}

static void fit(const struct align_pose *start, bool hard, struct shape_fit *out)
{
    assert_int_equal(shape_fit(&work, pts, POINTS, start, 1, hard, out), ST_OK);
    assert_int_equal(out->pose.t[0] == out->pose.t[0], 1);
    assert_true(isfinite(out->support) && isfinite(out->likeness));
}

/* The farthest that the fitted heights are from the face's, mm. */
static double off(const struct shape_fit *f)
{
    double most = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (f->cell[i] == SHAPE_SKIN)
            most = fmax(most, fabs((double)f->height[i] - (double)face[i]));
    return most;
}

static void test_recovered(void **state)
{
    struct brute_rng rng = {brute_seed("shape")};
    struct shape_fit f;

    (void)state;
    for (int round = 0; round < 20; round++) {
        struct align_pose pose;

        make_face(&rng);
        toy_pose(16 * brute_real(&rng) - 8, 16 * brute_real(&rng) - 8,
                 16 * brute_real(&rng) - 8,
                 (struct dvec3){6 * brute_real(&rng), 6 * brute_real(&rng) - 6,
                                6 * brute_real(&rng)},
                 &pose);
        move(&pose);
        fit(&still, false, &f);
        print_message("S %.3f likeness %.2f off %.3f skin %u cover %u apart %u\n",
                      f.support, f.likeness, off(&f), f.skin, f.cover, f.apart);
        for (size_t i = 0; i < POINTS; i += 97) {
            const struct dvec3 q = align_pose_apply(&f.pose, pts[i]);
            const double miss = q.z - height_at(face, q.x, q.y);

            assert_true(isnan(miss) || fabs(miss) < 1.5);
        }
        assert_true(f.support > 0.85);
        assert_int_equal(f.cover, 0);
        assert_true(off(&f) < 1.5);
    }
}

/* Wherever an allocation fails. */
static void test_no_memory(void **state)
{
    static struct shape_work w;
    struct brute_rng rng = {7};
    struct shape_fit f;
    unsigned long failed = 0;

    (void)state;
    make_face(&rng);
    for (int judged = 0; judged < 2; judged++)
        for (unsigned long n = 1;; n++) {
            enum status st;

            shape_prepare(&model, &w);
            fail_alloc_at(n);
            st = judged ? shape_judge(&w, pts, POINTS, &still, &f)
                        : shape_fit(&w, pts, POINTS, &still, 1, true, &f);
            fail_alloc_at(0);
            shape_free(&w);
            if (st == ST_OK)
                break;
            assert_int_equal(st, ST_ENOMEM);
            failed++;
        }
    assert_true(failed >= 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_recovered),
        cmocka_unit_test(test_no_memory),
    };
    int failed;

    toy_model(&model);
    shape_prepare(&model, &work);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    shape_free(&work);
    return failed;
}
