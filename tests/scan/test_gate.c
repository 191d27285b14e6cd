/* The gate: what is no face is not enrolled, each for its reason, and made-up faces are.  Kinds
 * and seeds of which the gate that judged by the mean face alone enrolled some. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <string.h>
#include <cmocka.h>

#include "cloudpoints.h"
#include "face.h"
#include "facegen.h"
#include "mem.h"
#include "object.h"
#include "relief.h"
#include "scan.h"

#define N 4000

static struct face_work *work;
static struct dvec3 pts[N];
static struct scan_found found;

static enum status build(const struct dvec3 *from, size_t n, enum scan_axes axes,
                         bool enrolment)
{
    const struct scan_options o = {.axes = axes, .enrolment = enrolment};
    struct cloudpoints c = {.n = n, .read = n, .unit_mm = 1};
    struct face face = {0};
    enum status st;

    assert_non_null(c.at = mem_array(n, sizeof *c.at));
    memcpy(c.at, from, n * sizeof *from);
    st = scan_build(&c, &o, work, &face, NULL, &found);
    cloudpoints_free(&c);
    face_free(&face);
    return st;
}

static size_t face(uint64_t subject)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = subject;
    facegen_pose(&s, 3, 4);
    return facegen_sample(&s, pts);
}

static void test_things(void **state)
{
    static const char *const name[] = {"cone from its point",
                                       "bottle",
                                       "teapot from the side",
                                       "vase",
                                       "fist",
                                       "foot from the front",
                                       "back of a head",
                                       "cow from the front",
                                       "egg with a ridge",
                                       "face: two in one",
                                       "face: sides swapped"};
    size_t tried = 0;

    (void)state;
    for (uint32_t k = 0; k < object_kinds(); k++)
        for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
            enum status st;

            if (strcmp(object_name(k), name[i]) != 0)
                continue;
            st = build(pts, object_scan(k, 0, N, pts), SCAN_AXES_AUTO, true);
            assert_true(st == ST_ENOTFACE || st == ST_ENOFACE || st == ST_EQUALITY);
            if (st == ST_ENOTFACE)
                assert_true(found.gate.support < found.gate.support_wanted ||
                            found.gate.likeness < found.gate.likeness_wanted ||
                            found.gate.eyes < found.gate.eyes_wanted ||
                            found.gate.scale[0] != 1 || found.gate.scale[1] != 1 ||
                            found.gate.scale[2] != 1);
            tried++;
        }
    assert_int_equal(tried, sizeof name / sizeof *name);
}

static void test_faces(void **state)
{
    (void)state;
    for (uint64_t who = 100; who < 130; who++) {
        const size_t n = face(who);

        assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_OK);
        assert_true(found.gate.support >= found.gate.support_wanted &&
                    found.gate.support_wanted > 0.5);
        assert_true(found.gate.likeness >= found.gate.likeness_wanted);
        assert_true(found.gate.eyes >= found.gate.eyes_wanted && found.gate.eyes <= 1);
        assert_true(found.gate.seen >= found.gate.seen_wanted && found.gate.seen <= 1);
        assert_true(found.gate.detail > 0.6 && found.gate.detail < 1.3);
        assert_true(found.gate.evidence >= found.gate.evidence_wanted);
        assert_true(found.gate.scale[0] == 1 && found.gate.scale[1] == 1 &&
                    found.gate.scale[2] == 1);
        assert_int_equal(build(pts, n, SCAN_AXES_SCANNER, true), ST_OK);
        assert_int_equal(build(pts, n, SCAN_AXES_AUTO, false), ST_OK);
        assert_true(found.gate.support_wanted < 0.5);
    }
}

/* A face that is too small or too large is none, and the scale is told. */
static void test_scale(void **state)
{
    static const double by[] = {0.5, 0.7, 1.4, 2};

    (void)state;
    for (size_t k = 0; k < sizeof by / sizeof *by; k++) {
        const size_t n = face(7);
        enum status st;

        for (size_t i = 0; i < n; i++)
            pts[i] = (struct dvec3){by[k] * pts[i].x, by[k] * pts[i].y, by[k] * pts[i].z};
        st = build(pts, n, SCAN_AXES_SCANNER, true);
        assert_true(st == ST_ENOTFACE);
        if (by[k] == 0.5)
            continue; /* its pose is not found, nor is its scale */
        assert_true(found.gate.scale[0] == found.gate.scale[1] &&
                    found.gate.scale[1] == found.gate.scale[2]);
        assert_true(found.gate.scale[0] * by[k] > 0.85 &&
                    found.gate.scale[0] * by[k] < 1.2);
    }
}

/* 1.6 times as tall: the scale along one axis. */
static void test_stretched(void **state)
{
    const size_t n = face(9);

    (void)state;
    for (size_t i = 0; i < n; i++)
        pts[i].y *= 1.6;
    assert_int_equal(build(pts, n, SCAN_AXES_SCANNER, true), ST_ENOTFACE);
    assert_true(found.gate.scale[0] == 1 && found.gate.scale[1] == 0.8 &&
                found.gate.scale[2] == 1);
}

/* A band of a face is too little to enrol, as is one without its forehead, and the part below the eyes is none without
 * them. */
static void test_parts(void **state)
{
    size_t n = face(9), left = 0;

    (void)state;
    for (size_t i = 0; i < n; i++)
        if (fabs(pts[i].y - 20) < 28)
            pts[left++] = pts[i];
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, true), ST_EQUALITY);
    assert_true(found.gate.seen < found.gate.seen_wanted && found.gate.seen > 0.2);
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, false), ST_OK);
    n = face(9);
    left = 0;
    for (size_t i = 0; i < n; i++)
        if (pts[i].y < 46)
            pts[left++] = pts[i];
    assert_int_equal(build(pts, left, SCAN_AXES_SCANNER, true), ST_EQUALITY);
    assert_true(found.gate.seen >= found.gate.seen_wanted && found.gate.forehead == -1);
    n = face(9);
    left = 0;
    for (size_t i = 0; i < n; i++)
        if (pts[i].y < 8)
            pts[left++] = pts[i];
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, true), ST_ENOTFACE);
    assert_true(found.gate.eyes < found.gate.eyes_wanted);
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, false), ST_OK);
}

/* Eggs with 12 smooth bumps, which a search against the gate made out of nothing but humps and
 * hollows: all that a face shows, but hardly a line of it that is fine. */
static void test_sought(void **state)
{
    static const struct relief egg[] = {
        {.across = 56.3,
         .up = 103.0,
         .depth = 21.7,
         .power = 1.06,
         .saddle = {-8.2, 0, -4.1},
         .bumps = 12,
         .bump = {{-28.6, -42.7, 21.0, 11.1, -1.2},
                  {-6.7, -43.7, 8.9, 22.0, -3.3},
                  {40.6, -36.9, 16.2, 9.0, -1.9},
                  {30.2, 4.9, 10.8, 14.3, -12.9},
                  {49.4, -29.9, 18.3, 19.3, 2.7},
                  {15.1, 20.5, 10.9, 13.4, -5.4},
                  {23.5, -21.5, 14.4, 21.8, 8.8},
                  {75.4, 2.1, 11.5, 23.3, -14.2},
                  {-6.4, -7.5, 8.5, 13.6, -11.9},
                  {39.3, -24.0, 8.9, 12.3, -8.2},
                  {38.3, -6.8, 23.1, 7.6, -3.5},
                  {8.4, -9.2, 15.7, 7.1, -0.3}}},
        {.across = 58.5,
         .up = 102.0,
         .depth = 20.5,
         .power = 1.44,
         .saddle = {-0.9, 0, -5.2},
         .bumps = 8,
         .bump = {{-12.0, -47.6, 7.4, 22.8, -2.9},
                  {21.6, -24.7, 23.7, 18.8, -0.1},
                  {9.7, 17.1, 23.6, 19.6, -15.5},
                  {10.1, 3.6, 8.8, 7.1, 14.9},
                  {5.6, -14.2, 10.0, 23.1, 13.2},
                  {15.8, 31.5, 22.5, 9.2, -0.3},
                  {-92.8, 23.8, 7.7, 19.1, 4.4},
                  {13.2, 65.7, 9.0, 7.4, -13.1}}},
    };

    (void)state;
    for (size_t k = 0; k < sizeof egg / sizeof *egg; k++) {
        struct draw r = draw_stream(k, 0, 5);
        const size_t n = relief_sample(&egg[k], 3000, 0.15, &r, pts);
        const struct gate *g = &found.gate;

        assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_ENOTFACE);
        assert_true(g->evidence < g->evidence_wanted && g->detail < 0.8);
        assert_true(g->support >= g->support_wanted && g->likeness >= g->likeness_wanted);
        assert_true(g->eyes >= g->eyes_wanted && g->seen >= g->seen_wanted);
        assert_true(g->evidence - 5 * g->detail > 10.5); /* or nearly enrolled without */
    }
}

/* Upside down it is no face where the axes are the scanner's; else it is found. */
static void test_turned(void **state)
{
    const size_t n = face(10);

    (void)state;
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){-pts[i].x, -pts[i].y, pts[i].z};
    assert_int_equal(build(pts, n, SCAN_AXES_SCANNER, true), ST_ENOTFACE);
    assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_OK);
    assert_true(found.found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_things), cmocka_unit_test(test_faces),
        cmocka_unit_test(test_scale),  cmocka_unit_test(test_stretched),
        cmocka_unit_test(test_parts),  cmocka_unit_test(test_sought),
        cmocka_unit_test(test_turned),
    };
    int failed;

    if ((work = face_work_new(NULL)) == NULL)
        return 2;
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    face_work_free(work);
    return failed;
}
