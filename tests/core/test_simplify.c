/* Removing points: filling a star gives the triangulation of the remaining points from
 * scratch; the greedy choice is the one by definition; no gap exceeds its limit; the reported
 * disparity is that over the papers' general triangulation. */
/* link: -Wl,--wrap=aligned_alloc */
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
#include "unit.h"

#define MOST 3000

static struct draw rng;
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

/* The points of m that are kept. */
static size_t remaining(const struct mesh *m, const uint8_t *in, struct ivec3 *out)
{
    size_t n = 0;

    for (uint32_t v = 0; v < m->nv; v++)
        if (in[v])
            out[n++] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
    return n;
}

/* A vertex with more neighbours than a star has room for stays. */
TEST(test_crowded)
{
    struct mesh m = {0};
    struct star star;
    size_t n = 0;

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
        out[v] = locate_height(&now, loc, m->xy[v]) - m->z[v];
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

TEST(test_greedy)
{
    struct mesh m = {0}, out = {0}, want = {0};
    struct simplify_result r;

    for (int round = 0; round < 5 * BRUTE_SHAPES; round++) {
        const size_t n =
            brute_points((enum brute_shape)(round % BRUTE_SHAPES), 24, &rng, pts);
        struct simplify_limit limit = {INFINITY, INFINITY, 0};
        uint8_t in[64];
        double height = 1;

        for (size_t i = 0; i < n; i++) {
            pts[i].z = brute_int(&rng, -100000, 100000);
            height = fmax(height, abs(pts[i].z));
        }
        build(pts, n, &m);
        if (round % 4 < 2)
            limit.error = draw_uniform(&rng, 0, height);
        else
            limit.disparity = height / draw_uniform(&rng, 0, 4);
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

            close_to(gap[v], locate_height(&out, loc, m.xy[v]) - m.z[v], 1e-6);
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
    locate_heights(b, a, la, oa);
    locate_heights(a, b, lb, ob);
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

TEST(test_face)
{
    static const double error[] = {0, 100, 300, 1000, 3000};
    struct mesh m = {0}, out = {0};
    uint32_t before = MOST + 1, hull = 0;
    struct simplify_result r;

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
TEST(test_limits)
{
    struct mesh m = {0}, out = {0};
    struct simplify_result r, by_error;
    struct simplify_limit limit = {500, INFINITY, 0};

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

static struct mesh whole, simple;

static enum status simplify_fresh(void *result)
{
    const struct simplify_limit limit = {300, INFINITY, 0};
    struct scratch s = {0};
    const enum status st = simplify_mesh(&whole, NULL, &limit, &s, &simple, NULL, result);

    assert_true(st == ST_OK || simple.nv == 0);
    scratch_free(&s);
    return st;
}

TEST(test_memory)
{
    struct mesh want = {0};
    struct simplify_result r;

    face(5, &whole);
    assert_true(fail_alloc_walk(simplify_fresh, &r) > 3);
    assert_int_equal(mesh_copy(&want, &simple, 0), ST_OK);
    assert_int_equal(simplify_fresh(&r), ST_OK);
    assert_true(brute_same(&simple, &want));
    mesh_free(&whole);
    mesh_free(&simple);
    mesh_free(&want);
}

BEFORE_ALL(set_up)
{
    rng.x = brute_seed("simplify");
}
