/* The numbers of a few fixed comparisons, to the last digit: they must not depend on the compiler or
 * its optimisation (scripts/check_digits.sh).  After an intended change of the measure run this with
 * GOLDEN_WRITE=1, which writes tests/golden/digits.txt, and raise the measure's number in
 * SURFACE_ENGINE. */
#include "face.h"
#include "facegen.h"
#include "minimal.h"
#include "toy.h"
#include "unit.h"

#define GOLDEN "tests/golden/digits.txt"
#define POINTS 3000

static FILE *out;
static struct surface_work *work;

static void put(const char *what, const double *x, size_t n)
{
    (void)fprintf(out, "%s", what);
    for (size_t i = 0; i < n; i++)
        if (isnan(x[i])) /* fprintf() may print a sign */
            (void)fprintf(out, " none");
        else
            (void)fprintf(out, " %.17g", x[i]);
    (void)fprintf(out, "\n");
}

static void make(const struct facegen_scan *s, struct surface_face *face)
{
    static struct dvec3 pts[POINTS];

    assert_int_equal(face_build(pts, facegen_sample(s, pts), work, face, NULL), ST_OK);
}

static void compare(const char *what, const struct surface_face *a,
                    const struct surface_face *b)
{
    struct surface_comparison r;
    struct surface_disparity m;
    struct surface_parts parts;

    assert_int_equal(surface_compare(work, a, b, &r), SURFACE_OK);
    assert_int_equal(surface_disparity(work, a, b, &m), SURFACE_OK);
    assert_int_equal(surface_parts(work, a, b, &parts), SURFACE_OK);
    (void)fprintf(out, "# %s\n", what);
    put("score", &r.score, 1);
    put("disparity_mm", &m.disparity_mm, 1);
    put("overlap", &r.overlap, 1);
    put("region", parts.region, SURFACE_REGIONS);
    put("turn_deg", &m.turn_deg, 1);
    put("shift_mm", &m.shift_mm, 1);
    put("transform", m.align_transform, 16);
    put("minimal_transform", m.transform, 16);
}

static void put_all(void)
{
    static struct surface_model model;
    static struct surface_face face[4];
    struct facegen_scan s;

    toy_model(&model);
    assert_non_null(work = surface_work_new(&model));
    for (uint64_t i = 0; i < 4; i++) {
        facegen_default(&s);
        s.subject = i < 3 ? 1 : 2;
        s.scan = i;
        s.points = i == 2 ? 1500 : POINTS;
        if (i > 0)
            facegen_pose(&s, 12, 40);
        s.holes = i == 2 ? 0.1 : 0;
        s.spikes = i == 2 ? 0.01 : 0;
        s.smile = i == 2 ? 1 : 0;
        make(&s, &face[i]);
    }
    put("frame", face[0].frame.pose.r, 9);
    put("at", face[0].frame.pose.t, 3);
    compare("the same person", &face[0], &face[1]);
    compare("smiling, with holes and spikes", &face[0], &face[2]);
    compare("somebody else", &face[0], &face[3]);
    compare("itself", &face[0], &face[0]);
    for (int i = 0; i < 4; i++)
        face_free(&face[i]);
    surface_work_free(work);
}

/* Line by line, so that a failure prints the line that differs. */
TEST(test_digits)
{
    const bool writing = getenv("GOLDEN_WRITE") != NULL;
    char want[4096], got[4096];
    FILE *golden;

    assert_non_null(out = writing ? fopen(GOLDEN, "w") : tmpfile());
    put_all();
    rewind(out);
    assert_non_null(golden = fopen(GOLDEN, "r"));
    while (!writing && fgets(want, sizeof want, golden) != NULL) {
        assert_non_null(fgets(got, sizeof got, out));
        assert_string_equal(want, got);
    }
    assert_true(writing || fgets(got, sizeof got, out) == NULL);
    (void)fclose(golden);
    assert_int_equal(fclose(out), 0);
}
