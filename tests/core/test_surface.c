/* One surface from points: prepared, moved, used again; spikes laid flat. */
/* link: -Wl,--wrap=aligned_alloc */
#include "brute.h"
#include "fail_alloc.h"
#include "holes.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "surface.h"
#include "unit.h"

#define SIDE 20
#define N    (SIDE * SIDE)

static const double still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
static struct scratch points, scratch;

/* A bowl, a point every 3 mm or so, with one spike of 20 mm. */
static void bowl(struct ivec3 *p)
{
    for (int i = 0; i < N; i++) {
        const int x = i % SIDE - SIDE / 2, y = i / SIDE - SIDE / 2;

        p[i] = (struct ivec3){3000 * x + 40 * y, 3000 * y + 70 * (x % 3),
                              100 * (x * x + y * y) + (i == N / 2 + 3 ? 20000 : 0)};
    }
}

static void assert_same(const struct surface *a, const struct surface *b)
{
    const size_t nv = a->mesh.nv;

    assert_true(brute_identical(&a->mesh, &b->mesh));
    assert_memory_equal(a->mesh.parent, b->mesh.parent, nv * sizeof *a->mesh.parent);
    assert_memory_equal(a->spacing, b->spacing, nv * sizeof *a->spacing);
    assert_memory_equal(a->bridge, b->bridge, a->mesh.nt);
    assert_true(a->measured == b->measured);
    assert_int_equal(a->spikes, b->spikes);
}

TEST(test_prepare)
{
    struct ivec3 p[N];
    struct surface s = {0}, rough = {0};
    uint32_t differ = 0;

    bowl(p);
    assert_int_equal(surface_prepare(p, N, true, &scratch, &s), ST_OK);
    assert_int_equal(mesh_check(&s.mesh, true), ST_OK);
    assert_int_equal(mst_check(&s.mesh), ST_OK);
    assert_int_equal(s.mesh.nv, N);
    assert_int_equal(s.spikes, 1);
    assert_true(s.measured > 0.9 * 57e3 * 57e3 && s.measured < 1.1 * 57e3 * 57e3);
    assert_int_equal(surface_prepare(p, N, false, &scratch, &rough), ST_OK);
    assert_int_equal(rough.spikes, 0);
    for (uint32_t v = 0; v < N; v++) {
        differ += rough.mesh.z[v] != s.mesh.z[v];
        assert_true(rough.mesh.z[v] >= s.mesh.z[v]);
    }
    assert_int_equal(differ, 1);
    /* The same memory serves a smaller surface and then one as large, without growing. */
    assert_int_equal(surface_prepare(p, N / 2, false, &scratch, &s), ST_OK);
    assert_int_equal(s.mesh.nv, N / 2);
    fail_alloc_at(0);
    assert_int_equal(surface_prepare(p, N, false, &scratch, &s), ST_OK);
    assert_int_equal(fail_alloc_count(), 0);
    assert_same(&s, &rough);
    surface_free(&s);
    surface_free(&rough);
    surface_free(NULL);
}

/* Where vertex v of s comes to lie by the transform, rounded. */
static struct ivec3 moved_to(const struct surface *s, uint32_t v, const double *transform)
{
    const struct dvec3 p =
        vec_transform(transform, lattice_to_mm(s->mesh.xy[v], s->mesh.z[v]));
    struct ivec3 out;

    assert_int_equal(lattice_from_mm(&p, 1, LATTICE_PER_MM, &out, NULL), ST_OK);
    return out;
}

/* `moved` has the vertices of s at their places, with s's tree, spacing and spikes, and is
 * triangulated there.  Returns the number of vertices put aside. */
static uint32_t check_moved(const struct surface *s, const struct surface *moved,
                            const double *transform)
{
    const size_t nv = s->mesh.nv;
    uint32_t aside = 0;
    uint8_t bridge[2 * N];

    assert_int_equal(moved->mesh.nv, nv);
    for (uint32_t v = 0; v < nv; v++) {
        const struct ivec3 p = moved_to(s, v, transform);

        assert_int_equal(moved->mesh.z[v], p.z);
        assert_int_equal(moved->mesh.xy[v].y, p.y);
        aside += moved->mesh.xy[v].x != p.x;
        assert_true(moved->mesh.xy[v].x >= p.x && moved->mesh.xy[v].x <= p.x + 2);
    }
    assert_int_equal(mesh_check(&moved->mesh, false), ST_OK);
    assert_memory_equal(moved->mesh.parent, s->mesh.parent, nv * sizeof *s->mesh.parent);
    assert_memory_equal(moved->spacing, s->spacing, nv * sizeof *s->spacing);
    assert_true(moved->measured == holes_mark(&moved->mesh, s->spacing, bridge));
    assert_memory_equal(moved->bridge, bridge, moved->mesh.nt);
    assert_int_equal(moved->spikes, s->spikes);
    return aside;
}

/* Moving by the identity changes no digit.  By other motions the surface keeps what belongs
 * to the scan: seen from the side, other points would be spikes. */
TEST(test_move)
{
    static const double quarter[16] = {0, -1, 0, 5, 1, 0, 0, 0, 0, 0, 1, -2, 0, 0, 0, 1};
    static const double mirror[16] = {-1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const double aside[16] = {.8, 0, .6, 1, 0, 1, 0, 0, -.6, 0, .8, 2, 0, 0, 0, 1};
    struct ivec3 p[N];
    struct surface s = {0}, moved = {0};

    bowl(p);
    assert_int_equal(surface_prepare(p, N, true, &scratch, &s), ST_OK);
    assert_int_equal(surface_move(&s, still, &points, &scratch, &moved), ST_OK);
    assert_same(&moved, &s);
    assert_int_equal(surface_move(&s, quarter, &points, &scratch, &moved), ST_OK);
    assert_int_equal(check_moved(&s, &moved, quarter), 0);
    assert_true(moved.measured == s.measured);
    assert_int_equal(surface_move(&s, mirror, &points, &scratch, &moved), ST_OK);
    assert_int_equal(check_moved(&s, &moved, mirror), 0);
    assert_true(moved.measured == s.measured);
    assert_int_equal(surface_move(&s, aside, &points, &scratch, &moved), ST_OK);
    assert_int_equal(check_moved(&s, &moved, aside), 0);
    fail_alloc_at(0);
    assert_int_equal(surface_move(&s, mirror, &points, &scratch, &moved), ST_OK);
    assert_int_equal(surface_move(&s, still, &points, &scratch, &moved), ST_OK);
    assert_int_equal(fail_alloc_count(), 0); /* each way has its memory by now */
    surface_free(&s);
    surface_free(&moved);
}

/* A bowl seen from its side: points of the near and of the far wall fall on one place.  None
 * is lost, and the lower number stays. */
TEST(test_coincide)
{
    static const double side[16] = {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1};
    struct ivec3 p[N];
    struct surface s = {0}, moved = {0}, again = {0};
    uint32_t aside = 0;

    bowl(p);
    assert_int_equal(surface_prepare(p, N, true, &scratch, &s), ST_OK);
    assert_int_equal(surface_move(&s, side, &points, &scratch, &moved), ST_OK);
    for (uint32_t v = 0; v < N; v++)
        for (uint32_t w = 0; w < v; w++) {
            const struct ivec3 a = moved_to(&s, v, side), b = moved_to(&s, w, side);

            if (a.x == b.x && a.y == b.y) {
                assert_int_equal(moved.mesh.xy[w].x, b.x);
                assert_int_equal(moved.mesh.xy[v].x, a.x + 1);
                aside++;
            }
        }
    assert_true(aside > 20);
    assert_int_equal(check_moved(&s, &moved, side), aside);
    assert_int_equal(surface_move(&s, side, &points, &scratch, &again), ST_OK);
    assert_same(&again, &moved);
    surface_free(&s);
    surface_free(&moved);
    surface_free(&again);
}

TEST(test_nothing_left)
{
    static const double far[16] = {1, 0, 0, 1e5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const double edge_on[16] = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    struct ivec3 p[N];
    struct surface s = {0}, moved = {0};

    bowl(p);
    assert_int_equal(surface_prepare(p, N, true, &scratch, &s), ST_OK);
    assert_int_equal(surface_move(&s, still, &points, &scratch, &moved), ST_OK);
    assert_int_equal(surface_move(&s, far, &points, &scratch, &moved), ST_ERANGE);
    assert_int_equal(moved.mesh.nv, 0);
    assert_int_equal(surface_move(&s, still, &points, &scratch, &moved), ST_OK);
    assert_int_equal(surface_move(&s, edge_on, &points, &scratch, &moved),
                     ST_EDEGENERATE);
    assert_int_equal(moved.mesh.nv, 0);
    surface_free(&s);
    surface_free(&moved);
}

/* ---- spikes */

#define SPIKED 800

/* The plane's height at (x, y): steep, but less than a spike. */
static int32_t slope(struct ivec2 p)
{
    return p.x / 2 - p.y / 4;
}

/* 800 points at random on a plane as wide as a face, every fiftieth thrown off.  They are
 * laid back on the plane, though its height changes by millimetres between neighbours. */
TEST(test_spikes)
{
    struct draw r = {7};
    struct ivec3 pts[SPIKED];
    struct surface s = {0};
    uint32_t laid = 0;

    for (int i = 0; i < SPIKED; i++) {
        const struct ivec2 p = {brute_int(&r, -50000, 50000),
                                brute_int(&r, -70000, 70000)};

        pts[i] = (struct ivec3){p.x, p.y, slope(p) + (i % 50 == 0) * 30000};
    }
    assert_int_equal(surface_prepare(pts, SPIKED, true, &scratch, &s), ST_OK);
    assert_int_equal(s.mesh.nv, SPIKED);
    assert_int_equal(s.spikes, SPIKED / 50);
    for (uint32_t v = 0; v < SPIKED; v++) {
        const int32_t off = s.mesh.z[v] - slope(s.mesh.xy[v]);
        bool border = false;
        uint32_t h = s.mesh.out[v];

        do { /* on the border all neighbours may be higher */
            border |= mesh_dest(&s.mesh, h) == SPIKED;
            h = mesh_turn(&s.mesh, h);
        } while (h != s.mesh.out[v]);
        assert_true(border || abs(off) <= 1);
        laid += off != 0;
    }
    assert_true(laid <= SPIKED / 50);
    surface_free(&s);
}

/* A ridge: the plane through a spike's neighbours leads out of their heights only where they
 * tell little; the median is taken, and the spike is gone. */
TEST(test_spike_median)
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
