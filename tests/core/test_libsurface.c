/* The library's public functions: they give the results of the core's own, and their errors. */
/* link: -Wl,--wrap=aligned_alloc */
#include "asymmetry.h"
#include "clouds.h"
#include "face.h"
#include "faces.h"
#include "fail_alloc.h"
#include "head.h"
#include "headscan.h"
#include "libsurface.h"
#include "minimal.h"
#include "model.h"
#include "status.h"
#include "unit.h"

#define POINTS 3000

static struct dvec3 pts[4 * POINTS];
static double xyz[4 * POINTS][3];

static size_t scan_of(uint64_t subject, uint64_t number, size_t points)
{
    const size_t n = clouds_scan(subject, number, points, pts);

    for (size_t i = 0; i < n; i++) {
        xyz[i][0] = pts[i].x;
        xyz[i][1] = pts[i].y;
        xyz[i][2] = pts[i].z;
    }
    return n;
}

static size_t scan(uint64_t subject, uint64_t number)
{
    return scan_of(subject, number, POINTS);
}

/* The n points at xyz, frontal. */
static enum surface_status build(struct surface_work *work, size_t n,
                                 struct surface_face **out, struct surface_found *found)
{
    const struct surface_cloud cloud = {
        .points = (const double(*)[3])xyz, .n = n, .flags = SURFACE_FRONTAL};

    return surface_build(work, &cloud, out, found);
}

/* A frontal face is built as by face_build(), and names its engine. */
TEST(test_same)
{
    struct surface_work *work = surface_work_new(NULL);
    struct surface_face *one = NULL;
    struct surface_face a = {0};
    struct surface_comparison c = {0};
    struct surface_quality q;
    char engine[SURFACE_ENGINE_SIZE];
    size_t n = scan(3, 0);

    assert_non_null(work);
    assert_int_equal(build(work, n, &one, NULL), SURFACE_OK);
    assert_int_equal(face_build(pts, n, work, &a, NULL), ST_OK);
    q = surface_face_quality(one);
    assert_memory_equal(&q, &a.quality, sizeof q);
    assert_int_equal(surface_quality_reasons(&q, one),
                     quality_reasons(&a.quality, &a.frame));
    surface_engine(NULL, engine);
    assert_non_null(strstr(engine, "/" SURFACE_VERSION " "));
    assert_memory_equal(engine, SURFACE_ENGINE " ", sizeof SURFACE_ENGINE);
    surface_work_free(work);
    work = surface_work_new(NULL); /* a face outlives the memory it was built with */
    assert_int_equal(surface_compare(work, one, &a, &c), SURFACE_OK);
    assert_int_equal(c.decision, SURFACE_MATCH);
    face_free(&a);
    surface_work_free(work);
    surface_face_free(one);
}

/* A raw scan of a head, in metres and turned: the face is found in it and matches; at the points
 * as they were given the gaps are small. */
TEST(test_raw)
{
    struct surface_face *face[2] = {NULL, NULL};
    struct surface_found found = {0};
    struct surface_comparison c = {0};
    struct surface_disparity d = {0};
    double to_template[16] = {0}, sum = 0, *gap;
    struct headscan_options o;
    struct headscan s;
    struct head h;
    size_t covered = 0;

    head_make_up(5, &h);
    for (int i = 0; i < 2; i++) {
        struct surface_cloud cloud = {.flags = SURFACE_ENROLMENT};

        assert_true(headscan_kind("head", 3 + (uint64_t)i, false, &o));
        o.unit_mm = 1000;
        headscan_render(&h, &o, &s);
        cloud.points = (const double(*)[3])s.at; /* x, y, z */
        cloud.n = s.n;
        assert_int_equal(surface_build(faces_work, &cloud, &face[i], &found), SURFACE_OK);
        assert_true(found.unit_mm == 1000 && found.unit_found && found.faces == 1);
        assert_true(found.points_used > 1000 && found.points_used < s.n);
        assert_true(found.evidence > found.evidence_wanted);
        if (i == 0)
            headscan_free(&s);
    }
    assert_int_equal(surface_compare(faces_work, face[0], face[1], &c), SURFACE_OK);
    assert_int_equal(c.decision, SURFACE_MATCH);
    assert_int_equal(surface_disparity(faces_work, face[0], face[1], &d), SURFACE_OK);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                to_template[4 * i + j] += d.transform[4 * i + k] * found.view[4 * k + j];
    assert_non_null(gap = malloc(s.n * sizeof *gap));
    assert_int_equal(
        surface_gaps(face[0], (const double(*)[3])s.at, s.n, to_template, gap),
        SURFACE_OK);
    for (size_t i = 0; i < s.n; i++)
        if (fabs(gap[i]) < 10) {
            sum += fabs(gap[i]);
            covered++;
        }
    assert_true(covered > found.points_used / 2 && sum / (double)covered < 2);
    free(gap);
    headscan_free(&s);
    head_free(&h);
    surface_face_free(face[0]);
    surface_face_free(face[1]);
}

/* Checked as both, a scan that only a verification takes has the enrolment's reason; in place the
 * points become those of the face; a build that nobody waits for ends. */
static int stop_now(const void *arg)
{
    (void)arg;
    return 1;
}

TEST(test_ways)
{
    const struct surface_stop stop = {stop_now, NULL};
    struct surface_found why = {0}, found = {0};
    struct surface_face *face = NULL, *other = NULL;
    struct surface_comparison c = {0};
    static uint32_t place[2 * POINTS];
    static double kept[2 * POINTS][3];
    struct surface_cloud cloud = {.points = (const double(*)[3])xyz, .n = scan(3, 0)};
    enum surface_status refused;

    assert_int_equal(surface_check(faces_work, &cloud, &face, &refused, &why, &found),
                     SURFACE_OK);
    assert_int_equal(refused, SURFACE_OK);
    assert_true(why.evidence_wanted > found.evidence_wanted || face != NULL);
    cloud.kept = kept;
    assert_int_equal(surface_build(faces_work, &cloud, &other, &found), SURFACE_EINVAL);
    cloud.kept_place = place;
    assert_int_equal(surface_build(faces_work, &cloud, &other, &found), SURFACE_OK);
    assert_true(found.kept == found.points_used && found.kept > 1000);
    assert_int_equal(surface_compare(faces_work, face, other, &c), SURFACE_OK);
    assert_true(c.decision == SURFACE_MATCH && c.overlap == 1);
    cloud.kept = xyz;
    assert_int_equal(surface_build(faces_work, &cloud, &other, &found), SURFACE_OK);
    assert_memory_equal(kept, xyz, found.kept * sizeof *kept);
    cloud.n = scan(3, 0);                /* over what was kept in their place */
    for (size_t i = 0; i < cloud.n; i++) /* half of a face, which nobody enrolls */
        xyz[i][0] = pts[i].x < -5 ? (double)NAN : pts[i].x;
    cloud.kept = NULL;
    cloud.kept_place = NULL;
    assert_int_equal(surface_check(faces_work, &cloud, &face, &refused, &why, &found),
                     SURFACE_OK);
    assert_true(refused == SURFACE_EQUALITY || refused == SURFACE_ENOTFACE);
    assert_true(why.support_wanted > found.support_wanted && why.points_used == 0 &&
                found.points_used > 500);
    cloud.stop = &stop;
    assert_int_equal(surface_build(faces_work, &cloud, &face, &found), SURFACE_ESTOPPED);
    assert_null(face);
    surface_face_free(other);
}

/* A face written and read again scores the same; damaged bytes are refused. */
TEST(test_bytes)
{
    struct surface_face *a = NULL, *b = NULL, *again = NULL;
    struct surface_comparison c[2] = {{0}, {0}};
    struct surface_quality q;
    double(*points)[3];
    uint32_t n, (*triangles)[3];
    size_t len;
    char *bytes;

    assert_int_equal(build(faces_work, scan(7, 0), &a, NULL), SURFACE_OK);
    assert_int_equal(build(faces_work, scan(7, 1), &b, NULL), SURFACE_OK);
    len = surface_encoded_size(a);
    assert_non_null(bytes = malloc(len));
    surface_encode(a, bytes);
    assert_int_equal(surface_decode(faces_work, bytes, len, &again), SURFACE_OK);
    assert_int_equal(surface_compare(faces_work, a, b, &c[0]), SURFACE_OK);
    assert_int_equal(surface_compare(faces_work, again, b, &c[1]), SURFACE_OK);
    assert_memory_equal(&c[0], &c[1], sizeof c[0]);
    q = surface_face_quality(again);
    assert_true(q.score == 0 && q.density_mm == 0);
    q = surface_face_quality(a);
    surface_face_rate(again, &q);
    assert_true(surface_face_quality(again).noise_mm == q.noise_mm);
    n = surface_face_triangles(again, NULL);
    assert_non_null(triangles = calloc(n, sizeof *triangles));
    assert_int_equal(surface_face_triangles(again, triangles), n);
    n = surface_face_points(again, NULL);
    assert_true(n > 2000);
    assert_true(triangles[0][0] < n && triangles[0][1] < n && triangles[0][2] < n);
    assert_int_equal(surface_face_check(again), SURFACE_OK);
    assert_non_null(points = calloc(n, sizeof *points));
    assert_int_equal(surface_face_points(again, points), n);
    for (size_t i = 0; i < n; i++)
        assert_true(fabs(points[i][0]) < 500 && points[i][2] == points[i][2]);
    assert_int_equal(surface_rebuild(faces_work, &again), SURFACE_OK);
    assert_int_equal(surface_compare(faces_work, again, b, &c[1]), SURFACE_OK);
    assert_memory_equal(&c[0], &c[1], sizeof c[0]);
    bytes[8] ^= 1;
    assert_int_equal(surface_decode(faces_work, bytes, len, &again), SURFACE_ECORRUPT);
    assert_null(again);
    free(points);
    free(triangles);
    free(bytes);
    surface_face_free(a);
    surface_face_free(b);
}

/* A model as text is the shipped one again; a calibration moves the threshold. */
TEST(test_model)
{
    const size_t len = surface_model_write(&model_default, NULL, 0);
    struct surface_calibration by = {
        .threshold = 1000, .n = 2, .knot = {{0, 1}, {10, 0.5}}};
    struct surface_face *a = NULL;
    struct surface_comparison c = {0};
    struct surface_model *m;
    struct surface_work *work;
    char engine[2][SURFACE_ENGINE_SIZE];
    uint32_t line = 0;
    char *text = malloc(len + 1);

    assert_non_null(text);
    (void)surface_model_write(&model_default, text, len + 1);
    assert_int_equal(surface_model_parse(text, len, &m, &line), SURFACE_OK);
    surface_engine(m, engine[0]);
    surface_engine(NULL, engine[1]);
    assert_string_equal(engine[0], engine[1]);
    assert_non_null(work = surface_work_new(m));
    assert_int_equal(build(work, scan(7, 0), &a, NULL), SURFACE_OK);
    assert_int_equal(surface_work_calibrate(work, &by), SURFACE_OK);
    assert_int_equal(surface_compare(work, a, a, &c), SURFACE_OK);
    assert_true(c.threshold == 1000 && c.decision != SURFACE_MATCH);
    by.knot[1].rate = 1;
    assert_int_equal(surface_work_calibrate(work, &by), SURFACE_EINVAL);
    assert_int_equal(surface_work_calibrate(work, NULL), SURFACE_OK);
    assert_int_equal(surface_compare(work, a, a, &c), SURFACE_OK);
    assert_int_equal(c.decision, SURFACE_MATCH);
    surface_work_free(work);
    surface_model_free(m);
    text[len / 2] = '?';
    assert_int_equal(surface_model_parse(text, len, &m, &line), SURFACE_ECORRUPT);
    assert_true(m == NULL && line > 1);
    surface_face_free(a);
    free(text);
}

/* test_face.c has what is refused for its points. */
TEST(test_refused)
{
    struct surface_found found = {0};
    struct surface_cloud cloud = {0};
    struct surface_face *face = NULL;
    const size_t n = scan(3, 0);

    assert_int_equal(surface_build(faces_work, &cloud, &face, NULL), SURFACE_ETOOFEW);
    cloud.n = 1;
    assert_int_equal(surface_build(faces_work, &cloud, &face, NULL), SURFACE_EINVAL);
    cloud.points = (const double(*)[3])xyz;
    cloud.width = 2;
    assert_int_equal(surface_build(faces_work, &cloud, &face, NULL), SURFACE_EINVAL);
    cloud.width = 0;
    cloud.flags = 64;
    assert_int_equal(surface_build(faces_work, &cloud, &face, NULL), SURFACE_EINVAL);
    assert_int_equal(build(faces_work, 99, &face, NULL), SURFACE_ETOOFEW);
    assert_int_equal(build(faces_work, SURFACE_MAX_POINTS + 1, &face, NULL),
                     SURFACE_ELIMIT);
    xyz[17][2] = (double)NAN;
    assert_int_equal(build(faces_work, n, &face, &found), SURFACE_ENOTFINITE);
    assert_int_equal(found.bad, 17);
    xyz[17][2] = 17e3;
    assert_int_equal(build(faces_work, n, &face, &found), SURFACE_ERANGE);
    assert_null(face);
    surface_work_free(NULL);
    surface_face_free(NULL);
    surface_model_free(NULL);
}

/* Each status has a message of its own, each bit a name; what is none has none. */
TEST(test_words)
{
    const char *name[3][10];
    static const int count[3] = {SURFACE_WARNINGS, SURFACE_REASONS, SURFACE_REGIONS};

    for (int i = 0; i < ST_COUNT; i++)
        for (int k = -1; k < i; k++)
            assert_string_not_equal(status_message((enum status)i),
                                    status_message((enum status)(k < 0 ? ST_COUNT : k)));
    assert_string_equal(status_message((enum status)(-1)), "unknown status");
    assert_string_equal(surface_message(SURFACE_ERANGE), status_message(ST_ERANGE));
    for (int i = 0; i <= 9; i++) {
        name[0][i] = surface_warning_name((enum surface_warning)i);
        name[1][i] = surface_reason_name((enum surface_reason)i);
        name[2][i] = surface_region_name((enum surface_region)i);
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i <= count[k]; i++) {
            assert_int_equal(name[k][i] == NULL, i == count[k]);
            for (int j = 0; j < i && i < count[k]; j++)
                assert_string_not_equal(name[k][i], name[k][j]);
        }
    assert_string_equal(name[0][SURFACE_THINNED], "thinned");
    assert_string_equal(name[1][SURFACE_OBLIQUE], "turned");
    assert_string_equal(name[2][SURFACE_CHIN], "chin");
}

/* ---- memory */

enum call {
    BUILD_FRONTAL,
    BUILD_FOUND, /* turned to the side */
    BUILD_THINNED,
    DECODE,
    COMPARE, /* from here on nothing is allocated the second time */
    MIRRORED,
    PARTS,
    MINIMUM,
    ASYMMETRY,
    CALLS
};

struct calls {
    enum call k;
    const struct surface_face *a, *b;
    size_t n, len;
    void *bytes; /* of a */
    double want[2];
};

static enum surface_status call(const struct calls *c, struct surface_work *w,
                                double got[2])
{
    const struct surface_cloud cloud = {.points = (const double(*)[3])xyz,
                                        .n = c->n,
                                        .flags = c->k == BUILD_FRONTAL ? SURFACE_FRONTAL
                                                                       : SURFACE_PINHOLE};
    struct surface_comparison r = {0};
    struct surface_parts parts = {0};
    struct surface_disparity d = {0};
    struct surface_asymmetry asym = {0};
    struct surface_face *face = NULL;
    enum surface_status st;
    double view[16];

    switch (c->k) {
    case COMPARE:
    case MIRRORED:
        st = c->k == COMPARE ? surface_compare(w, c->a, c->b, &r)
                             : surface_compare_mirrored(w, c->a, c->b, &r);
        got[0] = r.score;
        got[1] = r.expected;
        return st;
    case PARTS:
        st = surface_parts(w, c->a, c->b, &parts);
        got[0] = parts.region[0];
        got[1] = parts.region[SURFACE_REGIONS - 1];
        return st;
    case MINIMUM:
        if ((st = surface_disparity(w, c->a, c->b, &d)) == SURFACE_OK)
            st = surface_weigh(w, c->a, c->b, &d);
        got[0] = d.disparity_mm;
        got[1] = d.weighted_mm;
        return st;
    case ASYMMETRY:
        st = surface_asymmetry(w, c->a, &asym);
        got[0] = asym.disparity_mm;
        got[1] = asym.weighted_mm;
        return st;
    default:
        st = c->k == DECODE ? surface_decode(w, c->bytes, c->len, &face)
                            : surface_build(w, &cloud, &face, NULL);
    }
    assert_true((face != NULL) == (st == SURFACE_OK));
    if (st == SURFACE_OK) {
        surface_face_frame(face, view);
        got[0] = view[3];
        got[1] = surface_face_points(face, NULL);
    }
    surface_face_free(face);
    return st;
}

/* After a failure the next call has the same memory and gives the same digits. */
static enum status call_fresh(void *arg)
{
    const struct calls *c = arg;
    struct surface_work *w = surface_work_new(NULL);
    enum surface_status st;
    double got[2];

    if (w == NULL)
        return ST_ENOMEM;
    if ((st = call(c, w, got)) != SURFACE_OK)
        assert_int_equal(call(c, w, got), SURFACE_OK);
    assert_memory_equal(c->want, got, sizeof got);
    if (c->k >= COMPARE) {
        fail_alloc_at(0);
        assert_int_equal(call(c, w, got), SURFACE_OK);
        assert_int_equal(fail_alloc_count(), 0);
    }
    surface_work_free(w);
    return st == SURFACE_OK ? ST_OK : st == SURFACE_ENOMEM ? ST_ENOMEM : ST_EINTERNAL;
}

/* Each call, with each of its allocations failing. */
TEST(test_memory)
{
    struct surface_face *a = NULL, *b = NULL;
    struct calls c = {.k = 0};

    assert_int_equal(build(faces_work, scan(3, 0), &a, NULL), SURFACE_OK);
    c.len = surface_encoded_size(a);
    assert_non_null(c.bytes = malloc(c.len));
    surface_encode(a, c.bytes);
    c.n = scan_of(3, 1, 800);
    assert_int_equal(build(faces_work, c.n, &b, NULL), SURFACE_OK);
    c.a = a;
    c.b = b;
    for (; c.k < CALLS; c.k++) {
        if (c.k == BUILD_THINNED)
            c.n = scan_of(3, 1, 11000);
        for (size_t i = 0; c.k == BUILD_FOUND && i < c.n; i++) {
            const double x = xyz[i][0];

            xyz[i][0] = xyz[i][1];
            xyz[i][1] = -x;
        }
        assert_int_equal(call(&c, faces_work, c.want), SURFACE_OK);
        assert_true(fail_alloc_walk(call_fresh, &c) > 1);
    }
    free(c.bytes);
    surface_face_free(a);
    surface_face_free(b);
}
