/* Local spacing and the triangles that only bridge missing points. */
#include "brute.h"
#include "delaunay.h"
#include "holes.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "predicates.h"
#include "unit.h"

#define MAX_POINTS 4000

static struct ivec3 pts[MAX_POINTS];
static float spacing[MAX_POINTS];
static uint8_t bridge[2 * MAX_POINTS];
static struct scratch scratch;

static double make(struct mesh *m, size_t n)
{
    assert_int_equal(delaunay_build(pts, n, &scratch, m), ST_OK);
    assert_int_equal(mst_build(m, &scratch), ST_OK);
    assert_int_equal(holes_spacing(m, &scratch, spacing), ST_OK);
    return holes_mark(m, spacing, bridge);
}

/* A square grid of side points a side, step apart, without the points of the block. */
static size_t grid(int32_t side, int32_t step, int32_t from, int32_t to)
{
    size_t n = 0;

    for (int32_t x = 0; x < side; x++)
        for (int32_t y = 0; y < side; y++)
            if (x < from || x > to || y < from || y > to)
                pts[n++] = (struct ivec3){x * step, y * step, 0};
    return n;
}

static bool bridged_at(const struct mesh *m, int32_t x, int32_t y)
{
    return bridge[brute_locate(m, (struct ivec2){x, y}).he / 3] != 0;
}

/* The spacing by its definition: sums over the tree's edges, spread twice to the neighbours,
 * at most the limit. */
TEST(test_spacing)
{
    struct draw r = {brute_seed("holes")};
    static double sum[100], count[100], s2[100], c2[100];

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        struct mesh m = {0};
        double all = 0;

        (void)make(&m, brute_points((enum brute_shape)shape, 90, &r, pts));
        memset(sum, 0, sizeof sum);
        memset(count, 0, sizeof count);
        for (uint32_t v = 0; v < m.nv; v++)
            for (uint32_t w = 1; w < m.nv; w++)
                if (w == v || m.parent[w] == v) {
                    const uint32_t p = m.parent[w];

                    sum[v] += hypot(m.xy[w].x - m.xy[p].x, m.xy[w].y - m.xy[p].y);
                    count[v] += 1;
                }
        for (int step = 0; step < 2; step++) {
            memcpy(s2, sum, sizeof sum);
            memcpy(c2, count, sizeof count);
            for (uint32_t v = 0; v < m.nv; v++)
                for (uint32_t w = 0; w < m.nv; w++)
                    if (w != v && (m.parent[w] == v || m.parent[v] == w)) {
                        sum[v] += s2[w];
                        count[v] += c2[w];
                    }
        }
        for (uint32_t v = 1; v < m.nv; v++)
            all +=
                hypot(m.xy[v].x - m.xy[m.parent[v]].x, m.xy[v].y - m.xy[m.parent[v]].y);
        for (uint32_t v = 0; v < m.nv; v++) {
            const double want = fmin(sum[v] / count[v], HOLES_MOST * all / (m.nv - 1));

            assert_true(fabs(spacing[v] - want) <= 1e-6 * want);
        }
        mesh_free(&m);
    }
}

static bool bridges(const struct mesh *m, const float *space, uint32_t a, uint32_t b,
                    uint32_t c)
{
    const double sum = (double)space[a] + (double)space[b] + (double)space[c];
    double twice;

    return holes_wide(m->xy[a], m->xy[b], m->xy[c], sum, &twice);
}

/* The marks agree with holes_wide() triangle by triangle, and the measured area is that of
 * the triangles without a mark. */
TEST(test_marks)
{
    struct draw r = {brute_seed("holes") + 1};

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        struct mesh m = {0};
        const double measured =
            make(&m, brute_points((enum brute_shape)shape, 300, &r, pts));
        int64_t twice = 0;

        for (uint32_t t = 0; t < m.nt; t++) {
            const uint32_t *v = &m.org[3 * t];

            if (mesh_is_ghost(&m, t)) {
                assert_int_equal(bridge[t], 1);
                continue;
            }
            assert_int_equal(bridge[t], bridges(&m, spacing, v[0], v[1], v[2]));
            assert_int_equal(bridge[t], bridges(&m, spacing, v[2], v[1], v[0]));
            if (!bridge[t])
                twice += orient2d(m.xy[v[0]], m.xy[v[1]], m.xy[v[2]]);
        }
        assert_true(measured == 0.5 * (double)twice);
        mesh_free(&m);
    }
}

/* A whole grid has no holes; where a block is missing, exactly the block is a hole. */
TEST(test_block)
{
    struct mesh m = {0};
    double measured;

    assert_true(make(&m, grid(30, 700, 99, 0)) == 29.0 * 29 * 700 * 700);
    for (uint32_t t = 0; t < m.nt; t++)
        assert_int_equal(bridge[t], mesh_is_ghost(&m, t));
    mesh_free(&m);

    measured = make(&m, grid(30, 700, 10, 18)); /* a hole of 10 x 10 steps */
    assert_true(bridged_at(&m, 9950, 9850));
    assert_true(bridged_at(&m, 8450, 8340));
    for (int32_t x = 0; x < 29; x++)
        for (int32_t y = 0; y < 29; y++)
            if (x < 9 || x > 18 || y < 9 || y > 18)
                assert_false(bridged_at(&m, 700 * x + 300, 700 * y + 310));
    assert_true(measured >= 741.0 * 700 * 700 && measured <= 765.0 * 700 * 700);
    mesh_free(&m);

    (void)make(&m, grid(30, 700, 10, 11)); /* two points by two missing: no hole */
    for (uint32_t t = 0; t < m.nt; t++)
        assert_int_equal(bridge[t], mesh_is_ghost(&m, t));
    mesh_free(&m);
}
