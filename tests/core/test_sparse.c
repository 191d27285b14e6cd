/* Sparse scans: two of one person match despite spikes and holes; and where only one is
 * sparse, its coarse triangles hardly matter. */
#include "face.h"
#include "facegen.h"
#include "heights.h"
#include "toy.h"
#include "unit.h"

static void make(uint64_t subject, uint64_t number, uint32_t points, double spikes,
                 struct face_work *w, struct face *out)
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
    struct face_work *w = face_work_new(NULL);
    struct face tmpl = {0}, probe = {0}, other = {0};
    int count = 0;

    *others = 0;
    assert_non_null(w);
    for (uint64_t k = 0; k < 40; k++) {
        struct face_result r;

        make(k, 0, points, spikes, w, &tmpl);
        make(k, 1, points, spikes, w, &probe);
        make(k + 1, 1, points, spikes, w, &other);
        assert_int_equal(face_compare(&tmpl, &probe, (double)NAN, NULL, w, &r), ST_OK);
        if (r.decision != FACE_MATCH) {
            print_message("%u points, subject %d: %.2f\n", points, (int)k, r.score);
            count++;
        }
        assert_int_equal(face_compare(&tmpl, &other, (double)NAN, NULL, w, &r), ST_OK);
        *others += r.decision == FACE_MATCH;
    }
    face_free(&tmpl);
    face_free(&probe);
    face_free(&other);
    face_work_free(w);
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

/* The same face with 6,000 points and with 1,000, without noise: between its heights at one frame
 * is what the larger triangles cut off, and what fewer samples miss of a slope. */
TEST(test_two_densities)
{
    static struct dvec3 pts[6000];
    static float z[2][GRID_N];
    static struct cells cells;
    struct face_work *w = face_work_new(NULL);
    struct scratch scratch = {0};
    struct face face[2];
    double squares = 0, n = 0;

    memset(face, 0, sizeof face);
    assert_non_null(w);
    for (uint64_t subject = 0; subject < 8; subject++) {
        for (int k = 0; k < 2; k++) {
            struct facegen_scan scan;

            facegen_default(&scan);
            scan.subject = subject;
            scan.scan = (uint64_t)k;
            scan.noise = scan.warp = 0;
            scan.points = k == 0 ? 6000 : 1000;
            assert_int_equal(
                face_build(pts, facegen_sample(&scan, pts), w, &face[k], NULL), ST_OK);
            assert_int_equal(
                heights_of(&face[k].surface, &face[0].frame.pose, &scratch, z[k]), ST_OK);
        }
        toy_cells(&model_default, z[0], z[1], &cells);
        for (uint32_t i = 0; i < GRID_N; i++) {
            squares += (double)cells.gap[i] * (double)cells.gap[i];
            n += cells.area[i] > 0.0f;
        }
    }
    print_message("%.3f mm in %g cells\n", sqrt(squares / n), n);
    assert_true(n > 8 * 500);
    assert_true(sqrt(squares / n) < 0.35);
    face_free(&face[0]);
    face_free(&face[1]);
    scratch_free(&scratch);
    face_work_free(w);
}
