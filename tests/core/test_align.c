/* Alignment: the search finds known poses, from any start, despite holes and spikes; its
 * result does not depend on the start; a face of which a part has changed is registered by the
 * rest, and where the cheapest coarse pose is wrong its rival is found; surfaces with nothing in common are reported; failed
 * allocations.  The faces are facegen's. */
#include "align.h"
#include "align_field.h"
#include "pose.h"
#include "solve.h"
#include "brute.h"
#include "clouds.h"
#include "face.h"
#include "faces.h"
#include "facegen.h"
#include "fit.h"
#include "frame.h"
#include "locate.h"
#include "measure.h"
#include "model.h"
#include "pair.h"
#include "unit.h"

#define MAX_POINTS 3000

static const double degree = 3.14159265358979323846 / 180;
static uint64_t seed;
static struct frame_mean mean;
static struct fit_basis motion; /* the default model's, prepared */
static struct dvec3 points[MAX_POINTS], turned[MAX_POINTS];

/* A face of a subject scanned with a pose; the sampling depends on scan. */
static size_t sample(struct facegen_scan *s, uint64_t subject, uint64_t scan,
                     struct dvec3 *out)
{
    s->subject = subject;
    s->scan = scan;
    return facegen_sample(s, out);
}

static void build(const struct dvec3 *pts, size_t n, struct surface_face *f)
{
    assert_int_equal(face_build(pts, n, faces_work, f, NULL), ST_OK);
}

static void enroll(uint64_t subject, struct surface_face *f)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.warp = 0;
    build(points, sample(&s, subject, 0, points), f);
}

/* search(a, b, w, r): as face_align() does it. */
static enum status search(const struct surface_face *a, const struct surface_face *b,
                          struct align_work *w, struct align_result *r)
{
    struct pair pair;
    struct pose to, from, first;

    assert_int_equal(pair_make(a, b, faces_work, &pair), ST_OK);
    to = pose_unscaled(&pair.tmpl.pose);
    from = pose_unscaled(&pair.probe.pose);
    first = pose_after(&to, &from);
    return align_search(
        &a->surface, &b->surface,
        &(struct align_how){.start = &first,
                            .u = &(struct align_weight){mean.rigid, pair.tmpl.pose},
                            .motion = &motion},
        w, r);
}

/* align(a, b, r): in fresh memory, and as face_align() does. */
static void align(const struct surface_face *a, const struct surface_face *b,
                  struct align_result *r)
{
    struct align_work w = {0};
    struct align_result same;

    assert_int_equal(search(a, b, &w, r), ST_OK);
    align_work_free(&w);
    assert_int_equal(face_align(a, b, faces_work, &same), ST_OK);
    assert_memory_equal(r->transform, same.transform, sizeof r->transform);
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

/* A flat surface does not determine shifts within it nor the turn about its normal: those
 * unknowns stay 0, the others are found. */
TEST(test_solve_plane)
{
    struct solve_normal a;
    double x[6];

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

/* Single points at random places: the gap is that found by searching all triangles; outside
 * the hull there is none. */
TEST(test_field)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    struct surface_face f = {0};
    struct draw rng = {seed + 4};
    struct align_field field;
    struct align_point p = {{0, 0, 0}, 1, ALIGN_FIELD_NONE};

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
            const double z = locate_height(&f.surface.mesh, loc, q) / 1000;
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
TEST(test_finds_pose)
{
    struct surface_face a = {0}, b = {0};
    struct draw rng = {seed + 1};
    double sum = 0;

    for (uint64_t subject = 0; subject < 12; subject++) {
        struct facegen_scan s;
        struct align_result r;
        double true_r[9], error;

        enroll(subject, &a);
        facegen_default(&s);
        s.warp = 0;
        if (subject % 2 != 0) { /* a third of the face is missing, points lie far off */
            s.holes = 0.35;
            s.spikes = 0.012;
            s.noise = 0.3;
        }
        s.yaw = draw_uniform(&rng, -30, 30);
        s.pitch = draw_uniform(&rng, -20, 20);
        s.roll = draw_uniform(&rng, -20, 20);
        s.tx = draw_uniform(&rng, -200, 200);
        s.ty = draw_uniform(&rng, -200, 200);
        s.tz = draw_uniform(&rng, -200, 200);
        build(points, sample(&s, subject, 1, points), &b);
        align(&a, &b, &r);
        facegen_turn(&s, true_r);
        error = off_by(r.transform, true_r);
        printf("%d: %.2f degrees\n", (int)subject, error);
        assert_true(error < (subject % 2 == 0 ? 0.3 : 0.6));
        if (subject % 2 != 0)
            continue;
        sum += error;
        assert_int_not_equal(r.stop, ALIGN_APART);
        assert_true(r.turn_deg > 0 && r.turn_deg < 2 && r.shift_mm > 0 && r.shift_mm < 2);
        assert_true(r.within > 0.5 && r.cost_mm < 1);
        assert_true(r.starts >= 1 && r.evaluations > r.starts);
    }
    printf("without holes, mean %.2f degrees\n", sum / 6);
    assert_true(sum / 6 < 0.1);
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
TEST(test_start_does_not_matter)
{
    static const double poses[][6] = {{0, 0, 0, 0, 0, 0},       {8, 3, 0, 10, 0, 0},
                                      {0, 0, 20, 50, -150, 9},  {-9, -9, 9, 5, 5, 300},
                                      {30, 0, 0, 100, 0, 0},    {10, -20, -20, 5, 5, 300},
                                      {-25, 15, 15, 60, 70, 80}};
    struct surface_face a = {0}, b = {0};

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
            const struct facegen_scan turn = {
                .yaw = poses[i][0], .pitch = poses[i][1], .roll = poses[i][2]};
            struct pose p;
            struct align_result r;
            double off;

            facegen_turn(&turn, p.r);
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

/* A given start is used: from the end of a former search only few steps are left. */
TEST(test_given_start)
{
    struct surface_face a = {0}, b = {0};
    struct align_work w = {0};
    struct align_result r, again;
    struct pose end;
    struct facegen_scan s;

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

/* ---- a part that has changed, and a rival */

/* A scan with holes, and a share of the smooth error that facegen_default() gives. */
static size_t scan_of(uint64_t subject, uint64_t number, uint32_t points_wanted,
                      double holes, double warp)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.points = points_wanted;
    s.holes = holes;
    s.warp = warp;
    return sample(&s, subject, number, points);
}

/* How far the pose found leaves the upper face from where it belongs, mm; moved: where the
 * probe was moved to. */
static double error(const struct surface_face *tmpl, const struct surface_face *probe,
                    const double moved[16])
{
    static const double at[4][3] = {
        {-40, 40, -15}, {40, 40, -15}, {0, 70, -5}, {0, 0, 0}};
    struct align_work w = {0};
    struct align_result r;
    double worst = 0;

    assert_int_equal(
        align_search(&tmpl->surface, &probe->surface, &(struct align_how){0}, &w, &r),
        ST_OK);
    align_work_free(&w);
    for (int k = 0; k < 4; k++) {
        const struct dvec3 here = {at[k][0], at[k][1], at[k][2]};
        const struct dvec3 d =
            vec_sub(vec_transform(r.transform, vec_transform(moved, here)), here);

        worst = fmax(worst, sqrt(vec_dot(d, d)));
    }
    return worst;
}

/* All below the mouth lies 12 mm farther out: a quarter of the face.  Gaps beyond 2.5 mm
 * count nothing (ALIGN_TUKEY_MM), and the pose is right to 0.2 mm, unless the coarse stage ends
 * too far away (once in these); with all gaps counted all are wrong by 3 mm. */
TEST(test_change)
{
    struct surface_face a = {0}, b = {0};
    int right = 0;

    for (uint64_t subject = 0; subject < 8; subject++) {
        double moved[16];
        size_t n = scan_of(subject, 0, MAX_POINTS, 0, 0);

        build(points, n, &a);
        n = scan_of(subject, 1, MAX_POINTS, 0, 0);
        for (size_t i = 0; i < n; i++) {
            const double d = fmin(fmax((-35 - points[i].y) / 10, 0), 1);

            points[i].z += 12 * d * d * (3 - 2 * d);
        }
        clouds_move(points, n, subject + 100, 5, 5, moved);
        build(points, n, &b);
        right += error(&a, &b, moved) < 0.5;
    }
    assert_in_range(right, 7, 8);
    face_free(&a);
    face_free(&b);
}

/* One half of a face, with holes, turned by 30 degrees: for these subjects, of 1,100 tried, the
 * cheapest coarse pose is wrong by 30 to 100 mm, and its rival (ALIGN_RIVAL) is right. */
TEST(test_rival)
{
    static const uint64_t subject[] = {98, 355, 903, 1041};
    struct surface_face a = {0}, b = {0};
    int right = 0;

    for (int k = 0; k < 4; k++) {
        size_t n = scan_of(subject[k], 0, 800, 0.3, 0.15), half = 0;
        double moved[16];

        build(points, n, &a);
        n = scan_of(subject[k], 1, 800, 0.3, 0.15);
        clouds_move(points, n, subject[k] + 100, 30, 20, moved);
        for (size_t i = 0; i < n; i++)
            if (points[i].x > 0)
                points[half++] = points[i];
        build(points, half, &b);
        right += error(&a, &b, moved) < 4;
    }
    assert_in_range(right, 3, 4);
    face_free(&a);
    face_free(&b);
}

/* A template without measured area, and a pose off the lattice. */
TEST(test_apart)
{
    static const double far[16] = {1, 0, 0, 1e5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const double edge_on[16] = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    struct surface_face a = {0};
    struct measure_work w;
    struct align_work align = {0};
    struct align_result r;
    struct disparity d;

    memset(&w, 0, sizeof w);
    enroll(70, &a);
    assert_int_equal(measure_at(&a.surface, &a.surface, far, NULL, &w, &d), ST_OK);
    assert_true(d.area_mm2 == 0 && d.overlap == 0);
    assert_int_equal(measure_at(&a.surface, &a.surface, edge_on, NULL, &w, &d), ST_OK);
    assert_true(d.area_mm2 == 0 && d.overlap == 0);
    memset(a.surface.bridge, 1, a.surface.mesh.nt);
    assert_int_equal(search(&a, &a, &align, &r), ST_OK);
    assert_int_equal(r.stop, ALIGN_APART);
    for (int i = 0; i < 16; i++)
        assert_true(isfinite(r.transform[i]));
    align_work_free(&align);
    measure_work_free(&w);
    face_free(&a);
}

BEFORE_ALL(set_up)
{
    seed = brute_seed("align");
    assert_int_equal(frame_mean_make(&model_default, &mean), ST_OK);
    fit_prepare(&model_default.change, &motion);
}
