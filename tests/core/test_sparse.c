/* Sparse scans: two of one person match despite spikes and holes; and where only one is
 * sparse, its coarse triangles hardly matter. */
#include "face.h"
#include "facegen.h"
#include "unit.h"

static void make(uint64_t subject, uint64_t number, uint32_t points, double spikes,
                 struct surface_work *w, struct surface_face *out)
{
    struct dvec3 *pts = malloc(points * sizeof *pts);
    struct facegen_scan scan;
    size_t n;

    assert_non_null(pts);
    facegen_default(&scan);
    scan.subject = subject;
    scan.scan = number;
    scan.points = points;
    scan.spikes = spikes;
    scan.holes = 0.2;
    n = facegen_sample(&scan, pts);
    assert_int_equal(face_build(pts, n, w, out, NULL), ST_OK);
    free(pts);
}

/* Of 40 pairs, how many do not match; and of 40 pairs of different people, how many do: more than
 * the model's rate says, as made-up faces differ in fewer ways than people. */
static int refused(uint32_t points, double spikes, int *others)
{
    struct surface_work *w = surface_work_new(NULL);
    struct surface_face tmpl = {0}, probe = {0}, other = {0};
    int count = 0;

    *others = 0;
    assert_non_null(w);
    for (uint64_t k = 0; k < 40; k++) {
        struct face_result r;

        make(k, 0, points, spikes, w, &tmpl);
        make(k, 1, points, spikes, w, &probe);
        make(k + 1, 1, points, spikes, w, &other);
        assert_int_equal(face_compare(&tmpl, &probe, (double)NAN, NULL, w, &r), ST_OK);
        if (r.decision != SURFACE_MATCH) {
            print_message("%u points, subject %d: %.2f\n", points, (int)k, r.score);
            count++;
        }
        assert_int_equal(face_compare(&tmpl, &other, (double)NAN, NULL, w, &r), ST_OK);
        *others += r.decision == SURFACE_MATCH;
    }
    face_free(&tmpl);
    face_free(&probe);
    face_free(&other);
    surface_work_free(w);
    return count;
}

TEST(test_sparse)
{
    int others;

    assert_in_range(refused(800, 0.01, &others), 0, 1);
    assert_in_range(others, 0, 4);
    assert_in_range(refused(1000, 0.02, &others), 0, 1);
    assert_in_range(others, 0, 4);
}
