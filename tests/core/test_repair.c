/* Triangulations with given numbers: the right triangles, and no point lost.  One repaired after
 * its points have moved must be the one built from scratch. */
#include "brute.h"
#include "delaunay.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "repair.h"
#include "unit.h"

#define MOST 4000

static struct scratch scratch;
static struct ivec3 pts[2 * MOST]; /* delaunay_numbered() needs twice the room */
static struct mesh mesh, moved;

/* moved becomes mesh with its points at to[0..nv-1], repaired; it must be right if that
 * succeeds, and it succeeds only where no two points are on one place. */
static enum status repair(const struct ivec2 *to)
{
    const uint32_t nv = mesh.nv;
    struct mesh want = {0};
    enum status st, built;

    assert_int_equal(mesh_copy(&moved, &mesh, 0), ST_OK);
    memcpy(moved.xy, to, nv * sizeof *to);
    st = repair_mesh(&moved, &scratch);
    assert_int_equal(moved.nv, nv);
    assert_memory_equal(moved.xy, to, nv * sizeof *to);
    if (st != ST_OK) {
        assert_int_equal(st, ST_ELIMIT);
        return st;
    }
    for (uint32_t v = 0; v < nv; v++)
        pts[v] = (struct ivec3){to[v].x, to[v].y, 0};
    built = delaunay_build(pts, nv, &scratch, &want);
    assert_int_equal(built, ST_OK);
    assert_int_equal(want.nv, nv);
    assert_int_equal(mesh_check(&moved, false), ST_OK);
    assert_true(brute_same(&moved, &want));
    mesh_free(&want);
    return ST_OK;
}

/* The mesh of a point set, scaled up, where the lattice has the room for it, so that its
 * points can move between their neighbours. */
static void make(enum brute_shape shape, size_t n, int32_t scale, struct draw *r)
{
    n = brute_points(shape, n, r, pts);
    for (size_t i = 0; i < n; i++)
        if (abs(pts[i].x) > LATTICE_MAX / scale || abs(pts[i].y) > LATTICE_MAX / scale)
            scale = 1;
    for (size_t i = 0; i < n; i++) {
        pts[i].x *= scale;
        pts[i].y *= scale;
    }
    assert_int_equal(delaunay_numbered(pts, n, &scratch, &mesh), ST_OK);
}

static int32_t within_lattice(int64_t x)
{
    return x > LATTICE_MAX ? LATTICE_MAX : x < -LATTICE_MAX ? -LATTICE_MAX : (int32_t)x;
}

/* Each point moves a little by itself, by up to `most` in each axis. */
static void jitter(struct ivec2 *to, int32_t most, struct draw *r)
{
    for (uint32_t v = 0; v < mesh.nv; v++)
        to[v] = (struct ivec2){
            within_lattice((int64_t)mesh.xy[v].x + brute_int(r, -most, most)),
            within_lattice((int64_t)mesh.xy[v].y + brute_int(r, -most, most))};
}

/* Points of every kind, moved by nothing, a little and much, one by one and back to where
 * they were: cocircular and collinear ones, too, on the hull and inside, are moved apart and
 * together again. */
TEST(test_kinds)
{
    static const size_t size[] = {3, 4, 7, 30, 200, 900};
    static const int32_t most[] = {0, 1, 3, 10, 30, 100, 1000, 30000};
    struct draw r = {brute_seed("kinds")};
    static struct ivec2 to[MOST], home[MOST];
    uint32_t done = 0, all = 0;

    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t s = 0; s < sizeof size / sizeof *size; s++)
            for (size_t k = 0; k < sizeof most / sizeof *most; k++) {
                make((enum brute_shape)shape, size[s], 10, &r);
                memcpy(home, mesh.xy, mesh.nv * sizeof *home);
                jitter(to, most[k], &r);
                all++;
                if (repair(to) != ST_OK)
                    continue;
                done++;
                assert_int_equal(mesh_copy(&mesh, &moved, 0), ST_OK);
                all++;
                done += repair(home) == ST_OK;
            }
    printf("%u of %u repaired\n", done, all);
    assert_true(done > all / 2);
}

/* Turned in space by up to 12 degrees, as in a comparison: nearly all can be repaired. */
TEST(test_turned)
{
    struct draw r = {brute_seed("turned")};
    static struct ivec2 to[MOST];
    uint32_t done = 0;

    for (int round = 0; round < 60; round++) {
        const double x = draw_uniform(&r, -0.2, 0.2), y = draw_uniform(&r, -0.2, 0.2);

        make(BRUTE_RANDOM, 2000, 1, &r);
        for (uint32_t v = 0; v < mesh.nv; v++)
            to[v] =
                (struct ivec2){(int32_t)(mesh.xy[v].x * (1 - x * x / 2) + mesh.z[v] * x),
                               (int32_t)(mesh.xy[v].y * (1 - y * y / 2) + mesh.z[v] * y)};
        done += repair(to) == ST_OK;
    }
    printf("%u of 60 repaired\n", done);
    assert_true(done >= 55);
}

/* One point falls on another, be it its neighbour or not: no triangulation has both. */
TEST(test_coincide)
{
    struct draw r = {brute_seed("coincide")};
    static struct ivec2 to[MOST];

    for (int round = 0; round < 200; round++) {
        uint32_t v, w;

        make(BRUTE_RANDOM, 60, 1, &r);
        v = (uint32_t)(draw_next(&r) % mesh.nv);
        w = round % 2 ? mesh_dest(&mesh, mesh.out[v])
                      : (uint32_t)(draw_next(&r) % mesh.nv);
        memcpy(to, mesh.xy, mesh.nv * sizeof *to);
        if (w == v || w == mesh.nv)
            continue;
        to[v] = to[w];
        assert_int_equal(repair(to), ST_ELIMIT);
    }
}

/* What cannot be repaired: the mirror image, all points on a line, points that have changed
 * places at random. */
TEST(test_gives_up)
{
    struct draw r = {brute_seed("gives up")};
    static struct ivec2 to[MOST];

    make(BRUTE_RANDOM, 300, 1, &r);
    for (uint32_t v = 0; v < mesh.nv; v++)
        to[v] = (struct ivec2){-mesh.xy[v].x, mesh.xy[v].y};
    assert_int_equal(repair(to), ST_ELIMIT);
    for (uint32_t v = 0; v < mesh.nv; v++)
        to[v] = (struct ivec2){0, mesh.xy[v].y};
    assert_int_equal(repair(to), ST_ELIMIT);
    for (uint32_t v = 0; v < mesh.nv; v++)
        to[v] = mesh.xy[draw_next(&r) % mesh.nv];
    assert_int_equal(repair(to), ST_ELIMIT);
    make(BRUTE_RANDOM, 3, 1, &r);
    for (int i = 0; i < 27; i++) {
        const int32_t x[3] = {i % 3, i / 3 % 3, i / 9};

        for (int v = 0; v < 3; v++)
            to[v] = (struct ivec2){x[v], -2 * x[v]};
        assert_int_equal(repair(to), ST_ELIMIT);
    }
}

/* ---- given numbers */

#define HEAP 1000

/* mesh is the triangulation of pts as they are, number by number. */
static void check_numbered(uint32_t n)
{
    assert_int_equal(mesh.nv, n);
    assert_int_equal(mesh_check(&mesh, false), ST_OK);
    for (uint32_t v = 0; v < n; v++) {
        assert_int_equal(mesh.xy[v].x, pts[v].x);
        assert_int_equal(mesh.xy[v].y, pts[v].y);
        assert_int_equal(mesh.z[v], pts[v].z);
    }
    assert_int_equal(delaunay_build(pts, n, &scratch, &moved), ST_OK);
    assert_true(brute_same(&mesh, &moved));
}

TEST(test_numbered)
{
    struct draw r = {brute_seed("kinds")};
    struct ivec3 before[HEAP];

    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t size = 3; size < HEAP; size = 2 * size + 3) {
            const size_t n = brute_points((enum brute_shape)shape, size, &r, pts);

            memcpy(before, pts, n * sizeof *pts);
            assert_int_equal(delaunay_numbered(pts, n, &scratch, &mesh), ST_OK);
            assert_memory_equal(pts, before, n * sizeof *pts);
            check_numbered((uint32_t)n);
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
    assert_int_equal(delaunay_numbered(pts, n, &scratch, &mesh), ST_OK);
    for (uint32_t v = 0; v < n; v++) {
        assert_int_equal(pts[v].x, x[v]);
        assert_int_equal(pts[v].y, given[v].y);
        assert_int_equal(pts[v].z, given[v].z);
    }
    check_numbered(n);
}

/* Nearly all points on one place. */
TEST(test_heap)
{
    for (int32_t i = 0; i < HEAP; i++)
        pts[i] = (struct ivec3){0, i < HEAP - 2 ? 0 : i, i};
    pts[HEAP - 1].x = 5;
    assert_int_equal(delaunay_numbered(pts, HEAP, &scratch, &mesh), ST_OK);
    for (int32_t i = 0; i < HEAP - 2; i++)
        assert_int_equal(pts[i].x, i);
    check_numbered(HEAP);
}

TEST(test_numbered_refused)
{
    const int32_t far = LATTICE_MAX;

    pts[0] = pts[1] = (struct ivec3){far, 0, 0}; /* the second would leave the lattice */
    pts[2] = (struct ivec3){0, 0, 0};
    pts[3] = (struct ivec3){0, 9, 0};
    assert_int_equal(delaunay_numbered(pts, 4, &scratch, &mesh), ST_ERANGE);
    assert_int_equal(mesh.nv, 0);
    for (int32_t i = 0; i < 4;
         i++) /* two places are a line, whatever they were moved to */
        pts[i] = (struct ivec3){0, i / 2, 0};
    assert_int_equal(delaunay_numbered(pts, 4, &scratch, &mesh), ST_EDEGENERATE);
    assert_int_equal(mesh.nv, 0);
    assert_int_equal(delaunay_numbered(pts, 2, &scratch, &mesh), ST_EDEGENERATE);
}
