/* What a check of few points costs, by both gates as trial.c asks them: no more than MOST times what
 * one of an ordinary scan of as many points does, whatever they are: counted in basic blocks of core
 * and of the way to a face, so that no clock is asked. */
#include "brute.h"
#include "cloudpoints.h"
#include "face.h"
#include "clouds.h"
#include "mem.h"
#include "scan.h"
#include "unit.h"
#include "work.h"

#define MOST   13
#define POINTS 1000
#define KINDS  7

static struct dvec3 pts[POINTS];
static struct surface_work *work;

static uint64_t count(enum scan_axes axes, enum status *st)
{
    struct scan_search search = {.done = false};
    struct surface_face face = {0};
    uint64_t before;
    struct surface_found found;

    before = work_executed();
    for (int strict = 1; strict >= 0; strict--) {
        const struct scan_options o = {
            .axes = axes, .enrolment = strict == 1, .search = &search};
        struct cloudpoints c = {
            .at = mem_array(POINTS, sizeof *c.at), .read = POINTS, .n = POINTS};

        assert_non_null(c.at);
        memcpy(c.at, pts, sizeof pts);
        *st = scan_build(&c, &o, work, &face, NULL, &found);
        cloudpoints_free(&c);
        if (*st == ST_OK)
            break;
    }
    face_free(&face);
    return work_executed() - before;
}

static void ordinary(void)
{
    assert_int_equal(clouds_scan(1, 0, POINTS, pts), POINTS);
}

static void contrive(int kind, struct draw *r)
{
    ordinary();
    for (size_t i = 0; i < POINTS; i++) {
        const double x = draw_uniform(r, -90, 90), y = draw_uniform(r, -110, 110),
                     z = draw_uniform(r, -1, 1);
        const double e = x - 40 * rint(x / 40), f = y - 40 * rint(y / 40);
        const double ball = sqrt(fmax(0, 1 - x * x / 8100 - y * y / 12100));

        switch (kind) {
        case 0: /* waves */
            pts[i] = (struct dvec3){x, y, 12 * sin(x / 12) * sin(y / 15)};
            break;
        case 1: /* many noses */
            pts[i] = (struct dvec3){x, y, 20 * exp(-(e * e + f * f) / 100)};
            break;
        case 2: /* an egg with many noses */
            pts[i] = (struct dvec3){x, y, 80 * ball + 18 * exp(-(e * e + f * f) / 120)};
            break;
        case 3: /* a face inside out */
            pts[i].z = -pts[i].z;
            break;
        case 4: /* the wrong way up */
            pts[i] = (struct dvec3){-pts[i].x, -pts[i].y, pts[i].z};
            break;
        case 5: /* noisy */
            pts[i] =
                (struct dvec3){pts[i].x + x / 15, pts[i].y + y / 18, pts[i].z + 7 * z};
            break;
        default: /* one cluster, and strays */
            if (i % 20 != 0)
                pts[i] = (struct dvec3){x / 60, y / 70, 1.5 * z};
            else
                pts[i] = (struct dvec3){x, y, 100 * z};
        }
    }
}

TEST(test_contrived)
{
    struct draw r = {1};
    enum status st;
    double usual;

    work = surface_work_new(NULL);
    assert_non_null(work);
    ordinary();
    usual = (double)count(SCAN_AXES_AUTO, &st);
    assert_int_equal(st, ST_OK);
    for (int kind = 0; kind < KINDS; kind++)
        for (int axes = 0; axes < 2; axes++) {
            double ratio;

            contrive(kind, &r);
            ratio = (double)count(axes == 0 ? SCAN_AXES_AUTO : SCAN_AXES_SCANNER, &st) /
                    usual;
            print_message("kind %d, axes %d: %.2f\n", kind, axes, ratio);
            assert_true(ratio < MOST);
        }
    surface_work_free(work);
}
