/* The general triangulation must be the triangulation of the union built from scratch. */
/* link: -Wl,--wrap=aligned_alloc */
#include <unistd.h>

#include "brute.h"
#include "delaunay.h"
#include "fail_alloc.h"
#include "locate.h"
#include "mem.h"
#include "merge.h"
#include "mesh.h"
#include "mesh_link.h"
#include "mst.h"
#include "predicates.h"
#include "unit.h"

#define MOST 6000

static struct scratch scratch;

struct cloud {
    size_t n;
    struct ivec3 pts[MOST];
};

static struct cloud first, second;

static void add(struct cloud *c, int32_t x, int32_t y)
{
    assert_true(c->n < MOST);
    c->pts[c->n] = (struct ivec3){x, y, (int32_t)c->n};
    c->n++;
}

static void triangulate(const struct cloud *c, struct mesh *m)
{
    assert_int_equal(delaunay_build(c->pts, c->n, &scratch, m), ST_OK);
    assert_int_equal(mst_build(m, &scratch), ST_OK);
}

/* Both meshes, the locations, and room for the result. */
struct pair {
    struct mesh a, b, out;
    struct location *b_in_a;
    uint32_t *b_vertex;
};

/* b located in p->a. */
static void pair_locate(struct pair *p, const struct cloud *b)
{
    triangulate(b, &p->b);
    p->b_in_a = calloc(p->b.nv, sizeof *p->b_in_a);
    p->b_vertex = calloc(p->b.nv, sizeof *p->b_vertex);
    assert_true(p->b_in_a != NULL && p->b_vertex != NULL);
    locate_mesh(&p->a, &p->b, p->b_in_a);
}

static void pair_make(struct pair *p, const struct cloud *a, const struct cloud *b)
{
    *p = (struct pair){{0}, {0}, {0}, NULL, NULL};
    triangulate(a, &p->a);
    pair_locate(p, b);
}

static void pair_free(struct pair *p)
{
    mesh_free(&p->a);
    mesh_free(&p->b);
    mesh_free(&p->out);
    free(p->b_in_a);
    free(p->b_vertex);
}

/* a's vertices come first, unchanged; b_vertex leads to a vertex at the place of each of b's,
 * and the new ones are in b's order. */
static void check_numbers(const struct pair *p)
{
    uint32_t next = p->a.nv;

    for (uint32_t v = 0; v < p->a.nv; v++) {
        assert_int_equal(p->out.xy[v].x, p->a.xy[v].x);
        assert_int_equal(p->out.xy[v].y, p->a.xy[v].y);
        assert_int_equal(p->out.z[v], p->a.z[v]);
    }
    for (uint32_t v = 0; v < p->b.nv; v++) {
        const uint32_t w = p->b_vertex[v];

        assert_true(w < p->out.nv);
        assert_int_equal(p->out.xy[w].x, p->b.xy[v].x);
        assert_int_equal(p->out.xy[w].y, p->b.xy[v].y);
        if (w >= p->a.nv) {
            assert_int_equal(w, next++);
            assert_int_equal(p->out.z[w], p->b.z[v]);
        }
    }
    assert_int_equal(p->out.nv, next);
}

static void check_union(const struct pair *p)
{
    const size_t n = (size_t)p->a.nv + p->b.nv;
    struct ivec3 *pts = calloc(n, sizeof *pts);
    struct mesh want = {0};

    assert_non_null(pts);
    for (uint32_t v = 0; v < p->a.nv; v++)
        pts[v] = (struct ivec3){p->a.xy[v].x, p->a.xy[v].y, 0};
    for (uint32_t v = 0; v < p->b.nv; v++)
        pts[p->a.nv + v] = (struct ivec3){p->b.xy[v].x, p->b.xy[v].y, 0};
    assert_int_equal(delaunay_build(pts, n, &scratch, &want), ST_OK);
    assert_true(brute_same(&p->out, &want));
    assert_int_equal(mesh_check(&p->out, false), ST_OK);
    mesh_free(&want);
    free(pts);
}

/* Merge b into a; returns the allocations made once all memory has its size. */
static unsigned long check_merge(const struct cloud *a, const struct cloud *b)
{
    struct pair p;
    unsigned long allocations;

    pair_make(&p, a, b);
    for (int again = 0; again < 2; again++) {
        fail_alloc_at(0);
        assert_int_equal(merge_build(&p.a, &p.b, p.b_in_a, &scratch, &p.out, p.b_vertex),
                         ST_OK);
        allocations = fail_alloc_count();
        check_numbers(&p);
        check_union(&p);
    }
    pair_free(&p);
    return allocations;
}

static void check_both_ways(const struct cloud *a, const struct cloud *b)
{
    (void)check_merge(a, b);
    (void)check_merge(b, a);
}

/* Every kind of point set against every kind, at their own places and on one another. */
TEST(test_kinds)
{
    static const size_t size[][2] = {{3, 3}, {5, 60}, {80, 6}, {150, 150}, {700, 500}};
    struct draw r = {brute_seed("kinds")};

    for (int ka = 0; ka < BRUTE_SHAPES; ka++)
        for (int kb = 0; kb < BRUTE_SHAPES; kb++)
            for (size_t s = 0; s < sizeof size / sizeof size[0]; s++) {
                first.n = brute_points((enum brute_shape)ka, size[s][0], &r, first.pts);
                second.n = brute_points((enum brute_shape)kb, size[s][1], &r, second.pts);
                (void)check_merge(&first, &second);
            }
}

/* Some, then all points of b are points of a. */
TEST(test_shared)
{
    struct draw r = {brute_seed("shared")};
    struct pair p;

    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t n = 8; n < 300; n *= 3) {
            first.n = brute_points((enum brute_shape)shape, n, &r, first.pts);
            second.n = brute_points((enum brute_shape)shape, n, &r, second.pts);
            for (size_t i = 0; i < second.n; i += 2)
                second.pts[i] = first.pts[draw_next(&r) % first.n];
            check_both_ways(&first, &second);
            pair_make(&p, &first, &first);
            assert_int_equal(
                merge_build(&p.a, &p.b, p.b_in_a, &scratch, &p.out, p.b_vertex), ST_OK);
            assert_int_equal(p.out.nv, p.a.nv);
            check_numbers(&p);
            check_union(&p);
            pair_free(&p);
        }
}

/* b's points on a's edges, inner and hull edges, and on the lines beyond their ends. */
TEST(test_on_edges)
{
    struct draw r = {brute_seed("on edges")};

    for (int round = 0; round < 60; round++) {
        struct mesh m = {0};

        first.n = brute_points(round % 2 ? BRUTE_RANDOM : BRUTE_SMALL, 40, &r, first.pts);
        for (size_t i = 0; i < first.n;
             i++) { /* even, so that middles are lattice points */
            first.pts[i].x *= 4;
            first.pts[i].y *= 4;
        }
        triangulate(&first, &m);
        second.n = 0;
        for (uint32_t h = 0; h < 3 * m.nt; h++) {
            const uint32_t u = m.org[h], v = mesh_dest(&m, h);
            const int32_t part = brute_int(&r, -1, 5); /* -1 and 5: beyond the ends */

            if (u < m.nv && v < m.nv && u < v && draw_next(&r) % 3 != 0)
                add(&second, m.xy[u].x + (m.xy[v].x - m.xy[u].x) / 4 * part,
                    m.xy[u].y + (m.xy[v].y - m.xy[u].y) / 4 * part);
        }
        mesh_free(&m);
        check_both_ways(&first, &second);
    }
}

/* Points on half a parabola form a fan round the end with the greater curvature, so points
 * put in from the other end, as here, turn every edge each time. */
static void make_fan(int32_t n)
{
    first.n = second.n = 0;
    add(&first, -6000, 100); /* on the outer side, outside all circles of the fan */
    add(&first, -6500, 300);
    add(&first, -6300, -200);
    add(&first, -n, n * n); /* one point in common */
    for (int32_t t = 0; t <= n; t++)
        add(&second, -t, t * t);
}

/* Quadratic work: merge_build() must give up and triangulate the union from scratch, which is
 * seen by its allocations. */
TEST(test_work_limit)
{
    for (int32_t n = 500; n <= 4000; n *= 2) {
        make_fan(n);
        assert_true(check_merge(&first, &second) > 0);
        assert_int_equal(check_merge(&second, &first), 0);
    }
}

/* Two scans of one surface never come near that limit, whatever their sampling. */
TEST(test_steady_state)
{
    struct draw r = {brute_seed("steady state")};

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        first.n = brute_points((enum brute_shape)shape, 3000, &r, first.pts);
        second.n = brute_points((enum brute_shape)shape, 3000, &r, second.pts);
        assert_int_equal(check_merge(&first, &second), 0);
    }
}

/* A square in a rotated square, with edges between them that all lean the same way: a
 * visibility walk from the triangles between the squares to a point near the centre never
 * ends. */
static void make_pinwheel(struct mesh *m)
{
    static const struct ivec2 xy[8] = {{2, 2},  {-2, 2},  {-2, -2}, {2, -2},
                                       {-6, 3}, {-3, -6}, {6, -3},  {3, 6}};
    static const uint32_t org[14][3] = {
        {4, 7, 8}, {7, 6, 8}, {6, 5, 8}, {5, 4, 8}, {0, 1, 2}, {0, 2, 3}, {1, 0, 4},
        {2, 1, 5}, {3, 2, 6}, {0, 3, 7}, {1, 4, 5}, {2, 5, 6}, {3, 6, 7}, {0, 7, 4}};
    static const uint32_t parent[8] = {0, 0, 1, 2, 0, 1, 2, 3};

    assert_int_equal(mesh_reserve(m, 8), ST_OK);
    m->nv = 8;
    m->nt = 14;
    memcpy(m->xy, xy, sizeof xy);
    memset(m->z, 0, 8 * sizeof *m->z);
    memcpy(m->org, org, sizeof org);
    memcpy(m->parent, parent, sizeof parent);
    brute_order(m, NULL);
    brute_code(m);
    assert_int_equal(mesh_link(m, &scratch), ST_OK);
    assert_int_equal(mesh_check(m, true), ST_ECORRUPT); /* is not Delaunay */
}

/* The flips for the first point move the triangle in which the second one was located to
 * between the squares.  The alarm kills the test if a walk does not end. */
TEST(test_walk_limit)
{
    struct pair p = {{0}, {0}, {0}, NULL, NULL};

    make_pinwheel(&p.a);
    second.n = 0;
    add(&second, -2, 1);
    add(&second, -1, 0);
    add(&second, 0, -18);
    pair_locate(&p, &second);
    (void)alarm(60);
    assert_int_equal(merge_build(&p.a, &p.b, p.b_in_a, &scratch, &p.out, p.b_vertex),
                     ST_OK);
    (void)alarm(0);
    check_numbers(&p);
    check_union(&p);
    pair_free(&p);
}

/* Twice the area of the real triangles, each of which is counter-clockwise. */
static int64_t area(const struct mesh *m)
{
    int64_t sum = 0;

    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];

        if (!mesh_is_ghost(m, t)) {
            const int64_t twice = orient2d(m->xy[v[0]], m->xy[v[1]], m->xy[v[2]]);

            assert_true(twice > 0);
            sum += twice;
        }
    }
    return sum;
}

/* If a is not Delaunay, the result is still a triangulation of all points. */
TEST(test_flipped)
{
    struct draw r = {brute_seed("flipped")};

    for (int round = 0; round < 300; round++) {
        const enum brute_shape shape = (enum brute_shape)(round % BRUTE_SHAPES);
        struct pair p = {{0}, {0}, {0}, NULL, NULL};
        struct mesh want = {0};

        first.n = brute_points(shape, 60, &r, first.pts);
        triangulate(&first, &p.a);
        for (int i = 0; i < 500; i++)
            (void)brute_flip(&p.a, (uint32_t)(draw_next(&r) % (3 * p.a.nt)));
        second.n = brute_points(BRUTE_RANDOM, 60, &r, second.pts);
        pair_locate(&p, &second);
        assert_int_equal(merge_build(&p.a, &p.b, p.b_in_a, &scratch, &p.out, p.b_vertex),
                         ST_OK);
        check_numbers(&p);
        for (size_t i = 0; i < first.n; i++)
            add(&second, first.pts[i].x, first.pts[i].y);
        assert_int_equal(delaunay_build(second.pts, second.n, &scratch, &want), ST_OK);
        assert_int_equal(p.out.nv, want.nv);
        assert_int_equal(p.out.nt, want.nt);
        assert_true(area(&p.out) == area(&want));
        mesh_free(&want);
        pair_free(&p);
    }
}

static enum status merge_fresh(void *arg)
{
    struct pair *p = arg;
    struct scratch s = {0};
    enum status st;

    mesh_free(&p->out);
    st = merge_build(&p->a, &p->b, p->b_in_a, &s, &p->out, p->b_vertex);
    assert_true(st == ST_OK || p->out.nv == 0);
    scratch_free(&s);
    return st;
}

static void no_memory(const struct cloud *a, const struct cloud *b, unsigned long want)
{
    struct pair p;

    pair_make(&p, a, b);
    assert_int_equal(fail_alloc_walk(merge_fresh, &p), want);
    check_numbers(&p);
    check_union(&p);
    pair_free(&p);
}

TEST(test_no_memory)
{
    struct draw r = {brute_seed("no memory")};

    first.n = brute_points(BRUTE_RANDOM, 50, &r, first.pts);
    second.n = brute_points(BRUTE_RANDOM, 50, &r, second.pts);
    no_memory(&first, &second, 2); /* a copy, and the scratch for inserting */
    make_fan(900);
    no_memory(&first, &second, 4); /* and a list, and delaunay_build()'s scratch */
}

TEST(test_limit)
{
    struct draw r = {brute_seed("limit")};
    struct pair p;

    first.n = brute_points(BRUTE_RANDOM, 50, &r, first.pts);
    pair_make(&p, &first, &first);
    p.b.nv = SURFACE_MAX_POINTS; /* refused before any point is looked at */
    assert_int_equal(merge_build(&p.a, &p.b, p.b_in_a, &scratch, &p.out, p.b_vertex),
                     ST_ELIMIT);
    assert_int_equal(p.out.nv, 0);
    pair_free(&p);
}
