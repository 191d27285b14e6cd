/* The message of every failure to build a face has the measured value and a hint, and is not
 * truncated. */
#include "clouds.h"
#include "errinfo.h"
#include "face.h"
#include "cloudpoints.h"
#include "mem.h"
#include "sample.h"
#include "unit.h"

#define POINTS 1500

static struct dvec3 pts[POINTS];
static size_t n;
static struct surface_work *work;
static struct surface_face *f;
static struct errinfo e;

BEFORE_ALL(set_up)
{
    work = surface_work_new(NULL);
    assert_non_null(work);
}

AFTER_ALL(tear_down)
{
    surface_face_free(f);
    surface_work_free(work);
}

/* A scan in units of unit_mm. */
static void take(double unit_mm)
{
    n = clouds_scan(1, 0, POINTS, pts);
    for (size_t i = 0; i < n; i++)
        pts[i] =
            (struct dvec3){pts[i].x / unit_mm, pts[i].y / unit_mm, pts[i].z / unit_mm};
}

static enum status build(double given_mm)
{
    const struct sample_options o = {.enrolment = false};
    struct cloudpoints c = {.at = mem_array(n + 1, sizeof *pts),
                            .n = n,
                            .read = n,
                            .unit_mm = given_mm,
                            .axes_given = true};
    struct sample_found found;
    enum status st;

    e = (struct errinfo){0};
    assert_non_null(c.at);
    memcpy(c.at, pts, n * sizeof *pts);
    st = sample_build("points", &c, &o, work, &f, &found, &e);
    cloudpoints_free(&c);
    return st;
}

/* The scan is rejected with st and a whole message that contains text. */
static void assert_refused(enum status st, double given_mm, const char *text)
{
    assert_int_equal(build(given_mm), st);
    assert_int_equal(e.code, st);
    assert_true(strncmp(e.msg, "points: ", 8) == 0);
    if (strstr(e.msg, text) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, text);
    assert_true(strlen(e.msg) < sizeof e.msg - 1); /* not truncated */
}

TEST(test_units)
{
    static const struct {
        double real_mm, given_mm;
        const char *guess;
    } known[] = {{1000, 1, "mm: is it metres?"},
                 {10, 1, "mm: is it centimetres?"},
                 {1, 10, "mm: is it millimetres?"},
                 {100000, 1, "mm: is it one face, and the unit right?"}};

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        take(known[i].real_mm);
        if (known[i].real_mm > 50000) { /* else too small for a triangulation */
            pts[0].x += 2;              /* and too large for micrometres */
            pts[1].y += 2;
        }
        assert_refused(ST_EUNITS, known[i].given_mm, known[i].guess);
        assert_non_null(strstr(e.msg, "the extent is "));
    }
    take(1000);
    pts[0] = (struct dvec3){-0.09, 0.12, 0.01};
    for (size_t i = 1; i < n; i++)
        pts[i] = (struct dvec3){fmax(pts[i].x, -0.09), fmin(pts[i].y, 0.12), pts[i].z};
    pts[1] = (struct dvec3){0.1, -0.12, -0.1};
    assert_int_equal(build(1), ST_EUNITS);
    assert_non_null(strstr(e.msg, "the extent is 0.19 x 0.24 x "));
}

TEST(test_points)
{
    take(1);
    assert_int_equal(build(1), ST_OK);
    pts[16].y = NAN;
    assert_refused(ST_ENOTFINITE, 1, "point 17 of 15");
    take(1);
    pts[16].z = 2e6;
    assert_refused(ST_ERANGE, 1, "point 17 of 15");
    n = 99;
    assert_refused(ST_ETOOFEW, 1, "99 points");
    take(1);
    for (size_t i = 0; i < n; i++)
        pts[i].x = pts[i].y = 0;
    assert_refused(ST_EDEGENERATE, 1, "on one line");
}

TEST(test_surface)
{
    take(1);
    for (size_t i = 0; i < n; i++)
        pts[i].z = 0;
    assert_refused(ST_ENOTFACE, 1, "from the front");
    take(1);
    for (size_t i = 0; i < n; i++)
        pts[i].z += (double)(i * 7919 % 41) - 20;
    assert_refused(ST_EQUALITY, 1, "scan again");
    assert_non_null(strstr(e.msg, "noise "));
}
