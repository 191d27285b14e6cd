/* Face models: what is accepted and refused, and that comparing them depends on the two
 * models alone. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "brute.h"
#include "clouds.h"
#include "decision.h"
#include "face.h"
#include "facegen.h"
#include "fail_alloc.h"
#include "lattice.h"
#include "model.h"
#include "mst.h"

#define POINTS 3000

static struct face_work *work; /* one for the whole program: reuse is tested throughout */

struct cloud {
    size_t n;
    struct dvec3 pts[2 * POINTS];
};

static struct cloud cloud, other;

static void scan(uint64_t subject, uint64_t number, size_t n, struct cloud *c)
{
    c->n = clouds_scan(subject, number, n, c->pts);
    assert_true(c->n > FACE_MIN_POINTS);
}

static enum status build(const struct cloud *c, struct face *f)
{
    size_t bad;

    return face_build(c->pts, c->n, work, f, &bad);
}

static void make(uint64_t subject, uint64_t number, struct face *f)
{
    scan(subject, number, POINTS, &cloud);
    assert_int_equal(build(&cloud, f), ST_OK);
}

static void check_same_model(const struct face *a, const struct face *b)
{
    const struct mesh *m = &a->mesh, *k = &b->mesh;
    const size_t nv = m->nv, halves = 3 * (size_t)m->nt;

    assert_int_equal(m->nv, k->nv);
    assert_int_equal(m->nt, k->nt);
    assert_memory_equal(m->xy, k->xy, nv * sizeof *m->xy);
    assert_memory_equal(m->z, k->z, nv * sizeof *m->z);
    assert_memory_equal(m->org, k->org, halves * sizeof *m->org);
    assert_memory_equal(m->twin, k->twin, halves * sizeof *m->twin);
    assert_memory_equal(m->parent, k->parent, nv * sizeof *m->parent);
    assert_memory_equal(a->spacing, b->spacing, nv * sizeof *a->spacing);
    assert_memory_equal(a->bridge, b->bridge, m->nt);
    assert_memory_equal(a->raw, b->raw, nv * sizeof *a->raw);
    assert_memory_equal(&a->measured, &b->measured, sizeof a->measured);
}

static void check_same_quality(const struct face_quality *a, const struct face_quality *b)
{
    assert_memory_equal(a, b, sizeof *a); /* doubles alone: no padding */
}

/* Every figure but the clock's. */
#define FIGURES (24 + 2 * GRID_REGIONS)

static void figures(const struct face_result *r, double x[FIGURES])
{
    const struct disparity *m = &r->measure;
    const double one[24] = {r->disparity_mm,
                            r->threshold_mm,
                            r->fmr_at_score,
                            r->weight_overlap,
                            r->change_mm,
                            (double)r->decision,
                            m->volume_mm3,
                            m->area_mm2,
                            m->plain_mm,
                            m->weighted_mm,
                            m->overlap,
                            m->bridged_mm2,
                            m->outside_mm2,
                            m->cells,
                            m->bridged,
                            m->outside,
                            r->align.evaluations,
                            r->align.starts,
                            (double)r->align.stop,
                            r->align.within,
                            r->align.cost_mm,
                            r->align.rival_mm,
                            r->align.turn_deg,
                            r->align.shift_mm};

    memcpy(x, one, sizeof one);
    memcpy(x + 24, r->region_mm, sizeof r->region_mm);
    memcpy(x + 24 + GRID_REGIONS, r->region_weight, sizeof r->region_weight);
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

static void check_model(const struct face *f)
{
    const struct face_quality *q = &f->quality;

    assert_int_equal(mesh_check(&f->mesh, true), ST_OK);
    assert_int_equal(mst_check(&f->mesh), ST_OK);
    assert_true(q->score > 0 && q->score <= 1);
    assert_true(q->coverage > 0 && q->coverage <= 1);
    assert_true(q->density_mm > 0.2 && q->density_mm < 10);
    assert_true(q->noise_mm >= 0 && q->noise_mm < 3);
    assert_true(f->measured > 0);
}

/* Scans good and not so good, small and large: all are accepted. */
static void test_accepted(void **state)
{
    struct face f = {0};

    (void)state;
    for (uint64_t k = 0; k < 40; k++) {
        struct facegen_scan s;

        facegen_default(&s);
        s.subject = k;
        s.scan = k + 100;
        s.points = k % 4 == 3 ? 600 : k % 4 == 2 ? 2 * POINTS : POINTS;
        facegen_pose(&s, 15, 60);
        s.noise = 0.1 + 0.1 * (double)(k % 5);
        s.holes = k % 3 == 1 ? 0.2 : 0;
        s.spikes = k % 5 == 2 ? 0.02 : 0;
        s.smile = (double)(k % 2);
        cloud.n = facegen_sample(&s, cloud.pts);
        assert_int_equal(build(&cloud, &f), ST_OK);
        assert_true(f.mesh.nv <= cloud.n && f.mesh.nv > cloud.n - 5);
        check_model(&f);
    }
    face_free(&f);
    face_free(NULL);
    face_free(&f);
}

/* The estimate of the noise follows the noise; more holes, less coverage. */
static void test_quality(void **state)
{
    double noise[4], coverage[3];
    struct face f = {0};

    (void)state;
    for (int k = 0; k < 4; k++) {
        struct facegen_scan s;

        facegen_default(&s);
        s.subject = 5;
        s.noise = 0.1 * (1 << k);
        cloud.n = facegen_sample(&s, cloud.pts);
        assert_int_equal(build(&cloud, &f), ST_OK);
        noise[k] = f.quality.noise_mm;
        assert_true(noise[k] > 0.6 * s.noise && noise[k] < 2.5 * s.noise);
        assert_true(k == 0 || noise[k] > noise[k - 1]);
    }
    for (int k = 0; k < 3; k++) {
        struct facegen_scan s;

        facegen_default(&s);
        s.subject = 5;
        s.holes = 0.25 * k;
        cloud.n = facegen_sample(&s, cloud.pts);
        assert_int_equal(build(&cloud, &f), ST_OK);
        coverage[k] = f.quality.coverage;
        assert_true(k == 0 || coverage[k] < coverage[k - 1] - 0.05);
    }
    face_free(&f);
}

static void refused(const struct cloud *c, enum status want)
{
    struct face f = {0};

    assert_int_equal(build(c, &f), want);
    assert_int_equal(f.mesh.nv, 0);
    face_free(&f);
    make(1, 1, &f); /* a former face, and memory that is used again */
    assert_int_equal(build(c, &f), want);
    assert_int_equal(f.mesh.nv, 0);
    scan(1, 1, POINTS, &other);
    assert_int_equal(build(&other, &f), ST_OK); /* none the worse for it */
    check_model(&f);
    face_free(&f);
}

static void test_too_few(void **state)
{
    static struct cloud c;

    (void)state;
    scan(1, 2, POINTS, &c);
    for (c.n = 0; c.n < FACE_MIN_POINTS; c.n += 33)
        refused(&c, ST_ETOOFEW);
    c.n = FACE_MIN_POINTS - 1;
    refused(&c, ST_ETOOFEW);
    scan(1, 2, POINTS, &c);
    for (size_t i = 60; i < c.n; i++) /* many points, but at 60 places */
        c.pts[i] = c.pts[i % 60];
    refused(&c, ST_ETOOFEW);
}

static void test_not_finite(void **state)
{
    static const double wrong[] = {(double)NAN, (double)INFINITY, -(double)INFINITY,
                                   1e300};
    static struct cloud c;

    (void)state;
    for (int k = 0; k < 4; k++)
        for (int axis = 0; axis < 3; axis++) {
            struct face f = {0};
            size_t bad = 0;

            scan(2, 3, POINTS, &c);
            *(axis == 0   ? &c.pts[777].x
              : axis == 1 ? &c.pts[777].y
                          : &c.pts[777].z) = wrong[k];
            assert_int_equal(face_build(c.pts, c.n, work, &f, &bad),
                             k < 3 ? ST_ENOTFINITE : ST_ERANGE);
            assert_int_equal(bad, 777);
            assert_int_equal(face_build(c.pts, c.n, work, &f, NULL),
                             k < 3 ? ST_ENOTFINITE : ST_ERANGE);
            face_free(&f);
        }
}

static void test_limit(void **state)
{
    struct face f = {0};

    (void)state; /* refused before any point is looked at */
    assert_int_equal(face_build(cloud.pts, (size_t)MESH_MAX_POINTS + 1, work, &f, NULL),
                     ST_ELIMIT);
    assert_int_equal(face_build(cloud.pts, SIZE_MAX, work, &f, NULL), ST_ELIMIT);
    face_free(&f);
}

static void test_degenerate(void **state)
{
    static struct cloud c;

    (void)state;
    c.n = 500;
    for (size_t i = 0; i < c.n; i++)
        c.pts[i] = (struct dvec3){0.25 * (double)i, 0.5 * (double)i, sin((double)i)};
    refused(&c, ST_EDEGENERATE);
    for (size_t i = 0; i < c.n; i++)
        c.pts[i] = (struct dvec3){1, 2, 3};
    refused(&c, ST_EDEGENERATE);
}

static void test_units(void **state)
{
    static const double scale[] = {0.25, 5.5, 0.001, 0.1, 10};
    static struct cloud c;

    (void)
        state; /* 40 mm, 900 mm, metres and centimetres said to be mm, a tenth of a mm */
    for (size_t k = 0; k < sizeof scale / sizeof scale[0]; k++) {
        scan(3, 4, POINTS, &c);
        for (size_t i = 0; i < c.n; i++) {
            c.pts[i].x *= scale[k];
            c.pts[i].y *= scale[k];
            c.pts[i].z *= scale[k];
        }
        refused(&c, ST_EUNITS);
    }
}

/* Surfaces that are no face: planes, flat or tilted, with and without noise. */
static void test_not_face(void **state)
{
    static struct cloud c;
    struct brute_rng r = {brute_seed("planes")};

    (void)state;
    for (int k = 0; k < 6; k++) {
        scan(4, 5, POINTS, &c);
        for (size_t i = 0; i < c.n; i++)
            c.pts[i].z = (k % 3) * 0.3 * c.pts[i].x - (k % 2) * 0.4 * c.pts[i].y +
                         (k > 2) * (brute_real(&r) - 0.5);
        refused(&c, ST_ENOTFACE);
    }
}

static void test_noise(void **state)
{
    static struct cloud c;
    struct brute_rng r = {brute_seed("noise")};

    (void)state;
    scan(4, 6, POINTS, &c);
    for (size_t i = 0; i < c.n; i++)
        c.pts[i].z += 30 * (brute_real(&r) - 0.5);
    refused(&c, ST_EQUALITY);
}

/* Single points thrown far off are laid flat: the scan compares as if it had none. */
static void test_spikes(void **state)
{
    static struct cloud clean, spiky;
    struct brute_rng r = {brute_seed("spikes")};
    struct face a = {0}, b = {0}, c = {0};
    struct face_result plain, spikes;
    uint32_t laid = 0;

    (void)state;
    make(6, 0, &c);
    scan(6, 1, POINTS, &clean);
    spiky = clean;
    for (size_t i = 0; i < spiky.n; i += 60)
        spiky.pts[i].z += (i % 120 == 0 ? 1 : -1) * (10 + 20 * brute_real(&r));
    assert_int_equal(build(&clean, &a), ST_OK);
    assert_int_equal(build(&spiky, &b), ST_OK);
    assert_int_equal(a.mesh.nv, b.mesh.nv);
    for (uint32_t v = 0; v < b.mesh.nv; v++) {
        laid += b.raw[v] != b.mesh.z[v];
        if (abs(b.raw[v] - a.raw[v]) >
            8000) /* a spike: its height is near the true one */
            assert_true(abs(b.mesh.z[v] - a.mesh.z[v]) < 6000);
    }
    assert_true(laid >= 45 && laid < 80);
    assert_int_equal(face_compare(&c, &a, 0, NULL, work, &plain), ST_OK);
    assert_int_equal(face_compare(&c, &b, 0, NULL, work, &spikes), ST_OK);
    assert_true(fabs(plain.disparity_mm - spikes.disparity_mm) < 0.03);
    face_free(&a);
    face_free(&b);
    face_free(&c);
}

static void test_permutation(void **state)
{
    struct brute_rng r = {brute_seed("permutation")};
    struct face a = {0}, b = {0};

    (void)state;
    make(7, 0, &a);
    for (int k = 0; k < 4; k++) {
        for (size_t i = cloud.n; i-- > 1;) {
            const size_t j = brute_rand(&r) % (i + 1);
            const struct dvec3 t = cloud.pts[i];

            cloud.pts[i] = cloud.pts[j];
            cloud.pts[j] = t;
        }
        assert_int_equal(build(&cloud, &b), ST_OK);
        check_same_model(&a, &b);
        check_same_quality(&a.quality, &b.quality);
    }
    face_free(&a);
    face_free(&b);
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
    struct face_result r;
    double moved[16];

    (void)state;
    for (uint64_t k = 0; k < 5; k++) {
        double far = 0;

        make(k, 0, &a);
        assert_int_equal(face_compare(&a, &a, 0, NULL, work, &r), ST_OK);
        assert_int_equal(r.decision, FACE_MATCH);
        assert_true(r.disparity_mm < 0.001);
        assert_true(r.measure.plain_mm < 0.001);
        assert_true(r.measure.overlap > 0.99);
        check_identity(r.align.transform, 0.005);

        clouds_move(cloud.pts, cloud.n, k, 5, 30, moved);
        assert_int_equal(build(&cloud, &b), ST_OK);
        assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
        assert_int_equal(r.decision, FACE_MATCH);
        assert_true(r.disparity_mm < 0.12); /* another triangulation of the same points */
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

/* The same person's scans are nearer than anybody else's, and the decision says so. */
static void test_people(void **state)
{
    enum { PEOPLE = 6 };
    struct face tmpl = {0}, probe = {0};
    double worst = 0, nearest = INFINITY;

    (void)state;
    for (uint64_t k = 0; k < PEOPLE; k++) {
        make(k + 50, 0, &tmpl);
        for (uint64_t who = 0; who < PEOPLE; who++) {
            struct face_result r;
            double moved[16];

            scan(who + 50, who + 1, POINTS, &cloud);
            clouds_move(cloud.pts, cloud.n, who * 7 + k, 8, 10, moved);
            assert_int_equal(build(&cloud, &probe), ST_OK);
            assert_int_equal(face_compare(&tmpl, &probe, 0, NULL, work, &r), ST_OK);
            assert_true(r.threshold_mm == model_default.decision.threshold_mm);
            assert_true(r.fmr_at_score ==
                        decision_fmr(&model_default.decision, r.disparity_mm));
            assert_true(r.measure.plain_mm == r.measure.weighted_mm);
            assert_true(r.align_ms == 0 && r.measure_ms == 0);
            if (who == k) {
                assert_int_equal(r.decision, FACE_MATCH);
                worst = fmax(worst, r.disparity_mm);
            } else {
                assert_int_equal(r.decision, r.disparity_mm <= r.threshold_mm
                                                 ? FACE_MATCH
                                                 : FACE_NO_MATCH);
                nearest = fmin(nearest, r.disparity_mm);
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

/* The threshold decides, nothing else changes. */
static void test_threshold(void **state)
{
    struct face a = {0}, b = {0};
    struct face_result usual, strict, loose, negative;

    (void)state;
    make(12, 0, &a);
    make(12, 1, &b);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &usual), ST_OK);
    assert_int_equal(face_compare(&a, &b, 1e-6, NULL, work, &strict), ST_OK);
    assert_int_equal(face_compare(&a, &b, usual.disparity_mm, NULL, work, &loose), ST_OK);
    assert_int_equal(face_compare(&a, &b, -1, NULL, work, &negative), ST_OK);
    assert_int_equal(usual.decision, FACE_MATCH);
    assert_int_equal(strict.decision, FACE_NO_MATCH);
    assert_int_equal(loose.decision, FACE_MATCH); /* at the threshold is below it */
    assert_true(strict.threshold_mm == 1e-6);
    assert_true(loose.threshold_mm == usual.disparity_mm);
    assert_true(strict.disparity_mm == usual.disparity_mm);
    check_same_result(&usual, &negative);
    face_free(&a);
    face_free(&b);
}

/* A probe that shows a small part of the face says nothing. */
static void test_inconclusive(void **state)
{
    struct face a = {0}, b = {0};
    struct face_result r;
    size_t n = 0;

    (void)state;
    make(13, 0, &a);
    scan(13, 1, 2 * POINTS, &cloud);
    for (size_t i = 0; i < cloud.n; i++)
        if (fabs(cloud.pts[i].x) < 14 && fabs(cloud.pts[i].y) < 36)
            cloud.pts[n++] = cloud.pts[i];
    cloud.n = n;
    assert_int_equal(build(&cloud, &b), ST_OK);
    assert_int_equal(face_compare(&a, &b, 0, NULL, work, &r), ST_OK);
    assert_true(r.measure.overlap < decision_min_overlap);
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
    face_heatmap(&a, cloud.pts, cloud.n, up, gap);
    for (size_t i = 0; i < cloud.n; i++) {
        if (isnan(gap[i]))
            continue;
        seen++; /* on the template's own points, but for those laid flat */
        assert_true(fabs(gap[i] - 2) < 0.0021 || fabs(gap[i] - 2) > 0.9);
    }
    assert_true(seen > cloud.n * 9 / 10);
    face_heatmap(&a, cloud.pts, cloud.n, aside, gap);
    for (size_t i = 0; i < cloud.n; i++)
        assert_true(isnan(gap[i]));
    face_heatmap(&a, odd, 3, up, gap);
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
    scan(15, 0, POINTS, &cloud);
    for (size_t i = 0; i < cloud.n; i++)
        if (hypot(cloud.pts[i].x - 25, cloud.pts[i].y) > 14)
            cloud.pts[n++] = cloud.pts[i];
    cloud.n = n;
    assert_int_equal(build(&cloud, &f), ST_OK);
    for (uint32_t v = 0; v < f.mesh.nv; v++)
        pts[v] =
            (struct dvec3){f.mesh.xy[v].x / LATTICE_PER_MM,
                           f.mesh.xy[v].y / LATTICE_PER_MM, f.mesh.z[v] / LATTICE_PER_MM};
    face_heatmap(&f, pts, f.mesh.nv, still, gap);
    for (uint32_t v = 0; v < f.mesh.nv; v++) {
        bool bridged = false, measured = false;
        uint32_t h = f.mesh.out[v];

        do {
            bridged |= f.bridge[h / 3];
            measured |= !f.bridge[h / 3];
            h = mesh_turn(&f.mesh, h);
        } while (h != f.mesh.out[v]);
        rim += bridged && measured;
        assert_true(measured ? gap[v] == 0 : isnan(gap[v]));
    }
    assert_true(rim > 50);
    face_free(&f);
}

/* A model from its stored parts is the model that was stored. */
static void test_adopt(void **state)
{
    struct face a = {0}, b = {0};
    struct mesh *m = &b.mesh;

    (void)state;
    make(16, 0, &a);
    for (int damaged = 0; damaged < 2; damaged++) {
        assert_int_equal(mesh_copy(m, &a.mesh, 0), ST_OK);
        memcpy(m->z, a.raw, m->nv * sizeof *m->z);
        memset(m->twin, 0xff, 3 * (size_t)m->nt * sizeof *m->twin);
        memset(m->out, 0xff, ((size_t)m->nv + 1) * sizeof *m->out);
        if (damaged) {
            m->org[17] = m->org[18];
            assert_int_equal(face_adopt(&b, work), ST_ECORRUPT);
            assert_int_equal(m->nv, 0);
        } else {
            assert_int_equal(face_adopt(&b, work), ST_OK);
            assert_int_equal(mesh_check(m, true), ST_OK);
            assert_memory_equal(a.raw, b.raw, m->nv * sizeof *a.raw);
            assert_memory_equal(a.bridge, b.bridge, m->nt);
        }
    }
    face_free(&a);
    face_free(&b);
}

static void test_no_memory(void **state)
{
    struct face want = {0}, b = {0};
    struct face_result plain, r;
    enum status st = ST_ENOMEM;
    unsigned long k;

    (void)state;
    fail_alloc_at(1);
    assert_null(face_work_new(NULL));
    make(18, 1, &b);
    make(18, 0, &want);
    assert_int_equal(face_compare(&want, &b, 0, NULL, work, &plain), ST_OK);
    for (k = 1; st != ST_OK; k++) {
        struct face_work *w = face_work_new(NULL);
        struct face f = {0};

        assert_non_null(w);
        fail_alloc_at(k);
        st = face_build(cloud.pts, cloud.n, w, &f, NULL);
        if (st != ST_OK) {
            assert_int_equal(st, ST_ENOMEM);
            assert_int_equal(f.mesh.nv, 0);
            assert_int_equal(face_build(cloud.pts, cloud.n, w, &f, NULL), ST_OK);
        }
        fail_alloc_at(0);
        check_same_model(&want, &f);
        face_free(&f);
        face_work_free(w);
    }
    assert_true(k > 4);
    for (st = ST_ENOMEM, k = 1; st != ST_OK; k++) {
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
        cmocka_unit_test(test_accepted),    cmocka_unit_test(test_quality),
        cmocka_unit_test(test_too_few),     cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_limit),       cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_units),       cmocka_unit_test(test_not_face),
        cmocka_unit_test(test_noise),       cmocka_unit_test(test_spikes),
        cmocka_unit_test(test_permutation), cmocka_unit_test(test_identity),
        cmocka_unit_test(test_people),      cmocka_unit_test(test_determinism),
        cmocka_unit_test(test_threshold),   cmocka_unit_test(test_inconclusive),
        cmocka_unit_test(test_clock),       cmocka_unit_test(test_heatmap),
        cmocka_unit_test(test_heatmap_rim), cmocka_unit_test(test_adopt),
        cmocka_unit_test(test_no_memory),
    };
    int failed;

    if ((work = face_work_new(NULL)) == NULL)
        return 1;
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    face_work_free(work);
    return failed;
}
