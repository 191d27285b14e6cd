/* Location by walking, compared with a search of all triangles; heights at the locations. */
#include "brute.h"
#include "chains.h"
#include "delaunay.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "predicates.h"
#include "unit.h"

#define MAX_POINTS 400

static struct mesh make(enum brute_shape shape, size_t n, struct draw *r)
{
    static struct ivec3 pts[MAX_POINTS];
    struct mesh m = {0};

    n = brute_points(shape, n, r, pts);
    brute_delaunay(pts, n, &m);
    return m;
}

/* Flips edges in every second mesh, so that it is not Delaunay: location must work in any
 * triangulation. */
static void disturb(struct mesh *m, int round, struct draw *r)
{
    for (int i = 0; round % 2 != 0 && i < 100; i++)
        (void)brute_flip(m, (uint32_t)(draw_next(r) % (3 * m->nt)));
}

static bool same_xy(struct ivec2 a, struct ivec2 b)
{
    return a.x == b.x && a.y == b.y;
}

/* q must lie where `at` says, by the sides of that triangle alone. */
static void check_location(const struct mesh *m, struct location at, struct ivec2 q)
{
    const struct location ref = brute_locate(m, q);
    struct ivec2 a, b, c;

    assert_int_equal(at.where, ref.where);
    assert_in_range(at.he, 0, 3 * m->nt - 1);
    assert_false(mesh_is_ghost(m, at.he / 3));
    a = m->xy[m->org[at.he]];
    b = m->xy[mesh_dest(m, at.he)];
    c = m->xy[m->org[mesh_prev(at.he)]];
    switch (at.where) {
    case LOCATE_INSIDE:
        assert_true(orient2d(a, b, q) > 0 && orient2d(b, c, q) > 0 &&
                    orient2d(c, a, q) > 0);
        break;
    case LOCATE_EDGE:
        assert_true(orient2d(a, b, q) == 0 && orient2d(b, c, q) > 0 &&
                    orient2d(c, a, q) > 0);
        break;
    case LOCATE_VERTEX:
        assert_true(same_xy(a, q));
        break;
    default:
        assert_true(mesh_is_ghost(m, m->twin[at.he] / 3));
        assert_true(orient2d(a, b, q) < 0);
    }
}

/* The kinds of query points: vertices, middles of edges, inside, near and far outside. */
static struct ivec2 query(const struct mesh *m, struct draw *r)
{
    const struct ivec2 a = m->xy[draw_next(r) % m->nv], b = m->xy[draw_next(r) % m->nv];
    const int32_t far = 1 << 24;
    struct ivec2 q = a;

    switch (draw_next(r) % 6) {
    case 0:
        break;
    case 1:
        q.x = (int32_t)(((int64_t)a.x + b.x) / 2);
        q.y = (int32_t)(((int64_t)a.y + b.y) / 2);
        break;
    case 2: /* on the line through two points, beyond one: along collinear vertices */
        q.x = 2 * a.x - b.x;
        q.y = 2 * a.y - b.y;
        break;
    case 3:
        q.x += brute_int(r, -3, 3);
        q.y += brute_int(r, -3, 3);
        break;
    case 4:
        q.x = a.x;
        q.y = b.y;
        break;
    default:
        q.x = brute_int(r, -far, far);
        q.y = brute_int(r, -far, far);
    }
    q.x = q.x > far ? far : q.x < -far ? -far : q.x;
    q.y = q.y > far ? far : q.y < -far ? -far : q.y;
    return q;
}

static void walk_and_check(const struct mesh *m, struct draw *r)
{
    struct ivec2 start = query(m, r);
    const struct ivec2 q = query(m, r);
    struct location from = brute_locate(m, start);

    if (from.where == LOCATE_OUTSIDE) {
        start = m->xy[m->org[from.he]];
        from = brute_locate(m, start);
    }
    check_location(m, locate_point(m, from.he, start, q, NULL), q);
}

TEST(test_point)
{
    struct draw r = {brute_seed("locate")};

    for (int round = 0; round < 40; round++)
        for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
            struct mesh m = make((enum brute_shape)shape, 3 + draw_next(&r) % 60, &r);

            disturb(&m, round, &r);
            for (int k = 0; k < 60; k++)
                walk_and_check(&m, &r);
            mesh_free(&m);
        }
}

/* chains_find() gives a triangle that contains q, or a hull edge beyond which it lies. */
static void check_find(const struct mesh *m, const struct chains *c, struct ivec2 q)
{
    uint32_t he = UINT32_MAX;
    const bool inside = chains_find(c, q, &he);

    assert_int_equal(inside, brute_locate(m, q).where != LOCATE_OUTSIDE);
    assert_in_range(he, 0, 3 * m->nt - 1);
    assert_false(mesh_is_ghost(m, he / 3));
    assert_true(inside || mesh_is_ghost(m, m->twin[he] / 3));
    for (int i = 0; i < 3; i++, he = mesh_next(he)) {
        const int64_t side = orient2d(m->xy[m->org[he]], m->xy[mesh_dest(m, he)], q);

        assert_true(inside ? side >= 0 : i > 0 || side < 0);
    }
}

TEST(test_chains)
{
    struct draw r = {brute_seed("locate") + 1};
    struct scratch s = {0};

    for (int round = 0; round < 60; round++)
        for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
            struct mesh m = make((enum brute_shape)shape, 3 + draw_next(&r) % 60, &r);
            struct chains c;

            disturb(&m, round, &r);
            assert_int_equal(chains_make(&m, &s, &c), ST_OK);
            for (int k = 0; k < 60; k++)
                check_find(&m, &c, query(&m, &r));
            for (uint32_t v = 0; v < m.nv; v++)
                check_find(&m, &c, m.xy[v]);
            mesh_free(&m);
        }
    scratch_free(&s);
}

/* Whole meshes, along any tree: what the walk finds does not depend on the tree. */
TEST(test_mesh)
{
    struct draw r = {brute_seed("locate") + 2};
    static struct location loc[MAX_POINTS];

    for (int round = 0; round < 12; round++)
        for (int pair = 0; pair < BRUTE_SHAPES * BRUTE_SHAPES; pair++) {
            struct mesh in =
                make((enum brute_shape)(pair / BRUTE_SHAPES), 3 + draw_next(&r) % 80, &r);
            struct mesh pts =
                make((enum brute_shape)(pair % BRUTE_SHAPES), 3 + draw_next(&r) % 80, &r);

            disturb(&in, round, &r);
            pts.parent[0] = 0;
            for (uint32_t v = 1; v < pts.nv; v++)
                pts.parent[v] = (uint32_t)(draw_next(&r) % v);
            if (round % 3 == 0) /* points that both have */
                for (uint32_t v = 0; v < pts.nv; v += 2)
                    pts.xy[v] = in.xy[draw_next(&r) % in.nv];
            assert_int_equal(locate_mesh(&in, &pts, loc), ST_OK);
            for (uint32_t v = 0; v < pts.nv; v++)
                check_location(&in, loc[v], pts.xy[v]);
            mesh_free(&in);
            mesh_free(&pts);
        }
}

/* Two columns with needles between them, and points that a tree visits up and down across
 * the needles: most of the points are located without a walk. */
TEST(test_needles)
{
    enum { N = 3000 };
    static struct ivec3 pts[N];
    static struct location loc[N];
    struct draw r = {brute_seed("locate") + 4};
    struct scratch s = {0};
    struct mesh in = {0}, across = {0};

    for (int i = 0; i < N; i++)
        pts[i] = (struct ivec3){i % 2 * 8000000, i / 2 * 1000, 0};
    assert_int_equal(delaunay_build(pts, N, &s, &in), ST_OK);
    for (int i = 0; i < N; i++)
        pts[i] = (struct ivec3){brute_int(&r, -100000, 8100000),
                                brute_int(&r, -10000, N / 2 * 1000), 0};
    assert_int_equal(delaunay_build(pts, N, &s, &across), ST_OK);
    across.parent[0] = 0;
    for (uint32_t v = 1; v < across.nv; v++)
        across.parent[v] = v - 1;
    assert_int_equal(locate_mesh(&in, &across, loc), ST_OK);
    for (uint32_t v = 0; v < across.nv; v += 7)
        check_location(&in, loc[v], across.xy[v]);
    mesh_free(&in);
    mesh_free(&across);
    scratch_free(&s);
}

/* ---- heights */

/* On a plane every height is the plane's, up to the largest coordinates. */
TEST(test_plane)
{
    struct draw r = {brute_seed("locate") + 5};

    for (int round = 0; round < 20 * BRUTE_SHAPES; round++) {
        const int32_t a = brute_int(&r, -1, 1), b = brute_int(&r, -1, 1);
        struct mesh m =
            make((enum brute_shape)(round % BRUTE_SHAPES), 4 + draw_next(&r) % 60, &r);

        for (uint32_t v = 0; v < m.nv; v++)
            m.z[v] = a * m.xy[v].x + b * m.xy[v].y + 17;
        for (int k = 0; k < 60; k++) {
            const struct ivec2 q = query(&m, &r);
            const struct location at = brute_locate(&m, q);

            if (at.where == LOCATE_OUTSIDE)
                assert_true(isnan(locate_height(&m, at, q)));
            else
                assert_true(fabs(locate_height(&m, at, q) - (a * q.x + b * q.y + 17)) <
                            1e-6);
        }
        mesh_free(&m);
    }
}

/* At the vertices the height is the vertex's own, to the last digit, from every triangle; those of
 * a whole mesh are those of its points. */
TEST(test_heights)
{
    struct draw r = {brute_seed("locate") + 6};
    static struct location loc[MAX_POINTS];
    static double out[MAX_POINTS];

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        struct mesh m = make((enum brute_shape)shape, 80, &r);
        struct mesh of = make(BRUTE_RANDOM, 90, &r);

        for (uint32_t h = 0; h < 3 * m.nt; h++) {
            const struct location at = {h, LOCATE_VERTEX};

            if (!mesh_is_ghost(&m, h / 3))
                assert_true(locate_height(&m, at, m.xy[m.org[h]]) == m.z[m.org[h]]);
        }
        for (uint32_t v = 0; v < of.nv; v++)
            loc[v] = brute_locate(&m, of.xy[v]);
        locate_heights(&m, &of, loc, out);
        for (uint32_t v = 0; v < of.nv; v++)
            assert_true(loc[v].where == LOCATE_OUTSIDE
                            ? isnan(out[v])
                            : out[v] == locate_height(&m, loc[v], of.xy[v]));
        mesh_free(&m);
        mesh_free(&of);
    }
}
