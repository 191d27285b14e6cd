/* quality.h: the defects of a scan; and how much of a face's shape explains it (face.h). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "clouds.h"
#include "face.h"
#include "quality.h"

static const struct quality good = {0.9, 0.95, 2.2, 0.3};
static const struct frame still = {
    {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, 1, 1.7, 0.9, 0.9};

/* The frame of a face turned so many degrees about axis 0 to 2 (pitch, yaw, roll). */
static struct frame turned(int axis, double degrees)
{
    const double a = degrees * 3.14159265358979323846 / 180;
    const int i = (axis + 1) % 3, k = (axis + 2) % 3;
    struct frame f = still;

    f.pose.r[4 * i] = f.pose.r[4 * k] = cos(a);
    f.pose.r[3 * i + k] = -sin(a);
    f.pose.r[3 * k + i] = sin(a);
    return f;
}

static void test_reasons(void **state)
{
    const struct {
        struct quality q;
        enum quality_reason r;
    } bad[] = {{{0.9, 0.95, 3.1, 0.3}, QUALITY_SPARSE},
               {{0.9, 0.95, 2.2, 0.7}, QUALITY_NOISY},
               {{0.6, 0.6, 2.2, 0.3}, QUALITY_INCOMPLETE}};
    const struct quality all = {0.1, 0.1, 9, 2};
    struct frame f;

    (void)state;
    assert_int_equal(quality_reasons(&good, &still), 0);
    assert_int_equal(quality_reasons(&good, NULL), 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(quality_reasons(&bad[i].q, NULL), 1U << bad[i].r);
    f = turned(1, 45);
    assert_int_equal(quality_reasons(&all, &f), (1U << QUALITY_REASONS) - 1);
}

static void test_turned(void **state)
{
    static const double limit[3] = {20, 30, 20};

    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct frame f = turned(axis, sign * (limit[axis] - 1));

            assert_int_equal(quality_reasons(&good, &f), 0);
            f = turned(axis, sign * (limit[axis] + 1));
            assert_int_equal(quality_reasons(&good, &f), 1U << QUALITY_TURNED);
        }
}

static void test_words(void **state)
{
    (void)state;
    for (int i = 0; i < QUALITY_REASONS; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(quality_reason_name((enum quality_reason)i),
                                    quality_reason_name((enum quality_reason)k));
}

/* ---- how much of a face's shape explains a surface */

static double cylinder(double x, double y)
{
    (void)y;
    return sqrt(75 * 75 - x * x);
}

static double cone(double x, double y)
{
    const double r = 60 + 0.3 * y;

    return sqrt(fmax(r * r - x * x, 0));
}

static double egg(double x, double y)
{
    const double u = x / 75, v = y / 100;

    return 70 * sqrt(1 - u * u - v * v);
}

static double bowl(double x, double y)
{
    return -egg(x, y);
}

static enum status build(double (*height)(double, double), struct face_work *w,
                         struct face *f)
{
    static struct dvec3 pts[81 * 81];
    size_t n = 0;

    for (int i = 0; i < 81 * 81; i++) {
        const double x = 2.0 * (i % 81) - 80, y = 2.0 * (i / 81) - 80;

        if (x * x / 3000 + y * y / 5000 < 1)
            pts[n++] = (struct dvec3){x, y, height(x, y)};
    }
    return face_build(pts, n, w, f, NULL);
}

/* Surfaces of a face's size that are not faces have little support; one that is hollow has none,
 * and is refused. */
static void test_no_faces(void **state)
{
    static double (*const height[])(double, double) = {cylinder, cone, egg};
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};

    (void)state;
    assert_non_null(w);
    for (size_t k = 0; k < sizeof height / sizeof *height; k++) {
        const enum status st = build(height[k], w, &f);

        print_message("support %.3f\n", f.frame.support);
        assert_true(st == ST_ENOTFACE || (st == ST_OK && f.frame.support < 0.5));
    }
    assert_int_equal(build(bowl, w, &f), ST_ENOTFACE);
    assert_int_equal(f.surface.mesh.nv, 0);
    face_free(&f);
    face_work_free(w);
}

enum part { UPSIDE_DOWN, WHOLE, LEFT, RIGHT, UPPER, LOWER, PARTS };

/* part_of(pts, n, part): the points of a part of a frontal scan, or all of them upside down. */
static size_t part_of(struct dvec3 *pts, size_t n, enum part part)
{
    size_t left = 0;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = pts[i];

        if (part == UPSIDE_DOWN)
            pts[left++] = (struct dvec3){-p.x, -p.y, p.z};
        else if (part == WHOLE || (part == LEFT && p.x < 0) ||
                 (part == RIGHT && p.x > 0) || (part == UPPER && p.y > 0) ||
                 (part == LOWER && p.y < 0))
            pts[left++] = p;
    }
    return left;
}

/* A whole face and each half of one, sparse or dense, have much support, an upside-down face
 * little. */
static void test_halves(void **state)
{
    static const size_t points[] = {1000, 3000, 10000};
    struct face_work *w = face_work_new(NULL);
    static struct dvec3 pts[10000];
    struct face f = {0};

    (void)state;
    assert_non_null(w);
    for (uint64_t who = 0; who < 8; who++)
        for (int part = 0; part < PARTS; part++)
            for (size_t k = 0; k < 3; k++) {
                const size_t n =
                    part_of(pts, clouds_scan(who, 0, points[k], pts), (enum part)part);

                const enum status st = face_build(pts, n, w, &f, NULL);

                if (part == UPSIDE_DOWN && st == ST_ENOTFACE)
                    continue;
                assert_int_equal(st, ST_OK);
                if (part == UPSIDE_DOWN)
                    assert_true(f.frame.support < 0.5);
                else
                    assert_true(f.frame.support > 0.55);
            }
    face_free(&f);
    face_work_free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reasons), cmocka_unit_test(test_turned),
        cmocka_unit_test(test_words),   cmocka_unit_test(test_no_faces),
        cmocka_unit_test(test_halves),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
