/* The frames of a capture session become one face: less noise, no more holes than all of them have, and
 * nothing of another person. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <string.h>

#include "clouds.h"
#include "draw.h"
#include "fail_alloc.h"
#include "libsurface.h"
#include "pose.h"
#include "status.h"
#include "unit.h"

#define FRAMES 5
#define POINTS 3000

static struct dvec3 pts[FRAMES][2 * POINTS];
static struct surface_cloud cloud[SURFACE_FRAMES_MAX + 1];
static struct surface_frame frame[SURFACE_FRAMES_MAX + 1];
static struct surface_work *work;
static struct surface_face *fused;
static struct surface_found found;
static uint32_t base;

BEFORE_EACH(begin)
{
    memset(cloud, 0, sizeof cloud);
    assert_non_null(work = surface_work_new(NULL));
}

AFTER_EACH(end)
{
    surface_face_free(fused);
    fused = NULL;
    surface_work_free(work);
}

/* Frame k: subject, turned by some degrees, with so much noise. */
static void take(uint32_t k, uint64_t subject, double noise_mm, double yaw)
{
    const size_t n = clouds_scan(subject, 10 + k, POINTS, pts[k]);
    struct pose turn = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {4.0 * k, -3.0 * k, 2.0 * k}};
    struct draw r = {77 + k};

    pose_tilt(&turn, (struct dvec3){0, 0, -80}, yaw, yaw / 3);
    for (size_t i = 0; i < n; i++) {
        pts[k][i].z += noise_mm * draw_normal(&r);
        pts[k][i] = pose_apply(&turn, pts[k][i]);
    }
    cloud[k] = (struct surface_cloud){.points = (const double(*)[3])pts[k], .n = n};
    frame[k] = (struct surface_frame){0};
}

static void take_all(uint64_t subject, double noise_mm)
{
    for (uint32_t k = 0; k < FRAMES; k++)
        take(k, subject, noise_mm, 0.02 * k);
}

static enum surface_status fuse(uint32_t n)
{
    found = (struct surface_found){0};
    return surface_fuse(work, n, cloud, frame, &base, &fused, &found);
}

static void use_flags(uint32_t flags)
{
    for (uint32_t k = 0; k < FRAMES; k++)
        cloud[k].flags = flags;
}

/* The root mean square of face's points beside the scan of the same subject without noise, whose
 * frame they are moved to. */
static double beside(const struct surface_face *face, uint64_t subject)
{
    static double at[4 * POINTS][3], gap[4 * POINTS];
    static struct dvec3 truth[4 * POINTS];
    const uint32_t n = surface_face_points(face, at);
    const struct surface_cloud c = {.points = (const double(*)[3])truth,
                                    .n = clouds_scan(subject, 99, 3 * POINTS, truth)};
    struct surface_disparity d = {0};
    struct surface_face *f = NULL;
    double sum = 0, many = 0;

    assert_int_equal(surface_build(work, &c, &f, NULL), SURFACE_OK);
    assert_int_equal(surface_disparity(work, f, face, &d), SURFACE_OK);
    assert_int_equal(surface_gaps(f, (const double(*)[3])at, n, d.align_transform, gap),
                     SURFACE_OK);
    for (uint32_t i = 0; i < n; i++)
        if (fabs(gap[i]) < 5) {
            sum += gap[i] * gap[i];
            many++;
        }
    surface_face_free(f);
    return sqrt(sum / many);
}

TEST(test_noise)
{
    struct surface_face *one = NULL;
    double single;

    take_all(3, 1.0);
    use_flags(SURFACE_ENROLMENT);
    assert_int_equal(surface_build(work, &cloud[1], &one, NULL), SURFACE_OK);
    single = beside(one, 3);
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_true(base < FRAMES);
    for (uint32_t k = 0; k < FRAMES; k++) {
        assert_int_equal(frame[k].status, SURFACE_OK);
        assert_true(frame[k].gap_mm < 1 && (frame[k].gap_mm > 0) == (k != base));
        assert_int_equal(frame[k].found.points, cloud[k].n);
    }
    assert_true(single > 0.8);
    assert_true(beside(fused, 3) < 0.65 * single);
    assert_true(found.quality.noise_mm < 0.7 * surface_face_quality(one).noise_mm);
    assert_int_equal(found.points_used, surface_face_points(fused, NULL));
    assert_true(found.evidence_wanted > 0);
    surface_face_free(one);
}

/* Frames whose depths are in steps lie farther apart, and are used nevertheless; what is left of the
 * steps falls with the square root of their number, and counts as noise. */
TEST(test_steps)
{
    struct surface_comparison one = {0}, all = {0};
    struct surface_face *other = NULL, *single = NULL;

    take_all(5, 0);
    for (uint32_t k = 0; k < FRAMES; k++)
        for (size_t i = 0; i < cloud[k].n; i++)
            pts[k][i].z = 2.2 * round(pts[k][i].z / 2.2);
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    for (uint32_t k = 0; k < FRAMES; k++) {
        assert_int_equal(frame[k].status, SURFACE_OK);
        assert_true(fabs(frame[k].found.step_mm - 2.2) < 0.3);
    }
    assert_true(fabs(found.step_mm - 2.2 / sqrt(FRAMES)) < 0.2);
    assert_int_equal(surface_build(work, &cloud[0], &single, NULL), SURFACE_OK);
    take(0, 5, 0, 0.05);
    assert_int_equal(surface_build(work, &cloud[0], &other, NULL), SURFACE_OK);
    assert_int_equal(surface_compare(work, other, single, &one), SURFACE_OK);
    assert_int_equal(surface_compare(work, other, fused, &all), SURFACE_OK);
    assert_true(all.expected > 1.5 * one.expected && all.decision == SURFACE_MATCH);
    surface_face_free(other);
    surface_face_free(single);
}

/* One that is too noisy for an enrolment is fused all the same, and alone refused. */
TEST(test_gate)
{
    take_all(4, 3.0);
    use_flags(SURFACE_ENROLMENT);
    assert_int_not_equal(fuse(1), SURFACE_OK);
    assert_null(fused);
    use_flags(SURFACE_ENROLMENT);
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_true(found.residual_mm < found.residual_most);
}

/* Keeps the points of frame k at which x, mirrored if `by` is -1, is below a limit in the generator's frame. */
static void keep_side(uint32_t k, double by, double most)
{
    size_t n = 0;

    for (size_t i = 0; i < cloud[k].n; i++)
        if (by * (pts[k][i].x - 4.0 * k) < most)
            pts[k][n++] = pts[k][i];
    cloud[k].n = n;
}

static double parts_of(const struct surface_gain *g, int side)
{
    return g->part[SURFACE_CHEEKS][side] + g->part[SURFACE_EYES][side];
}

/* A copy adds nothing to what it is a copy of, neither area nor less noise. */
TEST(test_copy)
{
    const struct surface_gain *one, *copy;

    take(0, 3, 0.8, 0);
    take(1, 3, 0.8, 0);
    memcpy(pts[1], pts[0], sizeof pts[0]);
    cloud[1].n = cloud[0].n;
    assert_int_equal(fuse(2), SURFACE_OK);
    one = &frame[base].adds;
    copy = &frame[!base].adds;
    assert_true(one->place == 1 && copy->place == 2);
    assert_true(one->share > 0.998 && copy->share < 0.002);
    assert_true(fabs(copy->noise_mm / one->noise_mm - 1) < 0.02);
    assert_true(fabs(one->noise_mm / frame[base].found.quality.noise_mm - 1) < 0.2);
}

/* Of two frames that lack a side each the second adds the one that the first lacks, in either order. */
TEST(test_sides)
{
    double share[2];

    for (int first = 0; first < 2; first++) {
        for (uint32_t k = 0; k < 2; k++) {
            take(k, 3, 0.3, 0);
            keep_side(k, (int)k == first ? 1 : -1, 22);
        }
        assert_int_equal(fuse(2), SURFACE_OK);
        for (uint32_t k = 0; k < 2; k++) {
            const struct surface_gain *g = &frame[k].adds;
            const int own = (int)k == first ? 0 : 1;

            assert_int_equal(g->place, k == base ? 1 : 2);
            assert_true(parts_of(g, own) > (k == base ? 1.9 : 1.4));
            assert_true(parts_of(g, !own) < (k == base ? 0.8 : 0.05));
        }
        share[first] = frame[!base].adds.share;
        assert_true(share[first] > 0.2 && share[first] < 0.4);
        assert_true(fabs(frame[0].adds.share + frame[1].adds.share - 1) < 1e-9);
    }
    assert_true(fabs(share[0] - share[1]) < 0.05);
}

/* Each frame of white noise lowers that of the mean, to about the fused face's; the frames that are left out have
 * no place. */
TEST(test_adds)
{
    double before[FRAMES + 1] = {0};
    size_t placed = 0;

    take_all(3, 1.0);
    cloud[3].n = 20;
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    for (uint32_t k = 0; k < FRAMES; k++) {
        const struct surface_gain *g = &frame[k].adds;

        assert_true((g->place == 0) == (k == 3) && g->place < FRAMES);
        before[g->place] = g->noise_mm;
        placed += g->place;
    }
    assert_int_equal(placed, 1 + 2 + 3 + 4);
    for (int place = 2; place < FRAMES; place++)
        assert_true(before[place] < 0.97 * before[place - 1]);
    assert_true(fabs(before[FRAMES - 1] / found.quality.noise_mm - 1) < 0.1);
    assert_int_equal(fuse(1), SURFACE_OK);
    assert_int_equal(frame[0].adds.place, 0);
}

/* What one frame lacks another one has. */
TEST(test_holes)
{
    take_all(5, 0.3);
    for (uint32_t k = 0; k < FRAMES; k++) {
        size_t n = 0;

        for (size_t i = 0; i < cloud[k].n; i++) { /* a strip, another one in each */
            const double y = pts[k][i].y + 3.0 * k - (18.0 * k - 40);

            if (fabs(y) > 8)
                pts[k][n++] = pts[k][i];
        }
        cloud[k].n = n;
    }
    assert_int_equal(fuse(1), SURFACE_OK);
    assert_true(found.quality.coverage < 0.95);
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_true(found.quality.coverage > 0.97);
    assert_true(beside(fused, 5) < 0.4);
}

TEST(test_people)
{
    take_all(6, 0.5);
    take(2, 7, 0.5, 0);
    assert_int_equal(fuse(FRAMES), SURFACE_EPEOPLE);
    assert_null(fused);
    assert_true(base != 2);
    for (uint32_t k = 0; k < FRAMES; k++)
        assert_int_equal(frame[k].status, k == 2 ? SURFACE_EPEOPLE : SURFACE_OK);
    assert_true(frame[2].score < -9);
    take(0, 7, 0.5, 0); /* two of five */
    assert_int_equal(fuse(FRAMES), SURFACE_EPEOPLE);
    assert_int_equal(frame[0].status, SURFACE_EPEOPLE);
    assert_int_equal(frame[2].status, SURFACE_EPEOPLE);
    assert_int_equal(frame[1].status, SURFACE_OK);
}

TEST(test_left_out)
{
    static struct dvec3 plane[2000];

    take_all(8, 0.5);
    for (int i = 0; i < 2000; i++)
        plane[i] = (struct dvec3){i % 50 * 3.0, i / 50 * 4.0, 0};
    cloud[0].points = (const double(*)[3])plane;
    cloud[0].n = 2000;
    cloud[3].n = 20;
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_int_equal(frame[0].status, SURFACE_ENOTFACE);
    assert_int_equal(frame[3].status, SURFACE_ETOOFEW);
    assert_int_equal(frame[1].status, SURFACE_OK);
    cloud[1] = cloud[0];
    assert_int_equal(fuse(2), SURFACE_ENOTFACE);
    assert_null(fused);
}

/* A part of the face that is too small to be laid on the others. */
TEST(test_apart)
{
    size_t n = 0;

    take_all(9, 0.3);
    for (size_t i = 0; i < cloud[4].n; i++)
        if (pts[4][i].y > 5)
            pts[4][n++] = pts[4][i];
    cloud[4].n = n;
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_true(frame[4].status != SURFACE_EPEOPLE);
    assert_true(base != 4);
}

/* One frame is the face that surface_build() makes of it, and all are the same digits again. */
TEST(test_same)
{
    static double a[4 * POINTS][3], b[4 * POINTS][3];
    struct surface_work *other = surface_work_new(NULL), *first = work;
    struct surface_face *one = NULL;
    uint32_t n;

    take_all(11, 0.8);
    assert_int_equal(surface_build(work, &cloud[0], &one, NULL), SURFACE_OK);
    assert_int_equal(fuse(1), SURFACE_OK);
    n = surface_face_points(one, a);
    assert_int_equal(surface_face_points(fused, b), n);
    assert_memory_equal(a, b, n * sizeof *a);
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    n = surface_face_points(fused, a);
    work = other;
    assert_non_null(other);
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_int_equal(surface_face_points(fused, b), n);
    assert_memory_equal(a, b, n * sizeof *a);
    surface_face_free(one);
    work = first;
    surface_work_free(other);
}

/* The points of the base that are kept lie on the fused face. */
TEST(test_kept)
{
    static const double still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static double kept[FRAMES][2 * POINTS][3], gap[2 * POINTS];
    static uint32_t place[FRAMES][2 * POINTS];
    size_t measured = 0;

    take_all(12, 0.8);
    for (uint32_t k = 0; k < FRAMES; k++) {
        cloud[k].kept = kept[k];
        cloud[k].kept_place = place[k];
    }
    assert_int_equal(fuse(FRAMES), SURFACE_OK);
    assert_true(found.kept > 2000 && found.kept <= cloud[base].n);
    assert_int_equal(
        surface_gaps(fused, (const double(*)[3])kept[base], found.kept, still, gap),
        SURFACE_OK);
    for (size_t i = 0; i < found.kept; i++)
        if (!isnan(gap[i])) {
            measured++;
            assert_true(fabs(gap[i]) < 2e-3);
        }
    assert_true(measured > found.kept - 20);
}

TEST(test_arguments)
{
    take_all(3, 0.5);
    for (uint32_t k = FRAMES; k <= SURFACE_FRAMES_MAX; k++) {
        cloud[k] = cloud[0];
        frame[k] = frame[0];
    }
    assert_int_equal(fuse(0), SURFACE_EINVAL);
    assert_int_equal(fuse(SURFACE_FRAMES_MAX + 1), SURFACE_EINVAL);
    cloud[1].flags = 64;
    assert_int_equal(fuse(2), SURFACE_EINVAL);
    assert_null(fused);
}

static enum status run(void *arg)
{
    (void)arg;
    return status_from(fuse(3));
}

TEST(test_memory)
{
    take_all(3, 0.5);
    assert_true(fail_alloc_walk(run, NULL) > 20);
}
