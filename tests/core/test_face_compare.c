/* Comparing faces: pose, disparity and score depend on the two faces alone, the decision on
 * these and the threshold. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "clouds.h"
#include "decision.h"
#include "draw.h"
#include "face.h"
#include "facegen.h"
#include "fail_alloc.h"
#include "heatmap.h"
#include "lattice.h"
#include "measure.h"
#include "minimal.h"
#include "model.h"
#include "tuning.h"

#define POINTS 3000

static struct face_work *work; /* one for the whole program: reuse is tested throughout */

static struct {
    size_t n;
    struct dvec3 pts[2 * POINTS];
} cloud;

static void scan(uint64_t subject, uint64_t number, size_t n)
{
    cloud.n = clouds_scan(subject, number, n, cloud.pts);
    assert_true(cloud.n > FACE_MIN_POINTS);
}

static void build(struct face *f)
{
    assert_int_equal(face_build(cloud.pts, cloud.n, work, f, NULL), ST_OK);
}

static void make(uint64_t subject, uint64_t number, struct face *f)
{
    scan(subject, number, POINTS);
    build(f);
}

/* Every number except the times. */
#define FIGURES (15 + 2 * GRID_REGIONS)

static void figures(const struct face_result *r, double x[FIGURES])
{
    const double one[15] = {
        r->score_mm,       r->threshold_mm,       r->fmr_at_score,  r->weight_overlap,
        r->change_mm,      (double)r->decision,   r->overlap,       r->align.evaluations,
        r->align.starts,   (double)r->align.stop, r->align.within,  r->align.cost_mm,
        r->align.rival_mm, r->align.turn_deg,     r->align.shift_mm};

    memcpy(x, one, sizeof one);
    memcpy(x + 15, r->region_mm, sizeof r->region_mm);
    memcpy(x + 15 + GRID_REGIONS, r->region_weight, sizeof r->region_weight);
}

/* Byte for byte. */
static void check_same_result(const struct face_result *a, const struct face_result *b)
{
    double x[FIGURES], y[FIGURES];

    figures(a, x);
    figures(b, y);
    assert_memory_equal(x, y, sizeof x);
    assert_memory_equal(a->align.transform, b->align.transform,
                        sizeof a->align.transform);
}

static void check_identity(const double t[16], double within)
{
    for (int i = 0; i < 16; i++)
        assert_true(fabs(t[i] - (i % 5 == 0)) < within);
}

/* A face compared with itself, and with itself moved. */
static void test_identity(void **state)
{
    struct face a = {0}, b = {0};
    struct minimal least;
    struct face_result r;
    double moved[16];

    (void)state;
    for (uint64_t k = 0; k < 5; k++) {
        double far = 0;

        make(k, 0, &a);
        assert_int_equal(face_compare(&a, &a, 0, NULL, work, &r), ST_OK);
        assert_int_equal(r.decision, FACE_MATCH);
        assert_true(r.score_mm < 0.001);
        assert_int_equal(face_minimal(&a, &a, r.align.transform, NULL, work, &least),
                         ST_OK);
        assert_true(least.disparity.plain_mm < 0.001);
        assert_true(r.overlap > 0.99);
        check_identity(r.align.transform, 0.005);

        clouds_move(cloud.pts, cloud.n, k, 5, 30, moved);
        build(&b);
        assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
        assert_int_equal(r.decision, FACE_MATCH);
        /* not 0: the moved points are triangulated differently */
        assert_true(r.score_mm < 0.12);
        for (size_t i = 0; i < cloud.n; i++) {
            const double *t = r.align.transform, *m = moved;
            const struct dvec3 q = cloud.pts[i];
            const double d[3] = {q.x - m[3], q.y - m[7], q.z - m[11]};

            for (int c = 0; c < 3; c++) {
                const double was = m[c] * d[0] + m[4 + c] * d[1] + m[8 + c] * d[2];
                const double now = t[4 * c] * q.x + t[4 * c + 1] * q.y +
                                   t[4 * c + 2] * q.z + t[4 * c + 3];

                far = fmax(far, fabs(now - was));
            }
        }
        assert_true(far < 0.3);
    }
    face_free(&a);
    face_free(&b);
}

/* The weighted disparity is that of the model's u at the template's surface, taken in its
 * canonical frame; the plain one has the same digits with and without a weight. */
static void test_weigh(void **state)
{
    struct measure_work m = {0};
    struct face a = {0}, b = {0};
    struct face_result r;
    struct minimal least, weighed;
    struct disparity plain;
    double sum = 0, weights = 0;

    (void)state;
    make(3, 0, &a);
    make(3, 1, &b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_int_equal(face_minimal(&a, &b, r.align.transform, NULL, work, &least), ST_OK);
    weighed = least;
    assert_int_equal(face_weigh(&a, &b, work, &weighed), ST_OK);
    assert_true(weighed.disparity.plain_mm == least.disparity.plain_mm);
    assert_int_equal(
        measure_at(&a.surface, &b.surface, least.transform, NULL, &m, &plain), ST_OK);
    for (uint32_t h = 0; h < 3 * m.general.nt; h += 3) {
        double gap[3], u[3], twice;

        if (mesh_is_ghost(&m.general, h / 3) ||
            disparity_kind(&m.general, m.vertex, h, &twice) != DISPARITY_COMMON)
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
            u[i] = cell == GRID_NONE ? 0 : (double)model_default.weight[cell];
        }
        sum += disparity_prism_weighted(twice, gap, u);
        weights += twice * (u[0] + u[1] + u[2]) / 3;
    }
    assert_true(fabs(weighed.disparity.weighted_mm - sum / weights) < 1e-9);
    assert_true(fabs(sum / weights - least.disparity.plain_mm) > 1e-3);
    measure_work_free(&m);
    face_free(&a);
    face_free(&b);
}

/* All mated scores are below all non-mated scores, and the decisions follow the threshold. */
static void test_mated_and_not(void **state)
{
    enum { SUBJECTS = 6 };
    struct face tmpl = {0}, probe = {0};
    double worst = 0, nearest = INFINITY;

    (void)state;
    for (uint64_t k = 0; k < SUBJECTS; k++) {
        make(k + 50, 0, &tmpl);
        for (uint64_t who = 0; who < SUBJECTS; who++) {
            struct face_result r;
            double moved[16];

            scan(who + 50, who + 1, POINTS);
            clouds_move(cloud.pts, cloud.n, who * 7 + k, 8, 10, moved);
            build(&probe);
            assert_int_equal(face_compare(&tmpl, &probe, 0, NULL, work, &r), ST_OK);
            assert_true(r.threshold_mm == model_default.decision.threshold_mm);
            assert_true(r.fmr_at_score ==
                        decision_fmr(&model_default.decision, r.score_mm));
            assert_true(r.align_ms == 0 && r.measure_ms == 0);
            if (who == k) {
                assert_int_equal(r.decision, FACE_MATCH);
                worst = fmax(worst, r.score_mm);
            } else {
                assert_int_equal(r.decision, r.score_mm <= r.threshold_mm
                                                 ? FACE_MATCH
                                                 : FACE_NO_MATCH);
                nearest = fmin(nearest, r.score_mm);
            }
        }
    }
    assert_true(worst < nearest);
    face_free(&tmpl);
    face_free(&probe);
}

/* Twice, in fresh memory, after other comparisons: the same bytes. */
static void test_determinism(void **state)
{
    struct face a = {0}, b = {0}, c = {0};
    struct face_result first, again;
    struct face_work *fresh = face_work_new(NULL);

    (void)state;
    assert_non_null(fresh);
    make(10, 0, &a);
    make(11, 0, &c);
    make(10, 1, &b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &first), ST_OK);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &again), ST_OK);
    check_same_result(&first, &again);
    assert_int_equal(face_compare(&c, &a, 0, NULL, work, &again), ST_OK);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &again), ST_OK);
    check_same_result(&first, &again);
    assert_int_equal(face_compare(&a, &b, 0, NULL, fresh, &again), ST_OK);
    check_same_result(&first, &again);
    face_work_free(fresh);
    face_work_free(NULL);
    face_free(&a);
    face_free(&b);
    face_free(&c);
}

/* The threshold changes the decision and nothing else. */
static void test_threshold(void **state)
{
    struct face a = {0}, b = {0};
    struct face_result usual, strict, loose, negative;

    (void)state;
    make(12, 0, &a);
    make(12, 1, &b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &usual), ST_OK);
    assert_int_equal(face_compare(&a, &b, 1e-6, NULL, work, &strict), ST_OK);
    assert_int_equal(face_compare(&a, &b, usual.score_mm, NULL, work, &loose), ST_OK);
    assert_int_equal(face_compare(&a, &b, -1, NULL, work, &negative), ST_OK);
    assert_int_equal(usual.decision, FACE_MATCH);
    assert_int_equal(strict.decision, FACE_NO_MATCH);
    assert_int_equal(loose.decision, FACE_MATCH); /* a score equal to it matches */
    assert_true(strict.threshold_mm == 1e-6);
    assert_true(loose.threshold_mm == usual.score_mm);
    assert_true(strict.score_mm == usual.score_mm);
    check_same_result(&usual, &negative);
    face_free(&a);
    face_free(&b);
}

static void add_noise(double mm)
{
    struct draw r = draw_stream(1, 2, 3);

    for (size_t i = 0; i < cloud.n; i++)
        cloud.pts[i].z += mm * draw_normal(&r);
}

/* The noise of both scans raises the threshold as far as their comparison is rough, and the
 * false match rate is told of the score less that.  A scan that only claims to be noisy gains
 * nothing. */
static void test_noise(void **state)
{
    const struct decision *d = &model_default.decision;
    struct face a = {0}, b = {0};
    struct face_result plain, claimed, noisy, back;

    (void)state;
    make(14, 0, &a);
    make(14, 1, &b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &plain), ST_OK);
    assert_true(plain.calibrated_mm == plain.score_mm);
    b.quality.noise_mm = 1;
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &claimed), ST_OK);
    assert_true(claimed.threshold_mm < d->threshold_mm + 0.003);

    scan(14, 1, POINTS);
    add_noise(0.9);
    build(&b);
    assert_true(b.quality.noise_mm > 0.6);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &noisy), ST_OK);
    assert_true(noisy.threshold_mm > d->threshold_mm + 0.01);
    assert_true(fabs(noisy.score_mm - noisy.calibrated_mm -
                     (noisy.threshold_mm - d->threshold_mm)) < 1e-12);
    assert_true(noisy.fmr_at_score == decision_fmr(d, noisy.calibrated_mm));
    assert_int_equal(face_compare(&b, &a, 0, NULL, work, &back), ST_OK);
    assert_true(back.threshold_mm >
                d->threshold_mm + 0.01); /* the template's counts too */
    assert_int_equal(face_compare(&a, &b, noisy.calibrated_mm, NULL, work, &back), ST_OK);
    assert_int_equal(back.decision, FACE_MATCH);
    assert_int_equal(face_compare(&a, &b, 0.6 * noisy.calibrated_mm, NULL, work, &back),
                     ST_OK);
    assert_int_equal(back.decision, FACE_NO_MATCH);
    face_free(&a);
    face_free(&b);
}

/* A broad smile that no model has learned: its owner matches for the upper part of the face,
 * with the rate of the threshold; nobody else does, and nobody of whom something is hidden. */
static void test_expression(void **state)
{
    const struct decision *d = &model_default.decision;
    struct face a = {0}, b = {0}, other = {0};
    struct facegen_scan smiling;
    struct face_result r;

    (void)state;
    facegen_default(&smiling);
    smiling.subject = 531;
    for (int i = 0; i < 2; i++) {
        smiling.scan = 3 * (uint64_t)i;
        smiling.smile = 3 * i;
        cloud.n = facegen_sample(&smiling, cloud.pts);
        build(i == 0 ? &a : &b);
    }
    make(532, 0, &other);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_MATCH);
    assert_true(r.score_mm > 1.1 * d->threshold_mm && r.score_mm < r.threshold_mm);
    assert_true(r.calibrated_mm == d->threshold_mm);
    assert_true(r.fmr_at_score == decision_fmr(d, d->threshold_mm));
    assert_int_equal(face_compare(&a, &b, 0.5 * r.score_mm, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_NO_MATCH); /* too far above that threshold */
    assert_int_equal(face_compare(&other, &b, 0, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_NO_MATCH);
    b.hidden = 0.1;
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_true(r.decision != FACE_MATCH && r.threshold_mm < d->threshold_mm);
    face_free(&a);
    face_free(&b);
    face_free(&other);
}

/* Where a part of the probe's face is hidden the threshold is lower, and what is not far above
 * it inconclusive; the template's share does not count, it is not stored. */
static void test_hidden(void **state)
{
    const struct decision *d = &model_default.decision;
    struct face a = {0}, b = {0};
    struct face_result plain, hidden, r;
    double t;

    (void)state;
    make(15, 0, &a);
    make(15, 1, &b);
    assert_true(b.hidden == 0);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &plain), ST_OK);
    a.hidden = 0.4;
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    check_same_result(&plain, &r);
    b.hidden = 0.4;
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &hidden), ST_OK);
    assert_true(hidden.score_mm == plain.score_mm);
    assert_true(hidden.threshold_mm < 0.85 * d->threshold_mm);
    assert_true(fabs(hidden.calibrated_mm / d->threshold_mm -
                     hidden.score_mm / hidden.threshold_mm) < 1e-12);
    assert_true(hidden.fmr_at_score == decision_fmr(d, hidden.calibrated_mm));
    assert_int_equal(hidden.decision, FACE_MATCH);

    t = hidden.calibrated_mm;
    assert_int_equal(face_compare(&a, &b, 1.001 * t, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_MATCH);
    assert_int_equal(face_compare(&a, &b, 0.999 * t, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_INCONCLUSIVE);
    assert_true(r.comparable);
    assert_int_equal(face_compare(&a, &b, 0.7 * t, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_INCONCLUSIVE);
    assert_int_equal(face_compare(&a, &b, 0.6 * t, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_NO_MATCH);
    build(&b); /* it is what other points show */
    assert_true(b.hidden == 0);
    face_free(&a);
    face_free(&b);
}

/* What is left of a result that is rounded depends on the rounded score alone: scores that are
 * told the same have the same rate. */
static void check_rounding(const struct face_result *r)
{
    struct face_result one = *r, other = *r;
    const double told = round(r->score_mm * 1e3) / 1e3;

    other.score_mm = told + (r->score_mm > told ? -4e-4 : 4e-4);
    other.calibrated_mm = NAN;
    other.fmr_at_score = NAN;
    other.overlap += 1e-4;
    face_round(&one, work);
    face_round(&other, work);
    assert_true(one.score_mm == told && other.score_mm == told);
    assert_true(one.overlap == round(r->overlap * 100) / 100);
    assert_true(one.fmr_at_score == other.fmr_at_score);
    assert_true(one.fmr_at_score ==
                decision_fmr(&model_default.decision, one.calibrated_mm));
    assert_true(one.decision == r->decision);
    assert_true(one.threshold_mm >= r->threshold_mm &&
                one.threshold_mm < r->threshold_mm + 0.001);
}

/* Whatever the threshold and the score, the numbers told agree with the decision and are hardly
 * off; and the rate tells no more of the threshold's rise, which follows the roughness, than
 * the threshold told. */
static void check_agreement(struct face_result r)
{
    const double t = r.threshold_mm - r.rise_mm;

    for (int k = -30; k < 60; k++) {
        struct face_result last = {.threshold_mm = 0};

        r.score_mm = t + k * 0.0001 + 0.00005;
        for (int i = 0; i < 40; i++) {
            struct face_result told = r, again;

            told.rise_mm = 0.0001 + i * 0.0002;
            told.threshold_mm = t + told.rise_mm;
            face_round(&told, work);
            assert_int_equal(told.score_mm <= told.threshold_mm, k <= 2 * i);
            assert_true(fabs(told.score_mm - r.score_mm) < 0.002);
            assert_true(told.threshold_mm == round(told.threshold_mm * 1e3) / 1e3);
            if (told.score_mm == last.score_mm && told.threshold_mm == last.threshold_mm)
                assert_true(fabs(told.fmr_at_score - last.fmr_at_score) <
                            1e-12 * last.fmr_at_score);
            last = again = told;
            face_round(&again, work); /* once more changes nothing */
            assert_true(again.score_mm == told.score_mm &&
                        again.threshold_mm == told.threshold_mm);
        }
    }
}

static void test_round(void **state)
{
    struct face a = {0}, b = {0};
    struct face_result r, rounded;

    (void)state;
    make(14, 0, &a);
    make(14, 1, &b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    check_rounding(&r);
    rounded = r;
    face_round(&rounded, work);
    assert_true(rounded.fmr_at_score != r.fmr_at_score);
    assert_true(rounded.fmr_at_score ==
                decision_fmr(&model_default.decision, rounded.score_mm));
    b.hidden = 0.4;
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_true(r.factor < 1);
    check_rounding(&r);
    scan(14, 1, POINTS);
    add_noise(0.9);
    build(&b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_true(r.rise_mm > 0);
    check_rounding(&r);
    check_agreement(r);
    r.factor = 0; /* the rate does not depend on the score */
    rounded = r;
    face_round(&rounded, work);
    assert_true(rounded.fmr_at_score == r.fmr_at_score);
    face_free(&a);
    face_free(&b);
}

/* A mirrored scan scores as the scan that it is the mirror image of, up to the triangulation
 * and the pose found; the scan itself stays as it is. */
static void test_mirrored(void **state)
{
    struct face a = {0}, b = {0}, m = {0};
    struct face_result plain, as_is, mirrored, again;

    (void)state;
    for (uint64_t k = 20; k < 24; k++) {
        make(k, 0, &a);
        make(k, 1, &b);
        for (size_t i = 0; i < cloud.n; i++)
            cloud.pts[i].x = -cloud.pts[i].x;
        build(&m);
        m.hidden = 0.4;
        assert_int_equal(face_compare(&a, &b, 0, NULL, work, &plain), ST_OK);
        assert_int_equal(face_compare(&a, &m, 0, NULL, work, &as_is), ST_OK);
        assert_int_equal(face_compare_mirrored(&a, &m, NULL, work, &mirrored), ST_OK);
        print_message("%.4f, mirrored %.4f, back %.4f mm\n", plain.score_mm,
                      as_is.score_mm, mirrored.score_mm);
        assert_true(fabs(mirrored.score_mm - plain.score_mm) < 0.02 * plain.score_mm);
        assert_true(mirrored.score_mm < as_is.score_mm);
        assert_true(mirrored.threshold_mm < plain.threshold_mm); /* hidden too */
        assert_int_equal(face_compare_mirrored(&a, &m, NULL, work, &again), ST_OK);
        check_same_result(&mirrored, &again);
        assert_int_equal(face_compare(&a, &m, 0, NULL, work, &again), ST_OK);
        check_same_result(&as_is, &again);
    }
    face_free(&a);
    face_free(&b);
    face_free(&m);
}

/* A probe of a small part of the face is inconclusive. */
static void test_inconclusive(void **state)
{
    struct face a = {0}, b = {0};
    struct face_result r;
    size_t n = 0;

    (void)state;
    make(13, 0, &a);
    scan(13, 1, 2 * POINTS);
    for (size_t i = 0; i < cloud.n; i++)
        if (fabs(cloud.pts[i].x) < 14 && fabs(cloud.pts[i].y) < 36)
            cloud.pts[n++] = cloud.pts[i];
    cloud.n = n;
    build(&b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_true(r.overlap < DECISION_MIN_OVERLAP);
    assert_int_equal(r.decision, FACE_INCONCLUSIVE);
    assert_int_equal(face_compare(&a, &b, 1000, NULL, work, &r), ST_OK);
    assert_int_equal(r.decision, FACE_INCONCLUSIVE); /* whatever the threshold */
    face_free(&a);
    face_free(&b);
}

static double ticking(void)
{
    static double now = 100;

    return now += 2.5;
}

static void test_clock(void **state)
{
    struct face a = {0};
    struct face_result r, without;

    (void)state;
    make(14, 0, &a);
    assert_int_equal(face_compare(&a, &a, 0, ticking, work, &r), ST_OK);
    assert_true(r.align_ms == 2.5 && r.measure_ms == 2.5);
    assert_int_equal(face_compare(&a, &a, 0, NULL, work, &without), ST_OK);
    check_same_result(&r, &without);
    face_free(&a);
}

/* The values per cell add up to the score that was decided on. */
static void test_field(void **state)
{
    static struct face_field field;
    struct face a = {0}, b[2];

    (void)state;
    memset(b, 0, sizeof b);
    make(16, 0, &a);
    make(16, 1, &b[0]);
    make(17, 0, &b[1]);
    for (int k = 0; k < 2; k++) {
        struct face_result r;
        double weight = 0, score = 0, taken = 0;
        size_t n = 0;

        assert_int_equal(face_compare(&a, &b[k], 0, NULL, work, &r), ST_OK);
        assert_int_equal(face_field(&a, &b[k], r.align.transform, work, &field), ST_OK);
        for (uint32_t i = 0; i < GRID_N; i++) {
            const double d = (double)field.gap_mm[i] - (double)field.rest_mm[i];

            if (field.weight[i] <= 0)
                continue;
            weight += (double)field.weight[i];
            score += (double)field.weight[i] * (double)field.local_mm[i];
            taken += d * d;
            n++;
        }
        assert_true(n > 500);
        assert_true(fabs(weight - 1) < 1e-5);
        assert_true(fabs(score - r.score_mm) < 1e-5);
        assert_true(fabs(sqrt(taken / (double)n) - r.change_mm) < 0.02 * r.change_mm);
        face_free(&b[k]);
    }
    face_free(&a);
}

static void test_heatmap(void **state)
{
    static double gap[2 * POINTS];
    const double up[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1};
    const double aside[16] = {1, 0, 0, 400, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const struct dvec3 odd[] = {
        {(double)NAN, 0, 0}, {0, (double)INFINITY, 0}, {0, 0, 1e9}};
    struct face a = {0};
    size_t seen = 0;

    (void)state;
    make(15, 0, &a);
    assert_int_equal(heatmap_gaps(&a.surface, cloud.pts, cloud.n, up, gap), ST_OK);
    for (size_t i = 0; i < cloud.n; i++) {
        if (isnan(gap[i]))
            continue;
        seen++; /* 2 mm at the template's own points, except at flattened spikes */
        assert_true(fabs(gap[i] - 2) < 0.0021 || fabs(gap[i] - 2) > 0.9);
    }
    assert_true(seen > cloud.n * 9 / 10);
    assert_int_equal(heatmap_gaps(&a.surface, cloud.pts, cloud.n, aside, gap), ST_OK);
    for (size_t i = 0; i < cloud.n; i++)
        assert_true(isnan(gap[i]));
    assert_int_equal(heatmap_gaps(&a.surface, odd, 3, up, gap), ST_OK);
    for (size_t i = 0; i < 3; i++)
        assert_true(isnan(gap[i]));
    face_free(&a);
}

/* The points on the rim of a hole are covered: one of their triangles was measured. */
static void test_heatmap_rim(void **state)
{
    static struct dvec3 pts[POINTS];
    static double gap[POINTS];
    const double still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct face f = {0};
    size_t n = 0, rim = 0;

    (void)state;
    scan(15, 0, POINTS);
    for (size_t i = 0; i < cloud.n; i++)
        if (hypot(cloud.pts[i].x - 25, cloud.pts[i].y) > 14)
            cloud.pts[n++] = cloud.pts[i];
    cloud.n = n;
    build(&f);
    for (uint32_t v = 0; v < f.surface.mesh.nv; v++)
        pts[v] = (struct dvec3){f.surface.mesh.xy[v].x / LATTICE_PER_MM,
                                f.surface.mesh.xy[v].y / LATTICE_PER_MM,
                                f.surface.mesh.z[v] / LATTICE_PER_MM};
    assert_int_equal(heatmap_gaps(&f.surface, pts, f.surface.mesh.nv, still, gap), ST_OK);
    for (uint32_t v = 0; v < f.surface.mesh.nv; v++) {
        bool bridged = false, measured = false;
        uint32_t h = f.surface.mesh.out[v];

        do {
            bridged |= f.surface.bridge[h / 3];
            measured |= !f.surface.bridge[h / 3];
            h = mesh_turn(&f.surface.mesh, h);
        } while (h != f.surface.mesh.out[v]);
        rim += bridged && measured;
        assert_true(measured ? gap[v] == 0 : isnan(gap[v]));
    }
    assert_true(rim > 50);
    face_free(&f);
}

static void test_no_memory(void **state)
{
    struct face want = {0}, b = {0};
    struct face_result plain, r;
    enum status st = ST_ENOMEM;
    unsigned long k;

    (void)state;
    make(18, 1, &b);
    make(18, 0, &want);
    assert_int_equal(face_compare(&want, &b, 0, NULL, work, &plain), ST_OK);
    for (k = 1; st != ST_OK; k++) {
        struct face_work *w = face_work_new(NULL);

        assert_non_null(w);
        fail_alloc_at(k);
        st = face_compare(&want, &b, 0, NULL, w, &r);
        if (st != ST_OK) {
            assert_int_equal(st, ST_ENOMEM);
            assert_int_equal(face_compare(&want, &b, 0, NULL, w, &r), ST_OK);
        }
        check_same_result(&plain, &r);
        fail_alloc_at(0);
        assert_int_equal(face_compare(&want, &b, 0, NULL, w, &r), ST_OK);
        assert_int_equal(fail_alloc_count(), 0); /* the steady state allocates nothing */
        face_work_free(w);
    }
    assert_true(k > 4);
    face_free(&want);
    face_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_identity),      cmocka_unit_test(test_weigh),
        cmocka_unit_test(test_mated_and_not), cmocka_unit_test(test_determinism),
        cmocka_unit_test(test_threshold),     cmocka_unit_test(test_inconclusive),
        cmocka_unit_test(test_clock),         cmocka_unit_test(test_field),
        cmocka_unit_test(test_heatmap),       cmocka_unit_test(test_heatmap_rim),
        cmocka_unit_test(test_noise),         cmocka_unit_test(test_hidden),
        cmocka_unit_test(test_round),         cmocka_unit_test(test_expression),
        cmocka_unit_test(test_mirrored),      cmocka_unit_test(test_no_memory),
    };
    int failed;

    if ((work = face_work_new(NULL)) == NULL)
        return 1;
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    face_work_free(work);
    return failed;
}
