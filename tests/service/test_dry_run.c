/* link: -Wl,--wrap=scan_build */
/* A trial says what an enrolment and a verification would do: a scan that only a verification
 * takes keeps the enrolment's reason and advice, and the second run has the points as they
 * were. */
#include "cloudpoints.h"
#include "face.h"
#include "mem.h"
#include "scan.h"
#include "dry_run.h"
#include "unit.h"

/* What each run is to return, by whether it is an enrolment's. */
static enum status outcome[2];
static int runs;
static const struct scan_search *search; /* of the latest run */
static struct surface_found told;        /* but for the points */

enum status __wrap_scan_build(struct cloudpoints *c, const struct scan_options *o,
                              struct surface_work *w, struct surface_face *out,
                              size_t *bad, struct surface_found *found);

enum status __wrap_scan_build(struct cloudpoints *c, const struct scan_options *o,
                              struct surface_work *w, struct surface_face *out,
                              size_t *bad, struct surface_found *found)
{
    (void)w;
    (void)bad;
    (void)out;
    assert_true(o->search != NULL && (runs++ == 0 || o->search == search));
    search = o->search;
    assert_int_equal(o->axes, SCAN_AXES_SCANNER);
    assert_int_equal(c->n, 3);
    assert_true(c->at[1].y == 2.5 && c->index[2] == 4 && c->normal == NULL);
    *found = told;
    memset(c->at, 0, c->n * sizeof *c->at); /* used up */
    c->n = 1;
    if (outcome[o->enrolment] == ST_OK)
        found->quality = (struct surface_quality){.coverage = 1, .density_mm = 2};
    return outcome[o->enrolment];
}

static struct dry_run t;
static double value_mm; /* of a depth image; 0: it is none */

BEFORE_EACH(set_up)
{
    value_mm = 0;
    told = (struct surface_found){.unit_mm = 1,
                                  .extent = {410, 440, 120.5},
                                  .faces = 2,
                                  .warnings = 1U << SURFACE_SEVERAL};
}

static enum status run(enum status enrolment, enum status verification)
{
    struct cloudpoints c = {.at = mem_array(3, sizeof *c.at),
                            .index = mem_array(3, sizeof *c.index),
                            .n = 3,
                            .read = 5,
                            .unit_mm = value_mm > 0 ? 1 : 0,
                            .value_mm = value_mm,
                            .axes_given = true};
    struct surface_face *face = NULL;
    enum status st;

    assert_true(c.at != NULL && c.index != NULL);
    memset(c.at, 0, 3 * sizeof *c.at);
    c.at[1].y = 2.5;
    for (uint32_t i = 0; i < 3; i++)
        c.index[i] = 2 * i;
    outcome[true] = enrolment;
    outcome[false] = verification;
    runs = 0;
    st = dry_run_run("points", &c, &(struct sample_options){.stop = NULL}, NULL, &face,
                     &t);
    assert_true((face != NULL) == (st == ST_OK && t.verification == ST_OK));
    surface_face_free(face);
    cloudpoints_free(&c);
    return st;
}

TEST(test_both)
{
    assert_int_equal(run(ST_OK, ST_EINTERNAL), ST_OK);
    assert_int_equal(runs, 1);
    assert_int_equal(t.enrolment, ST_OK);
    assert_int_equal(t.verification, ST_OK);
    assert_string_equal(t.why.msg, "");
    assert_int_equal(t.found.points_read, 5);
    assert_string_equal(
        t.advice.line[0],
        "let only one person be in view: 2 faces were found, the nearest was used");
}

TEST(test_verification_alone)
{
    assert_int_equal(run(ST_ESEVERAL, ST_OK), ST_OK);
    assert_int_equal(runs, 2);
    assert_int_equal(t.enrolment, ST_ESEVERAL);
    assert_int_equal(t.verification, ST_OK);
    assert_int_equal(t.why.code, ST_ESEVERAL);
    assert_string_equal(
        t.why.msg,
        "points: an enrolment needs exactly one face: let only one person be in view: 2 faces were found");
    assert_string_equal(t.advice.line[0],
                        "let only one person be in view: 2 faces were found");
    assert_int_equal(t.found.points_read, 5);
}

TEST(test_neither)
{
    assert_int_equal(run(ST_ESEVERAL, ST_ENOTFACE), ST_OK);
    assert_int_equal(runs, 2);
    assert_int_equal(t.enrolment, ST_ESEVERAL);
    assert_int_equal(t.verification, ST_ENOTFACE);
    assert_int_equal(t.why.code, ST_ENOTFACE);
    assert_non_null(strstr(t.advice.line[0], "send one face"));
}

TEST(test_failure)
{
    assert_int_equal(run(ST_ENOMEM, ST_OK), ST_ENOMEM);
    assert_int_equal(runs, 1);
    assert_int_equal(t.why.code, ST_ENOMEM);
    assert_int_equal(run(ST_ENOTFACE, ST_ENOMEM), ST_ENOMEM);
    assert_int_equal(t.why.code, ST_ENOMEM);
}

/* Each refusal says what was measured, and ends with the advice. */
TEST(test_texts)
{
    static const struct {
        enum status st;
        const char *text;
    } known[] = {
        {ST_ENOFACE,
         "points: no face was found among 3 points, 410 x 440 x 120.5 in extent: "
         "let the scanner see the whole face, from the front or turned by up to "
         "55°"},
        {ST_EMIRRORED,
         "points: its normals or the order of its points are those of a mirror image: "
         "the scan seems to be a mirror image: switch mirroring off where it "
         "was made"},
        {ST_ENOTFACE,
         "points: the surface does not have the shape of a face (support 0.21, "
         "at least 0.33 wanted): send one face seen from the front, with "
         "forehead, nose and chin"},
        {ST_EQUALITY,
         "points: too much of the face is covered: take off glasses or mask, keep "
         "hair and hands away: 41 % of the face is covered"},
    };

    told.support = 0.21;
    told.support_wanted = 0.33;
    told.faces = 1;
    told.occluded = 0.41;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        told.warnings = known[i].st == ST_EQUALITY ? 1U << SURFACE_OCCLUDED : 0;
        assert_int_equal(run(known[i].st, ST_OK), ST_OK);
        assert_string_equal(t.why.msg, known[i].text);
    }
}

/* A face in an unusual unit, or in a depth image of another scale; nothing else is blamed. */
TEST(test_no_usual_unit)
{
    told.fits_mm = 99.6;
    told.unit_found = true;
    told.occluded = 0.6;
    told.warnings = 1U << SURFACE_OCCLUDED | 1U << SURFACE_TURNED;
    assert_int_equal(run(ST_EUNITS, ST_OK), ST_OK);
    assert_string_equal(
        t.why.msg, "points: a face in none of the units; at about 100 mm a unit it would "
                   "be: send it in one of the units: mm, cm, m, in or um");
    value_mm = 0.2;
    told.fits_mm = 1.24;
    assert_int_equal(run(ST_EUNITS, ST_OK), ST_OK);
    assert_string_equal(
        t.why.msg,
        "points: a face in none of the units; at about 0.25 mm a depth value it "
        "would be: give depth_scale=0.25");
    told.fits_mm = 0.025;
    assert_int_equal(run(ST_EUNITS, ST_OK), ST_OK);
    assert_non_null(strstr(t.why.msg, "about 0.005 mm a depth value it would be: give "
                                      "depth_scale=200000"));
}

/* What covers less than an enrolment may have is no reason for a refusal, but advice. */
TEST(test_covered_a_little)
{
    told.occluded = 0.06;
    told.warnings = 1U << SURFACE_OCCLUDED | 1U << SURFACE_TURNED;
    told.yaw_deg = 46;
    assert_int_equal(run(ST_EQUALITY, ST_OK), ST_OK);
    assert_string_equal(
        t.why.msg,
        "points: the face is turned away from the scanner: take off glasses or mask, keep "
        "hair and hands away: 6 % of the face is covered; turn the head towards the "
        "scanner: 46° to the left now, up to 30° for enrolment");
}

TEST(test_unread)
{
    static const enum status refusal[] = {
        ST_ELIMIT,  ST_ETOOFEW,  ST_ENOTFINITE, ST_ERANGE,   ST_EDEGENERATE, ST_EUNITS,
        ST_ENOFACE, ST_ESEVERAL, ST_EMIRRORED,  ST_ENOTFACE, ST_EQUALITY};
    const struct errinfo e = {.code = ST_ELIMIT, .msg = "more points than the limit"};

    dry_run_unread(ST_ELIMIT, &e, &t);
    assert_int_equal(t.enrolment, ST_ELIMIT);
    assert_int_equal(t.verification, ST_ELIMIT);
    assert_string_equal(t.why.msg, e.msg);
    assert_int_equal(t.found.points_read, 0);
    assert_int_equal(t.advice.n, 1);
    for (int st = 0; st < ST_COUNT; st++) {
        bool is = false;

        for (size_t i = 0; i < sizeof refusal / sizeof *refusal; i++)
            is = is || (int)refusal[i] == st;
        assert_int_equal(dry_run_is_refusal((enum status)st), is);
    }
}
