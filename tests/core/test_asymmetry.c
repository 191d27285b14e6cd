/* Asymmetry: exact cases by hand; in scans of many poses the value follows the asymmetry that
 * the generator put in, and the plane is found; a face and its mirror image have the same
 * value; failed allocations. */
#include "pose.h"
#include "asymmetry.h"
#include "face.h"
#include "faces.h"
#include "facegen.h"
#include "measure.h"
#include "toy.h"
#include "unit.h"

#define POINTS 3000
#define DEGREE (3.14159265358979323846 / 180)

static struct surface_face face;
static struct dvec3 points[POINTS];

static void close_to(double got, double wanted, double by)
{
    if (!(fabs(got - wanted) <= by))
        fail_msg("%.9g, wanted %.9g to %.2g", got, wanted, by);
}

/* ---- any surface */

static struct surface made;

static struct surface_asymmetry find(const struct dvec3 *p, uint32_t n)
{
    struct measure_work m = {0};
    struct surface upright = {0};
    struct surface_asymmetry out;

    toy_surface(p, n, &made);
    assert_int_equal(asymmetry_find(&made, &toy_still, NULL, &m, &upright, &out), ST_OK);
    measure_work_free(&m);
    surface_free(&upright);
    return out;
}

/* A rectangle of 100 x 80 mm, a point every 4 mm, with the given heights. */
static uint32_t sheet(double (*z)(double x, double y), struct dvec3 *p)
{
    uint32_t n = 0;

    for (int j = -10; j <= 10; j++)
        for (int i = -12; i <= 12; i++)
            p[n++] = (struct dvec3){i * 4.0, j * 4.0, z(i * 4.0, j * 4.0)};
    return n;
}

static double dome(double x, double y)
{
    return 20 - x * x / 80 - y * y / 160 + y / 16;
}

/* Beside the dome, on one side, a plateau of 2 mm that rises over 4 mm. */
static double step(double x, double y)
{
    return dome(x, y) + (x > 22 && x < 38 && fabs(y) < 18 ? 2 : 0);
}

/* The plateau is all of the asymmetry: 2 mm over its area, on either side; at its rim a
 * slope of half the spacing more. */
TEST(test_step)
{
    const struct surface_asymmetry a = find(points, sheet(step, points));
    const double volume = 2 * 2 * (12 + 4.0) * (32 + 4.0);

    close_to(a.first_mm * 96 * 80 / volume, 1, 0.02);
    assert_true(a.disparity_mm <= a.first_mm + 1e-3);
    close_to(a.volume_mm3 / volume, 1, 0.05);
    close_to(a.normal[0], 1, 1e-4);
}

/* For a symmetric surface that was turned and shifted, the plane gives the turn and shift. */
TEST(test_tilted)
{
    static const double turns[][4] = {{0, 0, 0, 0},
                                      {0.1, 0, 0, 0},
                                      {0, 0.2, 0, 0},
                                      {0, 0, -0.15, 4},
                                      {0.05, 0.1, 0.1, -6}};
    const uint32_t n = sheet(dome, points);

    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
        static struct dvec3 moved[POINTS];
        struct pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        const double x[6] = {turns[k][0], turns[k][1], turns[k][2], turns[k][3], 3, -2};
        struct surface_asymmetry a;
        double cosine;

        pose_move(&pose, (struct dvec3){0, 0, 0}, x);
        for (uint32_t i = 0; i < n; i++)
            moved[i] = pose_apply(&pose, points[i]);
        a = find(moved, n);
        cosine =
            a.normal[0] * pose.r[0] + a.normal[1] * pose.r[3] + a.normal[2] * pose.r[6];
        assert_true(acos(fmin(cosine, 1)) < 0.1 * DEGREE);
        close_to(a.offset_mm,
                 a.normal[0] * pose.t[0] + a.normal[1] * pose.t[1] +
                     a.normal[2] * pose.t[2],
                 0.05);
        assert_true(a.disparity_mm < 0.06); /* what cutting across the curve leaves */
    }
}

/* ---- faces */

static void scan(const struct facegen_scan *s)
{
    const size_t n = facegen_sample(s, points);

    assert_int_equal(face_build(points, n, faces_work, &face, NULL), ST_OK);
}

static struct surface_asymmetry measured(void)
{
    struct surface_asymmetry a;

    assert_int_equal(surface_asymmetry(faces_work, &face, &a), ST_OK);
    return a;
}

/* The generated face's heights, every millimetre. */
#define SIDE 200
static double height[SIDE][SIDE];

static double height_at(double x, double y)
{
    const double u = x + SIDE / 2.0, v = y + SIDE / 2.0;
    const int i = (int)u, j = (int)v;
    const double s = u - i, t = v - j;

    return (1 - t) * ((1 - s) * height[j][i] + s * height[j][i + 1]) +
           t * ((1 - s) * height[j + 1][i] + s * height[j + 1][i + 1]);
}

/* The mean gap of the surface and its mirror image over an oval, by definition: each point
 * reflected in the plane n . p = d, n = (1, n[0], n[1]) to scale, and d = n[2]. */
static double gap_by_definition(const double n[3])
{
    const double length = sqrt(1 + n[0] * n[0] + n[1] * n[1]);
    const double e[3] = {1 / length, n[0] / length, n[1] / length};
    double sum = 0, count = 0;

    for (double y = -75; y < 79; y += 2)
        for (double x = -62; x < 63; x += 2) {
            const double z = height_at(x, y);
            const double off = 2 * (e[0] * x + e[1] * y + e[2] * z - n[2]);

            if (x * x / (62.0 * 62) + (y - 2) * (y - 2) / (77.0 * 77) > 1)
                continue;
            sum += fabs(z - off * e[2] - height_at(x - off * e[0], y - off * e[1]));
            count++;
        }
    return sum / count;
}

/* Its minimum over the planes near x = 0, by trying many. */
static double least_gap(const struct facegen_scan *s, double n[3])
{
    struct facegen_face f;
    double best;

    facegen_face(s->subject, s->smile, &f);
    f.symmetry = s->symmetry;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            height[j][i] = facegen_height(&f, i - SIDE / 2, j - SIDE / 2);
    memset(n, 0, 3 * sizeof *n);
    best = gap_by_definition(n);
    for (double by = 0.016; by > 2e-4; by /= 2)
        for (int k = 0, failed = 0; failed < 6; k = (k + 1) % 6) {
            const double was = n[k / 2], d = k / 2 == 2 ? 40 * by : by;
            double gap;

            n[k / 2] += k % 2 ? d : -d;
            if ((gap = gap_by_definition(n)) < best) {
                best = gap;
                failed = 0;
            } else {
                n[k / 2] = was;
                failed++;
            }
        }
    return best;
}

/* The angle between a normal found in a scan and one of the head itself, degrees. */
static double angle(const struct facegen_scan *s, const double found[3],
                    const double n[3])
{
    const double length = sqrt(1 + n[0] * n[0] + n[1] * n[1]);
    double r[9], cosine = 0;

    facegen_turn(s, r);
    for (size_t i = 0; i < 3; i++)
        cosine +=
            found[i] * (r[3 * i] + r[3 * i + 1] * n[0] + r[3 * i + 2] * n[1]) / length;
    return acos(fmin(cosine, 1)) / DEGREE;
}

#define SUBJECTS 6
#define LEVELS   4
#define SCANS    3

TEST(test_planted)
{
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, spread = 0, worst = 0, cor;

    for (int i = 0; i < SUBJECTS * LEVELS; i++) {
        struct facegen_scan s;
        double plane[3], truth, low = INFINITY, high = 0;

        facegen_default(&s);
        s.subject = 1 + (uint64_t)i / LEVELS;
        s.warp = 0.05; /* small: a smooth error of the scanner is an asymmetry too */
        s.symmetry = 1 - 0.5 * (i % LEVELS);
        truth = least_gap(&s, plane);
        for (int k = 0; k < SCANS; k++) {
            struct surface_asymmetry a;

            s.scan = (uint64_t)(SCANS * i + k);
            facegen_pose(&s, 12, 10);
            scan(&s);
            a = measured();
            assert_true(a.conclusive);
            worst = fmax(worst, angle(&s, a.normal, plane));
            low = fmin(low, a.disparity_mm);
            high = fmax(high, a.disparity_mm);
            n++;
            x += truth;
            y += a.disparity_mm;
            xx += truth * truth;
            xy += truth * a.disparity_mm;
            yy += a.disparity_mm * a.disparity_mm;
        }
        spread = fmax(spread, high - low);
    }
    cor = (xy - x * y / n) / sqrt((xx - x * x / n) * (yy - y * y / n));
    (void)printf("correlation %.4f, re-scans within %.3f mm, plane within %.2f degrees\n",
                 cor, spread, worst);
    assert_true(cor >= 0.99);
    assert_true(spread < 0.2);
    assert_true(worst < 0.55);
}

/* The same input gives the same bytes; half a face gives an inconclusive result. */
TEST(test_half)
{
    struct facegen_scan s;
    struct surface_asymmetry a, b;
    size_t n, half = 0;

    facegen_default(&s);
    s.subject = 3;
    scan(&s);
    memset(&a, 0, sizeof a);
    memset(&b, 0, sizeof b);
    a = measured();
    b = measured();
    assert_memory_equal(&a, &b, sizeof a);
    assert_memory_equal(a.normal, b.normal, sizeof a.normal);
    assert_true(a.turn_deg > 0.01 && a.turn_deg < 2 && a.shift_mm < 2);
    n = facegen_sample(&s, points);
    for (size_t i = 0; i < n; i++)
        if (points[i].x > -4)
            points[half++] = points[i];
    assert_int_equal(face_build(points, half, faces_work, &face, NULL), ST_OK);
    a = measured();
    assert_false(a.conclusive);
}
