/* Comparing faces: the score depends on the two faces alone, the decision on that and the
 * threshold; parts of cells and regions add up to it. */
#include "libsurface.h"
#include "face.h"
#include "faces.h"
#include "heatmap.h"
#include "lattice.h"
#include "measure.h"
#include "minimal.h"
#include "model.h"
#include "unit.h"

/* Byte for byte. */
static void check_same(const struct surface_comparison *a,
                       const struct surface_comparison *b)
{
    assert_memory_equal(a, b, sizeof *a);
}

/* The share of identity in the variance of cell i of the model, times scale. */
static double share(uint32_t i, double scale)
{
    const struct surface_model *m = &model_default;
    double identity = 0, other = m->noise_floor_mm * m->noise_floor_mm;

    for (uint32_t k = 0; k < MODEL_MODES; k++) {
        identity += (double)m->identity.mode[i][k] * (double)m->identity.mode[i][k];
        other += (double)m->change.mode[i][k] * (double)m->change.mode[i][k];
    }
    return m->change.rest[i] > 0.0f ? scale * identity / (identity + other) : 0;
}

/* The scale of which the mean over the cells in use is 1. */
static double share_scale(void)
{
    double sum = 0, n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        sum += share(i, 1);
        n += model_default.change.rest[i] > 0.0f;
    }
    return n / sum;
}

/* The weighted disparity is that of the model's share of identity at the template's surface,
 * taken in its canonical frame; the plain one has the same digits with and without a weight. */
TEST(test_weigh)
{
    struct measure_work m = {0};
    struct surface_face a = {0}, b = {0};
    struct surface_disparity least, weighed;
    struct disparity plain;
    double sum = 0, weights = 0;
    const double scale = share_scale();

    faces_make(3, 0, &a);
    faces_make(4, 1, &b);
    assert_int_equal(surface_disparity(faces_work, &a, &b, &least), ST_OK);
    weighed = least;
    assert_int_equal(surface_weigh(faces_work, &a, &b, &weighed), ST_OK);
    assert_true(weighed.disparity_mm == least.disparity_mm);
    assert_int_equal(
        measure_at(&a.surface, &b.surface, least.transform, NULL, &m, &plain), ST_OK);
    for (uint32_t h = 0; h < 3 * m.general.nt; h += 3) {
        double gap[3], u[3], twice;

        if (mesh_is_ghost(&m.general, h / 3) ||
            !disparity_common(&m.general, m.vertex, h, &twice))
            continue;
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t v = m.general.org[h + i];
            const double z = /* the template's, whichever surface the vertex is from */
                m.general.z[v] - (v < a.surface.mesh.nv ? 0 : m.vertex[v].gap);
            const double *t = a.frame.pose.r, *s = a.frame.pose.t;
            const struct dvec3 p = {m.general.xy[v].x / LATTICE_PER_MM,
                                    m.general.xy[v].y / LATTICE_PER_MM,
                                    z / LATTICE_PER_MM};
            const uint32_t cell = grid_cell(t[0] * p.x + t[1] * p.y + t[2] * p.z + s[0],
                                            t[3] * p.x + t[4] * p.y + t[5] * p.z + s[1]);

            gap[i] = m.vertex[v].gap / LATTICE_PER_MM;
            u[i] = cell == GRID_NONE ? 0 : share(cell, scale);
        }
        sum += disparity_prism_weighted(twice, gap, u);
        weights += twice * (u[0] + u[1] + u[2]) / 3;
    }
    assert_true(fabs(weighed.weighted_mm - sum / weights) < 1e-7);
    assert_true(fabs(sum / weights - least.disparity_mm) > 1e-3);
    measure_work_free(&m);
    face_free(&a);
    face_free(&b);
}

/* surface_compare(), decided by another threshold. */
static enum surface_status compare_at(double threshold, const struct surface_face *a,
                                      const struct surface_face *b,
                                      struct surface_comparison *out)
{
    const enum surface_status st = surface_compare(faces_work, a, b, out);

    out->threshold = threshold;
    surface_best_of(faces_work, 1, out);
    return st;
}

/* The threshold changes the decision and nothing else; the best of five loses ln 5. */
TEST(test_threshold)
{
    struct surface_face a = {0}, b = {0};
    struct surface_comparison usual, strict, loose, below, best;

    faces_make(12, 0, &a);
    faces_make(12, 1, &b);
    assert_int_equal(surface_compare(faces_work, &a, &b, &usual), ST_OK);
    assert_int_equal(compare_at(1e3, &a, &b, &strict), ST_OK);
    assert_int_equal(compare_at(usual.score, &a, &b, &loose), ST_OK);
    assert_int_equal(compare_at(-1, &a, &b, &below), ST_OK);
    assert_int_equal(usual.decision, SURFACE_MATCH);
    assert_true(usual.threshold == model_default.calibration.threshold);
    best = usual; /* of five templates */
    surface_best_of(faces_work, 5, &best);
    assert_true(fabs(usual.score - log(5) - best.score) < 1e-12);
    assert_true(best.false_match_rate ==
                surface_calibration_rate(&model_default.calibration, best.score));
    /* more than two such scans of one person are expected to have: nobody could match */
    assert_true(strict.expected < 1e3);
    assert_int_equal(strict.decision, SURFACE_INCONCLUSIVE);
    assert_int_equal(loose.decision, SURFACE_MATCH); /* a score equal to it matches */
    assert_int_equal(below.decision, SURFACE_MATCH);
    assert_true(strict.threshold == 1e3 && below.threshold == -1);
    assert_true(loose.threshold == usual.score);
    assert_true(strict.false_match_rate == usual.false_match_rate);
    /* among more people than the table supports */
    assert_int_equal(compare_at((double)INFINITY, &a, &b, &below), ST_OK);
    assert_int_equal(below.decision, SURFACE_INCONCLUSIVE);
    strict.decision = usual.decision;
    strict.threshold = usual.threshold;
    check_same(&usual, &strict);
    faces_make(15, 0, &b);
    assert_int_equal(surface_compare(faces_work, &a, &b, &usual), ST_OK);
    assert_true(usual.score < usual.expected);
    assert_int_equal(compare_at(usual.expected, &a, &b, &loose), ST_OK);
    assert_int_equal(compare_at(nextafter(usual.expected, INFINITY), &a, &b, &strict),
                     ST_OK);
    assert_int_equal(loose.decision, SURFACE_NO_MATCH);
    assert_int_equal(strict.decision, SURFACE_INCONCLUSIVE);
    face_free(&a);
    face_free(&b);
}

/* Whatever the threshold and the score, the numbers shown agree with the decision and are
 * hardly off. */
TEST(test_shown)
{
    for (int i = -40; i < 40; i++)
        for (int k = -60; k < 60; k++) {
            struct surface_comparison r = {.threshold = i * 0.00213}, again;
            double score, threshold;

            r.score = r.threshold + k * 0.001 + 0.0005;
            surface_shown(&r, 100, &score, &threshold);
            assert_int_equal(score >= threshold, r.score >= r.threshold);
            assert_true(fabs(score - r.score) < 0.02);
            assert_true(threshold == round(threshold * 100) / 100);
            again = (struct surface_comparison){.score = score, .threshold = threshold};
            surface_shown(&again, 100, &score,
                          &threshold); /* once more changes nothing */
            assert_true(again.score == score && again.threshold == threshold);
        }
}

/* A mirrored scan scores as the scan that it is the mirror image of, up to the triangulation
 * and the pose found; the scan itself stays as it is. */
TEST(test_mirrored)
{
    struct surface_face a = {0}, b = {0}, m = {0};
    struct surface_comparison plain, as_is, mirrored, again;

    for (uint64_t k = 20; k < 24; k++) {
        faces_make(k, 0, &a);
        faces_make(k, 1, &b);
        for (size_t i = 0; i < faces_n; i++)
            faces_pts[i].x = -faces_pts[i].x;
        faces_build(&m);
        assert_int_equal(surface_compare(faces_work, &a, &b, &plain), ST_OK);
        assert_int_equal(surface_compare(faces_work, &a, &m, &as_is), ST_OK);
        assert_int_equal(surface_compare_mirrored(faces_work, &a, &m, &mirrored), ST_OK);
        print_message("%.2f, mirrored %.2f, back %.2f\n", plain.score, as_is.score,
                      mirrored.score);
        assert_true(fabs(mirrored.score - plain.score) < 0.2);
        assert_true(mirrored.score > as_is.score);
        assert_int_equal(surface_compare_mirrored(faces_work, &a, &m, &again), ST_OK);
        check_same(&mirrored, &again);
        assert_int_equal(surface_compare(faces_work, &a, &m, &again), ST_OK);
        check_same(&as_is, &again);
    }
    face_free(&a);
    face_free(&b);
    face_free(&m);
}

/* The points of the cloud for which holds() are left. */
static void keep(bool (*holds)(const struct dvec3 *p))
{
    size_t n = 0;

    for (size_t i = 0; i < faces_n; i++)
        if (holds(&faces_pts[i]))
            faces_pts[n++] = faces_pts[i];
    faces_n = n;
}

static bool is_nose(const struct dvec3 *p)
{
    return fabs(p->x) < 14 && fabs(p->y) < 36;
}

static bool is_forehead(const struct dvec3 *p)
{
    return p->y > 38;
}

/* A probe of a small part of the face has an empty encoding: no cell has a part in the score, and
 * whatever the threshold the comparison is inconclusive. */
TEST(test_inconclusive)
{
    static bool (*const part[])(const struct dvec3 *) = {is_nose, is_forehead};
    static struct surface_parts field;
    struct surface_face a = {0}, b = {0};

    faces_make(13, 0, &a);
    for (int k = 0; k < 2; k++) {
        struct surface_comparison r;

        faces_scan(13, 1, 2 * FACES_POINTS);
        keep(part[k]);
        faces_build(&b);
        assert_int_equal(surface_compare(faces_work, &a, &b, &r), ST_OK);
        assert_true(r.overlap > 0 && r.overlap < 0.3 && r.expected < r.threshold);
        assert_int_equal(r.decision, SURFACE_INCONCLUSIVE);
        assert_int_equal(compare_at(-1000, &a, &b, &r), ST_OK);
        assert_int_equal(r.decision, SURFACE_INCONCLUSIVE);
        assert_int_equal(b.encoding.n, 0);
        assert_int_equal(surface_parts(faces_work, &a, &b, &field), ST_OK);
        for (uint32_t i = 0; i < GRID_N; i++)
            assert_true(isnan(field.part[i]));
        for (int i = 0; i < SURFACE_REGIONS; i++)
            assert_true(field.region[i] == 0);
    }
    face_free(&a);
    face_free(&b);
}

static double ticking(void)
{
    static double now = 100;

    return now += 2.5;
}

TEST(test_clock)
{
    struct surface_face a = {0};
    struct surface_disparity least, plain;

    faces_make(14, 0, &a);
    assert_int_equal(surface_disparity(faces_work, &a, &a, &plain), ST_OK);
    assert_true(plain.align_ms == 0 && plain.minimal_ms == 0);
    surface_work_clock(faces_work, ticking);
    assert_int_equal(surface_disparity(faces_work, &a, &a, &least), ST_OK);
    surface_work_clock(faces_work, NULL);
    assert_true(least.align_ms == 2.5 && least.minimal_ms == 2.5);
    least.align_ms = least.minimal_ms = 0;
    assert_memory_equal(&least, &plain, sizeof least);
    face_free(&a);
}

static bool is_left(const struct dvec3 *p)
{
    return p->x < 12;
}

static bool is_far_left(const struct dvec3 *p)
{
    return p->x < -7;
}

static bool is_far_right(const struct dvec3 *p)
{
    return p->x > 7;
}

/* The parts of cells and of regions add up to the score that was decided on. */
static void check_field(const struct surface_face *tmpl, const struct surface_face *probe)
{
    static struct surface_parts field, again;
    double cells = 0, regions = 0, region[SURFACE_REGIONS] = {0};
    struct surface_comparison r;

    assert_int_equal(surface_compare(faces_work, tmpl, probe, &r), ST_OK);
    assert_int_equal(surface_parts(faces_work, tmpl, probe, &field), ST_OK);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint8_t bit = (uint8_t)(1U << i % 8);
        const bool has[] = {tmpl->encoding.there[i / 8] & bit,
                            probe->encoding.there[i / 8] & bit};

        if (has[0] && has[1]) /* (no gap is 12 mm on the face) */
            assert_true(fabsf(field.gap_mm[i]) < 24.0f);
        if (isnan(field.part[i])) {
            assert_false(has[0] || has[1]);
            continue;
        }
        region[grid_region_of(i)] += (double)field.part[i];
        cells += (double)field.part[i];
    }
    for (int i = 0; i < SURFACE_REGIONS; i++) {
        assert_true(fabs(region[i] - field.region[i]) < 1e-4);
        regions += field.region[i];
    }
    print_message("score %.6f: cells %+.1e, regions %+.1e\n", r.score, cells - r.score,
                  regions - r.score);
    assert_true(fabs(cells - r.score) < 1e-5);
    assert_true(fabs(regions - r.score) < 1e-10 * (1 + fabs(r.score)));
    assert_int_equal(surface_parts(faces_work, tmpl, probe, &again), ST_OK);
    assert_memory_equal(field.region, again.region, sizeof field.region);
}

TEST(test_field)
{
    struct surface_face a = {0}, b = {0};

    faces_make(16, 0, &a);
    check_field(&a, &a);
    faces_make(16, 1, &b);
    check_field(&a, &b);
    faces_make(17, 0, &b);
    check_field(&a, &b);
    faces_scan(16, 1, 2 * FACES_POINTS);
    keep(is_left);
    faces_build(&b);
    check_field(&a, &b);
    check_field(&b, &a);
    faces_scan(16, 0, 2 * FACES_POINTS); /* and of halves that have no cell in common */
    keep(is_far_left);
    faces_build(&a);
    faces_scan(16, 1, 2 * FACES_POINTS);
    keep(is_far_right);
    faces_build(&b);
    for (uint32_t i = 0; i < GRID_N / 8; i++)
        assert_int_equal(a.encoding.there[i] & b.encoding.there[i], 0);
    assert_true(a.encoding.n > 0 && b.encoding.n > 0);
    check_field(&a, &b);
    face_free(&a);
    face_free(&b);
}

/* The gaps are those between the two surfaces as they are: of a face moved 2 mm towards the
 * scanner in its own frame, 2 mm times the cosine of the slope. */
TEST(test_field_gap)
{
    static struct surface_parts field;
    struct surface_face a = {0}, b = {0};
    uint32_t n = 0;

    faces_make(16, 0, &a);
    faces_build(&b);
    b.frame.pose.t[2] += 2;
    assert_int_equal(surface_parts(faces_work, &a, &b, &field), ST_OK);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(field.gap_mm[i]))
            continue;
        assert_true(field.gap_mm[i] > 0.3f && field.gap_mm[i] < 2.0001f);
        n += field.gap_mm[i] > 1.9f;
    }
    assert_true(n > 100); /* where the face looks to the front */
    face_free(&a);
    face_free(&b);
}

/* Of the template's own points, moved up 2 mm, those on the rim of a hole are covered too: one of
 * their triangles was measured. */
TEST(test_heatmap)
{
    static struct dvec3 pts[FACES_POINTS];
    static double gap[FACES_POINTS];
    const double up[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1};
    const double aside[16] = {1, 0, 0, 400, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const struct dvec3 odd[] = {
        {(double)NAN, 0, 0}, {0, (double)INFINITY, 0}, {0, 0, 1e9}};
    struct surface_face f = {0};
    size_t n = 0, rim = 0;

    faces_scan(15, 0, FACES_POINTS);
    for (size_t i = 0; i < faces_n; i++)
        if (hypot(faces_pts[i].x - 25, faces_pts[i].y) > 14)
            faces_pts[n++] = faces_pts[i];
    faces_n = n;
    faces_build(&f);
    for (uint32_t v = 0; v < f.surface.mesh.nv; v++)
        pts[v] = (struct dvec3){f.surface.mesh.xy[v].x / LATTICE_PER_MM,
                                f.surface.mesh.xy[v].y / LATTICE_PER_MM,
                                f.surface.mesh.z[v] / LATTICE_PER_MM};
    assert_int_equal(heatmap_gaps(&f.surface, pts, f.surface.mesh.nv, up, gap), ST_OK);
    for (uint32_t v = 0; v < f.surface.mesh.nv; v++) {
        bool bridged = false, measured = false;
        uint32_t h = f.surface.mesh.out[v];

        do {
            bridged |= f.surface.bridge[h / 3];
            measured |= !f.surface.bridge[h / 3];
            h = mesh_turn(&f.surface.mesh, h);
        } while (h != f.surface.mesh.out[v]);
        rim += bridged && measured;
        assert_true(measured ? fabs(gap[v] - 2) < 1e-9 : isnan(gap[v]));
    }
    assert_true(rim > 50);
    assert_int_equal(heatmap_gaps(&f.surface, pts, f.surface.mesh.nv, aside, gap), ST_OK);
    for (uint32_t v = 0; v < f.surface.mesh.nv; v++)
        assert_true(isnan(gap[v]));
    assert_int_equal(heatmap_gaps(&f.surface, odd, 3, up, gap), ST_OK);
    assert_true(isnan(gap[0]) && isnan(gap[1]) && isnan(gap[2]));
    face_free(&f);
}
