/* The spanning tree in stages, against Prim's rule on the whole graph. */
#include "brute.h"
#include "delaunay.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "predicates.h"
#include "unit.h"

#define MAX_POINTS 700

static struct ivec3 pts[MAX_POINTS];
static uint32_t prim[MAX_POINTS];

static uint32_t vertex_at(const struct mesh *m, struct ivec2 p)
{
    for (uint32_t v = 0; v < m->nv; v++)
        if (m->xy[v].x == p.x && m->xy[v].y == p.y)
            return v;
    fail();
    return 0;
}

/* The tree is Prim's, edge for edge, and the numbering is that of mesh.h. */
static void check_tree(const struct mesh *m, const struct mesh *before)
{
    assert_int_equal(m->nv, before->nv);
    assert_int_equal(m->nt, before->nt);
    assert_int_equal(m->parent[0], 0);
    brute_prim(before, prim);
    for (uint32_t v = 1; v < m->nv; v++) {
        const uint32_t old = vertex_at(before, m->xy[v]);
        const struct ivec2 p = m->xy[m->parent[v]], q = before->xy[prim[old]];

        assert_true(m->parent[v] < v);
        assert_true(p.x == q.x && p.y == q.y);
        assert_int_equal(m->z[v], before->z[old]);
        assert_true(lex_less(m->xy[0], m->xy[v]));
    }
    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t a = m->org[h], b = before->org[h];

        assert_int_equal(m->twin[h], before->twin[h]);
        assert_true(a == m->nv
                        ? b == m->nv
                        : m->xy[a].x == before->xy[b].x && m->xy[a].y == before->xy[b].y);
    }
    for (uint32_t v = 0; v <= m->nv; v++)
        assert_int_equal(m->org[m->out[v]], v);
    assert_int_equal(mst_check(m), ST_OK);
}

/* Preorder of a depth-first walk: the parent of v is v - 1 or an ancestor of it. */
static void check_preorder(const struct mesh *m)
{
    for (uint32_t v = 1; v < m->nv; v++) {
        uint32_t u = v - 1;

        while (u != m->parent[v]) {
            assert_true(u > 0);
            u = m->parent[u];
        }
    }
}

TEST(test_against_prim)
{
    struct draw r = {brute_seed("mst")};
    struct scratch s = {0};

    for (int round = 0; round < 30; round++)
        for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
            struct mesh m = {0}, before = {0};
            const size_t n =
                brute_points((enum brute_shape)shape, 3 + draw_next(&r) % 90, &r, pts);

            brute_delaunay(pts, n, &m);
            for (int i = 0; round % 2 != 0 && i < 100;
                 i++) /* so that it is not Delaunay */
                (void)brute_flip(&m, (uint32_t)(draw_next(&r) % (3 * m.nt)));
            assert_int_equal(mesh_copy(&before, &m, 0), ST_OK);
            assert_int_equal(mst_build(&m, &s), ST_OK);
            check_tree(&m, &before);
            check_preorder(&m);
            mesh_free(&m);
            mesh_free(&before);
        }
    scratch_free(&s);
}

/* The tree and its numbering are a function of the set of points, also when built from a
 * mesh that already has them. */
TEST(test_canonical)
{
    struct draw r = {brute_seed("mst") + 1};
    struct scratch s = {0};

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        struct mesh a = {0}, b = {0};
        const size_t n = brute_points((enum brute_shape)shape, 300, &r, pts);

        brute_delaunay(pts, n, &a);
        brute_shuffle(pts, n, sizeof *pts, &r);
        brute_delaunay(pts, n, &b);
        assert_int_equal(mst_build(&a, &s), ST_OK);
        for (int again = 0; again < 2; again++) {
            assert_int_equal(mst_build(&b, &s), ST_OK);
            assert_memory_equal(a.xy, b.xy, n * sizeof *a.xy);
            assert_memory_equal(a.z, b.z, n * sizeof *a.z);
            assert_memory_equal(a.parent, b.parent, n * sizeof *a.parent);
        }
        mesh_free(&a);
        mesh_free(&b);
    }
    scratch_free(&s);
}

/* mst_check() must notice a tree that spans but is not minimal. */
TEST(test_check)
{
    struct draw r = {brute_seed("mst") + 2};
    struct scratch s = {0};
    struct mesh m = {0};
    int caught = 0;

    brute_delaunay(pts, brute_points(BRUTE_RANDOM, 60, &r, pts), &m);
    assert_int_equal(mst_build(&m, &s), ST_OK);
    for (uint32_t h = 0; h < 3 * m.nt; h++) {
        const uint32_t u = mesh_dest(&m, h), v = m.org[h],
                       keep = v < m.nv ? m.parent[v] : 0;

        if (v >= m.nv || u >= v || u == keep)
            continue;
        m.parent[v] = u;
        assert_int_equal(mst_check(&m), ST_ECORRUPT);
        m.parent[v] = keep;
        caught++;
    }
    assert_true(caught > 60);
    m.parent[5] = 5;
    assert_int_equal(mst_check(&m), ST_ECORRUPT);
    m.parent[0] = 1;
    assert_int_equal(mst_check(&m), ST_ECORRUPT);
    mesh_free(&m);
    scratch_free(&s);
}

/* A tree as deep as its number of points (along a line with growing distances); and a large
 * tree. */
TEST(test_deep_and_large)
{
    struct draw r = {brute_seed("mst") + 3};
    struct scratch s = {0};
    struct mesh m = {0};
    const size_t n = 20000;
    struct ivec3 *many = malloc(n * sizeof *many);

    assert_non_null(many);
    for (int32_t i = 0; i < 4000; i++)
        many[i] = (struct ivec3){i * (i + 1) / 2, i % 2, 0};
    assert_int_equal(delaunay_build(many, 4000, &s, &m), ST_OK);
    assert_int_equal(mst_build(&m, &s), ST_OK);
    for (uint32_t v = 1; v < m.nv; v++)
        assert_int_equal(m.parent[v], v - 1);
    assert_int_equal(mst_check(&m), ST_OK);
    for (size_t i = 0; i < n; i++)
        many[i] = (struct ivec3){brute_int(&r, -999999, 999999),
                                 brute_int(&r, -99999, 99999), 0};
    assert_int_equal(delaunay_build(many, n, &s, &m), ST_OK);
    assert_int_equal(mst_build(&m, &s), ST_OK);
    assert_int_equal(mesh_check(&m, true), ST_OK);
    assert_int_equal(mst_check(&m), ST_OK);
    check_preorder(&m);
    mesh_free(&m);
    scratch_free(&s);
    free(many);
}
