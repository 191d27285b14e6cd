/* The library's public functions: they give the results of face.h, and their own errors. */
/* link: -Wl,--wrap=aligned_alloc */
#include "brute.h"
#include "clouds.h"
#include "face.h"
#include "fail_alloc.h"
#include "libsurface.h"
#include "measure.h"
#include "minimal.h"
#include "status.h"
#include "unit.h"

#define POINTS 3000

static struct dvec3 pts[2 * POINTS];
static double xyz[2 * POINTS][3];

static size_t scan(uint64_t subject, uint64_t number)
{
    const size_t n = clouds_scan(subject, number, POINTS, pts);

    for (size_t i = 0; i < n; i++) {
        xyz[i][0] = pts[i].x;
        xyz[i][1] = pts[i].y;
        xyz[i][2] = pts[i].z;
    }
    return n;
}

static enum surface_status build(struct surface_work *work, size_t n,
                                 struct surface_face **out, size_t *bad)
{
    return surface_face_new(work, (const double(*)[3])xyz, n, out, bad);
}

/* The same as face_build() and face_compare() give, of the same subject and of two. */
TEST(test_same)
{
    static const uint64_t probe[2][2] = {{3, 1}, {4, 0}};
    struct surface_work *work = surface_work_new();
    struct face_work *w = face_work_new(NULL);
    struct surface_face *tmpl, *other;
    struct measure_work measure = {0};
    struct face a = {0}, b = {0};
    char engine[2][SURFACE_ENGINE_SIZE];
    size_t n = scan(3, 0);

    assert_non_null(work);
    assert_int_equal(build(work, n, &tmpl, NULL), SURFACE_OK);
    assert_int_equal(face_build(pts, n, w, &a, NULL), ST_OK);
    for (int i = 0; i < 2; i++) {
        struct surface_comparison c;
        struct surface_quality q;
        struct face_result r;
        struct minimal m;
        struct disparity aligned;

        n = scan(probe[i][0], probe[i][1]);
        assert_int_equal(build(work, n, &other, NULL), SURFACE_OK);
        assert_int_equal(face_build(pts, n, w, &b, NULL), ST_OK);
        surface_face_quality(other, &q);
        assert_int_equal(q.points, b.surface.mesh.nv);
        assert_true(q.score == b.quality.score && q.coverage == b.quality.coverage);
        assert_true(q.density_mm == b.quality.density_mm);
        assert_true(q.noise_mm == b.quality.noise_mm);
        assert_int_equal(surface_compare(work, tmpl, other, &c), SURFACE_OK);
        assert_int_equal(face_compare(&a, &b, (double)NAN, NULL, w, &r), ST_OK);
        assert_int_equal(c.decision, i == 0 ? SURFACE_MATCH : SURFACE_NO_MATCH);
        assert_true(c.score == r.score && c.threshold == r.threshold);
        assert_true(c.false_match_rate == r.fmr_at_score);
        assert_true(c.overlap == r.overlap);
        assert_int_equal(face_minimal(&a, &b, NULL, w, &r, &m), ST_OK);
        assert_memory_equal(c.transform, r.align.transform, sizeof c.transform);
        assert_true(c.disparity_mm == m.disparity.plain_mm);
        assert_true(c.volume_mm3 == m.disparity.volume_mm3);
        assert_true(c.area_mm2 == m.disparity.area_mm2);
        assert_memory_equal(c.minimal_transform, m.transform, sizeof m.transform);
        assert_int_equal(
            measure_at(&a.surface, &b.surface, c.transform, NULL, &measure, &aligned),
            ST_OK);
        assert_true(c.disparity_mm > 0 && c.disparity_mm <= aligned.plain_mm);
        assert_true(fabs(c.volume_mm3 / c.area_mm2 - c.disparity_mm) < 1e-9);
        surface_face_free(other);
    }
    surface_engine(engine[0]);
    face_engine(NULL, engine[1]);
    assert_string_equal(engine[0], engine[1]);
    measure_work_free(&measure);
    face_free(&a);
    face_free(&b);
    face_work_free(w);
    surface_work_free(work);
    surface_face_free(tmpl); /* a face outlives the memory it was built with */
}

/* A probe that shows a small part of the face has too little in common with it. */
TEST(test_inconclusive)
{
    struct surface_work *work = surface_work_new();
    struct surface_face *whole, *part;
    struct surface_comparison c;
    size_t n = scan(13, 0), kept = 0;

    assert_int_equal(build(work, n, &whole, NULL), SURFACE_OK);
    n = scan(13, 1);
    for (size_t i = 0; i < n; i++)
        if (fabs(xyz[i][0]) < 14 && fabs(xyz[i][1]) < 36)
            memcpy(xyz[kept++], xyz[i], sizeof *xyz);
    assert_int_equal(build(work, kept, &part, NULL), SURFACE_OK);
    assert_int_equal(surface_compare(work, whole, part, &c), SURFACE_OK);
    assert_int_equal(c.decision, SURFACE_INCONCLUSIVE);
    surface_face_free(whole);
    surface_face_free(part);
    surface_work_free(work);
}

TEST(test_refused)
{
    struct surface_work *work = surface_work_new();
    struct surface_face *face;
    struct brute_rng r = {1};
    size_t n = scan(3, 0), bad = 0;

    assert_int_equal(build(work, 99, &face, NULL), SURFACE_ETOOFEW);
    assert_null(face);
    assert_int_equal(build(work, SURFACE_MAX_POINTS + 1, &face, NULL), SURFACE_ELIMIT);
    assert_null(face);
    xyz[17][2] = (double)NAN;
    assert_int_equal(build(work, n, &face, &bad), SURFACE_ENOTFINITE);
    assert_int_equal(bad, 17);
    xyz[17][2] = 17e3;
    assert_int_equal(build(work, n, &face, &bad), SURFACE_ERANGE);
    for (size_t i = 0; i < n; i++) {
        xyz[i][0] = xyz[i][1] = (double)i / 10;
        xyz[i][2] = 0;
    }
    assert_int_equal(build(work, n, &face, NULL), SURFACE_EDEGENERATE);
    n = scan(3, 0);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            xyz[i][k] /= 10;
    assert_int_equal(build(work, n, &face, NULL), SURFACE_EUNITS);
    n = scan(3, 0);
    for (size_t i = 0; i < n; i++)
        xyz[i][2] = 0;
    assert_int_equal(build(work, n, &face, NULL), SURFACE_ENOTFACE);
    assert_null(face);
    n = scan(3, 0);
    for (size_t i = 0; i < n; i++)
        xyz[i][2] += 30 * (brute_real(&r) - 0.5);
    assert_int_equal(build(work, n, &face, NULL), SURFACE_EQUALITY);
    surface_work_free(work);
    surface_work_free(NULL);
    surface_face_free(NULL);
}

/* Each status has a message of its own; a value that is no status has another. */
TEST(test_messages)
{
    for (unsigned i = 0; i <= SURFACE_STATUSES; i++)
        for (unsigned k = 0; k < i; k++)
            assert_string_not_equal(surface_message((enum surface_status)i),
                                    surface_message((enum surface_status)k));
    assert_string_equal(surface_message(SURFACE_ENOTFACE), status_message(ST_ENOTFACE));
}

TEST(test_memory)
{
    const size_t n = scan(3, 0);
    enum surface_status st = SURFACE_ENOMEM;
    unsigned long k;

    for (k = 1; st != SURFACE_OK; k++) {
        struct surface_face *face = NULL;
        struct surface_comparison c;
        struct surface_work *work;

        fail_alloc_at(k);
        if ((work = surface_work_new()) != NULL) {
            st = build(work, n, &face, NULL);
            assert_true((face != NULL) == (st == SURFACE_OK));
            if (st == SURFACE_OK)
                st = surface_compare(work, face, face, &c);
        }
        fail_alloc_at(0);
        assert_true(st == SURFACE_OK || st == SURFACE_ENOMEM);
        surface_face_free(face);
        surface_work_free(work);
    }
    assert_true(k > 15);
}
