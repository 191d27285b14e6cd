/* The volume over one cell: every sign case by hand; compared with exact overlays; and its
 * symmetries to the last digit. */
#include "brute.h"
#include "disparity.h"
#include "mesh.h"
#include "unit.h"

static uint64_t seed;

TEST(test_cell_by_hand)
{
    assert_true(disparity_prism(6, 0, 0, 0) == 0);
    assert_true(disparity_prism(6, 2, 2, 2) == 12); /* prism */
    assert_true(disparity_prism(6, 1, 2, 3) == 12); /* cut prism */
    assert_true(disparity_prism(6, 0, 3, 3) == 12); /* (a) pyramid over a quadrangle */
    assert_true(disparity_prism(6, 0, 0, 3) == 6); /* (b) (c) pyramid over the triangle */
    assert_true(disparity_prism(6, 0, 0, -3) == 6);
    assert_true(disparity_prism(6, 0, -3, 3) == 6); /* (d) two pyramids of 3 */
    assert_true(disparity_prism(6, 0, -1, 3) == 5); /* 1.5 * 1 / 3 + 4.5 * 3 / 3 */
    assert_true(disparity_prism(6, 1, -1, 1) == 3); /* (e) (f) 0.5 and a wedge of 2.5 */
    assert_true(disparity_prism(6, -1, 1, -1) == 3);
    /* tip 30 / 3 / 5 = 2 in area, 2 / 3 in volume; the signed volume is 50 */
    assert_true(fabs(disparity_prism(30, 2, -1, 4) - (50 + 4.0 / 3)) < 1e-13);
    assert_true(disparity_prism(0, 5, -7, 1) == 0);
}

static double cell_by_overlay(double *area, int32_t a, int32_t b, int32_t c)
{
    const struct ivec3 flat[] = {{0, 0, 0}, {900, 100, 0}, {300, 700, 0}};
    const struct ivec3 bent[] = {{0, 0, a}, {900, 100, b}, {300, 700, c}};
    struct mesh m = {0}, n = {0};
    double volume;

    brute_delaunay(flat, 3, &m);
    brute_delaunay(bent, 3, &n);
    volume = brute_volume(&m, &n, area);
    mesh_free(&m);
    mesh_free(&n);
    return volume;
}

TEST(test_cell_by_overlay)
{
    struct brute_rng r = {seed};

    for (int round = 0; round < 2000; round++) {
        const int32_t top = round % 2 == 0 ? 3 : 1000;
        const int32_t a = brute_int(&r, -top, top), b = brute_int(&r, -top, top);
        const int32_t c = brute_int(&r, -top, top);
        double area;
        const double want = cell_by_overlay(&area, a, b, c);

        assert_true(fabs(disparity_prism(area, a, b, c) - want) <= 1e-12 * (want + 1));
    }
}

TEST(test_cell_symmetries)
{
    struct brute_rng r = {seed + 1};

    for (int round = 0; round < 5000; round++) {
        const double a = brute_real(&r) - 0.5, b = brute_real(&r) - 0.5;
        const double c = round % 3 == 0 ? 0 : round % 7 == 0 ? a : brute_real(&r) - 0.5;
        const double v = disparity_prism(3, a, b, c);

        assert_true(v > 0);
        assert_true(disparity_prism(3, b, c, a) == v && disparity_prism(3, c, a, b) == v);
        assert_true(disparity_prism(3, b, a, c) == v && disparity_prism(3, c, b, a) == v);
        assert_true(disparity_prism(3, -a, -b, -c) == v);
        assert_true(disparity_prism(3, 1024 * a, 1024 * b, 1024 * c) == 1024 * v);
        assert_true(v <= 3 * (fabs(a) + fabs(b) + fabs(c)) / 3 * (1 + 1e-15));
        assert_true(v >= 3 * fabs(a + b + c) / 3 * (1 - 1e-15));
    }
}

/* The integral of u |gap| by quadrature: the rule at the middles of the sides is exact for the
 * product of two linear functions; pieces in which the gap changes its sign are cut in four
 * again and again. */
static double quadrature(const double gap[3], const double u[3], int depth)
{
    double sum = 0;

    if (depth == 0 || (gap[0] >= 0 && gap[1] >= 0 && gap[2] >= 0) ||
        (gap[0] <= 0 && gap[1] <= 0 && gap[2] <= 0)) {
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3;

            sum += (u[i] + u[j]) / 2 * fabs(gap[i] + gap[j]) / 2;
        }
        return sum / 3;
    }
    for (int part = 0; part < 4; part++) {
        double g[3], w[3];

        for (int i = 0; i < 3; i++) { /* the last piece is the one in the middle */
            const int a = part < 3 ? part : (i + 1) % 3, b = part < 3 ? i : (i + 2) % 3;

            g[i] = (gap[a] + gap[b]) / 2;
            w[i] = (u[a] + u[b]) / 2;
        }
        sum += quadrature(g, w, depth - 1);
    }
    return sum / 4;
}

TEST(test_weighted_by_quadrature)
{
    struct brute_rng r = {seed + 2};

    for (int round = 0; round < 300; round++) {
        double gap[3], u[3], want;

        for (int i = 0; i < 3; i++) {
            gap[i] = brute_real(&r) - 0.5;
            u[i] = round % 5 == 0 ? (i == round % 3) : brute_real(&r);
        }
        if (round % 4 == 0)
            gap[round % 3] = 0;
        want = 3 * quadrature(gap, u, 16);
        assert_true(fabs(disparity_prism_weighted(3, gap, u) - want) <= 1e-9 * want);
    }
}

TEST(test_weighted_by_hand)
{
    const double crossed[] = {1, -1, 1}, touching[] = {0, 0, 3}, none[] = {0, 0, 0};
    const double even[] = {2, 2, 2}, tip[] = {0, 1, 0};

    assert_true(disparity_prism_weighted(6, crossed, even) ==
                6); /* twice (e) (f) above */
    assert_true(disparity_prism_weighted(6, touching, even) == 12);
    assert_true(disparity_prism_weighted(6, none, even) == 0);
    assert_true(disparity_prism_weighted(6, touching, tip) == 1.5); /* 6 / 12 * 3 * 1 */
    /* u is 1 at the corner below zero and 1/2 along the line: over the tip, a quarter of the
     * area, 6 / 12 / 4 * (1 * 2 + 1); over all 6 / 12 * (1 * 1 - 1) = 0: beyond it as much. */
    assert_true(disparity_prism_weighted(6, crossed, tip) == 2 * 3.0 / 8);
}

BEFORE_ALL(set_up)
{
    seed = brute_seed("test_disparity_prism");
}
