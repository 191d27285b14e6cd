/* The minimal disparity: against descent by values alone over the measure itself; cases by
 * hand; its limits; gaps and their derivatives; failed allocations. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "pose.h"
#include "brute.h"
#include "face.h"
#include "facegen.h"
#include "fail_alloc.h"
#include "lattice.h"
#include "measure.h"
#include "minimal.h"
#include "minimal_places.h"
#include "toy.h"

#define POINTS 3000
#define LEVER  80.0

static struct face_work *work;
static struct measure_work measure;
static struct face tmpl, probe;
static struct dvec3 points[POINTS];

/* ---- what is compared */

static void build(const struct facegen_scan *s, double from_x, struct face *out)
{
    size_t n = facegen_sample(s, points), kept = 0;

    for (size_t i = 0; i < n; i++)
        if (points[i].x > from_x)
            points[kept++] = points[i];
    assert_int_equal(face_build(points, kept, work, out, NULL), ST_OK);
}

/* A template, and a probe of the same person or another, of so many points, of which those
 * beyond from_x are left.  Returns the alignment's transform. */
static const double *pair(uint64_t subject, bool mated, uint32_t n, double from_x)
{
    static struct face_result r;
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = subject;
    build(&s, -INFINITY, &tmpl);
    s.subject += mated ? 0 : 1;
    s.scan = 1;
    s.points = n;
    s.noise = 0.3;
    s.smile = subject % 2 ? 0.3 : 0;
    facegen_pose(&s, 8, 12);
    build(&s, from_x, &probe);
    assert_int_equal(face_align(&tmpl, &probe, NULL, work, &r), ST_OK);
    return r.align.transform;
}

static void close_to(double got, double wanted, double by)
{
    if (!(fabs(got - wanted) <= by))
        fail_msg("%.9g, wanted %.9g to %.2g", got, wanted, by);
}

static struct disparity at(const double transform[16])
{
    struct disparity d;

    assert_int_equal(
        measure_at(&tmpl.surface, &probe.surface, transform, NULL, &measure, &d), ST_OK);
    return d;
}

static struct minimal find(const double transform[16])
{
    struct minimal m = {.ms = 0};

    assert_int_equal(minimal_find(&tmpl.surface, &probe.surface, transform, &measure, &m),
                     ST_OK);
    return m;
}

/* transform, then the turn by x[0..2] / LEVER about the middle of the probe, and the shift. */
static void moved(const double transform[16], const double x[6], double out[16])
{
    struct pose pose;
    double y[6];

    pose_from_matrix(transform, &pose);
    for (int k = 0; k < 6; k++)
        y[k] = k < 3 ? x[k] / LEVER : x[k];
    pose_move(&pose, pose_apply(&pose, pose_centre(&probe.surface.mesh)), y);
    pose_to_matrix(&pose, out);
}

/* ---- against descent by values alone */

/* Pattern search over the measure, from `start` on. */
static double descent(const double start[16], double from, double to, double least_area)
{
    double x[6] = {0}, best = INFINITY;

    for (double step = from; step >= to;) {
        bool better = false;

        for (int k = 0; k < 12; k++) {
            for (int i = 0; i < 8; i++) {
                const double before = x[k / 2];
                struct disparity d;
                double t[16];

                x[k / 2] += k % 2 ? -step : step;
                moved(start, x, t);
                d = at(t);
                if (d.plain_mm < best && d.area_mm2 >= least_area) {
                    best = d.plain_mm;
                    better = true;
                } else {
                    x[k / 2] = before;
                    break;
                }
            }
        }
        step *= better ? 1 : 0.5;
    }
    return best;
}

static void against_descent(uint64_t subject, bool mated, double most)
{
    double transform[16];
    struct disparity aligned;
    struct minimal m;
    double best, other;

    memcpy(transform, pair(subject, mated, POINTS, -INFINITY), sizeof transform);
    aligned = at(transform);
    m = find(transform);
    best = descent(m.transform, 0.2, 0.04, MINIMAL_AREA * aligned.area_mm2);
    other = descent(transform, 1, 0.1, MINIMAL_AREA * aligned.area_mm2);
    best = best < other ? best : other;
    best = best < m.disparity.plain_mm ? best : m.disparity.plain_mm;
    if (!(m.disparity.plain_mm <= most * best))
        fail_msg("subject %u: %.4f, %.4f of the least", (unsigned)subject,
                 m.disparity.plain_mm, m.disparity.plain_mm / best);
    assert_true(m.disparity.plain_mm <= (mated ? 1 : 0.99) * aligned.plain_mm);
    assert_true(m.disparity.area_mm2 >= MINIMAL_AREA * aligned.area_mm2);
}

static void test_descent(void **state)
{
    (void)state;
    for (uint64_t subject = 50; subject < 53; subject++) {
        against_descent(subject, true, 1.01);
        against_descent(subject, false, 1.02);
    }
}

/* ---- what holds of every result */

static void test_result(void **state)
{
    static const double start[3][6] = {
        {2, 0, -1, 1, 2, 1}, {-1, 2, 1, -2, 0, 1}, {0, -2, 2, 0.5, -2, -1}};
    const double *aligned = pair(7, true, POINTS, -INFINITY);
    const struct minimal first = find(aligned);

    (void)state;
    for (int i = 0; i < 3; i++) {
        double t[16];
        struct disparity d;
        struct minimal m;

        moved(aligned, start[i], t);
        m = find(t);
        d = at(m.transform);
        assert_true(m.disparity.plain_mm == d.plain_mm &&
                    m.disparity.area_mm2 == d.area_mm2 &&
                    m.disparity.volume_mm3 == d.volume_mm3);
        assert_true(m.disparity.plain_mm <= at(t).plain_mm);
        if (!(fabs(m.disparity.plain_mm / first.disparity.plain_mm - 1) < 0.015))
            fail_msg("from pose %d: %.4f, else %.4f", i, m.disparity.plain_mm,
                     first.disparity.plain_mm);
    }
}

/* m's measure is not more than that at the pose where it began, and the area is kept. */
static void not_above(const char *what, const struct minimal *m,
                      const struct disparity *before)
{
    if (!(m->disparity.plain_mm <= before->plain_mm &&
          m->disparity.area_mm2 >= MINIMAL_AREA * before->area_mm2))
        fail_msg("%s: %.4f mm of %.4f, %.4f of the area", what, m->disparity.plain_mm,
                 before->plain_mm, m->disparity.area_mm2 / before->area_mm2);
}

/* Few points, parts of faces, poses far off.  At the estimate's minimum alone the first eight
 * have 0.67 to 0.94 of the area, and the next three 0.2 to 2 % more than at the alignment. */
static void test_alignment(void **state)
{
    static const struct {
        uint64_t subject;
        bool mated;
        uint32_t n;
        double from_x;
    } k[] = {{155, false, 3000, -10}, {147, false, 3000, 0}, {116, false, 3000, 0},
             {123, false, 3000, 0},   {100, false, 500, 0},  {153, false, 500, 0},
             {155, false, 250, -10},  {140, false, 250, 0},  {110, true, 250, -INFINITY},
             {140, true, 250, -10},   {127, true, 250, 0},   {134, true, 500, 0}};
    static const double far[6] = {4, -6, 3, 15, -12, 4};

    (void)state;
    for (size_t i = 0; i < sizeof k / sizeof *k; i++) {
        double t[16];
        struct disparity before;
        struct minimal m;
        char what[40];

        memcpy(t, pair(k[i].subject, k[i].mated, k[i].n, k[i].from_x), sizeof t);
        (void)snprintf(what, sizeof what, "subject %u", (unsigned)k[i].subject);
        before = at(t);
        m = find(t);
        not_above(what, &m, &before);
        moved(t, far, t);
        before = at(t);
        m = find(t);
        not_above(what, &m, &before);
    }
}

/* From a minimum: nothing more, whatever the estimate says. */
static void test_again(void **state)
{
    (void)state;
    for (uint64_t subject = 60; subject < 68; subject++) {
        struct minimal m = find(pair(subject, true, POINTS, -INFINITY));

        for (int i = 0; i < 3; i++) {
            const struct disparity before = m.disparity;
            double t[16];

            memcpy(t, m.transform, sizeof t);
            m = find(t);
            not_above("again", &m, &before);
        }
    }
}

/* How far m is from the alignment: degrees, and mm of the middle of the probe. */
static void distance(const double aligned[16], const struct minimal *m, double *turn,
                     double *shift)
{
    const struct dvec3 c = pose_centre(&probe.surface.mesh);
    const struct dvec3 d =
        vec_sub(vec_transform(m->transform, c), vec_transform(aligned, c));
    double trace = 0;

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            trace += m->transform[4 * i + k] * aligned[4 * i + k];
    *turn = acos(fmin(1, (trace - 1) / 2)) * VEC_DEGREES;
    *shift = sqrt(vec_dot(d, d));
}

static void test_limits(void **state)
{
    static const double far[5][6] = {{0, 0, 0, 0, 0, 45},
                                     {0, 0, 0, 0, 0, -30},
                                     {12, 24, 6, 0, 0, 45},
                                     {0, 24, 0, 0, 0, 0},
                                     {0, 0, 28, 0, 0, 0}};
    double aligned[16], t[16], turn, shift;

    (void)state;
    memcpy(aligned, pair(3, true, POINTS, -INFINITY), sizeof aligned);
    for (int i = 0; i < 5; i++) {
        struct minimal m;

        moved(aligned, far[i], t);
        m = find(t);
        distance(t, &m, &turn, &shift);
        assert_true(turn <= MINIMAL_TURN_DEG + 1e-6 && shift <= MINIMAL_SHIFT_MM + 1e-6);
        assert_true(m.disparity.plain_mm < 0.8 * at(t).plain_mm);
        if (i < 3)
            assert_true(shift > MINIMAL_SHIFT_MM - 0.01);
        else
            assert_true(turn > MINIMAL_TURN_DEG - 0.5);
    }
}

/* ---- by hand */

static double sheet(const void *arg, double x, double y)
{
    const double *s = arg;

    return s[0] + s[1] * x + s[2] * y;
}

static void sheets(const double a[3], const double b[3])
{
    struct brute_rng r = {brute_seed("minimal")};

    toy_scan(sheet, a, 1500, NULL, &r, &tmpl.surface);
    toy_scan(sheet, b, 1800, NULL, &r, &probe.surface);
}

static const double still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static void test_planes(void **state)
{
    static const double up[3] = {3, 0.1, 0.05}, tilted[3] = {-2, 0.13, 0.02},
                        down[3] = {0, 0.1, 0.05};
    struct minimal m;

    (void)state;
    sheets(down, up);
    assert_true(at(still).plain_mm > 2.9);
    assert_true(find(still).disparity.plain_mm < 0.01);
    sheets(down, tilted);
    assert_true(find(still).disparity.plain_mm < 0.01);
    sheets(down, down);
    m = find(still);
    assert_true(m.disparity.plain_mm < 1e-3);
}

/* Over itself: exactly 0, and the pose is the alignment's to the bit. */
static void test_itself(void **state)
{
    const double *aligned = pair(5, true, POINTS, -INFINITY);
    struct minimal m;
    double t[16];

    (void)state;
    (void)aligned;
    assert_int_equal(face_build(points, 0, work, &probe, NULL), ST_ETOOFEW);
    face_free(&probe);
    probe = tmpl;
    m = find(still);
    assert_true(m.disparity.plain_mm == 0);
    assert_memory_equal(m.transform, still, sizeof still);
    moved(still, (const double[6]){1, -1, 1, 0.5, 1, -1}, t);
    assert_true(find(t).disparity.plain_mm < 0.1);
    memset(&probe, 0, sizeof probe);
}

static void test_apart(void **state)
{
    double away[16];
    struct disparity nothing;
    struct minimal m;

    (void)state;
    memset(&nothing, 0, sizeof nothing);
    memcpy(away, pair(1, true, POINTS, -INFINITY), sizeof away);
    away[3] += 500;
    m = find(away);
    assert_memory_equal(m.transform, away, sizeof away);
    assert_true(m.disparity.plain_mm == 0 && m.disparity.area_mm2 == 0);
    away[3] = 1e7; /* off the lattice */
    m = find(away);
    assert_memory_equal(m.transform, away, sizeof away);
    assert_memory_equal(&m.disparity, &nothing, sizeof nothing);
}

/* Seen from the back or the side most triangles are overturned: it ends all the same. */
static void test_overturned(void **state)
{
    double aligned[16], t[16];

    (void)state;
    memcpy(aligned, pair(2, true, POINTS, -INFINITY), sizeof aligned);
    for (int i = 1; i < 6; i++) {
        const double x[6] = {0, 40.0 * i, 15.0 * i, 0, 0, 0};

        moved(aligned, x, t);
        assert_true(find(t).disparity.plain_mm <= at(t).plain_mm);
    }
}

/* ---- gaps and derivatives */

static void test_places(void **state)
{
    static const double a[3] = {0, 0.2, -0.1}, b[3] = {4, 0.4, 0.25};
    struct minimal_pair p = {.tmpl = {.surface = &tmpl.surface},
                             .probe = {.surface = &probe.surface}};
    struct pose pose;
    struct disparity d;
    double transform[16];
    float *gap, *by[5];
    uint32_t n, checked = 0;
    void *block;

    (void)state;
    sheets(a, b);
    p.centre = (struct dvec3){3, -4, 5};
    block = aligned_alloc(64, minimal_places_layout(&p, NULL));
    (void)minimal_places_layout(&p, block);
    minimal_places_begin(&p);

    /* Each triangle weighs twice its area at each corner. */
    toy_pose(25, -9, 15, (struct dvec3){2, -3, 1}, &pose);
    pose_to_matrix(&pose, transform);
    d = at(transform);
    close_to(minimal_places_all(&p, &pose) / (2 * 6 * d.area_mm2), 1, 0.02);
    n = p.places.n;
    close_to(minimal_mean(&p.places) / d.plain_mm, 1, 0.01);
    gap = calloc(6 * (size_t)n, sizeof *gap);
    memcpy(gap, p.places.gap, n * sizeof *gap);
    for (int k = 0; k < 5; k++) {
        by[k] = gap + (size_t)(k + 1) * n;
        memcpy(by[k], p.places.by[k], n * sizeof **by);
    }
    for (int k = 0; k < 6; k++) {
        struct pose turned = pose;
        double x[6] = {0};

        x[k] = k < 3 ? 1e-3 : 0.1;
        pose_move(&turned, p.centre, x);
        assert_true(minimal_places_all(&p, &turned) > 0);
        for (uint32_t i = 0; i < n; i++) {
            const double rate = k < 5 ? (double)by[k][i] : 1;

            if (p.places.weight[i] <= 0 || gap[i] == 0)
                continue;
            checked++;
            if (!(fabs((double)p.places.gap[i] - (double)gap[i] - rate * x[k]) < 1.5e-3))
                fail_msg("place %u, motion %d: %g, not %g", (unsigned)i, k,
                         (double)p.places.gap[i] - (double)gap[i], rate * x[k]);
        }
    }
    assert_true(checked > 3 * n);

    /* Few of them: about the same. */
    assert_true(probe.surface.mesh.nv / MINIMAL_FEW >= 2);
    close_to(minimal_places_few(&p, &pose) * p.stride / (6 * d.area_mm2), 1, 0.05);
    close_to(minimal_mean(&p.places) / d.plain_mm, 1, 0.03);
    free(gap);
    free(block);
}

/* Missing points of either scan are bridged, and nothing is measured there. */
static void test_holes(void **state)
{
    struct minimal_pair p = {.tmpl = {.surface = &tmpl.surface},
                             .probe = {.surface = &probe.surface}};
    struct face_result r;
    struct facegen_scan s;
    struct pose pose;
    void *block;

    (void)state;
    facegen_default(&s);
    s.subject = 20;
    s.holes = 0.3;
    build(&s, -INFINITY, &tmpl);
    s.scan = 1;
    build(&s, -INFINITY, &probe);
    assert_int_equal(face_align(&tmpl, &probe, NULL, work, &r), ST_OK);
    block = aligned_alloc(64, minimal_places_layout(&p, NULL));
    (void)minimal_places_layout(&p, block);
    pose_from_matrix(r.align.transform, &pose);
    minimal_places_begin(&p);
    close_to(minimal_places_all(&p, &pose) / (2 * 6 * at(r.align.transform).area_mm2), 1,
             0.04);
    free(block);
}

/* ---- memory */

static void test_digits(void **state)
{
    struct measure_work fresh = {0};
    double aligned[16];
    struct minimal first = {.ms = 0}, m;

    (void)state;
    memcpy(aligned, pair(9, false, POINTS, -INFINITY), sizeof aligned);
    assert_int_equal(minimal_find(&tmpl.surface, &probe.surface, aligned, &fresh, &first),
                     ST_OK);
    m = find(aligned);
    assert_memory_equal(&m, &first, sizeof m);
    (void)minimal_find(&probe.surface, &tmpl.surface, aligned, &fresh, &m);
    assert_int_equal(minimal_find(&tmpl.surface, &probe.surface, aligned, &fresh, &m),
                     ST_OK);
    assert_memory_equal(&m, &first, sizeof m);
    measure_work_free(&fresh);
}

static void test_memory(void **state)
{
    struct minimal m = {.ms = 0};
    double aligned[16];
    unsigned long k = 0, failed;
    enum status st;

    (void)state;
    memcpy(aligned, pair(4, true, POINTS, -INFINITY), sizeof aligned);
    do {
        struct measure_work fresh = {0};

        fail_alloc_at(++k);
        st = minimal_find(&tmpl.surface, &probe.surface, aligned, &fresh, &m);
        failed = fail_alloc_count();
        fail_alloc_at(0);
        assert_true(st == ST_OK || st == ST_ENOMEM);
        assert_true(st == ST_OK || failed >= k);
        measure_work_free(&fresh);
    } while (st == ST_ENOMEM);
    assert_true(k > 4);
    assert_true(m.disparity.plain_mm == find(aligned).disparity.plain_mm);
}

static int start(void **state)
{
    (void)state;
    return (work = face_work_new(NULL)) == NULL;
}

static int end(void **state)
{
    (void)state;
    face_work_free(work);
    measure_work_free(&measure);
    face_free(&tmpl);
    face_free(&probe);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_descent),    cmocka_unit_test(test_result),
        cmocka_unit_test(test_alignment),  cmocka_unit_test(test_again),
        cmocka_unit_test(test_limits),     cmocka_unit_test(test_planes),
        cmocka_unit_test(test_itself),     cmocka_unit_test(test_apart),
        cmocka_unit_test(test_overturned), cmocka_unit_test(test_places),
        cmocka_unit_test(test_holes),      cmocka_unit_test(test_digits),
        cmocka_unit_test(test_memory)};

    return cmocka_run_group_tests(tests, start, end);
}
