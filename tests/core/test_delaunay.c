/* Delaunay triangulation against its definition, on every kind of input. */
/* link: -Wl,--wrap=aligned_alloc */
#include "brute.h"
#include "delaunay.h"
#include "fail_alloc.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"
#include "unit.h"

#define LARGE 20000

static struct scratch scratch; /* one for the whole program: reuse is tested throughout */

static int by_xy(const void *a, const void *b)
{
    const struct ivec3 *p = a, *q = b;

    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return (p->y > q->y) - (p->y < q->y);
}

/* Merges points of the same x and y into one with the mean height, rounded down.  Sorts
 * pts. */
static size_t united(struct ivec3 *pts, size_t n)
{
    size_t k = 0;

    qsort(pts, n, sizeof *pts, by_xy);
    for (size_t i = 0, j; i < n; i = j) {
        int64_t sum = 0, count, mean;

        for (j = i; j < n && by_xy(&pts[i], &pts[j]) == 0; j++)
            sum += pts[j].z;
        count = (int64_t)(j - i);
        for (mean = sum / count; mean * count > sum;)
            mean--;
        pts[k] = pts[i];
        pts[k++].z = (int32_t)mean;
    }
    return k;
}

/* The mesh's points in the order of united(). */
static struct ivec3 *points_of(const struct mesh *m)
{
    struct ivec3 *p = malloc((m->nv + 1) * sizeof *p);

    assert_non_null(p);
    for (uint32_t v = 0; v < m->nv; v++)
        p[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
    qsort(p, m->nv, sizeof *p, by_xy);
    return p;
}

static void check_points(const struct mesh *m, const struct ivec3 *want, size_t n)
{
    struct ivec3 *got = points_of(m);

    assert_int_equal(m->nv, n);
    assert_memory_equal(got, want, n * sizeof *got);
    free(got);
}

/* Against the definition; pts is sorted and united. */
static void check_brute(struct ivec3 *pts, size_t n)
{
    struct mesh got = {0}, want = {0};

    assert_int_equal(delaunay_build(pts, n, &scratch, &got), ST_OK);
    n = united(pts, n);
    check_points(&got, pts, n);
    brute_delaunay(pts, n, &want);
    assert_true(brute_same(&got, &want));
    assert_int_equal(mesh_check(&got, false), ST_OK);
    mesh_free(&got);
    mesh_free(&want);
}

TEST(test_by_definition)
{
    struct draw r = {brute_seed("by definition")};
    struct ivec3 pts[400];

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        for (size_t n = 3; n < 40; n++)
            check_brute(pts, brute_points((enum brute_shape)shape, n, &r, pts));
        for (int k = 0; k < 12; k++) {
            const size_t n = (size_t)brute_int(&r, 40, 400);

            check_brute(pts, brute_points((enum brute_shape)shape, n, &r, pts));
        }
    }
}

/* Every set of up to 9 points on a 3 x 3 grid, if not all are on one line. */
TEST(test_all_small_sets)
{
    int lines = 0;

    for (unsigned set = 0; set < 1u << 9; set++) {
        struct ivec3 pts[9];
        size_t n = 0;
        bool line = true;

        for (int i = 0; i < 9; i++)
            if (set >> i & 1)
                pts[n++] = (struct ivec3){i % 3, i / 3, i};
        for (size_t i = 2; i < n; i++)
            line = line && orient2d((struct ivec2){pts[0].x, pts[0].y},
                                    (struct ivec2){pts[1].x, pts[1].y},
                                    (struct ivec2){pts[i].x, pts[i].y}) == 0;
        if (line) {
            struct mesh m = {0};

            assert_int_equal(delaunay_build(pts, n, &scratch, &m), ST_EDEGENERATE);
            mesh_free(&m);
            lines++;
        } else {
            check_brute(pts, n);
        }
    }
    assert_int_equal(lines, 1 + 9 + 36 + 8); /* none, one, two, three in a row */
}

/* Many points at few places: heights averaged and rounded down, whatever the order. */
TEST(test_duplicates)
{
    static const int side[] = {2, 3, 4, 7, 15};
    struct draw r = {brute_seed("duplicates")};
    struct ivec3 pts[500];

    for (size_t s = 0; s < 5; s++)
        for (size_t n = 10; n <= 500; n += 49) {
            for (size_t i = 0; i < n; i++)
                pts[i] = (struct ivec3){brute_int(&r, 0, side[s] - 1),
                                        brute_int(&r, 0, side[s] - 1),
                                        brute_int(&r, -LATTICE_MAX, LATTICE_MAX)};
            for (int i = 0; i < 3; i++) { /* never on one line */
                pts[i].x = i == 1;
                pts[i].y = i == 2;
            }
            check_brute(pts, n);
        }
}

TEST(test_canonical)
{
    struct draw r = {brute_seed("canonical")};
    struct ivec3 *pts = malloc(2 * LARGE * sizeof *pts);
    struct mesh a = {0}, b = {0};

    assert_non_null(pts);
    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t n = 5; n <= LARGE; n *= 8) {
            size_t k = brute_points((enum brute_shape)shape, n, &r, pts);

            for (size_t i = 0; i < n / 3; i++) { /* some twice, at another height */
                pts[k + i] = pts[draw_next(&r) % k];
                pts[k + i].z += brute_int(&r, -9, 9);
            }
            k += n / 3;
            assert_int_equal(delaunay_build(pts, k, &scratch, &a), ST_OK);
            assert_int_equal(mesh_check(&a, false), ST_OK);
            for (int again = 0; again < 3; again++) {
                brute_shuffle(pts, k, sizeof *pts, &r);
                assert_int_equal(delaunay_build(pts, k, &scratch, &b), ST_OK);
                assert_true(brute_identical(&a, &b));
            }
            qsort(pts, k, sizeof *pts, by_xy);
            assert_int_equal(delaunay_build(pts, k, &scratch, &b), ST_OK);
            assert_true(brute_identical(&a, &b));
        }
    mesh_free(&a);
    mesh_free(&b);
    free(pts);
}

TEST(test_refused)
{
    static const struct ivec3 far[] = {
        {LATTICE_MAX + 1, 0, 0},  {-LATTICE_MAX - 1, 0, 0}, {0, LATTICE_MAX + 1, 0},
        {0, -LATTICE_MAX - 1, 0}, {0, 0, LATTICE_MAX + 1},  {0, 0, -LATTICE_MAX - 1},
        {INT32_MAX, 0, 0},        {0, INT32_MIN, 0},        {INT32_MIN, INT32_MAX, 0},
        {1, 1, INT32_MIN}};
    struct ivec3 pts[5] = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {9, 9, 0}, {4, 3, 0}};
    const struct ivec3 one[6] = {{3, 3, 0}, {3, 3, 1}, {3, 3, 2},
                                 {8, 3, 0}, {8, 3, 0}, {3, 3, 3}};
    struct mesh m = {0};

    for (size_t k = 0; k < sizeof far / sizeof far[0]; k++)
        for (int i = 0; i < 5; i++) {
            const struct ivec3 keep = pts[i];

            assert_int_equal(delaunay_build(pts, 5, &scratch, &m), ST_OK);
            pts[i] = far[k];
            assert_int_equal(delaunay_build(pts, 5, &scratch, &m), ST_ERANGE);
            assert_int_equal(m.nv, 0);
            pts[i] = keep;
        }
    for (size_t n = 0; n < 3; n++)
        assert_int_equal(delaunay_build(pts, n, &scratch, &m), ST_EDEGENERATE);
    for (size_t n = 1; n <= 6; n++)
        assert_int_equal(delaunay_build(one, n, &scratch, &m), ST_EDEGENERATE);
    assert_int_equal(m.nv, 0);
    assert_int_equal(delaunay_build(pts, (size_t)SURFACE_MAX_POINTS + 1, &scratch, &m),
                     ST_ELIMIT);
    assert_int_equal(delaunay_build(pts, SIZE_MAX, &scratch, &m), ST_ELIMIT);
    assert_int_equal(delaunay_build(pts, 5, &scratch, &m),
                     ST_OK); /* the memory is still usable */
    assert_int_equal(m.nv, 5);
    mesh_free(&m);
}

/* Bigger, smaller and bigger again in the same memory gives what fresh memory gives. */
TEST(test_reuse)
{
    static const size_t size[] = {3000, 7, 400, 3, 5000, 3000, 12};
    struct draw r = {brute_seed("reuse")};
    struct ivec3 *pts = malloc(5000 * sizeof *pts);
    struct mesh kept = {0};

    assert_non_null(pts);
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        const size_t k = brute_points(BRUTE_RANDOM, size[i], &r, pts);
        struct scratch s = {0};
        struct mesh fresh = {0};

        assert_int_equal(delaunay_build(pts, k, &s, &fresh), ST_OK);
        assert_int_equal(delaunay_build(pts, k, &scratch, &kept), ST_OK);
        assert_true(brute_identical(&fresh, &kept));
        fail_alloc_at(0);
        assert_int_equal(delaunay_build(pts, k, &scratch, &kept), ST_OK);
        assert_int_equal(fail_alloc_count(), 0); /* the steady state allocates nothing */
        mesh_free(&fresh);
        scratch_free(&s);
    }
    mesh_free(&kept);
    free(pts);
}

static enum status build_fresh(void *pts)
{
    struct scratch s = {0};
    struct mesh m = {0};
    const enum status st = delaunay_build(pts, 60, &s, &m);

    if (st != ST_OK) {
        assert_int_equal(m.nv, 0);
        assert_int_equal(delaunay_build(pts, 60, &s, &m), ST_OK);
    }
    assert_int_equal(mesh_check(&m, false), ST_OK);
    mesh_free(&m);
    scratch_free(&s);
    return st;
}

TEST(test_no_memory)
{
    struct draw r = {brute_seed("no memory")};
    struct ivec3 pts[60];

    assert_int_equal(brute_points(BRUTE_RANDOM, 60, &r, pts), 60);
    assert_int_equal(fail_alloc_walk(build_fresh, pts), 2);
}

/* mesh_check() must notice each kind of damage. */
TEST(test_check_can_fail)
{
    struct draw r = {brute_seed("check")};
    struct ivec3 pts[60];
    const size_t n = brute_points(BRUTE_RANDOM, 60, &r, pts);
    struct mesh m = {0};
    int seen = 0;

    assert_int_equal(delaunay_build(pts, n, &scratch, &m), ST_OK);
    for (uint32_t h = 0; h < 3 * m.nt; h++) {
        const uint32_t org = m.org[h], twin = m.twin[h];

        m.org[h] = (org + 1) % (m.nv + 1);
        assert_int_equal(mesh_check(&m, false), ST_ECORRUPT);
        m.org[h] = UINT32_MAX;
        assert_int_equal(mesh_check(&m, false), ST_ECORRUPT);
        m.org[h] = org;
        m.twin[h] = (twin + 1) % (3 * m.nt);
        assert_int_equal(mesh_check(&m, false), ST_ECORRUPT);
        m.twin[h] = UINT32_MAX;
        assert_int_equal(mesh_check(&m, false), ST_ECORRUPT);
        m.twin[h] = twin;
    }
    for (uint32_t v = 0; v < m.nv; v++) { /* a moved point spoils shape or circles */
        const struct ivec2 p = m.xy[v];

        m.xy[v].x += 40000;
        seen += mesh_check(&m, false) == ST_ECORRUPT;
        m.xy[v] = p;
        m.out[v] = m.out[(v + 1) % m.nv];
        assert_int_equal(mesh_check(&m, false), ST_ECORRUPT);
        for (uint32_t h = 0; h < 3 * m.nt; h++)
            if (m.org[h] == v)
                m.out[v] = h;
    }
    assert_true(seen > 50);
    assert_int_equal(mesh_check(&m, false), ST_OK);
    mesh_free(&m);
}
