/* The gate enrols made-up faces and refuses made-up things, each for its reason. */
#include "brute.h"
#include "cloudpoints.h"
#include "face.h"
#include "faces.h"
#include "facegen.h"
#include "mem.h"
#include "scan.h"
#include "unit.h"

#define N 4000

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
    st = scan_build(&c, &o, faces_work, &face, NULL, &found);
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

/* ---- things that are no faces, as heights z of (x, y), mm, from numbers u of 0 to 1 */

typedef double thing(const double u[16], double x, double y);

/* A vase or a bottle: a solid of revolution about y. */
static double vase(const double u[16], double x, double y)
{
    const double at = (y + 110) / 20, k = at - floor(at), by = k * k * (3 - 2 * k);
    const int i = (int)at;
    const double r = 25 + 45 * (u[i] + by * (u[i + 1] - u[i]));

    return sqrt(r * r - x * x); /* NAN: beside it */
}

/* An egg, or nearly a cone, with a ridge like a nose. */
static double egg(const double u[16], double x, double y)
{
    const double a = x / (60 + 25 * u[0]), b = y / (80 + 25 * u[0]);
    const double p = x / (6 + 6 * u[1]), q = (y - 30 * u[2]) / (15 + 25 * u[3]);

    return -(35 + 30 * u[4]) * pow(a * a + b * b, 0.5 + u[5]) +
           (12 + 14 * u[6]) * exp(-(p * p + q * q) / 2);
}

/* Waves of any direction on a dome. */
static double relief(const double u[16], double x, double y)
{
    double z = -x * x / 140 - y * y / 220;

    for (int i = 0; i < 5; i++) {
        const double turn = 6.2832 * u[3 * i], mm = 20 + 40 * u[3 * i + 1];

        z += 0.15 * mm *
             cos(6.2832 / mm * (x * cos(turn) + y * sin(turn)) + 6.2832 * u[3 * i + 2]);
    }
    return z;
}

/* What a scanner sees of a thing: nothing steeper than 75 degrees. */
static size_t scan_thing(thing *height, struct draw *r)
{
    double u[16];
    size_t n = 0;

    for (int i = 0; i < 16; i++)
        u[i] = draw_uniform(r, 0, 1);
    while (n < N) {
        const double x = draw_uniform(r, -75, 75), y = draw_uniform(r, -100, 100);
        const double z = height(u, x, y), dx = 2 * (height(u, x + 0.5, y) - z);
        const double dy = 2 * (height(u, x, y + 0.5) - z);

        if (hypot(x / 75, y / 100) <= 1 && dx * dx + dy * dy <= 15)
            pts[n++] = (struct dvec3){x, y, z + draw_uniform(r, 0, 0.4)};
    }
    return n;
}

TEST(test_things)
{
    static thing *const kind[] = {vase, egg, relief};
    struct draw r = {brute_seed("gate")};

    for (size_t k = 0; k < 30; k++) {
        const size_t n = scan_thing(kind[k % 3], &r);
        const enum status st = build(pts, n, SCAN_AXES_AUTO, true);

        assert_true(st == ST_ENOTFACE || st == ST_ENOFACE);
        if (st == ST_ENOTFACE)
            assert_true(found.support < found.support_wanted ||
                        found.evidence < found.evidence_wanted);
    }
}

/* Two faces in one place leave too much unexplained; of one whose left half is on the right the
 * eyes are not seen. */
TEST(test_made_of_faces)
{
    struct facegen_scan s;
    size_t n;

    facegen_default(&s);
    s.subject = 1018;
    s.points = N / 2;
    s.tx = 19;
    s.ty = 22;
    n = facegen_sample(&s, pts);
    s.subject++;
    s.tx = -19;
    s.ty = -22;
    n += facegen_sample(&s, pts + n);
    assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_EQUALITY);
    assert_true(found.residual_mm > found.residual_most);
    n = face(1018);
    for (size_t i = 0; i < n; i++)
        pts[i].x += pts[i].x < 0 ? 65 : -65;
    assert_int_equal(build(pts, n, SCAN_AXES_AUTO, true), ST_EQUALITY);
    assert_true(found.seen < found.seen_wanted && found.eyes == 0);
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
