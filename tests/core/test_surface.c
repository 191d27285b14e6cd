/* One surface from points: prepared, moved, used again; failed allocations. */
/* link: -Wl,--wrap=aligned_alloc */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "fail_alloc.h"
#include "holes.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "mesh_check.h"
#include "mst.h"
#include "surface.h"

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

static uint32_t laid_flat(const struct surface *s)
{
    uint32_t n = 0;

    for (uint32_t v = 0; v < s->mesh.nv; v++)
        n += s->mesh.z[v] != s->raw[v];
    return n;
}

static void assert_same(const struct surface *a, const struct surface *b)
{
    const size_t nv = a->mesh.nv;

    assert_int_equal(nv, b->mesh.nv);
    assert_memory_equal(a->mesh.xy, b->mesh.xy, nv * sizeof *a->mesh.xy);
    assert_memory_equal(a->mesh.z, b->mesh.z, nv * sizeof *a->mesh.z);
    assert_memory_equal(a->mesh.org, b->mesh.org, 3 * a->mesh.nt * sizeof *a->mesh.org);
    assert_memory_equal(a->mesh.parent, b->mesh.parent, nv * sizeof *a->mesh.parent);
    assert_memory_equal(a->raw, b->raw, nv * sizeof *a->raw);
    assert_memory_equal(a->spacing, b->spacing, nv * sizeof *a->spacing);
    assert_memory_equal(a->bridge, b->bridge, a->mesh.nt);
    assert_true(a->measured == b->measured);
}

static void test_prepare(void **state)
{
    struct ivec3 p[N];
    struct surface s = {0}, rough = {0};

    (void)state;
    bowl(p);
    assert_int_equal(surface_prepare(p, N, true, &scratch, &s), ST_OK);
    assert_int_equal(mesh_check(&s.mesh, true), ST_OK);
    assert_int_equal(mst_check(&s.mesh), ST_OK);
    assert_int_equal(s.mesh.nv, N);
    assert_int_equal(laid_flat(&s), 1);
    assert_true(s.measured > 0.9 * 57e3 * 57e3 && s.measured < 1.1 * 57e3 * 57e3);
    assert_int_equal(surface_prepare(p, N, false, &scratch, &rough), ST_OK);
    assert_int_equal(laid_flat(&rough), 0);
    assert_memory_equal(rough.raw, s.raw, N * sizeof *s.raw);
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

/* Moving by the identity changes no digit, and spikes are found again among the scanned
 * heights; a quarter turn about z gives the same surface, turned. */
static void test_move(void **state)
{
    static const double quarter[16] = {0, -1, 0, 5, 1, 0, 0, 0, 0, 0, 1, -2, 0, 0, 0, 1};
    struct ivec3 p[N];
    struct surface s = {0}, moved = {0}, want = {0};

    (void)state;
    bowl(p);
    assert_int_equal(surface_prepare(p, N, true, &scratch, &s), ST_OK);
    assert_int_equal(surface_move(&s, still, &points, &scratch, &moved), ST_OK);
    assert_same(&moved, &s);
    assert_int_equal(surface_move(&s, quarter, &points, &scratch, &moved), ST_OK);
    for (int i = 0; i < N; i++)
        p[i] = (struct ivec3){5000 - p[i].y, p[i].x, p[i].z - 2000};
    assert_int_equal(surface_prepare(p, N, true, &scratch, &want), ST_OK);
    assert_same(&moved, &want);
    surface_free(&s);
    surface_free(&moved);
    surface_free(&want);
}

static void test_nothing_left(void **state)
{
    static const double far[16] = {1, 0, 0, 1e5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const double edge_on[16] = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    struct ivec3 p[N];
    struct surface s = {0}, moved = {0};

    (void)state;
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

static void test_memory(void **state)
{
    struct ivec3 p[N];
    enum status st = ST_ENOMEM;
    unsigned long n;

    (void)state;
    bowl(p);
    for (n = 1; st != ST_OK; n++) {
        struct scratch a = {0}, b = {0};
        struct surface s = {0}, moved = {0};

        fail_alloc_at(n);
        st = surface_prepare(p, N, true, &a, &s);
        if (st == ST_OK)
            st = surface_move(&s, still, &b, &a, &moved);
        fail_alloc_at(0);
        assert_true(st == ST_OK || (st == ST_ENOMEM && moved.mesh.nv == 0));
        surface_free(&s);
        surface_free(&moved);
        scratch_free(&a);
        scratch_free(&b);
    }
    assert_true(n > 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_prepare),
        cmocka_unit_test(test_move),
        cmocka_unit_test(test_nothing_left),
        cmocka_unit_test(test_memory),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);

    scratch_free(&points);
    scratch_free(&scratch);
    return failed;
}
