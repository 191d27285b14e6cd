/* link: -Wl,--wrap=aligned_alloc */
/* mesh_link(), which checks decoded meshes.  Its twins are compared with delaunay_build()'s,
 * and its verdict on damaged meshes with the conditions of mesh.h by definition. */
#include "brute.h"
#include "delaunay.h"
#include "fail_alloc.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "mesh_link.h"
#include "mst.h"
#include "predicates.h"
#include "unit.h"

#define MAX_POINTS 3000

static struct ivec3 pts[MAX_POINTS];
static struct scratch scratch;

static void build(size_t n, struct mesh *m)
{
    assert_int_equal(delaunay_build(pts, n, &scratch, m), ST_OK);
    assert_int_equal(mst_build(m, &scratch), ST_OK);
}

/* A copy of what mesh_link() reads, and nothing else. */
static void strip(const struct mesh *m, struct mesh *out)
{
    assert_int_equal(mesh_copy(out, m, 0), ST_OK);
    brute_code(out);
}

/* ---- the conditions by definition */

/* Is v to the right of the way from a to b, or straight ahead beyond b? */
static bool beyond(const struct mesh *m, uint32_t a, uint32_t b, uint32_t v)
{
    const struct ivec2 p = m->xy[a], q = m->xy[b], r = m->xy[v];
    const int64_t turn = orient2d(p, q, r);

    if (turn != 0)
        return turn < 0;
    return llabs((int64_t)r.x - p.x) + llabs((int64_t)r.y - p.y) >
           llabs((int64_t)q.x - p.x) + llabs((int64_t)q.y - p.y);
}

/* Twice the area of the convex hull, by gift wrapping. */
static int64_t hull_area(const struct mesh *m)
{
    uint32_t first = 0, at, next;
    int64_t area = 0;

    for (uint32_t v = 1; v < m->nv; v++)
        if (lex_less(m->xy[v], m->xy[first]))
            first = v;
    at = first;
    do {
        next = at == 0 ? 1 : 0;
        for (uint32_t v = 0; v < m->nv; v++)
            if (v != at && beyond(m, at, next, v))
                next = v;
        area += orient2d(m->xy[first], m->xy[at], m->xy[next]);
        at = next;
    } while (at != first);
    return area;
}

static bool rings_full(const struct mesh *m)
{
    uint32_t seen = 0;

    for (uint32_t v = 0; v <= m->nv; v++) {
        uint32_t h = m->out[v], steps = 0;

        do {
            if (h >= 3 * m->nt || m->org[h] != v || steps++ > 3 * m->nt)
                return false;
            h = mesh_turn(m, h);
        } while (h != m->out[v]);
        seen += steps;
    }
    return seen == 3 * m->nt;
}

static bool tree_in_mesh(const struct mesh *m)
{
    for (uint32_t v = 1; v < m->nv; v++) {
        bool found = false;

        for (uint32_t h = 0; h < 3 * m->nt; h++)
            found = found || (m->org[h] == v && mesh_dest(m, h) == m->parent[v]);
        if (!found || m->parent[v] >= v)
            return false;
    }
    return m->parent[0] == 0;
}

/* The triangles form a sphere over distinct points; each real one is counter-clockwise, and
 * their areas add up to that of the hull.  Such triangles cannot overlap. */
static bool valid(const struct mesh *m)
{
    int64_t area = 0;

    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t t = m->twin[h];

        if (t >= 3 * m->nt || m->twin[t] != h || t == h || m->org[t] != mesh_dest(m, h) ||
            mesh_dest(m, t) != m->org[h])
            return false;
    }
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *c = m->org + 3 * t;

        if (!mesh_is_ghost(m, t)) {
            const int64_t a = orient2d(m->xy[c[0]], m->xy[c[1]], m->xy[c[2]]);

            if (a <= 0)
                return false;
            area += a;
        }
    }
    for (uint32_t v = 0; v < m->nv; v++)
        for (uint32_t u = 0; u < v; u++)
            if (m->xy[u].x == m->xy[v].x && m->xy[u].y == m->xy[v].y)
                return false;
    return rings_full(m) && area == hull_area(m) && tree_in_mesh(m);
}

/* ---- tests */

TEST(test_links)
{
    struct draw r = {brute_seed("mesh")};
    struct mesh m = {0}, d = {0};

    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t n = 3; n <= MAX_POINTS; n += 1 + n / 2) {
            build(brute_points((enum brute_shape)shape, n, &r, pts), &m);
            strip(&m, &d);
            assert_int_equal(mesh_link(&d, &scratch), ST_OK);
            assert_true(brute_identical(&m, &d));
            assert_int_equal(mesh_check(&d, true), ST_OK);
            assert_true(d.nv > 200 || valid(&d));
        }
    mesh_free(&m);
    mesh_free(&d);
}

/* Triangulations that are not Delaunay are accepted too, if the tree's edges are edges of
 * the mesh. */
TEST(test_flipped)
{
    struct draw r = {brute_seed("flipped")};
    struct mesh m = {0}, d = {0};
    uint32_t accepted = 0;

    for (int round = 0; round < 200; round++) {
        build(brute_points(BRUTE_RANDOM, 40, &r, pts), &m);
        for (int i = 0; i < 3; i++) {
            if (brute_flip(&m, (uint32_t)brute_int(&r, 0, (int32_t)(3 * m.nt) - 1))) {
                brute_order(&m, &r);
                strip(&m, &d);
                if (mesh_link(&d, &scratch) != ST_OK) {
                    assert_false(tree_in_mesh(&d));
                    break;
                }
                assert_true(valid(&d));
                assert_int_equal(mesh_copy(&m, &d, 0), ST_OK); /* its twins are new */
                accepted++;
            }
        }
    }
    assert_true(accepted > 50);
    mesh_free(&m);
    mesh_free(&d);
}

static uint32_t refused, accepted;

/* Links damaged code: if it is accepted, the mesh must be valid. */
static void try(const struct mesh *code, struct mesh *d)
{
    enum status st;

    assert_int_equal(mesh_copy(d, code, 0), ST_OK);
    st = mesh_link(d, &scratch);
    if (st == ST_OK) {
        assert_true(valid(d));
        accepted++;
    } else {
        assert_int_equal(st, ST_ECORRUPT);
        refused++;
    }
}

/* The i-th number of a mesh's code, of 4 nt + nv: four kinds of each triangle, and parents. */
static uint32_t *number(struct mesh *m, uint32_t i)
{
    if (i >= 4 * m->nt)
        return &m->parent[i - 4 * m->nt];
    return i % 4 == 3 ? &m->twin[i / 4 * 3] : &m->org[i / 4 * 3 + i % 4];
}

/* Every number of the code of small meshes, set to every other value. */
TEST(test_each_index)
{
    struct draw r = {brute_seed("indices")};
    struct mesh m = {0}, k = {0}, d = {0};

    refused = accepted = 0;
    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t n = 4; n <= 10; n += 3) {
            build(brute_points((enum brute_shape)shape, n, &r, pts), &m);
            strip(&m, &k);
            for (uint32_t i = 0; i < 4 * k.nt + k.nv; i++) {
                uint32_t *const at = number(&k, i);
                const uint32_t was = *at;

                for (uint32_t v = 0; v <= 3 * k.nt + 2; v++) {
                    *at = v <= 3 * k.nt       ? v
                          : v == 3 * k.nt + 1 ? UINT32_C(0x80000000)
                                              : UINT32_MAX;
                    if (*at != was && was != UINT32_MAX)
                        try(&k, &d);
                }
                *at = was;
            }
        }
    print_message("%u refused, %u accepted\n", refused, accepted);
    assert_true(refused > 10000);
    mesh_free(&m);
    mesh_free(&k);
    mesh_free(&d);
}

/* A pair that is listed twice, in place of another: the other one would be without twins. */
TEST(test_pair_twice)
{
    struct draw r = {brute_seed("pairs")};
    struct mesh m = {0}, k = {0}, d = {0};

    build(brute_points(BRUTE_RANDOM, 20, &r, pts), &m);
    strip(&m, &k);
    refused = accepted = 0;
    for (uint32_t t = 2; t < k.nt; t += 2) {
        const uint32_t h = k.org[3 * t + 1], g = k.org[3 * t + 4];

        k.org[3 * t + 1] = k.org[1];
        k.org[3 * t + 4] = k.org[4];
        try(&k, &d);
        k.org[3 * t + 1] = k.org[4];
        k.org[3 * t + 4] = k.org[1];
        try(&k, &d);
        k.org[3 * t + 1] = h;
        k.org[3 * t + 4] = g;
    }
    assert_int_equal(accepted, 0);
    try(&k, &d);
    assert_int_equal(accepted, 1);
    mesh_free(&m);
    mesh_free(&k);
    mesh_free(&d);
}

/* Up to three numbers exchanged or overwritten, points moved. */
TEST(test_damaged)
{
    struct draw r = {brute_seed("damaged")};
    struct mesh m = {0}, code = {0}, k = {0}, d = {0};

    refused = accepted = 0;
    for (int round = 0; round < 40000; round++) {
        if (round % 100 == 0) {
            build(
                brute_points((enum brute_shape)(round / 100 % BRUTE_SHAPES), 14, &r, pts),
                &m);
            strip(&m, &code);
        }
        assert_int_equal(mesh_copy(&k, &code, 0), ST_OK);
        for (int changes = brute_int(&r, 1, 3); changes > 0; changes--) {
            const int32_t last = (int32_t)k.nt - 1;
            const uint32_t kind = (uint32_t)brute_int(&r, 0, 3);
            uint32_t *const a = number(&k, 4 * (uint32_t)brute_int(&r, 0, last) + kind);
            uint32_t *const b = number(&k, 4 * (uint32_t)brute_int(&r, 0, last) + kind);
            const uint32_t v = (uint32_t)brute_int(&r, 0, (int32_t)k.nv - 1), was = *a;

            switch (brute_int(&r, 0, 3)) {
            case 0:
                *a = *b;
                break;
            case 1:
                *a = *b;
                *b = was;
                break;
            case 2:
                k.xy[v] = k.xy[brute_int(&r, 0, (int32_t)k.nv - 1)];
                break;
            default:
                k.xy[v].x += brute_int(&r, -40, 40);
                k.xy[v].y += brute_int(&r, -40, 40);
            }
        }
        try(&k, &d);
    }
    print_message("%u refused, %u accepted\n", refused, accepted);
    assert_true(refused > 10000 && accepted > 100);
    mesh_free(&m);
    mesh_free(&code);
    mesh_free(&k);
    mesh_free(&d);
}

/* A fan whose rim goes round its centre twice: edges pair, all triangles are counter-clockwise
 * and the hull turns left at each corner, but it makes two turns. */
TEST(test_turns_twice)
{
    static const struct ivec2 rim[5] = {
        {1000, 0}, {309, 951}, {-809, 588}, {-809, -588}, {309, -951}};
    struct mesh m = {0};

    for (uint32_t step = 1; step <= 2; step++) {
        assert_int_equal(mesh_reserve(&m, 6), ST_OK);
        m.nv = 6;
        m.nt = 10;
        m.xy[0] = (struct ivec2){0, 0};
        memset(m.z, 0, 6 * sizeof *m.z);
        memset(m.parent, 0, 6 * sizeof *m.parent);
        for (uint32_t i = 0; i < 5; i++) {
            const uint32_t clockwise[3] = {5 - i, i < 4 ? 4 - i : 5, 6};
            const uint32_t real[3] = {0, 1 + i, 1 + (i + 1) % 5};

            m.xy[1 + i] = rim[i * step % 5];
            memcpy(m.org + 3 * i, clockwise, sizeof clockwise);
            memcpy(m.org + 3 * (5 + i), real, sizeof real);
        }
        brute_order(&m, NULL);
        brute_code(&m);
        assert_int_equal(mesh_link(&m, &scratch), step == 1 ? ST_OK : ST_ECORRUPT);
    }
    mesh_free(&m);
}

TEST(test_limits)
{
    struct draw r = {brute_seed("limits")};
    struct mesh m = {0}, d = {0};
    int32_t *at;

    build(brute_points(BRUTE_RANDOM, 50, &r, pts), &m);
    for (int i = 0; i < 3; i++) {
        at = i == 0 ? &m.z[7] : i == 1 ? &m.xy[0].x : &m.xy[49].y;
        for (int k = 0; k < 4; k++) {
            const int32_t was = *at;

            *at = k == 0   ? LATTICE_MAX + 1
                  : k == 1 ? -LATTICE_MAX - 1
                  : k == 2 ? INT32_MAX
                           : INT32_MIN;
            strip(&m, &d);
            assert_int_equal(mesh_link(&d, &scratch), ST_ECORRUPT);
            *at = was;
        }
    }
    m.z[7] = LATTICE_MAX;
    m.z[8] = -LATTICE_MAX;
    strip(&m, &d);
    assert_int_equal(mesh_link(&d, &scratch), ST_OK);
    strip(&m, &d);
    d.nt--;
    assert_int_equal(mesh_link(&d, &scratch), ST_ECORRUPT);
    d.nv = 2;
    d.nt = 2;
    assert_int_equal(mesh_link(&d, &scratch), ST_ECORRUPT);
    mesh_free(&m);
    mesh_free(&d);
}

TEST(test_no_memory)
{
    struct draw r = {brute_seed("memory")};
    struct mesh m = {0}, d = {0};
    struct scratch empty = {0};

    build(brute_points(BRUTE_RANDOM, 30, &r, pts), &m);
    strip(&m, &d);
    fail_alloc_at(1);
    assert_int_equal(mesh_link(&d, &empty), ST_ENOMEM);
    fail_alloc_at(0);
    assert_int_equal(mesh_link(&d, &empty), ST_OK);
    assert_true(brute_identical(&m, &d));
    scratch_free(&empty);
    scratch_free(&scratch);
    mesh_free(&m);
    mesh_free(&d);
}
