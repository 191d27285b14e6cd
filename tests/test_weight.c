/* The weight: highest on and above the nose tip, symmetric, never below its floor; its sum
 * over a template. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "face.h"
#include "facegen.h"
#include "measure.h"
#include "weight.h"

static struct dvec3 points[3000];

/* A face of a subject with its nose tip near (x, y). */
static void build(uint64_t subject, double x, double y, struct face_work *w,
                  struct face *f)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = subject;
    s.tx = x;
    s.ty = y;
    assert_int_equal(face_build(points, facegen_sample(&s, points), w, f, NULL), ST_OK);
}

static struct measure_surface surface_of(const struct face *f)
{
    return (struct measure_surface){&f->mesh, f->raw, f->spacing, f->bridge, f->measured};
}

static void test_nose(void **state)
{
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};

    (void)state;
    assert_non_null(w);
    for (uint64_t subject = 0; subject < 20; subject++) {
        struct measure_surface s;
        struct weight_face face;
        struct disparity_weight u;

        build(subject, 40, -70, w, &f);
        s = surface_of(&f);
        u = weight_of(&s, &face);
        assert_true(fabs(face.nose_x / 1000 - 40) < 4);
        assert_true(fabs(face.nose_y / 1000 + 70) < 12);
        assert_true(u.arg == &face);
    }
    face_free(&f);
    face_work_free(w);
}

static void test_shape(void **state)
{
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};
    struct measure_surface s;
    struct weight_face face;
    struct disparity_weight u;
    double x, y, total;

    (void)state;
    assert_non_null(w);
    build(3, 0, 0, w, &f);
    s = surface_of(&f);
    u = weight_of(&s, &face);
    x = face.nose_x;
    y = face.nose_y;
    assert_true(u.at(u.arg, x, y) == 1);
    assert_true(u.at(u.arg, x, y + 60e3) == 1);
    for (double d = 0; d < 200e3; d += 1e3) {
        assert_true(u.at(u.arg, x + d, y) == u.at(u.arg, x - d, y));
        assert_true(u.at(u.arg, x + d + 1e3, y) < u.at(u.arg, x + d, y));
        assert_true(u.at(u.arg, x, y - d - 1e3) < u.at(u.arg, x, y - d));
        assert_true(u.at(u.arg, x + d, y - d) >= 0.05);
    }
    assert_true(fabs(u.at(u.arg, x + 30e3, y) - 0.525) < 1e-9);
    assert_true(fabs(u.at(u.arg, x, y - 10e3) - 0.525) < 1e-9);
    total = weight_total(&s, &u);
    assert_true(total > 0.05 * s.measured * 1e-6 && total < s.measured * 1e-6);
    face_free(&f);
    face_work_free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nose),
        cmocka_unit_test(test_shape),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
