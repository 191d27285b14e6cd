/* No request costs more than MOST times an ordinary one of its size, whatever the points are:
 * counted in basic blocks of core, so that no clock is asked. */
#include "align.h"
#include "asymmetry.h"
#include "brute.h"
#include "clouds.h"
#include "delaunay.h"
#include "facegen.h"
#include "heatmap.h"
#include "lattice.h"
#include "locate.h"
#include "measure.h"
#include "minimal.h"
#include "mst.h"
#include "toy.h"
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

static enum status prepare(const struct dvec3 *p, size_t n, struct scratch *s,
                           struct surface *out)
{
    struct ivec3 *lattice = malloc(n * sizeof *lattice);
    enum status st = lattice_from_mm(p, n, LATTICE_PER_MM, lattice, NULL);

    if (st == ST_OK)
        st = surface_prepare(lattice, n, true, s, out);
    free(lattice);
    return st;
}

/* The basic blocks that two requests take, whatever the points a and b: no gate for faces is in
 * the way. */
struct cost {
    uint64_t comparison, asymmetry;
};

static struct cost count_work(size_t n)
{
    const struct align_how how = {0};
    double *gap = alloc(n, sizeof *gap);
    struct surface s[2] = {{.spikes = 0}, {.spikes = 0}}, upright = {0};
    struct align_work align = {0};
    struct measure_work m = {0};
    struct align_result found;
    struct disparity disparity;
    struct minimal minimal;
    struct surface_asymmetry asymmetry;
    uint64_t from = work_executed();
    struct cost c = {0, 0};

    if (prepare(a, n, &m.scratch, &s[0]) == ST_OK &&
        prepare(b, n, &m.scratch, &s[1]) == ST_OK) {
        c.asymmetry = (work_executed() - from) / 2;
        assert_int_equal(align_search(&s[0], &s[1], &how, &align, &found), ST_OK);
        assert_int_equal(measure_at(&s[0], &s[1], found.transform, NULL, &m, &disparity),
                         ST_OK);
        assert_int_equal(minimal_find(&s[0], &s[1], found.transform, &m, &minimal),
                         ST_OK);
        assert_int_equal(heatmap_gaps(&s[0], b, n, found.transform, gap), ST_OK);
        c.comparison = work_executed() - from;
        from = work_executed();
        assert_int_equal(
            asymmetry_find(&s[1], &toy_still, NULL, &m, &upright, &asymmetry), ST_OK);
        c.asymmetry += work_executed() - from;
    }
    surface_free(&s[0]);
    surface_free(&s[1]);
    surface_free(&upright);
    align_work_free(&align);
    measure_work_free(&m);
    free(gap);
    return c;
}

/* How many times the work of the ordinary request of as many points. */
static void check(const char *name, size_t n, const struct cost *ordinary)
{
    const struct cost c = count_work(n);
    const double comparison = (double)c.comparison / (double)ordinary->comparison;
    const double asymmetry = (double)c.asymmetry / (double)ordinary->asymmetry;

    print_message("%-12s comparison %.1f, asymmetry %.1f\n", name, comparison, asymmetry);
    assert_true(comparison < MOST && asymmetry < MOST);
}

static struct cost measure_ordinary(size_t n)
{
    const size_t na = clouds_scan(1, 0, n, a), nb = clouds_scan(1, 1, n, b);

    return count_work(na < nb ? na : nb);
}

/* ---- point sets made to cost much work: columns, rows, fans, hulls and clusters on a face */

enum contrived_gene {
    CONTRIVED_FACE,    /* shares of the points: sampled evenly from the face */
    CONTRIVED_COLUMNS, /* on columns and */
    CONTRIVED_ROWS,    /* rows, which cross the face */
    CONTRIVED_FAN,     /* on an arc round one point */
    CONTRIVED_HULL,    /* on half a parabola below the face: one long hull */
    CONTRIVED_CLUSTER, /* in one spot */
    CONTRIVED_LINES,   /* columns and rows: how many, */
    CONTRIVED_APART,   /* how far apart, */
    CONTRIVED_PITCH,   /* and the points on them */
    CONTRIVED_SPOT,    /* size of the spot and the arc */
    CONTRIVED_ORDER,   /* below 0.5: shuffled */
    CONTRIVED_STRAY,   /* above 0.5: one point 900 mm off */
    CONTRIVED_GENES
};

/* From lo at 0 to hi at 1, by equal ratios. */
static double between(double gene, double lo, double hi)
{
    return lo * pow(hi / lo, gene);
}

static double unit(struct draw *r)
{
    return (double)brute_int(r, 0, 1 << 24) / (1 << 24);
}

/* The i-th of n points of a feature, on the plane. */
static struct dvec3 place(enum contrived_gene kind, const double *gene, uint32_t i,
                          uint32_t n, struct draw *r)
{
    const uint32_t lines = 1 + (uint32_t)(gene[CONTRIVED_LINES] * 15);
    const double apart = between(gene[CONTRIVED_APART], 0.001, 40);
    const double pitch = between(gene[CONTRIVED_PITCH], 0.001, 130.0 * lines / (n + 1));
    const double across = (i % lines - (lines - 1) / 2.0) * apart;
    const double along = (i / lines - n / 2.0 / lines) * pitch;
    const double spot = between(gene[CONTRIVED_SPOT], 0.01, 60), part = (i + 0.5) / n;

    switch (kind) {
    case CONTRIVED_COLUMNS:
        return (struct dvec3){across, along, 0};
    case CONTRIVED_ROWS:
        return (struct dvec3){along, across, 0};
    case CONTRIVED_FAN:
        if (i == 0)
            return (struct dvec3){0, -60, 0};
        return (struct dvec3){spot * sin(part - 0.5), spot * cos(part - 0.5) - 60, 0};
    case CONTRIVED_HULL:
        return (struct dvec3){140 * part - 70, 90 * (2 * part - 1) * (2 * part - 1) - 90,
                              0};
    case CONTRIVED_CLUSTER:
        return (struct dvec3){10 + spot * unit(r), 10 + spot * unit(r), 0};
    default:
        return (struct dvec3){110 * unit(r) - 55, 150 * unit(r) - 80, 0};
    }
}

/* n points, mm, by CONTRIVED_GENES numbers of 0 to 1. */
static void contrived_make(const double *gene, uint64_t seed, uint32_t n,
                           struct dvec3 *out)
{
    struct draw r = {seed};
    struct facegen_face face;
    double shares = 1e-3, sum = 1e-3;
    uint32_t at = 0;

    facegen_face(seed, 0, &face);
    for (int k = CONTRIVED_FACE; k <= CONTRIVED_CLUSTER; k++)
        shares += gene[k];
    for (int k = CONTRIVED_CLUSTER; k >= CONTRIVED_FACE; k--) {
        uint32_t from = at, end;

        sum += gene[k];
        end = k == CONTRIVED_FACE ? n : (uint32_t)(n * sum / shares);
        for (; at < end; at++)
            out[at] = place((enum contrived_gene)k, gene, at - from, end - from, &r);
    }
    for (uint32_t i = 0; i < n; i++)
        out[i].z = facegen_height(&face, out[i].x, out[i].y);
    for (uint32_t i = n; gene[CONTRIVED_ORDER] < 0.5 && i > 1; i--) {
        const uint32_t k = (uint32_t)(draw_next(&r) % i);
        const struct dvec3 swap = out[k];

        out[k] = out[i - 1];
        out[i - 1] = swap;
    }
    if (gene[CONTRIVED_STRAY] > 0.5)
        out[0].x = 900;
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
        const struct cost ordinary = measure_ordinary(n);

        for (size_t i = 0; i < sizeof gene / sizeof *gene; i++) {
            contrived_make(gene[i], 1, n, a);
            contrived_make(gene[i] + CONTRIVED_GENES, 1, n, b);
            check("found", n, &ordinary);
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
    struct draw r = {3};
    const struct cost ordinary = measure_ordinary(POINTS);

    for (int i = 0; i < POINTS; i++) {
        const double y = i % 3 == 2 ? brute_int(&r, -60000, 60000) * 0.001
                                    : (i / 3 - POINTS / 6) * 0.001;
        const double x =
            i % 3 == 2 ? brute_int(&r, -50000, 50000) * 0.001 : i % 3 * 0.001;

        a[i] = b[i] = (struct dvec3){x, y, height(x, y)};
    }
    b[5].x = 900;
    check("columns", POINTS, &ordinary);
}

/* Needles between two columns 100 mm apart, and a probe at random over them. */
TEST(test_needles)
{
    struct draw r = {4};
    const struct cost ordinary = measure_ordinary(POINTS);

    for (int i = 0; i < POINTS; i++) {
        const double x = brute_int(&r, -60000, 60000) * 0.001,
                     y = brute_int(&r, -60000, 60000) * 0.001;

        a[i] = (struct dvec3){i % 2 * 100 - 50, i / 2 * 0.012 - 60, 0};
        a[i].z = height(a[i].x, a[i].y);
        b[i] = (struct dvec3){x, y, height(x, y)};
    }
    check("needles", POINTS, &ordinary);
}

/* Location alone, where each step of the tree crosses hundreds of needles. */
TEST(test_location)
{
    struct draw r = {6};
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
    struct draw r = {5};
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
            const uint32_t h = (uint32_t)(draw_next(&r) % (3 * tmpl.mesh.nt));

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
