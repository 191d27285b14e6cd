/* The volume between two surfaces and over one cell: by hand, by the definition in disparity.h,
 * and against exact overlays. */
#include "brute.h"
#include "disparity.h"
#include "holes.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "predicates.h"
#include "unit.h"

#define MAX_POINTS 1200

static struct ivec3 pts_a[MAX_POINTS], pts_b[MAX_POINTS];

struct one {
    struct surface surface;
    struct location loc[MAX_POINTS];
    double other[MAX_POINTS];
};

/* Two surfaces, their general triangulation built from scratch, and their disparity. */
struct both {
    struct one a, b;
    struct mesh general;
    uint32_t b_vertex[MAX_POINTS];
    struct disparity_vertex vertex[2 * MAX_POINTS];
    struct disparity d;
};

static void make_one(struct one *o, const struct ivec3 *pts, size_t n)
{
    struct scratch s = {0};

    brute_delaunay(pts, n, &o->surface.mesh);
    assert_int_equal(mst_build(&o->surface.mesh, &s), ST_OK);
    assert_int_equal(surface_derive(&o->surface, &s), ST_OK);
    scratch_free(&s);
}

/* Marks no triangle but the ghosts as a bridge: a surface without holes. */
static void fill_holes(struct one *o)
{
    int64_t twice = 0;

    for (uint32_t t = 0; t < o->surface.mesh.nt; t++) {
        const uint32_t *v = &o->surface.mesh.org[3 * t];

        o->surface.bridge[t] = mesh_is_ghost(&o->surface.mesh, t);
        if (!o->surface.bridge[t])
            twice += orient2d(o->surface.mesh.xy[v[0]], o->surface.mesh.xy[v[1]],
                              o->surface.mesh.xy[v[2]]);
    }
    for (uint32_t v = 0; v < o->surface.mesh.nv; v++)
        o->surface.spacing[v] = 1e9F;
    o->surface.measured = 0.5 * (double)twice;
}

static void put_into(struct one *o, const struct mesh *other)
{
    for (uint32_t v = 0; v < o->surface.mesh.nv; v++) {
        o->loc[v] = brute_locate(other, o->surface.mesh.xy[v]);
        o->other[v] = locate_height(other, o->loc[v], o->surface.mesh.xy[v]);
    }
}

static void unite(struct both *p)
{
    static struct ivec3 all[2 * MAX_POINTS];
    size_t n = p->a.surface.mesh.nv;

    for (uint32_t v = 0; v < n; v++)
        all[v] = (struct ivec3){p->a.surface.mesh.xy[v].x, p->a.surface.mesh.xy[v].y,
                                p->a.surface.mesh.z[v]};
    for (uint32_t v = 0; v < p->b.surface.mesh.nv; v++) {
        const struct ivec2 q = p->b.surface.mesh.xy[v];
        const struct location at = brute_locate(&p->a.surface.mesh, q);

        if (at.where == LOCATE_VERTEX) {
            p->b_vertex[v] = p->a.surface.mesh.org[at.he];
            continue;
        }
        p->b_vertex[v] = (uint32_t)n;
        all[n++] = (struct ivec3){q.x, q.y, p->b.surface.mesh.z[v]};
    }
    brute_delaunay(all, n, &p->general);
}

static void measure(struct both *p, const struct disparity_weight *weight, double per_mm)
{
    double gap_a[MAX_POINTS], gap_b[MAX_POINTS];
    const struct disparity_side a = {&p->a.surface, gap_a};
    const struct disparity_side b = {&p->b.surface, gap_b};

    memcpy(gap_a, p->a.other, sizeof gap_a);
    memcpy(gap_b, p->b.other, sizeof gap_b);
    disparity_gaps(a.surface, b.surface, p->a.loc, false, gap_a);
    disparity_gaps(b.surface, a.surface, p->b.loc, true, gap_b);
    disparity_measure(&p->general, p->b_vertex, &a, &b, weight, per_mm, p->vertex, &p->d);
}

static struct both *compare(size_t na, size_t nb, bool holes)
{
    struct both *p = calloc(1, sizeof *p);

    assert_non_null(p);
    make_one(&p->a, pts_a, na);
    make_one(&p->b, pts_b, nb);
    if (!holes) {
        fill_holes(&p->a);
        fill_holes(&p->b);
    }
    put_into(&p->a, &p->b.surface.mesh);
    put_into(&p->b, &p->a.surface.mesh);
    unite(p);
    measure(p, NULL, 1);
    return p;
}

static void drop(struct both *p)
{
    surface_free(&p->a.surface);
    surface_free(&p->b.surface);
    mesh_free(&p->general);
    free(p);
}

static bool close_to(double a, double b)
{
    return fabs(a - b) <= 1e-11 * (fabs(a) + fabs(b));
}

/* The same points with other heights: the cells are the triangles of both surfaces, and the
 * disparity is exactly the volume of their overlay. */
TEST(test_same_points)
{
    struct draw r = {brute_seed("disparity") + 2};

    for (int round = 0; round < 6; round++)
        for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
            const size_t n =
                brute_points((enum brute_shape)shape, 4 + draw_next(&r) % 60, &r, pts_a);
            struct both *p;
            double area, volume;

            for (size_t i = 0; i < n; i++) {
                pts_b[i] = pts_a[i];
                pts_b[i].z += brute_int(&r, -1, 1) * brute_int(&r, 0, 3000);
            }
            p = compare(n, n, false);
            volume = brute_volume(&p->a.surface.mesh, &p->b.surface.mesh, &area);
            /* the overlay clips in doubles, at coordinates up to 2^24 */
            assert_true(fabs(p->d.volume_mm3 - volume) <= 1e-7 * volume);
            assert_true(fabs(p->d.area_mm2 - area) <= 1e-7 * area);
            assert_true(p->d.overlap == 1);
            assert_true(p->d.weighted_mm == p->d.plain_mm);
            area = p->d.area_mm2;
            volume = p->d.volume_mm3;
            measure(p, NULL, 2); /* half a millimetre a unit */
            assert_true(p->d.area_mm2 == area / 4);
            assert_true(close_to(p->d.volume_mm3, volume / 8) || volume == 0);
            drop(p);
        }
}

static size_t grid(struct ivec3 *out, int32_t side, struct ivec3 from)
{
    size_t n = 0;

    for (int32_t x = 0; x < side; x++)
        for (int32_t y = 0; y < side; y++)
            out[n++] = (struct ivec3){from.x + 100 * x, from.y + 100 * y, from.z};
    return n;
}

/* Two grids that overlap by half: common area and overlap by hand. */
TEST(test_overlap)
{
    const size_t n = grid(pts_a, 11, (struct ivec3){0, 0, 0});
    struct both *p = compare(n, grid(pts_b, 11, (struct ivec3){500, 0, -7}), true);

    assert_true(p->d.area_mm2 == 50 * 1e4);
    assert_true(p->d.overlap == 0.5);
    assert_true(close_to(p->d.plain_mm, 7));
    p->a.surface.measured = 1; /* less than the common area: the overlap is at most 1 */
    measure(p, NULL, 1);
    assert_true(p->d.overlap == 1);
    p->a.surface.measured = 0;
    measure(p, NULL, 1);
    assert_true(p->d.overlap == 0);
    drop(p);

    p = compare(n, grid(pts_b, 11, (struct ivec3){5000, 0, 0}), true); /* apart */
    assert_true(p->d.area_mm2 == 0 && p->d.volume_mm3 == 0 && p->d.plain_mm == 0);
    assert_true(p->d.overlap == 0 && p->d.weighted_mm == 0);
    drop(p);
}

/* A vertex has the spacing of its mesh; if it is in both meshes, the larger one. */
static void check_spacings(const struct both *p)
{
    static bool shared[2 * MAX_POINTS];

    memset(shared, 0, sizeof shared);
    for (uint32_t v = 0; v < p->b.surface.mesh.nv; v++) {
        const uint32_t g = p->b_vertex[v];
        const float own = p->b.surface.spacing[v];
        const float want =
            g < p->a.surface.mesh.nv ? fmaxf(own, p->a.surface.spacing[g]) : own;

        shared[g] = true;
        assert_true(p->vertex[g].spacing == want);
    }
    for (uint32_t v = 0; v < p->a.surface.mesh.nv; v++)
        assert_true(shared[v] || p->vertex[v].spacing == p->a.surface.spacing[v]);
}

/* Every cell and vertex classified again by the definition in the header. */
static double gap_again(const struct both *p, uint32_t v)
{
    double gap = 0;
    bool bridged = false, outside = false;

    for (int side = 0; side < 2; side++) {
        const struct one *mine = side == 0 ? &p->a : &p->b,
                         *other = side == 0 ? &p->b : &p->a;

        for (uint32_t w = 0; w < mine->surface.mesh.nv; w++) {
            const struct ivec2 q = mine->surface.mesh.xy[w];
            bool covered = false;

            if ((side == 0 ? w : p->b_vertex[w]) != v)
                continue;
            gap = side == 0 ? mine->other[w] - mine->surface.mesh.z[w]
                            : mine->surface.mesh.z[w] - mine->other[w];
            outside |= mine->loc[w].where == LOCATE_OUTSIDE;
            for (uint32_t t = 0; t < other->surface.mesh.nt; t++) {
                bool in =
                    !mesh_is_ghost(&other->surface.mesh, t) && !other->surface.bridge[t];

                for (uint32_t h = 3 * t; in && h < 3 * t + 3; h++)
                    in = orient2d(
                             other->surface.mesh.xy[other->surface.mesh.org[h]],
                             other->surface.mesh.xy[mesh_dest(&other->surface.mesh, h)],
                             q) >= 0;
                covered |= in;
            }
            bridged |= !covered;
        }
    }
    return outside ? (double)NAN : bridged ? (double)INFINITY : gap;
}

TEST(test_classes)
{
    struct draw r = {brute_seed("disparity") + 6};

    for (int round = 0; round < 3 * BRUTE_SHAPES; round++) {
        const size_t na =
            brute_points((enum brute_shape)(round % BRUTE_SHAPES), 150, &r, pts_a);
        const size_t nb = brute_points((enum brute_shape)(round / 3), 150, &r, pts_b);
        struct both *p;
        long double volume = 0;
        int64_t common = 0;

        if (round % 2 == 0) /* some points in both */
            for (size_t i = 0; i < na && i < nb; i += 3)
                pts_b[i] = pts_a[i];
        for (size_t i = 0; i < nb; i++) /* no point twice in one mesh */
            for (size_t j = 0; j < i; j++)
                if (pts_b[i].x == pts_b[j].x && pts_b[i].y == pts_b[j].y)
                    pts_b[j].x++, j = (size_t)-1;
        p = compare(na, nb, true);
        for (uint32_t t = 0; t < p->general.nt; t++) {
            const uint32_t *v = &p->general.org[3 * t];
            double g[3], spread = 0, area;
            int64_t twice;

            if (mesh_is_ghost(&p->general, t))
                continue;
            twice =
                orient2d(p->general.xy[v[0]], p->general.xy[v[1]], p->general.xy[v[2]]);
            for (int i = 0; i < 3; i++) {
                g[i] = gap_again(p, v[i]);
                spread += (double)p->vertex[v[i]].spacing;
                assert_memory_equal(&g[i], &p->vertex[v[i]].gap,
                                    isnan(g[i]) ? 0 : sizeof g[i]);
                assert_int_equal(isnan(g[i]) != 0, isnan(p->vertex[v[i]].gap) != 0);
            }
            if (!isfinite(g[0] + g[1] + g[2]) ||
                holes_wide(p->general.xy[v[0]], p->general.xy[v[1]], p->general.xy[v[2]],
                           spread, &area))
                continue;
            common += twice;
            volume += (long double)disparity_prism(0.5 * (double)twice, g[0], g[1], g[2]);
        }
        check_spacings(p);
        assert_true(p->d.area_mm2 == 0.5 * (double)common);
        assert_true(close_to(p->d.volume_mm3, (double)volume));
        drop(p);
    }
}

/* Heights so high that a plain sum drops most of the small cells: the exact volume is a
 * whole number of sixths. */
TEST(test_compensated)
{
    struct draw r = {brute_seed("disparity") + 7};
    __extension__ __int128 exact = 0;
    size_t n = 0;
    struct both *p;
    double naive = 0, want, ulp;

    for (; n < 900; n++)
        pts_a[n] = (struct ivec3){8000000 + brute_int(&r, 0, 800),
                                  8000000 + brute_int(&r, 0, 800), 0};
    for (size_t i = 0; i < n; i++) /* no point twice */
        for (size_t j = 0; j < i; j++)
            if (pts_a[i].x == pts_a[j].x && pts_a[i].y == pts_a[j].y) {
                pts_a[i--] = pts_a[--n];
                break;
            }
    memcpy(pts_b, pts_a, sizeof pts_a);
    for (size_t i = 0; i < n; i++)
        pts_b[i].z = 1025;
    for (int32_t i = 0; i < 4; i++, n++) {
        pts_a[n] = (struct ivec3){i / 2 * (1 << 24), i % 2 * (1 << 24), -(1 << 24)};
        pts_b[n] = (struct ivec3){pts_a[n].x, pts_a[n].y, (1 << 24) - 1};
    }
    p = compare(n, n, false);
    for (uint32_t t = 0; t < p->general.nt; t++) {
        const uint32_t *v = &p->general.org[3 * t];
        int64_t sum = 0, twice;

        if (mesh_is_ghost(&p->general, t))
            continue;
        twice = orient2d(p->general.xy[v[0]], p->general.xy[v[1]], p->general.xy[v[2]]);
        for (int i = 0; i < 3; i++)
            sum += (int64_t)p->vertex[v[i]].gap;
        exact += (predicates_i128)twice * sum;
        naive += (double)twice * (double)sum;
    }
    want = (double)exact / 6;
    ulp = nextafter(want, INFINITY) - want;
    assert_true(fabs(p->d.volume_mm3 - want) <= 2 * ulp);
    assert_true(fabs(naive / 6 - want) > 20 * ulp); /* a plain sum would not do */
    drop(p);
}

/* ---- one cell */

TEST(test_cell_symmetries)
{
    struct draw r = {brute_seed("disparity") + 9};

    for (int round = 0; round < 5000; round++) {
        const double a = draw_uniform(&r, -0.5, 0.5), b = draw_uniform(&r, -0.5, 0.5);
        const double c = round % 3 == 0   ? 0
                         : round % 7 == 0 ? a
                                          : draw_uniform(&r, -0.5, 0.5);
        const double v = disparity_prism(3, a, b, c);

        assert_true(v > 0);
        assert_true(disparity_prism(3, b, c, a) == v && disparity_prism(3, c, a, b) == v);
        assert_true(disparity_prism(3, b, a, c) == v && disparity_prism(3, c, b, a) == v);
        assert_true(disparity_prism(3, -a, -b, -c) == v);
        assert_true(disparity_prism(3, 1024 * a, 1024 * b, 1024 * c) == 1024 * v);
        assert_true(v <= 3 * (fabs(a) + fabs(b) + fabs(c)) / 3 * (1 + 1e-15));
        assert_true(v >= 3 * fabs(a + b + c) / 3 * (1 - 1e-15));
    }
}

/* The integral of u |gap| by quadrature: the rule at the middles of the sides is exact for the
 * product of two linear functions; pieces in which the gap changes its sign are cut in four
 * again and again. */
static double quadrature(const double gap[3], const double u[3], int depth)
{
    double sum = 0;

    if (depth == 0 || (gap[0] >= 0 && gap[1] >= 0 && gap[2] >= 0) ||
        (gap[0] <= 0 && gap[1] <= 0 && gap[2] <= 0)) {
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3;

            sum += (u[i] + u[j]) / 2 * fabs(gap[i] + gap[j]) / 2;
        }
        return sum / 3;
    }
    for (int part = 0; part < 4; part++) {
        double g[3], w[3];

        for (int i = 0; i < 3; i++) { /* the last piece is the one in the middle */
            const int a = part < 3 ? part : (i + 1) % 3, b = part < 3 ? i : (i + 2) % 3;

            g[i] = (gap[a] + gap[b]) / 2;
            w[i] = (u[a] + u[b]) / 2;
        }
        sum += quadrature(g, w, depth - 1);
    }
    return sum / 4;
}

TEST(test_weighted_by_quadrature)
{
    struct draw r = {brute_seed("disparity") + 10};

    for (int round = 0; round < 300; round++) {
        double gap[3], u[3], want;

        for (int i = 0; i < 3; i++) {
            gap[i] = draw_uniform(&r, -0.5, 0.5);
            u[i] = round % 5 == 0 ? (i == round % 3) : draw_uniform(&r, 0, 1);
        }
        for (int i = 0; i < 3; i++) /* all of them, one, or none are 0 */
            gap[i] *= round > 0 && (round % 4 != 0 || i != round % 3);
        want = 3 * quadrature(gap, u, 16);
        assert_true(fabs(disparity_prism_weighted(3, gap, u) - want) <= 1e-9 * want);
    }
}
