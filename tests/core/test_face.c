/* Faces: the measured quality follows the scan; what is no face is refused. */
#include "brute.h"
#include "clouds.h"
#include "face.h"
#include "facegen.h"
#include "faces.h"
#include "unit.h"

#define POINTS 3000

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

    return face_build(c->pts, c->n, faces_work, f, &bad);
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
    faces_make(1, 1, &f); /* now into a face that is in use: its memory is used again */
    assert_int_equal(build(c, &f), want);
    assert_int_equal(f.surface.mesh.nv, 0);
    scan(1, 1, POINTS, &other);
    assert_int_equal(build(&other, &f), ST_OK); /* f is still usable */
    face_free(&f);
}

/* The k-th cloud that is no face, and why; false: there is none. */
static bool no_face(int k, struct cloud *c, enum status *want)
{
    static const double scale[] = {0.25, 5.5, 0.001, 0.1, 10};
    struct draw r = {brute_seed("no face")};

    scan(4, 5, POINTS, c);
    if (k < 5) /* few points */
        c->n = k < 4 ? (size_t)k * 33 : SURFACE_MIN_POINTS - 1;
    *want = k < 6    ? ST_ETOOFEW
            : k < 8  ? ST_EDEGENERATE
            : k < 13 ? ST_EUNITS
            : k < 19 ? ST_ENOTFACE
                     : ST_EQUALITY;
    for (size_t i = 0; i < c->n; i++) {
        const double t = (double)i, noise = draw_uniform(&r, -0.5, 0.5);
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
