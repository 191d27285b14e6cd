/* Removing points: filling a star gives the triangulation of the remaining points from
 * scratch; the greedy choice is the one by definition; no gap exceeds its limit; the reported
 * disparity is that over the papers' general triangulation. */
/* link: -Wl,--wrap=aligned_alloc */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "brute.h"
#include "clouds.h"
#include "delaunay.h"
#include "disparity.h"
#include "fail_alloc.h"
#include "locate.h"
#include "mem.h"
#include "merge.h"
#include "mesh.h"
#include "mst.h"
#include "simplify.h"
#include "star.h"
#include "interpolate.h"

#define MOST 3000

static struct brute_rng rng;
static struct scratch scratch;
static struct ivec3 pts[MOST], rest[MOST];
static double gap[MOST];

static void close_to(double got, double wanted, double by)
{
    if (!(fabs(got - wanted) <= by))
        fail_msg("%.12g, wanted %.12g to %.2g", got, wanted, by);
}

static void build(const struct ivec3 *p, size_t n, struct mesh *m)
{
    assert_int_equal(delaunay_build(p, n, &scratch, m), ST_OK);
}

/* m without the vertices and triangles that are out. */
static void compact(const struct mesh *m, struct mesh *out)
{
    static uint32_t vertex[MOST + 1], triangle[2 * MOST];
    uint32_t nv = 0, nt = 0;

    assert_int_equal(mesh_reserve(out, m->nv), ST_OK);
    for (uint32_t v = 0; v < m->nv; v++)
        if (m->out[v] != STAR_NONE) {
            out->xy[nv] = m->xy[v];
            out->z[nv] = m->z[v];
            vertex[v] = nv++;
        }
    vertex[m->nv] = nv;
    for (uint32_t t = 0; t < m->nt; t++)
        triangle[t] = m->org[3 * t] != STAR_NONE ? nt++ : STAR_NONE;
    out->nv = nv;
    out->nt = nt;
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (triangle[h / 3] != STAR_NONE) {
            const uint32_t to = 3 * triangle[h / 3] + h % 3, twin = m->twin[h];

            assert_true(triangle[twin / 3] != STAR_NONE);
            out->org[to] = vertex[m->org[h]];
            out->twin[to] = 3 * triangle[twin / 3] + twin % 3;
        }
    for (uint32_t v = 0; v <= m->nv; v++)
        if (v == m->nv || m->out[v] != STAR_NONE)
            out->out[vertex[v]] = 3 * triangle[m->out[v] / 3] + m->out[v] % 3;
}

/* The points of m that are kept. */
static size_t remaining(const struct mesh *m, const uint8_t *in, struct ivec3 *out)
{
    size_t n = 0;

    for (uint32_t v = 0; v < m->nv; v++)
        if (in[v])
            out[n++] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
    return n;
}

static void test_star(void **state)
{
    struct mesh m = {0}, small = {0}, want = {0};
    struct star star;
    unsigned removed = 0;

    (void)state;
    for (int round = 0; round < 12 * BRUTE_SHAPES; round++) {
        const enum brute_shape shape = (enum brute_shape)(round % BRUTE_SHAPES);
        const size_t n = brute_points(shape, 8 + (size_t)round / 2, &rng, pts);
        static uint8_t in[MOST];

        build(pts, n, &m);
        memset(in, 1, n);
        for (int tries = 0; tries < 60; tries++) {
            const uint32_t v = (uint32_t)brute_int(&rng, 0, (int32_t)m.nv - 1);
            size_t left;

            if (!star_find(&m, v, &star))
                continue;
            star_remove(&m, &star);
            in[v] = 0;
            removed++;
            assert_false(star_find(&m, v, &star));
            compact(&m, &small);
            left = remaining(&m, in, rest);
            brute_delaunay(rest, left, &want);
            if (mesh_check(&small, false) != ST_OK || !brute_same(&small, &want))
                fail_msg("%s: not the triangulation of %zu points",
                         brute_shape_name(shape), left);
        }
    }
    assert_true(removed > 500);
    mesh_free(&m);
    mesh_free(&small);
    mesh_free(&want);
}

/* A vertex with more neighbours than a star has room for stays. */
static void test_crowded(void **state)
{
    struct mesh m = {0};
    struct star star;
    size_t n = 0;

    (void)state;
    for (int i = 0; i < 100; i++)
        pts[n++] = (struct ivec3){(int32_t)lrint(1e6 * cos(i * 0.0628318)),
                                  (int32_t)lrint(1e6 * sin(i * 0.0628318)), 0};
    pts[n++] = (struct ivec3){0, 0, 0};
    build(pts, n, &m);
    for (uint32_t v = 0; v < m.nv; v++)
        assert_false(star_find(&m, v, &star));
    mesh_free(&m);
}

/* ---- the greedy choice, by definition */

/* The gaps of the surface of the kept points; false if a hull point is removed. */
static bool gaps(const struct mesh *m, const uint8_t *in, double *out)
{
    static struct mesh now;
    const size_t n = remaining(m, in, rest);

    if (delaunay_build(rest, n, &scratch, &now) != ST_OK)
        return false;
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct location loc = brute_locate(&now, m->xy[v]);

        if (loc.where == LOCATE_OUTSIDE)
            return false;
        out[v] = interpolate_height(&now, loc, m->xy[v]) - m->z[v];
    }
    mesh_free(&now);
    return true;
}

static bool on_hull(const struct mesh *m, uint32_t v)
{
    const uint32_t first = m->out[v];
    uint32_t h = first;

    do {
        if (mesh_dest(m, h) == m->nv)
            return true;
    } while ((h = mesh_turn(m, h)) != first);
    return false;
}

static double volume_of(const struct mesh *m, const double *g, bool bound, double *area)
{
    double volume = 0;

    *area = 0;
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        double twice;

        if (mesh_is_ghost(m, t))
            continue;
        twice =
            (double)(m->xy[v[1]].x - m->xy[v[0]].x) * (m->xy[v[2]].y - m->xy[v[0]].y) -
            (double)(m->xy[v[1]].y - m->xy[v[0]].y) * (m->xy[v[2]].x - m->xy[v[0]].x);
        *area += twice;
        volume += bound ? twice * (fabs(g[v[0]]) + fabs(g[v[1]]) + fabs(g[v[2]])) / 3
                        : disparity_prism(twice, g[v[0]], g[v[1]], g[v[2]]);
    }
    return volume;
}

/* Which points the definition keeps. */
static void by_definition(const struct mesh *m, const struct simplify_limit *limit,
                          uint8_t *in)
{
    const bool by_volume = isfinite(limit->disparity);
    double g[64], now[64] = {0}, area;
    uint32_t left = m->nv;

    memset(in, 1, m->nv);
    while (left > limit->least) {
        double best = INFINITY;
        uint32_t at = m->nv;

        for (uint32_t v = 0; v < m->nv; v++) {
            double worst = 0, key;

            if (!in[v] || on_hull(m, v))
                continue;
            in[v] = 0;
            if (gaps(m, in, g)) {
                for (uint32_t p = 0; p < m->nv; p++) /* where something changes */
                    if (p == v || fabs(g[p] - now[p]) > 1e-6)
                        worst = fmax(worst, fabs(g[p]));
                key = by_volume ? volume_of(m, g, true, &area) : worst;
                if (worst <= limit->error && key < best) {
                    best = key;
                    at = v;
                }
            }
            in[v] = 1;
        }
        if (at == m->nv)
            return;
        in[at] = 0;
        assert_true(gaps(m, in, g));
        if (by_volume && volume_of(m, g, false, &area) > limit->disparity * area) {
            in[at] = 1;
            return;
        }
        memcpy(now, g, sizeof now);
        left--;
    }
}

static void test_greedy(void **state)
{
    struct mesh m = {0}, out = {0}, want = {0};
    struct simplify_result r;

    (void)state;
    for (int round = 0; round < 40; round++) {
        const size_t n =
            brute_points(round % 2 ? BRUTE_RANDOM : BRUTE_CLUSTERS, 24, &rng, pts);
        struct simplify_limit limit = {INFINITY, INFINITY, 0};
        uint8_t in[64];
        double height = 1;

        for (size_t i = 0; i < n; i++) {
            pts[i].z = brute_int(&rng, -100000, 100000);
            height = fmax(height, abs(pts[i].z));
        }
        build(pts, n, &m);
        if (round % 4 < 2)
            limit.error = height * brute_real(&rng);
        else
            limit.disparity = height / 4 * brute_real(&rng);
        limit.least = round % 3 ? 0 : 10;
        assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, gap, &r), ST_OK);
        by_definition(&m, &limit, in);
        build(rest, remaining(&m, in, rest), &want);
        assert_int_equal(r.kept, want.nv);
        assert_true(brute_same(&out, &want));
        assert_int_equal(mesh_check(&out, false), ST_OK);
        assert_true(r.error <= limit.error &&
                    r.disparity <= limit.disparity * (1 + 1e-12));
        for (uint32_t v = 0; v < m.nv; v++) {
            const struct location loc = brute_locate(&out, m.xy[v]);

            close_to(gap[v], interpolate_height(&out, loc, m.xy[v]) - m.z[v], 1e-6);
        }
    }
    mesh_free(&m);
    mesh_free(&out);
    mesh_free(&want);
}

/* ---- faces */

/* The papers' disparity of a and b over their general triangulation, mm. */
static struct disparity measure(const struct mesh *a, const struct mesh *b)
{
    static struct location la[MOST], lb[MOST];
    static double oa[MOST], ob[MOST];
    static float spacing[MOST];
    static uint8_t bridge[2 * MOST];
    static uint32_t vertex[MOST];
    static struct disparity_vertex seen[2 * MOST];
    const struct surface whole_a = {
        .mesh = *a, .spacing = spacing, .bridge = bridge, .measured = 1};
    const struct surface whole_b = {
        .mesh = *b, .spacing = spacing, .bridge = bridge, .measured = 1};
    const struct disparity_side sa = {&whole_a, oa}, sb = {&whole_b, ob};
    struct mesh general = {0};
    struct disparity out;

    for (size_t i = 0; i < MOST; i++)
        spacing[i] = 1e7f; /* no triangle is a bridge */
    locate_mesh(b, a, la);
    locate_mesh(a, b, lb);
    interpolate_mesh(b, a, la, oa);
    interpolate_mesh(a, b, lb, ob);
    disparity_gaps(&whole_a, &whole_b, la, false, oa);
    disparity_gaps(&whole_b, &whole_a, lb, true, ob);
    assert_int_equal(merge_build(a, b, lb, &scratch, &general, vertex), ST_OK);
    disparity_measure(&general, vertex, &sa, &sb, NULL, 1000, seen, &out);
    mesh_free(&general);
    return out;
}

static void face(uint64_t subject, struct mesh *m)
{
    build(pts, clouds_make(CLOUDS_FACE, subject, MOST, pts), m);
    assert_int_equal(mst_build(m, &scratch), ST_OK);
}

static void test_face(void **state)
{
    static const double error[] = {0, 100, 300, 1000, 3000};
    struct mesh m = {0}, out = {0};
    uint32_t before = MOST + 1, hull = 0;
    struct simplify_result r;

    (void)state;
    face(3, &m);
    for (uint32_t v = 0; v < m.nv; v++)
        hull += on_hull(&m, v);
    for (size_t i = 0; i < sizeof error / sizeof *error; i++) {
        const struct simplify_limit limit = {error[i], INFINITY, 0};
        struct disparity d;
        double worst = 0;

        assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, gap, &r), ST_OK);
        assert_int_equal(mst_build(&out, &scratch), ST_OK);
        for (uint32_t v = 0; v < m.nv; v++)
            worst = fmax(worst, fabs(gap[v]));
        d = measure(&m, &out);
        close_to(r.error, worst, 0);
        assert_true(r.error <= error[i]);
        close_to(d.plain_mm * 1000, r.disparity, 1e-6 * (1 + r.disparity));
        assert_true(r.kept == out.nv && r.kept < before && r.kept >= hull);
        before = r.kept;
    }
    assert_true(before < 400); /* 3 mm */
    mesh_free(&m);
    mesh_free(&out);
}

/* A limit on the disparity keeps fewer points than one on the gap; `least` is obeyed. */
static void test_limits(void **state)
{
    struct mesh m = {0}, out = {0};
    struct simplify_result r, by_error;
    struct simplify_limit limit = {500, INFINITY, 0};

    (void)state;
    face(4, &m);
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, NULL, &by_error),
                     ST_OK);
    limit = (struct simplify_limit){INFINITY, by_error.disparity, 0};
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, NULL, &r), ST_OK);
    assert_true(r.disparity <= limit.disparity && r.disparity > 0.98 * limit.disparity);
    assert_true(r.kept < by_error.kept && r.error > by_error.error);
    limit = (struct simplify_limit){INFINITY, INFINITY, 1000};
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, NULL, &r), ST_OK);
    assert_int_equal(r.kept, 1000);
    mesh_free(&m);
    mesh_free(&out);
}

/* A plane is simplified to its outline, a pyramid to its outline and tip. */
static void test_by_hand(void **state)
{
    struct mesh m = {0}, out = {0};
    struct simplify_limit limit = {0.5, INFINITY, 0};
    struct simplify_result r;
    size_t n = 0;

    (void)state;
    for (int j = 0; j < 11; j++)
        for (int i = 0; i < 11; i++)
            pts[n++] = (struct ivec3){1000 * i, 1000 * j, 200 * i + 300 * j};
    build(pts, n, &m);
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, gap, &r), ST_OK);
    assert_int_equal(r.kept, 40);
    close_to(r.error, 0, 1e-9);
    close_to(r.disparity, 0, 1e-9);
    pts[60].z += 4000;
    build(pts, n, &m);
    limit.error = 3999;
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, gap, &r), ST_OK);
    assert_true(r.kept > 40 && r.kept < 60 && r.error <= limit.error);
    limit.error = 4000; /* the tip may be removed */
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &out, gap, &r), ST_OK);
    assert_int_equal(r.kept, 40);
    close_to(r.error, 4000, 1e-9);
    /* The pyramid stood over six triangles of 0.5 mm^2, 4 mm high, out of 100 mm^2. */
    close_to(r.disparity, 40, 1e-9);
    mesh_free(&m);
    mesh_free(&out);
}

static void test_memory(void **state)
{
    const struct simplify_limit limit = {300, INFINITY, 0};
    struct mesh m = {0}, out = {0}, want = {0};
    struct simplify_result r;
    enum status st = ST_ENOMEM;
    unsigned long k;

    (void)state;
    face(5, &m);
    assert_int_equal(simplify_mesh(&m, NULL, &limit, &scratch, &want, NULL, &r), ST_OK);
    for (k = 1; st != ST_OK; k++) {
        struct scratch s = {0};

        fail_alloc_at(k);
        st = simplify_mesh(&m, NULL, &limit, &s, &out, NULL, &r);
        fail_alloc_at(0);
        if (st != ST_OK) {
            assert_int_equal(st, ST_ENOMEM);
            assert_int_equal(out.nv, 0);
        }
        scratch_free(&s);
    }
    assert_true(k > 4);
    assert_true(brute_same(&out, &want));
    mesh_free(&m);
    mesh_free(&out);
    mesh_free(&want);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_star),   cmocka_unit_test(test_crowded),
        cmocka_unit_test(test_greedy), cmocka_unit_test(test_face),
        cmocka_unit_test(test_limits), cmocka_unit_test(test_by_hand),
        cmocka_unit_test(test_memory),
    };
    int failed;

    rng.state = brute_seed("simplify");
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    scratch_free(&scratch);
    return failed;
}
