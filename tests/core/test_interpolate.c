/* Heights by barycentric interpolation, inside and beyond the hull. */
#include "brute.h"
#include "locate.h"
#include "mesh.h"
#include "interpolate.h"
#include "unit.h"

#define MAX_POINTS 200

static struct ivec3 pts[MAX_POINTS];

static double height(const struct mesh *m, struct ivec2 q)
{
    return interpolate_height(m, brute_locate(m, q), q);
}

/* On a plane every height is the plane's, up to the largest coordinates. */
TEST(test_plane)
{
    struct brute_rng r = {brute_seed("interpolate")};

    for (int round = 0; round < 20; round++)
        for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
            const int32_t a = brute_int(&r, -1, 1), b = brute_int(&r, -1, 1);
            const size_t n =
                brute_points((enum brute_shape)shape, 4 + brute_rand(&r) % 60, &r, pts);
            struct mesh m = {0};

            for (size_t i = 0; i < n; i++)
                pts[i].z = a * pts[i].x + b * pts[i].y + 17;
            brute_delaunay(pts, n, &m);
            for (int k = 0; k < 60; k++) {
                const struct ivec2 u = m.xy[brute_rand(&r) % n],
                                   v = m.xy[brute_rand(&r) % n];
                const struct ivec2 q = {(u.x + v.x) / 2, (u.y + v.y) / 2};

                if (brute_locate(&m, q).where == LOCATE_OUTSIDE)
                    continue;
                assert_true(fabs(height(&m, q) - (a * q.x + b * q.y + 17)) < 1e-6);
            }
            mesh_free(&m);
        }
}

/* At the vertices the height is the vertex's own, to the last digit, from every triangle. */
TEST(test_vertices)
{
    struct brute_rng r = {brute_seed("interpolate") + 1};

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        const size_t n = brute_points((enum brute_shape)shape, 80, &r, pts);
        struct mesh m = {0};

        brute_delaunay(pts, n, &m);
        for (uint32_t h = 0; h < 3 * m.nt; h++) {
            const struct location at = {h, LOCATE_VERTEX};

            if (!mesh_is_ghost(&m, h / 3))
                assert_true(interpolate_height(&m, at, m.xy[m.org[h]]) == m.z[m.org[h]]);
        }
        mesh_free(&m);
    }
}

/* interpolate_mesh() gives the same heights as point by point. */
TEST(test_interpolate)
{
    struct brute_rng r = {brute_seed("interpolate") + 2};
    static struct location loc[MAX_POINTS];
    static double out[MAX_POINTS];

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        struct mesh a = {0}, b = {0};

        brute_delaunay(pts, brute_points((enum brute_shape)shape, 90, &r, pts), &a);
        brute_delaunay(pts, brute_points(BRUTE_RANDOM, 90, &r, pts), &b);
        for (uint32_t v = 0; v < b.nv; v++)
            loc[v] = brute_locate(&a, b.xy[v]);
        interpolate_mesh(&a, &b, loc, out);
        for (uint32_t v = 0; v < b.nv; v++)
            assert_true(loc[v].where == LOCATE_OUTSIDE
                            ? isnan(out[v])
                            : out[v] == interpolate_height(&a, loc[v], b.xy[v]));
        mesh_free(&a);
        mesh_free(&b);
    }
}
