/* Alignment: the search finds known poses, from any start, despite holes and spikes; its
 * result does not depend on the start; surfaces with nothing in common are reported; failed
 * allocations.  The faces are facegen's. */
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

#include "align.h"
#include "align_field.h"
#include "pose.h"
#include "solve.h"
#include "brute.h"
#include "cells.h"
#include "face.h"
#include "facegen.h"
#include "fit.h"
#include "frame.h"
#include "heights.h"
#include "interpolate.h"
#include "locate.h"
#include "measure.h"
#include "mem.h"
#include "model.h"
#include "toy.h"

#define MAX_POINTS 3000

static const double degree = 3.14159265358979323846 / 180;
static uint64_t seed;
static long allowed = -1; /* allocations until one fails; -1: never */
static struct face_work *work;
static struct frame_mean mean;
static struct fit_basis motion; /* the default model's, prepared */
static struct scratch scratch;
static struct dvec3 points[MAX_POINTS], turned[MAX_POINTS];

void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    if (allowed == 0)
        return NULL;
    allowed -= allowed > 0;
    return __real_aligned_alloc(alignment, size);
}

/* rotation(yaw, pitch, roll, r): Rz Rx Ry, degrees. */
static void rotation(double yaw, double pitch, double roll, double r[9])
{
    const double cy = cos(yaw * degree), sy = sin(yaw * degree);
    const double cx = cos(pitch * degree), sx = sin(pitch * degree);
    const double cz = cos(roll * degree), sz = sin(roll * degree);
    const double m[9] = {cz * cy - sz * sx * sy,
                         -sz * cx,
                         cz * sy + sz * sx * cy,
                         sz * cy + cz * sx * sy,
                         cz * cx,
                         sz * sy - cz * sx * cy,
                         -cx * sy,
                         sx,
                         cx * cy};

    memcpy(r, m, sizeof m);
}

/* A face of a subject scanned with a pose; the sampling depends on scan. */
static size_t sample(struct facegen_scan *s, uint64_t subject, uint64_t scan,
                     struct dvec3 *out)
{
    s->subject = subject;
    s->scan = scan;
    return facegen_sample(s, out);
}

static void build(const struct dvec3 *pts, size_t n, struct face *f)
{
    assert_int_equal(face_build(pts, n, work, f, NULL), ST_OK);
}

static void enroll(uint64_t subject, struct face *f)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.warp = 0;
    build(points, sample(&s, subject, 0, points), f);
}

/* search(a, b, w, r): as face_align() does it. */
static enum status search(const struct face *a, const struct face *b,
                          struct align_work *w, struct align_result *r)
{
    const struct pose first = pose_after(&a->frame.pose, &b->frame.pose);
    const struct align_weight u = {mean.rigid, a->frame.pose};
    const struct align_how how = {.start = &first, .u = &u, .motion = &motion};

    return align_search(&a->surface, &b->surface, &how, w, r);
}

/* align(a, b, r): in fresh memory, and as face_align() does. */
static void align(const struct face *a, const struct face *b, struct align_result *r)
{
    struct align_work w = {0};
    struct face_result same;

    assert_int_equal(search(a, b, &w, r), ST_OK);
    align_work_free(&w);
    assert_int_equal(face_align(a, b, NULL, work, &same), ST_OK);
    assert_memory_equal(r->transform, same.align.transform, sizeof r->transform);
}

/* off_by(m, r): degrees between the rotation of m and the inverse of r. */
static double off_by(const double m[16], const double r[9])
{
    double trace = 0;

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            trace += m[4 * i + k] * r[3 * k + i];
    trace = (trace - 1) / 2;
    return acos(trace > 1 ? 1 : trace) / degree;
}

static void test_solve(void **state)
{
    struct brute_rng rng = {seed};

    (void)state;
    for (int round = 0; round < 50; round++) {
        struct solve_normal a;
        double want[6], x[6];

        memset(&a, 0, sizeof a);
        for (int i = 0; i < 6; i++)
            want[i] = brute_real(&rng) - 0.5;
        for (int k = 0; k < 30; k++) {
            double j[6], r = 0;

            for (int i = 0; i < 6; i++) {
                j[i] = brute_real(&rng) - 0.5;
                r -= j[i] * want[i];
            }
            solve_add(&a, j, r, 0.1 + brute_real(&rng));
        }
        assert_true(solve_equations(&a, 0, x));
        for (int i = 0; i < 6; i++)
            assert_true(fabs(x[i] - want[i]) < 1e-9);
    }
}

/* A flat surface does not determine shifts within it nor the turn about its normal: those
 * unknowns stay 0, the others are found. */
static void test_solve_plane(void **state)
{
    struct solve_normal a;
    double x[6];

    (void)state;
    memset(&a, 0, sizeof a);
    for (int i = -5; i <= 5; i++)
        for (int k = -5; k <= 5; k++) {
            const double j[6] = {k, -i, 0, 0, 0, 1};

            solve_add(&a, j, -2.0 - 0.01 * k, 1);
        }
    assert_true(solve_equations(&a, 1e-6, x));
    assert_true(fabs(x[0] - 0.01) < 1e-4 && fabs(x[1]) < 1e-4 && fabs(x[5] - 2) < 1e-4);
    assert_true(x[2] == 0 && x[3] == 0 && x[4] == 0);
    memset(&a, 0, sizeof a);
    assert_false(solve_equations(&a, 1e-6, x));
}

static void test_pose(void **state)
{
    struct pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 2, 3}}, back;
    const struct dvec3 centre = {5, -7, -80};
    double m[16];

    (void)state;
    for (int i = 0; i < 1000; i++) {
        const double x[6] = {0.2, -0.1, 0.05, 1, 2, -3};
        const struct dvec3 before = pose_apply(&pose, (struct dvec3){9, 9, 9});
        struct dvec3 after;

        pose_move(&pose, centre, x);
        after = pose_apply(&pose, (struct dvec3){9, 9, 9});
        /* the centre moves along; the point keeps its distance to it */
        assert_true(fabs(hypot(hypot(before.x - 5, before.y + 7), before.z + 80) -
                         hypot(hypot(after.x - 6, after.y + 5), after.z + 83)) < 1e-6);
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double d = 0;

            for (int l = 0; l < 3; l++)
                d += pose.r[3 * i + l] * pose.r[3 * k + l];
            assert_true(fabs(d - (i == k)) < 1e-14);
        }
    pose_to_matrix(&pose, m);
    pose_from_matrix(m, &back);
    assert_memory_equal(&pose, &back, sizeof pose);
}

/* Single points at random places: the gap is that found by searching all triangles; outside
 * the hull there is none. */
static void test_field(void **state)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    struct face f = {0};
    struct brute_rng rng = {seed + 4};
    struct align_field field;
    struct align_point p = {{0, 0, 0}, 1, ALIGN_FIELD_NONE};

    (void)state;
    enroll(5, &f);
    memset(f.surface.bridge, 0, f.surface.mesh.nt);
    align_field_make(&f.surface, NULL, &field);
    p.triangle = field.first;
    for (int i = 0; i < 2000; i++) {
        const struct ivec2 q = {brute_int(&rng, -120000, 120000),
                                brute_int(&rng, -150000, 150000)};
        const struct location loc = brute_locate(&f.surface.mesh, q);
        struct align_corners c;
        struct solve_sum sum;
        bool found;

        p.p = (struct dvec3){q.x / 1000.0, q.y / 1000.0, -30};
        found = align_field_find(&field, &p, p.p, &c);
        align_field_sum(&field, &p, 1, 1, &still, p.p, SOLVE_LOSS_L1, &sum);
        if (loc.where == LOCATE_OUTSIDE) {
            assert_false(found);
            assert_true(sum.within == 0 && sum.cost == 3);
        } else {
            const double z = interpolate_height(&f.surface.mesh, loc, q) / 1000;
            const struct dvec3 a = {(double)c.at[0][0], (double)c.at[0][1],
                                    (double)c.at[0][2]};
            const struct dvec3 e = {(double)c.at[1][0] - a.x, (double)c.at[1][1] - a.y,
                                    (double)c.at[1][2] - a.z};
            const struct dvec3 g = {(double)c.at[2][0] - a.x, (double)c.at[2][1] - a.y,
                                    (double)c.at[2][2] - a.z};
            const struct dvec3 n = vec_cross(e, g);
            const double gap = fabs(-30 - z) * n.z / sqrt(vec_dot(n, n));

            assert_true(found);
            assert_true(fabs(-30 + vec_dot(a, n) / n.z / 1000 - z) < 1e-3);
            assert_true(sum.within == 1 && fabs(sum.cost - (gap < 5 ? gap : 5)) < 1e-4);
        }
    }
    face_free(&f);
}

/* Mated probes, turned and shifted up to the limits of the search. */
static void test_finds_pose(void **state)
{
    struct face a = {0}, b = {0};
    struct brute_rng rng = {seed + 1};
    double sum = 0;

    (void)state;
    for (uint64_t subject = 0; subject < 12; subject++) {
        struct facegen_scan s;
        struct align_result r;
        double true_r[9], error;

        enroll(subject, &a);
        facegen_default(&s);
        s.warp = 0;
        s.yaw = 60 * brute_real(&rng) - 30;
        s.pitch = 40 * brute_real(&rng) - 20;
        s.roll = 40 * brute_real(&rng) - 20;
        s.tx = 400 * brute_real(&rng) - 200;
        s.ty = 400 * brute_real(&rng) - 200;
        s.tz = 400 * brute_real(&rng) - 200;
        build(points, sample(&s, subject, 1, points), &b);
        align(&a, &b, &r);
        rotation(s.yaw, s.pitch, s.roll, true_r);
        error = off_by(r.transform, true_r);
        sum += error;
        assert_true(error < 1.5);
        printf("%d: %.2f degrees\n", (int)subject, error);
        assert_int_not_equal(r.stop, ALIGN_APART);
        assert_true(r.turn_deg > 0 && r.turn_deg < 2 && r.shift_mm > 0 && r.shift_mm < 2);
        assert_true(r.within > 0.5 && r.cost_mm < 1);
        assert_true(r.starts >= 1 && r.evaluations > r.starts);
    }
    printf("mean rotation error %.2f degrees\n", sum / 12);
    assert_true(sum / 12 < 0.5);
    face_free(&a);
    face_free(&b);
}

/* A third of the face is missing, and some points lie far off. */
static void test_holes_and_spikes(void **state)
{
    struct face a = {0}, b = {0};
    double sum = 0;

    (void)state;
    for (uint64_t subject = 20; subject < 30; subject++) {
        struct facegen_scan s;
        struct align_result r;
        double true_r[9];

        enroll(subject, &a);
        facegen_default(&s);
        s.holes = 0.35;
        s.spikes = 0.012;
        s.noise = 0.3;
        s.subject = subject;
        s.scan = 3;
        facegen_pose(&s, 10, 15);
        build(points, sample(&s, subject, 3, points), &b);
        align(&a, &b, &r);
        rotation(s.yaw, s.pitch, s.roll, true_r);
        sum += off_by(r.transform, true_r);
        assert_true(off_by(r.transform, true_r) < 3);
        printf("%d: %.2f degrees\n", (int)subject, off_by(r.transform, true_r));
    }
    assert_true(sum / 10 < 1.2);
    face_free(&a);
    face_free(&b);
}

/* Where the points p are once they are moved, compared with the places `was`: the root mean
 * square distance, mm. */
static double moved_by(const double transform[16], const struct dvec3 *p, size_t n,
                       const struct dvec3 *was)
{
    double sum = 0;

    for (size_t k = 0; k < n; k++) {
        const struct dvec3 d = vec_sub(vec_transform(transform, p[k]), was[k]);

        sum += vec_dot(d, d);
    }
    return sqrt(sum / (double)n);
}

/* Whatever the probe's pose, its points come to the same places; not as exactly in non-mated
 * comparisons, where the minimum is shallow. */
static void test_start_does_not_matter(void **state)
{
    static const double poses[][6] = {{0, 0, 0, 0, 0, 0},       {8, 3, 0, 10, 0, 0},
                                      {0, 0, 20, 50, -150, 9},  {-9, -9, 9, 5, 5, 300},
                                      {30, 0, 0, 100, 0, 0},    {10, -20, -20, 5, 5, 300},
                                      {-25, 15, 15, 60, 70, 80}};
    struct face a = {0}, b = {0};

    (void)state;
    for (uint64_t who = 0; who < 6; who++) {
        const uint64_t subject = 40 + who % 3; /* mated, then non-mated: no pose
                                                   fits well */
        static struct dvec3 first[MAX_POINTS];
        struct facegen_scan s;
        size_t n;

        enroll(subject, &a);
        facegen_default(&s);
        n = sample(&s, who < 3 ? subject : subject + 7, 5, points);
        for (size_t i = 0; i < sizeof poses / sizeof *poses; i++) {
            struct pose p;
            struct align_result r;
            double off;

            rotation(poses[i][0], poses[i][1], poses[i][2], p.r);
            memcpy(p.t, poses[i] + 3, sizeof p.t);
            for (size_t k = 0; k < n; k++)
                turned[k] = pose_apply(&p, points[k]);
            build(turned, n, &b);
            align(&a, &b, &r);
            for (size_t k = 0; i == 0 && k < n; k++)
                first[k] = vec_transform(r.transform, turned[k]);
            off = moved_by(r.transform, turned, n, first);
            printf("%d, pose %zu: %.3f mm\n", (int)who, i, off);
            assert_true(off < (who < 3 ? 0.04 : 2));
        }
    }
    face_free(&a);
    face_free(&b);
}

/* Mirroring both faces, or moving both, moves the pose likewise. */
static void test_mirror_and_translation(void **state)
{
    static const double maps[][3] = {{1, 0, 0}, {-1, 0, 0}, {1, 777.7, -333.3}};
    static struct dvec3 first[MAX_POINTS];
    struct face f[2] = {0};
    struct facegen_scan s;
    struct align_result r;

    (void)state;
    facegen_default(&s);
    for (size_t how = 0; how < sizeof maps / sizeof *maps; how++) {
        size_t n = 0;
        double off;

        for (uint64_t side = 0; side < 2; side++) {
            n = sample(&s, 50, side, points);
            for (size_t i = 0; i < n; i++) {
                points[i].x = maps[how][0] * points[i].x + maps[how][1];
                points[i].y += maps[how][2];
            }
            build(points, n, &f[side]);
        }
        align(&f[0], &f[1], &r);
        for (size_t i = 0; how == 0 && i < n; i++)
            first[i] = vec_transform(r.transform, points[i]);
        for (size_t i = 0; i < n; i++)
            turned[i] = (struct dvec3){maps[how][0] * first[i].x + maps[how][1],
                                       first[i].y + maps[how][2], first[i].z};
        off = moved_by(r.transform, points, n, turned);
        printf("map %zu: %.3f mm\n", how, off);
        assert_true(off < 0.04);
    }
    face_free(&f[0]);
    face_free(&f[1]);
}

/* The gap per cell of the template's frame, at right angles to the mean face. */
static void gap_at(const struct face *a, const struct face *b, const double transform[16],
                   struct cells *out)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct pose back = pose_after(&a->frame.pose, &still);
    struct pose pose;
    float z[2][GRID_N];

    pose_from_matrix(transform, &pose);
    pose = pose_after(&back, &pose);
    assert_int_equal(heights_of(&a->surface, &a->frame.pose, &scratch, z[0]), ST_OK);
    assert_int_equal(heights_of(&b->surface, &pose, &scratch, z[1]), ST_OK);
    toy_cells(&model_default, z[0], z[1], out);
}

/* The search samples the gap.  At the pose where it ends, hardly any of the exact gap can be
 * explained as motion (somewhat more in a non-mated comparison, where the minimum is
 * shallow); and the same input gives the same bytes. */
static void test_end(void **state)
{
    struct face a = {0}, b = {0};

    (void)state;
    for (uint64_t who = 60; who < 62; who++) {
        struct align_result r, again;
        struct facegen_scan s;
        struct cells cells;
        struct fit fit;

        enroll(60, &a);
        facegen_default(&s);
        build(points, sample(&s, who, 9, points), &b);
        align(&a, &b, &r);
        align(&a, &b, &again);
        assert_memory_equal(&r.transform, &again.transform, sizeof r.transform);
        gap_at(&a, &b, r.transform, &cells);
        assert_int_equal(fit_solve(&motion, &cells, 1e-4, 1, &scratch, &fit), ST_OK);
        for (int i = 0; i < 6; i++)
            assert_true(fabs(fit.x[i]) < (who == 60 ? 0.3 : 1) * (i < 3 ? degree : 1));
    }
    face_free(&a);
    face_free(&b);
}

/* A given start is used: from the end of a former search only few steps are left. */
static void test_given_start(void **state)
{
    struct face a = {0}, b = {0};
    struct align_work w = {0};
    struct align_result r, again;
    struct pose end;
    struct facegen_scan s;

    (void)state;
    enroll(63, &a);
    facegen_default(&s);
    s.yaw = 20;
    s.tx = 100;
    build(points, sample(&s, 63, 1, points), &b);
    assert_int_equal(align_search(&a.surface, &b.surface, &(struct align_how){0}, &w, &r),
                     ST_OK);
    assert_true(r.turn_deg == (double)INFINITY); /* no model of the change was given */
    pose_from_matrix(r.transform, &end);
    assert_int_equal(align_search(&a.surface, &b.surface,
                                  &(struct align_how){.start = &end}, &w, &again),
                     ST_OK);
    assert_int_equal(again.starts, 1);
    assert_true(again.evaluations < r.evaluations);
    for (int i = 0; i < 16; i++)
        assert_true(fabs(r.transform[i] - again.transform[i]) <
                    (i % 4 == 3 ? 0.05 : 1e-3));
    align_work_free(&w);
    face_free(&a);
    face_free(&b);
}

/* A template without measured area, and a pose off the lattice. */
static void test_apart(void **state)
{
    static const double far[16] = {1, 0, 0, 1e5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const double edge_on[16] = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    struct face a = {0};
    struct measure_work w;
    struct align_work align = {0};
    struct align_result r;
    struct disparity d;

    (void)state;
    memset(&w, 0, sizeof w);
    enroll(70, &a);
    assert_int_equal(measure_at(&a.surface, &a.surface, far, NULL, &w, &d), ST_OK);
    assert_true(d.common == 0 && d.area_mm2 == 0 && d.overlap == 0);
    assert_int_equal(measure_at(&a.surface, &a.surface, edge_on, NULL, &w, &d), ST_OK);
    assert_true(d.common == 0 && d.area_mm2 == 0 && d.overlap == 0);
    memset(a.surface.bridge, 1, a.surface.mesh.nt);
    assert_int_equal(search(&a, &a, &align, &r), ST_OK);
    assert_int_equal(r.stop, ALIGN_APART);
    for (int i = 0; i < 16; i++)
        assert_true(isfinite(r.transform[i]));
    align_work_free(&align);
    measure_work_free(&w);
    face_free(&a);
}

/* The n-th allocation fails, for every n until none does. */
static void test_memory(void **state)
{
    struct face a = {0}, b = {0};
    struct facegen_scan s;
    enum status st = ST_ENOMEM;
    long n = 0;

    (void)state;
    facegen_default(&s);
    enroll(80, &a);
    build(points, sample(&s, 80, 4, points), &b);
    for (; st != ST_OK; n++) {
        struct align_work w = {0};
        struct align_result r;

        allowed = n;
        st = search(&a, &b, &w, &r);
        allowed = -1;
        assert_true(st == ST_OK || st == ST_ENOMEM);
        align_work_free(&w);
        assert_null(w.field.block);
        assert_null(w.fit.block);
    }
    assert_true(n > 2);
    measure_work_free(NULL);
    face_free(&a);
    face_free(&b);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solve),
        cmocka_unit_test(test_solve_plane),
        cmocka_unit_test(test_pose),
        cmocka_unit_test(test_field),
        cmocka_unit_test(test_finds_pose),
        cmocka_unit_test(test_holes_and_spikes),
        cmocka_unit_test(test_start_does_not_matter),
        cmocka_unit_test(test_mirror_and_translation),
        cmocka_unit_test(test_end),
        cmocka_unit_test(test_given_start),
        cmocka_unit_test(test_apart),
        cmocka_unit_test(test_memory),
    };
    int failed;

    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    seed = brute_seed("align");
    if ((work = face_work_new(NULL)) == NULL ||
        frame_mean_make(&model_default, &mean) != ST_OK)
        return 2;
    fit_prepare(&model_default.change, &motion);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    face_work_free(work);
    scratch_free(&scratch);
    return failed;
}
