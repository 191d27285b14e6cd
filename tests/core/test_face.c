/* Faces: what is accepted and refused, and that a face depends on its points alone. */
#include "brute.h"
#include "clouds.h"
#include "face.h"
#include "facegen.h"
#include "mesh.h"
#include "mst.h"
#include "unit.h"

#define POINTS 3000

static struct surface_work
    *work; /* one for the whole program: reuse is tested throughout */

struct cloud {
    size_t n;
    struct dvec3 pts[2 * POINTS];
};

static struct cloud cloud, other;

static void scan(uint64_t subject, uint64_t number, size_t n, struct cloud *c)
{
    c->n = clouds_scan(subject, number, n, c->pts);
    assert_true(c->n > SURFACE_MIN_POINTS);
}

static enum status build(const struct cloud *c, struct surface_face *f)
{
    size_t bad;

    return face_build(c->pts, c->n, work, f, &bad);
}

static void make(uint64_t subject, uint64_t number, struct surface_face *f)
{
    scan(subject, number, POINTS, &cloud);
    assert_int_equal(build(&cloud, f), ST_OK);
}

static void check_same_model(const struct surface_face *a, const struct surface_face *b)
{
    const struct mesh *m = &a->surface.mesh, *k = &b->surface.mesh;
    const size_t nv = m->nv;

    assert_true(brute_identical(m, k));
    assert_memory_equal(m->parent, k->parent, nv * sizeof *m->parent);
    assert_memory_equal(a->surface.spacing, b->surface.spacing,
                        nv * sizeof *a->surface.spacing);
    assert_memory_equal(a->surface.bridge, b->surface.bridge, m->nt);
    assert_memory_equal(&a->surface.measured, &b->surface.measured,
                        sizeof a->surface.measured);
    assert_memory_equal(&a->frame.pose, &b->frame.pose, sizeof a->frame.pose);
    assert_memory_equal(&a->encoding, &b->encoding, sizeof a->encoding);
    assert_memory_equal(&a->quality, &b->quality, sizeof a->quality);
}

static void check_model(const struct surface_face *f)
{
    const struct surface_quality *q = &f->quality;

    assert_int_equal(mesh_check(&f->surface.mesh, true), ST_OK);
    assert_int_equal(mst_check(&f->surface.mesh), ST_OK);
    assert_true(q->score > 0 && q->score <= 1);
    assert_true(q->coverage > 0 && q->coverage <= 1);
    assert_true(q->density_mm > 0.2 && q->density_mm < 10);
    assert_true(q->noise_mm >= 0 && q->noise_mm < 3);
    assert_true(f->surface.measured > 0);
}

/* Scans of good and poor quality, with few and many points, are accepted. */
TEST(test_accepted)
{
    struct surface_face f = {0};

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
        assert_true(f.surface.mesh.nv <= cloud.n && f.surface.mesh.nv > cloud.n - 5);
        check_model(&f);
    }
    face_free(&f);
    face_free(NULL);
    face_free(&f);
}

/* The estimate of the noise follows the noise; more holes, less coverage. */
TEST(test_quality)
{
    double noise[4], coverage[3];
    struct surface_face f = {0};

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
    struct surface_face f = {0};

    assert_int_equal(build(c, &f), want);
    assert_int_equal(f.surface.mesh.nv, 0);
    face_free(&f);
    make(1, 1, &f); /* now into a face that is in use: its memory is used again */
    assert_int_equal(build(c, &f), want);
    assert_int_equal(f.surface.mesh.nv, 0);
    scan(1, 1, POINTS, &other);
    assert_int_equal(build(&other, &f), ST_OK); /* f is still usable */
    check_model(&f);
    face_free(&f);
}

/* The k-th cloud that is no face, and why; false: there is none. */
static bool no_face(int k, struct cloud *c, enum status *want)
{
    static const double scale[] = {0.25, 5.5, 0.001, 0.1, 10};
    struct brute_rng r = {brute_seed("no face")};

    scan(4, 5, POINTS, c);
    if (k < 5) /* few points */
        c->n = k < 4 ? (size_t)k * 33 : SURFACE_MIN_POINTS - 1;
    *want = k < 6    ? ST_ETOOFEW
            : k < 8  ? ST_EDEGENERATE
            : k < 13 ? ST_EUNITS
            : k < 19 ? ST_ENOTFACE
                     : ST_EQUALITY;
    for (size_t i = 0; i < c->n; i++) {
        const double t = (double)i, noise = brute_real(&r) - 0.5;
        struct dvec3 *p = &c->pts[i];

        if (k == 5) /* many points, but at 60 places */
            *p = c->pts[i % 60];
        else if (k == 6 || k == 7) /* a line; one place */
            *p = k == 6 ? (struct dvec3){t / 4, t / 2, sin(t)} : (struct dvec3){1, 2, 3};
        else if (k >= 8 && k < 13) /* faces of 40 and 900 mm; m, cm, 1/10 mm as mm */
            *p = (struct dvec3){p->x * scale[k - 8], p->y * scale[k - 8],
                                p->z * scale[k - 8]};
        else if (k >= 13 && k < 19) /* planes, level or tilted, smooth or not */
            p->z = k % 3 * 0.3 * p->x - k % 2 * 0.4 * p->y + (k > 15) * noise;
        else if (k == 19)
            p->z += 30 * noise;
    }
    return k < 20;
}

TEST(test_refused)
{
    static struct cloud c;
    enum status want;

    for (int k = 0; no_face(k, &c, &want); k++)
        refused(&c, want);
}

TEST(test_permutation)
{
    struct brute_rng r = {brute_seed("permutation")};
    struct surface_face a = {0}, b = {0};

    make(7, 0, &a);
    for (int k = 0; k < 4; k++) {
        brute_shuffle(cloud.pts, cloud.n, sizeof *cloud.pts, &r);
        assert_int_equal(build(&cloud, &b), ST_OK);
        check_same_model(&a, &b);
    }
    face_free(&a);
    face_free(&b);
}

/* A face made from its stored parts is the face that was stored. */
TEST(test_adopt)
{
    struct surface_face a = {0}, b = {0};
    struct mesh *m = &b.surface.mesh;

    make(16, 0, &a);
    for (int damaged = 0; damaged < 2; damaged++) {
        assert_int_equal(mesh_copy(m, &a.surface.mesh, 0), ST_OK);
        brute_code(m);
        if (damaged) {
            m->org[17] = m->org[18];
            assert_int_equal(face_adopt(&b, work), ST_ECORRUPT);
            assert_int_equal(m->nv, 0);
        } else {
            assert_int_equal(face_adopt(&b, work), ST_OK);
            assert_int_equal(mesh_check(m, true), ST_OK);
            assert_memory_equal(a.surface.bridge, b.surface.bridge, m->nt);
        }
    }
    face_free(&a);
    face_free(&b);
}

BEFORE_ALL(set_up)
{
    assert_non_null(work = surface_work_new(NULL));
}
