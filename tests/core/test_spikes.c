/* Spikes laid flat. */
#include "brute.h"
#include "mem.h"
#include "mesh.h"
#include "surface.h"
#include "unit.h"

#define N 800

static struct scratch scratch;

/* The plane's height at (x, y): steep, but less than a spike. */
static int32_t slope(struct ivec2 p)
{
    return p.x / 2 - p.y / 4;
}

/* 800 points at random on a plane as wide as a face, every fiftieth thrown off.  They are
 * laid back on the plane, though its height changes by millimetres between neighbours. */
TEST(test_plane)
{
    struct brute_rng r = {7};
    struct ivec3 pts[N];
    struct surface s = {0};
    uint32_t laid = 0;

    for (int i = 0; i < N; i++) {
        const struct ivec2 p = {brute_int(&r, -50000, 50000),
                                brute_int(&r, -70000, 70000)};

        pts[i] = (struct ivec3){p.x, p.y, slope(p) + (i % 50 == 0) * 30000};
    }
    assert_int_equal(surface_prepare(pts, N, true, &scratch, &s), ST_OK);
    assert_int_equal(s.mesh.nv, N);
    assert_int_equal(s.spikes, N / 50);
    for (uint32_t v = 0; v < N; v++) {
        const int32_t off = s.mesh.z[v] - slope(s.mesh.xy[v]);
        bool border = false;
        uint32_t h = s.mesh.out[v];

        do { /* on the border all neighbours may be higher */
            border |= mesh_dest(&s.mesh, h) == N;
            h = mesh_turn(&s.mesh, h);
        } while (h != s.mesh.out[v]);
        assert_true(border || abs(off) <= 1);
        laid += off != 0;
    }
    assert_true(laid <= N / 50);
    surface_free(&s);
}

/* A ridge: the plane through a spike's neighbours leads out of their heights only where they
 * tell little; the median is taken, and the spike is gone. */
TEST(test_median)
{
    struct ivec3 pts[25];
    struct surface s = {0};

    for (int i = 0; i < 25; i++)
        pts[i] = (struct ivec3){i % 5 * 2000, i / 5 * 2000 + i % 3, 0};
    pts[0].z = 20000; /* a corner: all its neighbours lie to one side */
    pts[6].z = 100;
    assert_int_equal(surface_prepare(pts, 25, true, &scratch, &s), ST_OK);
    assert_int_equal(s.spikes, 1);
    for (uint32_t v = 0; v < 25; v++)
        assert_in_range(s.mesh.z[v] + 1, 1, 101);
    surface_free(&s);
}
