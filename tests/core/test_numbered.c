/* Triangulations with given numbers: the right triangles, and no point lost. */
#include "brute.h"
#include "delaunay.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "numbered.h"
#include "unit.h"

#define MOST 1000

static struct scratch scratch;
static struct ivec3 pts[2 * MOST];
static struct mesh mesh, want;

/* mesh is the triangulation of pts as they are, number by number. */
static void check(uint32_t n)
{
    assert_int_equal(mesh.nv, n);
    assert_int_equal(mesh_check(&mesh, false), ST_OK);
    for (uint32_t v = 0; v < n; v++) {
        assert_int_equal(mesh.xy[v].x, pts[v].x);
        assert_int_equal(mesh.xy[v].y, pts[v].y);
        assert_int_equal(mesh.z[v], pts[v].z);
    }
    assert_int_equal(delaunay_build(pts, n, &scratch, &want), ST_OK);
    assert_true(brute_same(&mesh, &want));
}

TEST(test_kinds)
{
    struct brute_rng r = {brute_seed("kinds")};
    struct ivec3 before[MOST];

    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t size = 3; size < MOST; size = 2 * size + 3) {
            const size_t n = brute_points((enum brute_shape)shape, size, &r, pts);

            memcpy(before, pts, n * sizeof *pts);
            assert_int_equal(numbered_build(pts, n, &scratch, &mesh), ST_OK);
            assert_memory_equal(pts, before, n * sizeof *pts);
            check((uint32_t)n);
        }
}

/* A pile pushes its neighbours aside, in the order of x, then of the numbers; other rows stay
 * as they are. */
TEST(test_pile)
{
    static const struct ivec3 given[] = {{7, 0, 5}, {9, 3, 1}, {7, 0, -4}, {8, 0, 2},
                                         {2, 0, 9}, {7, 0, 0}, {8, 3, 6},  {20, 0, 8}};
    static const int32_t x[] = {7, 9, 8, 10, 2, 9, 8, 20};
    const uint32_t n = sizeof given / sizeof *given;

    memcpy(pts, given, sizeof given);
    assert_int_equal(numbered_build(pts, n, &scratch, &mesh), ST_OK);
    for (uint32_t v = 0; v < n; v++) {
        assert_int_equal(pts[v].x, x[v]);
        assert_int_equal(pts[v].y, given[v].y);
        assert_int_equal(pts[v].z, given[v].z);
    }
    check(n);
}

/* Nearly all points on one place. */
TEST(test_heap)
{
    for (int32_t i = 0; i < MOST; i++)
        pts[i] = (struct ivec3){0, i < MOST - 2 ? 0 : i, i};
    pts[MOST - 1].x = 5;
    assert_int_equal(numbered_build(pts, MOST, &scratch, &mesh), ST_OK);
    for (int32_t i = 0; i < MOST - 2; i++)
        assert_int_equal(pts[i].x, i);
    check(MOST);
}

TEST(test_refused)
{
    const int32_t far = LATTICE_MAX;

    pts[0] = pts[1] = (struct ivec3){far, 0, 0}; /* the second would leave the lattice */
    pts[2] = (struct ivec3){0, 0, 0};
    pts[3] = (struct ivec3){0, 9, 0};
    assert_int_equal(numbered_build(pts, 4, &scratch, &mesh), ST_ERANGE);
    assert_int_equal(mesh.nv, 0);
    for (int32_t i = 0; i < 4;
         i++) /* two places are a line, whatever they were moved to */
        pts[i] = (struct ivec3){0, i / 2, 0};
    assert_int_equal(numbered_build(pts, 4, &scratch, &mesh), ST_EDEGENERATE);
    assert_int_equal(mesh.nv, 0);
    assert_int_equal(numbered_build(pts, 2, &scratch, &mesh), ST_EDEGENERATE);
}
