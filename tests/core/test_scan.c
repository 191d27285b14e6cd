/* From points to a model: with the scanner's axes the points are left as they are, else the face is
 * found, cropped and judged; what was found is told. */
#include "brute.h"
#include "cloudpoints.h"
#include "face.h"
#include "faces.h"
#include "clouds.h"
#include "headscan.h"
#include "mem.h"
#include "scan.h"
#include "toy.h"
#include "unit.h"

#define ROOM         60000
#define FOCAL_PEOPLE 16

static struct surface_face tmpl, face, plain;
static struct surface_found found;
static struct dvec3 pts[ROOM];
static size_t n;
static struct cloudpoints c;

static void sample(uint64_t subject, uint64_t scan, uint32_t points)
{
    n = clouds_scan(subject, scan, points, pts);
    assert_true(n > 0);
}

static void enroll(uint64_t subject)
{
    sample(subject, 0, 3000);
    assert_int_equal(face_build(pts, n, faces_work, &tmpl, NULL), ST_OK);
}

/* Turns all points, and then gives them in units of so many mm. */
static void turn(double yaw, double pitch, double roll, double unit_mm)
{
    struct pose p;

    toy_pose(yaw, pitch, roll, (struct dvec3){120, -40, 700}, &p);
    for (size_t i = 0; i < n; i++) {
        const struct dvec3 q = pose_apply(&p, pts[i]);

        pts[i] = (struct dvec3){q.x / unit_mm, q.y / unit_mm, q.z / unit_mm};
    }
}

static bool take(void)
{
    cloudpoints_free(&c);
    c = (struct cloudpoints){.at = mem_array(n, sizeof *c.at), .n = n, .read = n};
    if (c.at != NULL)
        memcpy(c.at, pts, n * sizeof *pts);
    return c.at != NULL;
}

static enum status build(const struct scan_options *o)
{
    assert_true(take());
    return scan_build(&c, o, faces_work, &face, NULL, &found);
}

static const struct scan_options probe,
    enrolment = {.enrolment = true}, agreed = {.axes = SCAN_AXES_SCANNER},
    agreed_enrolment = {.axes = SCAN_AXES_SCANNER, .enrolment = true};

static bool warned(enum surface_warning k)
{
    return (found.warnings >> k & 1) != 0;
}

/* Millimetres per unit of the points. */
static double view_scale(void)
{
    const double *v = found.view;

    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Against the template: of one person or not. */
static void assert_decision(enum surface_decision want)
{
    struct surface_comparison r;

    assert_int_equal(surface_compare(faces_work, &tmpl, &face, &r), ST_OK);
    if (r.decision != want)
        fail_msg("decision %d, wanted %d: score %.2f", r.decision, want, r.score);
}

/* ---- frontal */

/* The same model as face_build() gives, to the last digit, and the points stay. */
TEST(test_as_it_is)
{
    for (uint64_t subject = 1; subject < 16; subject++) {
        const struct surface *a = &plain.surface, *b = &face.surface;

        sample(subject, 2, subject % 2 ? 3000 : 800);
        assert_int_equal(face_build(pts, n, faces_work, &plain, NULL), ST_OK);
        assert_int_equal(build(subject % 3 ? &agreed_enrolment : &agreed), ST_OK);
        assert_memory_equal(c.at, pts, n * sizeof *pts);
        assert_true(c.n == n && c.index == NULL);
        assert_int_equal(a->mesh.nv, b->mesh.nv);
        assert_memory_equal(a->mesh.xy, b->mesh.xy, a->mesh.nv * sizeof *a->mesh.xy);
        assert_memory_equal(a->mesh.z, b->mesh.z, a->mesh.nv * sizeof *a->mesh.z);
        assert_memory_equal(&plain.frame.pose, &face.frame.pose, sizeof face.frame.pose);
        assert_true(plain.frame.support == face.frame.support);
        assert_true(!found.cropped && found.unit_mm == 1);
        assert_true(found.points_used == n && found.elsewhere == 0);
        assert_true(found.view[0] == 1 && found.view[3] == 0 && found.view[15] == 1);
        assert_true(fabs(found.yaw_deg) < 10 && fabs(found.roll_deg) < 10);
        assert_true(found.support >= found.support_wanted);
    }
}

/* A frontal face is taken out of its points as any other is: seen from aside it is the same one, to
 * nearly the score that it has with itself. */
TEST(test_one_way)
{
    struct surface_comparison self, turned;

    for (uint64_t subject = 1; subject < 16; subject++) {
        sample(subject, 2, 3000);
        assert_int_equal(build(&enrolment), ST_OK);
        assert_true(found.cropped && found.unit_found && found.unit_mm == 1);
        assert_true(found.faces == 1 && found.elsewhere < 0.05);
        assert_true(fabs(found.yaw_deg) < 10 && fabs(found.roll_deg) < 10);
        face_free(&tmpl);
        tmpl = face;
        face = (struct surface_face){0};
        assert_int_equal(surface_compare(faces_work, &tmpl, &tmpl, &self), ST_OK);
        turn(40, 20, 30, 1);
        assert_int_equal(build(&enrolment), ST_OK);
        assert_int_equal(surface_compare(faces_work, &tmpl, &face, &turned), ST_OK);
        if (!(turned.score > 0.95 * self.score))
            fail_msg("subject %d: %.2f, with itself %.2f", (int)subject, turned.score,
                     self.score);
    }
}

/* In another unit, given or not. */
TEST(test_units)
{
    static const double mm[] = {1000, 10, 25.4};

    for (size_t k = 0; k < sizeof mm / sizeof *mm; k++) {
        sample(1, 0, 3000);
        for (size_t i = 0; i < n; i++)
            pts[i] = (struct dvec3){pts[i].x / mm[k], pts[i].y / mm[k], pts[i].z / mm[k]};
        assert_int_equal(build(&enrolment), ST_OK);
        assert_true(found.unit_mm == mm[k] && found.unit_found && found.cropped);
        assert_true(fabs(view_scale() - mm[k]) < 1e-9 * mm[k]);
        assert_true(take());
        c.unit_mm = mm[k];
        assert_int_equal(scan_build(&c, &probe, faces_work, &face, NULL, &found), ST_OK);
        assert_true(found.unit_mm == mm[k] && !found.unit_found);
        assert_true(take());
        c.unit_mm = 1;
        assert_int_equal(scan_build(&c, &probe, faces_work, &face, NULL, &found),
                         ST_EUNITS);
    }
}

static void scale_points(double by)
{
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){pts[i].x * by, pts[i].y * by, pts[i].z * by};
}

/* In an unusual unit, which nobody gave, or which is that of a depth image: the unit that would fit is
 * told. */
TEST(test_unusual_unit)
{
    static const double mm[] = {100, 4.8, 0.15, 0.01};

    for (size_t k = 0; k < sizeof mm / sizeof *mm; k++) {
        sample(1, 0, 3000);
        scale_points(1 / mm[k]);
        for (int verifying = 0; verifying < 2; verifying++) {
            assert_int_equal(build(verifying ? &probe : &enrolment), ST_EUNITS);
            assert_true(found.unit_found && fabs(log(found.fits_mm / mm[k])) < 0.2);
        }
        assert_true(take());
        c.unit_mm = 1;
        assert_true(scan_build(&c, &enrolment, faces_work, &face, NULL, &found) != ST_OK);
        assert_true(found.fits_mm == 0);
        assert_true(take());
        c.unit_mm = 1;
        c.pinhole = true;
        assert_int_equal(scan_build(&c, &enrolment, faces_work, &face, NULL, &found),
                         ST_EUNITS);
        assert_true(fabs(log(found.fits_mm / mm[k])) < 0.2);
    }
    /* What is no face is none at any scale. */
    sample(1, 0, 3000);
    for (size_t i = 0; i < n; i++)
        pts[i].z = 0.01 * pts[i].x;
    scale_points(0.01);
    assert_true(build(&enrolment) != ST_OK && found.fits_mm == 0);
}

/* Of more than SCAN_FULL points at most SCAN_ENOUGH are used. */
TEST(test_dense)
{
    enroll(3);
    sample(3, 1, 50000);
    assert_int_equal(build(&enrolment), ST_OK);
    assert_true(found.cropped);
    assert_true(warned(SURFACE_THINNED) && !warned(SURFACE_BEHIND) &&
                !warned(SURFACE_OCCLUDED));
    assert_in_range(found.points_used, SCAN_ENOUGH * 9 / 10, SCAN_ENOUGH);
    assert_decision(SURFACE_MATCH);
    sample(4, 1, 50000);
    assert_int_equal(build(&agreed), ST_OK);
    assert_in_range(c.n, SCAN_ENOUGH * 9 / 10, SCAN_ENOUGH);
    for (size_t i = 0; i < c.n; i++)
        assert_memory_equal(&c.at[i], &pts[c.index[i]], sizeof *pts);
    assert_decision(SURFACE_NO_MATCH);
}

/* ---- found */

/* The view leads from the points sent to those used. */
static void assert_view(void)
{
    for (size_t i = 0; i < c.n; i++) {
        const struct dvec3 from = pts[c.index != NULL ? c.index[i] : i];
        const struct dvec3 d = vec_sub(vec_transform(found.view, from), c.at[i]);

        assert_true(vec_dot(d, d) < 1e-12);
    }
}

/* Points that are too far apart for a face to be seen are rated nevertheless: their distance is the reason. */
TEST(test_too_sparse)
{
    sample(5, 1, 300);
    assert_int_equal(build(&enrolment), ST_EQUALITY);
    assert_true(found.seen < found.seen_wanted &&
                found.quality.density_mm > SURFACE_SPARSE_MM);
}

/* The points become those of the kind that headscan makes of them, from the pose that they lie in. */
static void cover(const char *kind, uint64_t seed)
{
    struct headscan_options o;
    struct headscan s;
    struct head h = {0};

    assert_true(headscan_kind(kind, seed, true, &o));
    for (size_t i = 0; i < n; i++)
        head_add(&h, pts[i], HEAD_SKIN);
    head_measure(&h);
    headscan_render(&h, &o, &s);
    assert_true((n = s.n) <= ROOM);
    memcpy(pts, s.at, n * sizeof *pts);
    headscan_free(&s);
    head_free(&h);
}

/* Glasses hide the bridge of the nose and both eyes, so that the search often begins at the mouth.  The
 * chin lies nevertheless where it lies without them. */
TEST(test_glasses)
{
    const struct dvec3 chin = {0, -80, -20};
    unsigned lost = 0;

    for (uint64_t subject = 1; subject <= 24; subject++) {
        struct pose bare;
        struct dvec3 off;

        enroll(subject);
        bare = pose_unscaled(&tmpl.frame.pose);
        for (size_t i = 0; i < n; i++)
            pts[i] = pose_apply(&bare, pts[i]);
        cover("glasses", subject);
        assert_int_equal(build(&probe), ST_OK);
        off = pose_apply(&face.frame.pose, vec_transform(found.view, chin));
        off = vec_sub(off, chin);
        if (vec_dot(off, off) > 8 * 8)
            lost++;
    }
    print_message("%u lie elsewhere\n", lost);
    assert_true(lost <= 1);
}

/* What is left of a half profile lies askew to its own axes, and its nose at its edge: it stays
 * where it was found. */
TEST(test_half_profile)
{
    for (uint64_t subject = 8; subject < 12; subject++) {
        const double *r = face.frame.pose.r, *t = face.frame.pose.t;
        struct headscan_options o;
        struct headscan s;
        struct head h;

        assert_true(headscan_kind("half", 1, false, &o));
        head_make_up(subject, &h);
        headscan_render(&h, &o, &s);
        assert_true((n = s.n) <= ROOM);
        memcpy(pts, s.at, n * sizeof *pts);
        headscan_free(&s);
        head_free(&h);
        assert_int_equal(build(&probe), ST_OK);
        assert_true(warned(SURFACE_TURNED) && fabs(found.yaw_deg - o.yaw) < 8);
        assert_true(r[0] + r[4] + r[8] > 1 + 2 * cos(12 / VEC_DEGREES));
        assert_true(t[0] * t[0] + t[1] * t[1] + t[2] * t[2] < 10 * 10);
    }
}

TEST(test_found)
{
    static const double poses[][4] = {/* yaw, pitch, roll, unit */
                                      {0, 0, 90, 1},
                                      {40, 0, 0, 1},
                                      {170, 20, -30, 1000},
                                      {-50, 60, 120, 10}};

    enroll(5);
    for (size_t k = 0; k < sizeof poses / sizeof *poses; k++) {
        sample(5, 1 + k, 3000);
        turn(poses[k][0], poses[k][1], poses[k][2], poses[k][3]);
        assert_int_equal(build(&enrolment), ST_OK);
        assert_true(found.cropped && found.unit_mm == poses[k][3]);
        assert_decision(SURFACE_MATCH);
        assert_view();
        sample(6, 1 + k, 3000);
        turn(poses[k][0], poses[k][1], poses[k][2], poses[k][3]);
        assert_int_equal(build(&probe), ST_OK);
        assert_decision(SURFACE_NO_MATCH);
        if (k > 1) /* with the axes told, it is where it is */
            assert_int_not_equal(build(&agreed), ST_OK);
    }
}

/* A camera's axes: the turn is told against them. */
TEST(test_turn)
{
    sample(5, 1, 3000);
    turn(35, 0, 0, 1);
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){pts[i].x, -pts[i].y, -pts[i].z};
    assert_int_equal(build(&probe), ST_OK);
    assert_true(fabs(found.yaw_deg - 35) < 6 && fabs(found.roll_deg) < 6);
    assert_true(warned(SURFACE_TURNED));
    sample(5, 1, 3000);
    turn(0, 0, 100, 1);
    assert_int_equal(build(&probe), ST_OK);
    assert_true(fabs(found.yaw_deg) < 6 && fabs(found.pitch_deg) < 6);
    assert_true(fabs(found.roll_deg - 100) < 6);
    turn(0, 90, 0, 1); /* it looks up: no scanner along z */
    assert_int_equal(build(&probe), ST_OK);
    assert_true(isnan(found.yaw_deg) && isnan(found.roll_deg));
}

/* Whichever way up the scanner stands, a face has the same yaw and pitch, and is refused if it is turned
 * too far; the quarter turn alone is no reason. */
TEST(test_on_its_side)
{
    static const double roll[] = {0, 90, 180, -90, 50};

    for (size_t k = 0; k < sizeof roll / sizeof *roll; k++)
        for (int far = 0; far < 2; far++) {
            const double yaw = far ? 42 : 20;
            size_t kept = 0;

            sample(5, 1, 5000);
            for (size_t i = 0; i < n; i++)
                if (!far || pts[i].x < 22)
                    pts[kept++] = pts[i];
            n = kept;
            turn(yaw, 0, 0, 1);
            turn(0, 0, roll[k], 1);
            assert_int_equal(build(&enrolment), far ? ST_EQUALITY : ST_OK);
            assert_true(fabs(found.yaw_deg - yaw) < 8 && fabs(found.pitch_deg) < 8);
            assert_true(cos((found.roll_deg - roll[k]) / VEC_DEGREES) >
                        cos(8 / VEC_DEGREES));
            assert_int_equal(warned(SURFACE_TURNED), far || k == 4);
        }
}

/* Depths in steps of 3 mm: the noise is that of the step, whether the face is found or lies as agreed, and
 * no person is told from himself.  A rebuilt face knows its steps. */
TEST(test_stepped)
{
    const double step = 3;
    struct surface_comparison r;

    for (uint64_t subject = 5; subject < 9; subject++) {
        enroll(subject - subject % 2); /* another person's, or the same's */
        sample(subject, 1, 5000);
        for (size_t i = 0; i < n; i++)
            pts[i].z = step * rint(pts[i].z / step);
        for (int k = 0; k < 2; k++) {
            float residual;

            assert_int_equal(build(k == 0 ? &probe : &agreed), ST_OK);
            assert_true(warned(SURFACE_STEPPED) && fabs(found.step_mm - step) < 1e-6);
            assert_true(found.quality.noise_mm >= step / 2);
            assert_true(face.encoding.residual_mm > 2);
            assert_int_equal(surface_compare(faces_work, &tmpl, &face, &r), ST_OK);
            assert_int_not_equal(r.decision,
                                 subject % 2 ? SURFACE_MATCH : SURFACE_NO_MATCH);
            residual = face.encoding.residual_mm;
            assert_int_equal(face_rebuild(&face, faces_work), ST_OK);
            assert_true(face.encoding.residual_mm == residual);
        }
    }
    sample(5, 1, 5000); /* in the memory of the last */
    assert_int_equal(build(&probe), ST_OK);
    assert_true(!warned(SURFACE_STEPPED) && found.step_mm == 0 && face.step_mm == 0);
    for (size_t i = 0; i < n; i++)
        pts[i].z = rint(pts[i].z);
    assert_int_equal(build(&probe), ST_OK);
    assert_true(!warned(SURFACE_STEPPED) && fabs(found.step_mm - 1) < 1e-6);
    assert_true(found.quality.noise_mm < SURFACE_NOISY_MM);
}

/* Points of a depth image whose focal length is right, too small or too large: people differ, so that not
 * every face shows it. */
static unsigned focal_warnings(double wide, double *mean)
{
    unsigned warnings = 0, known = 0;

    *mean = 0;
    for (uint64_t subject = 1; subject <= FOCAL_PEOPLE; subject++) {
        sample(subject, 1, 4000);
        for (size_t i = 0; i < n; i++) {
            pts[i].x *= wide;
            pts[i].y *= wide;
        }
        assert_true(take());
        c.pinhole = true;
        assert_int_equal(scan_build(&c, &probe, faces_work, &face, NULL, &found), ST_OK);
        warnings += warned(SURFACE_FOCAL);
        known += found.focal_times > 0;
        *mean += found.focal_times;
    }
    assert_true(known >= FOCAL_PEOPLE / 2);
    *mean /= known;
    return warnings;
}

TEST(test_focal)
{
    double usual, wide, narrow;
    const unsigned none = focal_warnings(1, &usual);
    const unsigned many = focal_warnings(1.16, &wide);

    (void)focal_warnings(0.9, &narrow);
    print_message("%u, %u of %d: mean %.3f, wide %.3f, narrow %.3f\n", none, many,
                  FOCAL_PEOPLE, usual, wide, narrow);
    assert_int_equal(none, 0);
    assert_true(many >= FOCAL_PEOPLE / 2);
    assert_true(narrow < usual && usual < wide);
    sample(1, 1, 4000); /* not of a depth image */
    assert_int_equal(build(&probe), ST_OK);
    assert_true(found.focal_times == 0 && !warned(SURFACE_FOCAL));
}

/* A tenth of the points are of the back of the head. */
TEST(test_elsewhere)
{
    struct draw rng = {brute_seed("scan")};
    size_t front = 0;

    enroll(7);
    sample(7, 1, 3000);
    for (size_t i = 0; i < n; i += 10)
        pts[i] = (struct dvec3){draw_uniform(&rng, -55, 55), draw_uniform(&rng, -70, 60),
                                draw_uniform(&rng, -180, -160)};
    assert_int_equal(build(&enrolment), ST_OK);
    assert_true(warned(SURFACE_BEHIND) && found.elsewhere > 0.08 &&
                found.elsewhere < 0.2);
    for (size_t i = 0; i < c.n; i++)
        front += c.index[i] % 10 != 0;
    assert_int_equal(front, c.n);
    assert_decision(SURFACE_MATCH);
}

/* Two people: the nearer one is taken, though the other is a plain face where it is. */
TEST(test_two)
{
    size_t first;

    enroll(7);
    sample(7, 1, 4000);
    first = n;
    for (size_t i = 0; i < first; i++)
        pts[ROOM - first + i] =
            (struct dvec3){pts[i].x + 290, pts[i].y - 20, pts[i].z + 90};
    sample(8, 1, 8000);
    memmove(pts + n, pts + ROOM - first, first * sizeof *pts);
    n += first;
    assert_true(n > SCAN_FULL);
    assert_int_equal(build(&probe), ST_OK);
    assert_true(warned(SURFACE_SEVERAL) && found.faces == 2);
    assert_decision(SURFACE_MATCH);
    assert_int_equal(build(&enrolment), ST_ESEVERAL);
}

/* ---- what is told, and what is refused */

/* Everything below the nose is under a cover. */
TEST(test_cover)
{
    enroll(9);
    sample(9, 1, 3000);
    for (size_t i = 0; i < n; i++)
        if (pts[i].y < -8 && hypot(pts[i].x / 50, (pts[i].y + 36) / 30) < 1)
            pts[i].z =
                12 - pts[i].x * pts[i].x / 70 - (pts[i].y + 36) * (pts[i].y + 36) / 100;
    assert_int_equal(build(&probe), ST_OK);
    assert_true(warned(SURFACE_OCCLUDED) && found.occluded > 0.15);
    for (size_t i = 0; i < c.n; i++)
        assert_false(hypot(c.at[i].x / 40, (c.at[i].y + 36) / 22) < 1);
    assert_int_equal(build(&enrolment), ST_EQUALITY);
    assert_true(warned(SURFACE_OCCLUDED) && face.surface.mesh.nv == 0);
}

TEST(test_mirrored)
{
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        sample(10, 1, 3000);
        turn(0, mirrored ? 60 : 0, 0, 1);
        assert_true(take());
        c.normal = mem_array(n, sizeof *c.normal);
        assert_non_null(c.normal);
        for (size_t i = 0; i < n; i++)
            c.normal[i] = (struct dvec3){0, mirrored ? 0.87 : 0, mirrored ? -0.5 : 1};
        assert_int_equal(scan_build(&c, &enrolment, faces_work, &face, NULL, &found),
                         mirrored ? ST_EMIRRORED : ST_OK);
        assert_int_equal(warned(SURFACE_MIRRORED), mirrored);
    }
}

TEST(test_no_face)
{
    struct draw rng = {brute_seed("ball")};

    for (n = 0; n < 4000;) { /* a ball of a head's size */
        const struct dvec3 q = {draw_uniform(&rng, -0.5, 0.5),
                                draw_uniform(&rng, -0.5, 0.5),
                                draw_uniform(&rng, -0.5, 0.5)};
        const double r = sqrt(vec_dot(q, q));

        if (r > 0.1 && r < 0.5)
            pts[n++] = (struct dvec3){90 * q.x / r, 90 * q.y / r, 90 * q.z / r};
    }
    assert_int_not_equal(build(&probe), ST_OK);
    assert_int_not_equal(build(&enrolment), ST_OK);
    assert_int_equal(face.surface.mesh.nv, 0);
    n = SURFACE_MIN_POINTS - 1;
    assert_int_equal(build(&probe), ST_ETOOFEW);
    n = 0;
    assert_int_equal(build(&probe), ST_ETOOFEW);
    n = 400;
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){(double)i, 0, (double)(i * i % 50)};
    assert_int_equal(build(&probe), ST_EDEGENERATE);
}

/* A second call for the same points takes what the first one's search found, and gives what it
 * gives without: to the last digit. */
TEST(test_search_kept)
{
    struct scan_search search = {.done = false};
    const struct scan_options strict = {.enrolment = true, .search = &search},
                              loose = {.search = &search};
    struct surface_found before;

    sample(6, 1, 3000);
    turn(45, 0, 30, 1000);
    assert_int_equal(build(&probe), ST_OK);
    before = found;
    assert_int_equal(build(&strict), ST_OK);
    assert_true(search.done && search.st == ST_OK && found.cropped);
    assert_int_equal(build(&loose), ST_OK);
    assert_memory_equal(&found, &before, sizeof found);
    search.find.faces = 7;
    assert_int_equal(build(&loose), ST_OK);
    assert_int_equal(found.faces, 7);
}

/* The same where the points stay as they are, and both gates refuse them. */
TEST(test_as_is_kept)
{
    struct scan_search search = {.done = false};
    const struct scan_options strict = {.axes = SCAN_AXES_SCANNER,
                                        .enrolment = true,
                                        .search = &search},
                              loose = {.axes = SCAN_AXES_SCANNER, .search = &search},
                              fresh = {.axes = SCAN_AXES_SCANNER};
    struct surface_found before;
    struct surface_quality quality;
    size_t bad = 0;

    for (int kind = 0; kind < 3; kind++) {
        enum status st;

        sample(6, 1, 1500);
        for (size_t i = 0; i < n; i++) {
            if (kind == 0) /* the model has no support */
                pts[i].z = 12 * sin(pts[i].x / 12) * sin(pts[i].y / 15);
            else if (kind == 1) /* a little, the wrong way up */
                pts[i] = (struct dvec3){-pts[i].x, -pts[i].y, pts[i].z};
        }
        if (kind == 2)
            pts[700].y = -1e9;
        search = (struct scan_search){.done = false};
        st = build(&fresh);
        before = found;
        quality = face.quality;
        assert_int_not_equal(st, ST_OK);
        assert_true(take());
        assert_int_not_equal(scan_build(&c, &strict, faces_work, &face, &bad, &found),
                             ST_OK);
        assert_true(take());
        bad = 0;
        assert_int_equal(scan_build(&c, &loose, faces_work, &face, &bad, &found), st);
        assert_memory_equal(&found, &before, sizeof found);
        assert_memory_equal(&face.quality, &quality, sizeof quality);
        assert_int_equal(face.surface.mesh.nv, 0);
        assert_int_equal(bad, kind == 2 ? 700 : 0);
    }
}

/* A number that no scanner gives is told as such, and where. */
TEST(test_range)
{
    size_t bad = 0;

    sample(1, 0, 3000);
    for (size_t i = 0; i < n; i++)
        pts[i].z = 0;
    pts[1234].x = 1e300;
    assert_true(take());
    assert_int_equal(scan_build(&c, &probe, faces_work, &face, &bad, &found), ST_ERANGE);
    assert_int_equal(bad, 1234);
}
