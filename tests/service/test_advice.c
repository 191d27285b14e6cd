/* The advice on what was found says what to change, with the measured value; every kind of it
 * fits in a line, and describe_scan() has what the HTTP interface promises. */
#include "advice.h"
#include "cloudformat.h"
#include "describe.h"
#include "face.h"
#include "json.h"
#include "sample.h"
#include "unit.h"

static struct advice a;
static struct surface_face face; /* quality and frame alone */

static const struct surface_found plain = {
    .points_used = 3000, .unit_mm = 1, .extent = {180, 240, 110}, .faces = 1};

static void good(void)
{
    face = (struct surface_face){0};
    face.quality = (struct surface_quality){
        .score = 0.9, .coverage = 0.95, .density_mm = 2.2, .noise_mm = 0.2};
    face.frame.pose.r[0] = face.frame.pose.r[4] = face.frame.pose.r[8] = 1;
}

/* The line i is text. */
static void assert_line(size_t i, const char *text)
{
    assert_true(i < a.n);
    assert_string_equal(a.line[i], text);
}

static void give(enum status st, struct surface_found f)
{
    f.quality = face.quality;
    advice_give(st, &f, &face, &a);
    for (size_t i = 0; i < a.n; i++)
        assert_true(strlen(a.line[i]) < ADVICE_MAX - 1); /* not truncated */
}

/* All lines of the advice are text, with a newline between them. */
static void advises(enum status st, struct surface_found f, const char *text)
{
    char all[ADVICE_LINES * (ADVICE_MAX + 1)] = "";

    give(st, f);
    for (size_t i = 0; i < a.n; i++)
        (void)snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s",
                       i > 0 ? "\n" : "", a.line[i]);
    assert_string_equal(all, text);
}

TEST(test_none)
{
    good();
    advises(ST_OK, plain, "");
}

TEST(test_turned)
{
    struct surface_found f = plain;

    good();
    f.warnings = 1U << SURFACE_TURNED;
    f.yaw_deg = 38.2;
    advises(
        ST_OK, f,
        "turn the head towards the scanner: 38° to the left now, up to 30° for enrolment");
    f.yaw_deg = -47;
    f.pitch_deg = 26;
    advises(
        ST_EQUALITY, f,
        "turn the head towards the scanner: 47° to the right now, up to 30° for enrolment\n"
        "lower the chin: the face looks 26° up now, up to 20° is good");
    f.yaw_deg = f.pitch_deg = 0;
    f.roll_deg = 24.6;
    advises(ST_OK, f,
            "hold the head upright: tilted by 25° to the right now, up to 20° is good");
    f.yaw_deg = f.pitch_deg = f.roll_deg =
        (double)NAN; /* where the scanner was cannot be told */
    advises(ST_OK, f, "");
}

TEST(test_found)
{
    struct surface_found f = plain;

    good();
    f.warnings = 1U << SURFACE_BEHIND | 1U << SURFACE_OCCLUDED | 1U << SURFACE_SEVERAL |
                 1U << SURFACE_MIRRORED;
    f.elsewhere = 0.12;
    f.occluded = 0.234;
    f.faces = 2;
    f.unit_mm = 1000;
    f.unit_found = true;
    advises(
        ST_OK, f,
        "let only one person be in view: 2 faces were found, the nearest was used\n"
        "the scan seems to be a mirror image: switch mirroring off where it was made\n"
        "take off glasses or mask, keep hair and hands away: 23 % of the face is covered");
    assert_int_equal(a.nnote, 2);
    assert_string_equal(a.note[0],
                        "12 % of the points are outside the face and were ignored");
    assert_string_equal(a.note[1], "detected metres; units=m skips the detection");
    f.warnings = 0;
    advises(ST_ESEVERAL, f, "let only one person be in view: 2 faces were found");
    f.unit_found = false;
    advises(ST_OK, f, "");
}

TEST(test_quality)
{
    struct surface_found part = plain;

    good();
    face.quality.noise_mm = 1.24;
    face.quality.density_mm = 4;
    face.quality.coverage = 0.45;
    advises(
        ST_EQUALITY, plain,
        "hold still and scan again: the noise is 1.2 mm, 0.6 mm or less is good\n"
        "move nearer to the scanner: a point every 4.0 mm now, every 3.0 mm or less is good\n"
        "let the scanner see all of the face: 45 % of its outline was measured");
    good();
    face.frame.pose.r[0] = face.frame.pose.r[8] = cos(0.7);
    face.frame.pose.r[2] = -(face.frame.pose.r[6] = sin(0.7));
    give(ST_OK, plain);
    assert_int_equal(a.n, 1);
    good();
    face.quality.density_mm = 0; /* not rated */
    advises(ST_EQUALITY, plain, "scan again, nearer and without moving");
    part.seen = 0.42;
    part.seen_wanted = 0.45;
    advises(ST_EQUALITY, part,
            "let the scanner see all of the face: 42 % of it now, 45 % at least");
    /* points that are too far apart are the cause, and come first */
    face.quality.density_mm = 7;
    part.warnings = 1U << SURFACE_OCCLUDED;
    part.occluded = 0.09;
    give(ST_EQUALITY, part);
    assert_int_equal(a.n, 2);
    assert_line(
        0, "move nearer to the scanner: a point every 7.0 mm now, every 3.0 mm or less "
           "is good");
}

/* What is nearly a face may be one that is covered; of what is none nothing is known. */
TEST(test_support)
{
    struct surface_found f = plain;

    good();
    f.warnings = 1U << SURFACE_OCCLUDED | 1U << SURFACE_BEHIND;
    f.occluded = 0.56;
    f.support_wanted = 0.33;
    f.support = 0.31;
    give(ST_ENOTFACE, f);
    assert_int_equal(a.n, 2);
    assert_line(0,
                "take off glasses or mask, keep hair and hands away: 56 % of the face is "
                "covered");
    f.support = -0.12;
    advises(ST_ENOTFACE, f,
            "send one face seen from the front, with forehead, nose and chin");
}

/* An egg: the pose and the cover that were found on it are those of no face. */
TEST(test_egg)
{
    struct surface_found f = plain;

    good();
    f.warnings = 1U << SURFACE_OCCLUDED | 1U << SURFACE_TURNED | 1U << SURFACE_BEHIND;
    f.occluded = 0.06;
    f.pitch_deg = 32;
    f.support_wanted = 0.35;
    f.support = 0.4;
    advises(ST_ENOTFACE, f,
            "send one face seen from the front, with forehead, nose and chin");
    f.pitch_deg = 4;
    f.yaw_deg = 46;
    give(ST_ENOTFACE, f);
    assert_int_equal(a.n, 3);
    assert_line(1,
                "turn the head towards the scanner: 46° to the left now, up to 30° for "
                "enrolment");
}

/* What the model explains too little of is a matter of the sensor, not of the person. */
TEST(test_noisy)
{
    struct surface_found f = plain;

    good();
    f.residual_mm = 1.8;
    f.residual_most = 1.4;
    advises(
        ST_EQUALITY, f,
        "move nearer, hold still, and let the scanner average several frames: the scan is too noisy to tell people apart");
}

TEST(test_focal)
{
    struct surface_found f = plain;

    good();
    f.focal_times = 1.12;
    f.warnings = 1U << SURFACE_FOCAL;
    advises(
        ST_OK, f,
        "check fx and fy: the face is too wide for its depth, as if they should be 1.12 times those given or more");
    f.focal_times = 0.84;
    give(ST_OK, f);
    assert_line(
        0,
        "check fx and fy: the face is too narrow for its depth, as if they should be 0.84 times "
        "those given or less");
}

/* A picture on its side is no tilted head; what is beyond the quarter turn is. */
TEST(test_on_its_side)
{
    struct surface_found f = plain;

    good();
    f.yaw_deg = f.pitch_deg = 0;
    f.roll_deg = 93;
    advises(ST_OK, f, "");
    assert_int_equal(a.nnote, 1);
    assert_string_equal(
        a.note[0],
        "the picture is turned by 93°: hold the scanner upright, or turn its pictures");
    f.roll_deg = -120;
    f.warnings = 1U << SURFACE_TURNED;
    advises(ST_OK, f,
            "hold the head upright: tilted by 30° to the left now, up to 20° is good");
}

/* Steps are told in place of the noise that they are. */
TEST(test_stepped)
{
    struct surface_found f = plain;

    good();
    face.quality.noise_mm = f.quality.noise_mm = 1.5;
    f.step_mm = 3;
    f.warnings = 1U << SURFACE_STEPPED;
    advises(
        ST_OK, f,
        "use a finer depth mode, move nearer, or let the scanner average several frames: its depths are 3.0 mm apart, 1.2 mm or less is good");
}

/* Each refusal of a scan has its advice, and so does everything at once. */
TEST(test_refusals)
{
    struct surface_found f = plain;

    good();
    for (int st = ST_ETOOFEW; st <= ST_EQUALITY; st++) {
        give((enum status)st, plain);
        assert_true(a.n >= 1);
    }
    face.quality =
        (struct surface_quality){.coverage = 0.1, .density_mm = 9, .noise_mm = 9};
    f.warnings = (1U << SURFACE_WARNINGS) - 1;
    f.yaw_deg = f.pitch_deg = f.roll_deg = 90;
    give(ST_EQUALITY, f);
    assert_int_equal(a.n, ADVICE_LINES);
}

TEST(test_describe)
{
    struct sample_found s = {.scan = plain}, empty = {.format = CLOUDFORMAT_XYZ};
    struct surface_found f = plain;
    struct json *j = json_new();
    char *text;

    s.format = CLOUDFORMAT_GLB;
    s.points_read = 60000;
    s.points_dropped = 12;
    f.points_used = 9000;
    f.unit_mm = 0.001;
    f.yaw_deg = 12.34567;
    f.occluded = 0.25;
    f.warnings = 1U << SURFACE_TURNED | 1U << SURFACE_SEVERAL;
    for (int i = 0; i < 3; i++)
        f.view[5 * i] = 0.001 * 0.123456789;
    f.view[3] = -12.34567;
    f.view[15] = 1;
    s.scan = f;
    describe_scan(j, "scan", &s);
    text = json_compact(j);
    assert_string_equal(
        text,
        "{\"scan\":{\"format\":\"glb\",\"points_read\":60000,\"points_dropped\":12,"
        "\"points_used\":9000,\"units\":\"um\",\"view\":[0.0001234568,0,0,-12.3457,0,"
        "0.0001234568,0,0,0,0,0.0001234568,0,0,0,0,1],\"yaw_deg\":12.3457,"
        "\"occluded\":0.25,\"warnings\":[\"several_faces\",\"turned\"]}}");
    free(text);
    empty.scan.yaw_deg = (double)NAN;
    describe_scan(j = json_new(), "scan", &empty);
    text = json_compact(j);
    assert_non_null(strstr(text, "\"units\":null,\"view\":null,\"yaw_deg\":null,"
                                 "\"occluded\":0,\"warnings\":[]"));
    free(text);
}
