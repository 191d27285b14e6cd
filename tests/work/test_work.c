/* No request costs more than MOST times an ordinary one of its size, whatever the points are:
 * counted in basic blocks of core, so that no clock is asked. */
#include "align.h"
#include "brute.h"
#include "clouds.h"
#include "contrived.h"
#include "delaunay.h"
#include "heatmap.h"
#include "lattice.h"
#include "locate.h"
#include "measure.h"
#include "mst.h"
#include "unit.h"
#include "work.h"

#define MOST   10
#define POINTS 20000

static struct dvec3 a[POINTS], b[POINTS];

static void *alloc(size_t n, size_t size)
{
    void *p = calloc(n, size);

    assert_non_null(p);
    return p;
}

static void check(const char *name, size_t n, const double ordinary[WORK_STEPS])
{
    double blocks[WORK_STEPS];

    work_count(a, b, n, blocks);
    print_message("%-12s %4.1f:", name, work_ratio(blocks, ordinary));
    for (int k = 0; k < WORK_STEPS; k++)
        print_message(" %s %.1f", work_name((enum work_step)k), blocks[k] / ordinary[k]);
    print_message("\n");
    assert_true(work_ratio(blocks, ordinary) < MOST);
}

static void measure_ordinary(size_t n, double ordinary[WORK_STEPS])
{
    const size_t na = clouds_scan(1, 0, n, a), nb = clouds_scan(1, 1, n, b);

    work_count(a, b, na < nb ? na : nb, ordinary);
}

/* Of many point sets that were searched: the worst at their time, before and after the limits. */
TEST(test_found)
{
    static const double gene[][2 * CONTRIVED_GENES] = {
        {0.00, 1.00, 0.00, 0.00, 0.26, 0.00, 0.06, 0.71, 0.05, 0.57, 0.79, 0.05,
         0.00, 0.11, 0.09, 0.16, 0.00, 0.64, 0.33, 0.67, 0.48, 0.00, 0.09, 0.27},
        {0.00, 1.00, 0.18, 0.00, 0.05, 0.00, 0.07, 0.77, 0.13, 0.98, 0.61, 0.48,
         0.84, 0.85, 0.56, 0.20, 0.46, 0.21, 0.57, 0.57, 0.37, 0.04, 1.00, 0.16},
        {0.31, 0.08, 0.82, 0.26, 0.79, 0.13, 0.53, 0.81, 0.39, 0.81, 0.82, 0.77,
         0.27, 0.00, 0.00, 0.98, 0.00, 0.66, 0.10, 0.44, 0.11, 0.77, 0.51, 0.17},
        {0.00, 0.16, 0.45, 0.46, 0.00, 0.94, 0.64, 0.29, 0.47, 0.93, 0.96, 0.20,
         0.22, 0.00, 0.00, 0.09, 0.44, 0.52, 0.72, 0.16, 0.15, 0.53, 0.24, 0.91},
        {0.00, 0.69, 0.00, 0.12, 0.00, 0.17, 0.06, 0.25, 0.49, 0.50, 0.61, 0.16,
         0.83, 0.00, 0.00, 0.79, 0.61, 0.01, 0.90, 1.00, 0.27, 0.89, 0.41, 0.69},
        {0.00, 0.54, 0.00, 0.00, 0.00, 0.52, 0.02, 0.80, 0.50, 0.44, 0.23, 0.24,
         0.00, 0.44, 0.15, 0.00, 0.54, 0.87, 0.84, 0.71, 0.95, 0.33, 0.46, 0.11},
        {0.46, 0.97, 0.06, 0.06, 0.80, 0.00, 0.19, 0.72, 0.36, 0.02, 0.47, 0.92,
         0.00, 0.86, 0.17, 0.00, 0.13, 0.00, 0.87, 0.24, 0.74, 0.10, 0.46, 0.15},
    };

    for (uint32_t n = 2000; n <= POINTS; n *= 10) {
        double ordinary[WORK_STEPS];

        measure_ordinary(n, ordinary);
        for (size_t i = 0; i < sizeof gene / sizeof *gene; i++) {
            contrived_make(gene[i], 1, n, a);
            contrived_make(gene[i] + CONTRIVED_GENES, 1, n, b);
            check("found", n, ordinary);
        }
    }
}

static double height(double x, double y)
{
    return 30 - (x * x + y * y) / 200;
}

/* Two columns 0.001 mm apart, points between them, and one 900 mm off: a start grid over the
 * bounding box had every walk cross most triangles, 41 s for 300,000 points. */
TEST(test_columns)
{
    struct brute_rng r = {3};
    double ordinary[WORK_STEPS];

    measure_ordinary(POINTS, ordinary);
    for (int i = 0; i < POINTS; i++) {
        const double y = i % 3 == 2 ? brute_int(&r, -60000, 60000) * 0.001
                                    : (i / 3 - POINTS / 6) * 0.001;
        const double x =
            i % 3 == 2 ? brute_int(&r, -50000, 50000) * 0.001 : i % 3 * 0.001;

        a[i] = b[i] = (struct dvec3){x, y, height(x, y)};
    }
    b[5].x = 900;
    check("columns", POINTS, ordinary);
}

/* Needles between two columns 100 mm apart, and a probe at random over them. */
TEST(test_needles)
{
    struct brute_rng r = {4};
    double ordinary[WORK_STEPS];

    measure_ordinary(POINTS, ordinary);
    for (int i = 0; i < POINTS; i++) {
        const double x = brute_int(&r, -60000, 60000) * 0.001,
                     y = brute_int(&r, -60000, 60000) * 0.001;

        a[i] = (struct dvec3){i % 2 * 100 - 50, i / 2 * 0.012 - 60, 0};
        a[i].z = height(a[i].x, a[i].y);
        b[i] = (struct dvec3){x, y, height(x, y)};
    }
    check("needles", POINTS, ordinary);
}

/* Location alone, where each step of the tree crosses hundreds of needles. */
TEST(test_location)
{
    struct brute_rng r = {6};
    struct ivec3 *pts = alloc(POINTS, sizeof *pts);
    struct location *loc = alloc(POINTS, sizeof *loc);
    struct scratch s = {0};
    struct mesh in = {0}, across = {0};
    uint64_t before;

    for (int i = 0; i < POINTS; i++)
        pts[i] = (struct ivec3){i % 2 * 8000000, i / 2, 0};
    assert_int_equal(delaunay_build(pts, POINTS, &s, &in), ST_OK);
    for (int i = 0; i < POINTS; i++)
        pts[i] =
            (struct ivec3){brute_int(&r, 0, 8000000), brute_int(&r, 0, POINTS / 2), 0};
    assert_int_equal(delaunay_build(pts, POINTS, &s, &across), ST_OK);
    assert_int_equal(mst_build(&across, &s), ST_OK);
    before = work_executed();
    assert_int_equal(locate_mesh(&in, &across, loc), ST_OK);
    print_message("location: %.0f blocks a point\n",
                  (double)(work_executed() - before) / POINTS);
    assert_true(work_executed() - before < (uint64_t)1500 * POINTS);
    mesh_free(&in);
    mesh_free(&across);
    scratch_free(&s);
    free(pts);
    free(loc);
}

/* All points of a heat map at one vertex that has thousands of triangles, all of which
 * bridge. */
TEST(test_one_vertex)
{
    static const double still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const uint32_t n = 5000;
    struct ivec3 *pts = alloc(n, sizeof *pts);
    double *gap = alloc(n, sizeof *gap);
    struct surface s = {0};
    struct scratch scratch = {0};
    uint64_t before;

    for (uint32_t i = 0; i < n; i++) { /* an arc round its centre */
        const double t = (double)i / n - 0.5;

        pts[i] = (struct ivec3){(int32_t)(1e5 * sin(t)), (int32_t)(1e5 * cos(t)), 0};
        a[i] = (struct dvec3){0, 0, 0};
    }
    pts[0] = (struct ivec3){0, 0, 0};
    assert_int_equal(surface_prepare(pts, n, false, &scratch, &s), ST_OK);
    before = work_executed();
    assert_int_equal(heatmap_gaps(&s, a, n, still, gap), ST_OK);
    assert_true(work_executed() - before < (uint64_t)500 * n);
    surface_free(&s);
    scratch_free(&scratch);
    free(pts);
    free(gap);
}

/* A template that was stored with another triangulation than Delaunay's: walks towards a point
 * may go in circles there. */
TEST(test_not_delaunay)
{
    const struct align_how how = {0};
    struct brute_rng r = {5};
    struct surface tmpl = {0}, probe = {0};
    struct measure_work m = {0};
    struct align_work w = {0};
    struct align_result found;
    struct disparity disparity;
    struct ivec3 *pts = alloc(2000, sizeof *pts);
    uint64_t work[2];

    for (int flips = 0; flips < 2; flips++) {
        for (int k = 0; k < 2; k++) {
            const size_t n = clouds_scan(1, (uint64_t)k, 2000, a);

            assert_int_equal(lattice_from_mm(a, n, LATTICE_PER_MM, pts, NULL), ST_OK);
            assert_int_equal(
                surface_prepare(pts, n, true, &m.scratch, k == 0 ? &tmpl : &probe),
                ST_OK);
        }
        for (int i = 0; i < flips * 100000; i++) {
            const uint32_t h = (uint32_t)(brute_rand(&r) % (3 * tmpl.mesh.nt));

            if (!mesh_is_ghost(&tmpl.mesh, h / 3))
                (void)brute_flip(&tmpl.mesh, h);
        }
        work[flips] = work_executed();
        assert_int_equal(align_search(&tmpl, &probe, &how, &w, &found), ST_OK);
        assert_int_equal(measure_at(&tmpl, &probe, found.transform, NULL, &m, &disparity),
                         ST_OK);
        work[flips] = work_executed() - work[flips];
    }
    print_message("not Delaunay: %.1f times\n", (double)work[1] / (double)work[0]);
    assert_true(work[1] < MOST * work[0]);
    surface_free(&tmpl);
    surface_free(&probe);
    measure_work_free(&m);
    align_work_free(&w);
    free(pts);
}

/* The spanning tree takes a fixed time a point.  Two lines on which the gaps grow as in a
 * ruler: each stage of the search halves the trees, but of the edges between the lines none
 * ends up inside a tree before the last.  Without the limit to parallel edges each stage
 * would cost as much as the first. */
TEST(test_tree)
{
    double each[2];

    for (int k = 0; k < 2; k++) {
        const uint32_t n = k == 0 ? 1 << 9 : 1 << 15;
        struct ivec3 *pts = alloc(2 * n, sizeof *pts);
        struct scratch s = {0};
        struct mesh m = {0};
        int32_t x = -8000000;

        for (uint32_t i = 0; i < n; i++) {
            x += 100 + 10 * (int32_t)__builtin_ctz(i + 1);
            pts[2 * i] = (struct ivec3){x, 0, 0};
            pts[2 * i + 1] = (struct ivec3){x + 30, 1000, 0};
        }
        assert_int_equal(delaunay_build(pts, 2 * n, &s, &m), ST_OK);
        each[k] = (double)work_executed();
        assert_int_equal(mst_build(&m, &s), ST_OK);
        each[k] = ((double)work_executed() - each[k]) / (2 * n);
        mesh_free(&m);
        scratch_free(&s);
        free(pts);
    }
    print_message("tree: %.1f and %.1f blocks a point\n", each[0], each[1]);
    assert_true(each[1] < 1.1 * each[0]);
}
