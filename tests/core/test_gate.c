/* The gate: what is no face is not enrolled, each for its reason, and made-up faces are.  Kinds
 * and seeds of which the gate that judged by the mean face alone enrolled some. */
#include "cloudpoints.h"
#include "face.h"
#include "facegen.h"
#include "mem.h"
#include "object.h"
#include "scan.h"
#include "unit.h"

#define N 4000

static struct surface_work *work;
static struct dvec3 pts[N];
static struct surface_found found;

static enum status build(const struct dvec3 *from, size_t n, enum scan_axes axes,
                         bool enrolment)
{
    const struct scan_options o = {.axes = axes, .enrolment = enrolment};
    struct cloudpoints c = {.n = n, .read = n, .unit_mm = 1};
    struct surface_face face = {0};
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

TEST(test_things)
{
    for (uint32_t k = 0; k < OBJECT_KINDS; k++) {
        const enum status st =
            build(pts, object_scan(k, 0, N, pts), SCAN_AXES_AUTO, true);

        assert_true(st == ST_ENOTFACE || st == ST_ENOFACE || st == ST_EQUALITY);
        if (st == ST_ENOTFACE && found.evidence_wanted > 0)
            assert_true(found.support < found.support_wanted ||
                        found.evidence < found.evidence_wanted);
    }
}

TEST(test_faces)
{
    for (uint64_t who = 100; who < 130; who++) {
        const size_t n = face(who);

        assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_OK);
        assert_true(found.support >= found.support_wanted && found.support_wanted > 0.3);
        assert_true(found.eyes > 0.4 && found.eyes <= 1);
        assert_true(found.seen >= found.seen_wanted && found.seen <= 1);
        assert_true(found.detail > 0.4 && found.detail < 1.3);
        assert_true(found.evidence >= found.evidence_wanted);
        assert_true(found.residual_mm < found.residual_most);
        assert_int_equal(build(pts, n, SCAN_AXES_SCANNER, true), ST_OK);
        assert_int_equal(build(pts, n, SCAN_AXES_AUTO, false), ST_OK);
        assert_true(found.support_wanted < 0.3);
    }
}

/* Children and large adults are people; a doll and a giant's mask are none. */
TEST(test_sizes)
{
    static const struct {
        double by;
        bool person;
    } size[] = {{0.4, false}, {0.78, true}, {0.9, true},
                {1.1, true},  {1.15, true}, {2, false}};

    for (uint64_t who = 7; who < 12; who++)
        for (size_t k = 0; k < sizeof size / sizeof *size; k++) {
            const size_t n = face(who);
            const double by = size[k].by;
            enum status st;

            for (size_t i = 0; i < n; i++)
                pts[i] = (struct dvec3){by * pts[i].x, by * pts[i].y, by * pts[i].z};
            st = build(pts, n, SCAN_AXES_SCANNER, true);
            if ((st == ST_OK) != size[k].person)
                fail_msg("%g times as large: %d", by, (int)st);
            if (st == ST_OK)
                assert_true(found.head_size > 0.8 * by && found.head_size < 1.3 * by);
        }
}

/* Leaves the points below so many mm. */
static size_t below(size_t n, double mm)
{
    size_t left = 0;

    for (size_t i = 0; i < n; i++)
        if (pts[i].y < mm)
            pts[left++] = pts[i];
    return left;
}

/* A band of a face is too little to enrol, and the part below the eyes is none without them. */
TEST(test_parts)
{
    size_t n = face(9), left = 0;

    for (size_t i = 0; i < n; i++)
        if (fabs(pts[i].y - 20) < 28)
            pts[left++] = pts[i];
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, true), ST_EQUALITY);
    assert_true(found.seen < found.seen_wanted && found.seen > 0.2);
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, false), ST_OK);
    left = below(face(9), 8);
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, true), ST_ENOTFACE);
    assert_true(found.evidence < found.evidence_wanted);
    assert_int_equal(build(pts, left, SCAN_AXES_AUTO, false), ST_OK);
}

/* The lower half of a large face is no small face; a child's face is one, its forehead hidden or not. */
TEST(test_lower_half)
{
    static const uint64_t large[][2] = {{5, 1}, {121, 3}, {150, 3}};
    uint32_t hidden = 0;

    for (size_t k = 0; k < sizeof large / sizeof *large; k++)
        for (int mm = -14; mm <= -2; mm++) {
            struct facegen_scan s;

            facegen_default(&s);
            s.subject = large[k][0];
            s.scan = large[k][1];
            facegen_pose(&s, 5, 5);
            assert_int_equal(
                build(pts, below(facegen_sample(&s, pts), mm), SCAN_AXES_AUTO, true),
                ST_ENOTFACE);
        }
    for (uint64_t who = 20; who < 25; who++) {
        const size_t n = below(face(who), 44);

        for (size_t i = 0; i < n; i++)
            pts[i] = (struct dvec3){0.72 * pts[i].x, 0.72 * pts[i].y, 0.72 * pts[i].z};
        assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_OK);
        assert_true(found.head_size < 0.9);
        hidden += found.forehead < 0;
    }
    assert_true(hidden >= 3);
}

/* Upside down it is no face where the axes are the scanner's; else it is found. */
TEST(test_turned)
{
    const size_t n = face(10);

    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){-pts[i].x, -pts[i].y, pts[i].z};
    assert_int_equal(build(pts, n, SCAN_AXES_SCANNER, true), ST_ENOTFACE);
    assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_OK);
    assert_true(found.cropped);
}

BEFORE_ALL(set_up)
{
    assert_false((work = surface_work_new(NULL)) == NULL);
}

AFTER_ALL(tear_down)
{
    surface_work_free(work);
}
