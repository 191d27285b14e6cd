/* The volume between two surfaces: by hand, against exact overlays, and by its symmetries. */
#include "brute.h"
#include "disparity.h"
#include "holes.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "predicates.h"
#include "interpolate.h"
#include "unit.h"

#define MAX_POINTS 1200

static uint64_t seed;
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
        o->other[v] = interpolate_height(other, o->loc[v], o->surface.mesh.xy[v]);
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

static size_t square(struct ivec3 *out, int32_t (*height)(int32_t x, int32_t y))
{
    static const struct ivec2 at[] = {{0, 0}, {12, 0}, {12, 12}, {0, 12}, {6, 6}};

    for (size_t i = 0; i < 5; i++)
        out[i] = (struct ivec3){at[i].x, at[i].y, height(at[i].x, at[i].y)};
    return 5;
}

static int32_t level(int32_t x, int32_t y)
{
    return 0 * (x + y);
}

static int32_t higher(int32_t x, int32_t y)
{
    return 7 + 0 * (x + y);
}

static int32_t slope(int32_t x, int32_t y)
{
    return x - 6 + 0 * y;
}

static int32_t pyramid(int32_t x, int32_t y)
{
    return x == 6 && y == 6 ? 60 : 0;
}

/* Parallel planes, crossing planes, a pyramid, over a square of 12 x 12. */
TEST(test_by_hand)
{
    const struct {
        int32_t (*height)(int32_t x, int32_t y);
        double volume;
    } want[] = {{level, 0}, {higher, 7 * 144}, {slope, 432}, {pyramid, 60 * 144 / 3}};

    for (size_t i = 0; i < 4; i++) {
        const size_t n = square(pts_a, level);
        struct both *p = compare(n, square(pts_b, want[i].height), false);

        assert_true(close_to(p->d.volume_mm3, want[i].volume) || want[i].volume == 0);
        assert_true(p->d.area_mm2 == 144);
        assert_true(close_to(p->d.plain_mm, want[i].volume / 144));
        assert_true(p->d.weighted_mm == p->d.plain_mm);
        assert_true(p->d.overlap == 1);
        assert_int_equal(p->d.common, 4);
        assert_int_equal(p->d.bridged + p->d.outside, 0);
        measure(p, NULL, 2); /* half a millimetre a unit */
        assert_true(close_to(p->d.volume_mm3, want[i].volume / 8) || want[i].volume == 0);
        assert_true(p->d.area_mm2 == 36);
        assert_true(close_to(p->d.plain_mm, want[i].volume / 288));
        drop(p);
    }
}

/* The same points with other heights: the cells are the triangles of both surfaces, and the
 * disparity is exactly the volume of their overlay. */
TEST(test_same_points)
{
    struct brute_rng r = {seed + 2};

    for (int round = 0; round < 6; round++)
        for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
            const size_t n =
                brute_points((enum brute_shape)shape, 4 + brute_rand(&r) % 60, &r, pts_a);
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
            drop(p);
        }
}

/* Two planes, whatever the points: the disparity is exact over the common hull. */
TEST(test_planes)
{
    struct brute_rng r = {seed + 3};

    for (int round = 0; round < 40; round++) {
        size_t n[2];
        struct both *p;
        double area, volume;

        for (int side = 0; side < 2; side++) {
            struct ivec3 *pts = side == 0 ? pts_a : pts_b;
            const int32_t a = brute_int(&r, -3, 3), b = brute_int(&r, -3, 3);

            n[side] = brute_points(round % 2 == 0 ? BRUTE_RANDOM : BRUTE_HULL_LINE, 50,
                                   &r, pts);
            for (int32_t i = 0; i < 4; i++) /* one hull for both */
                pts[n[side]++] =
                    (struct ivec3){i / 2 * 200000 - 100000, i % 2 * 200000 - 100000, 0};
            for (size_t i = 0; i < n[side]; i++)
                pts[i].z = a * pts[i].x + b * pts[i].y + 1000 * side;
        }
        p = compare(n[0], n[1], false);
        volume = brute_volume(&p->a.surface.mesh, &p->b.surface.mesh, &area);
        assert_true(p->d.area_mm2 == 4e10);
        assert_true(fabs(p->d.volume_mm3 - volume) <= 1e-9 * volume);
        drop(p);
    }
}

/* Smooth surfaces densely sampled: the volume is close to that of the overlay over their
 * common area. */
TEST(test_smooth)
{
    struct brute_rng r = {seed + 4};
    struct both *p;
    double area, volume;

    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 500; i++) {
            struct ivec3 q = {brute_int(&r, -60000, 60000), brute_int(&r, -60000, 60000),
                              0};

            q.z = (int32_t)(9000 * cos(q.x * 3e-5) * cos(q.y * 2e-5)) +
                  side * (int32_t)(3000 * sin(q.x * 4e-5));
            (side == 0 ? pts_a : pts_b)[i] = q;
        }
    p = compare(500, 500, false);
    volume = brute_volume(&p->a.surface.mesh, &p->b.surface.mesh, &area);
    assert_true(p->d.area_mm2 <= area && p->d.area_mm2 > 0.9 * area);
    assert_true(fabs(p->d.plain_mm - volume / area) < 0.01 * volume / area);
    drop(p);
}

/* Exchanging, shifting and mirroring the surfaces does not matter. */
TEST(test_symmetries)
{
    struct brute_rng r = {seed + 5};

    for (int round = 0; round < 16; round++) {
        const bool holes = round % 2 == 0;
        const size_t na = brute_points(BRUTE_RANDOM, 150, &r, pts_a);
        size_t nb =
            brute_points(round % 4 < 2 ? BRUTE_RANDOM : BRUTE_CLUSTERS, 150, &r, pts_b);
        struct both *first, *p;

        if (round % 3 == 0) /* some points in both */
            for (size_t i = 0; i < 40; i++)
                pts_b[i] = pts_a[i];
        first = compare(na, nb, holes);
        for (int change = 0; change < 3; change++) {
            for (size_t i = 0; i < (na > nb ? na : nb); i++) {
                struct ivec3 t = pts_a[i];

                if (change == 0) { /* swap */
                    pts_a[i] = pts_b[i];
                    pts_b[i] = t;
                } else if (change == 1) { /* mirror */
                    pts_a[i].x = -pts_a[i].x;
                    pts_b[i].x = -pts_b[i].x;
                } else { /* shift both */
                    pts_a[i].x += 3001, pts_a[i].y -= 777, pts_a[i].z += 50;
                    pts_b[i].x += 3001, pts_b[i].y -= 777, pts_b[i].z += 50;
                }
            }
            p = compare(change == 0 ? nb : na, change == 0 ? na : nb, holes);
            assert_true(close_to(p->d.volume_mm3, first->d.volume_mm3));
            assert_true(p->d.area_mm2 == first->d.area_mm2);
            assert_true(p->d.outside_mm2 == first->d.outside_mm2);
            assert_true(p->d.bridged_mm2 == first->d.bridged_mm2);
            assert_int_equal(p->d.common, first->d.common);
            drop(p);
            if (change == 0)
                for (size_t i = 0; i < (na > nb ? na : nb); i++) {
                    struct ivec3 t = pts_a[i];

                    pts_a[i] = pts_b[i];
                    pts_b[i] = t;
                }
        }
        drop(first);
    }
}

static size_t grid(struct ivec3 *out, int32_t side, struct ivec3 from, bool block)
{
    size_t n = 0;

    for (int32_t x = 0; x < side; x++)
        for (int32_t y = 0; y < side; y++)
            if (!block || x < 6 || x > 14 || y < 6 || y > 14)
                out[n++] = (struct ivec3){from.x + 100 * x, from.y + 100 * y, from.z};
    return n;
}

/* Two grids that overlap by half: common area, area outside and overlap by hand. */
TEST(test_overlap)
{
    const size_t n = grid(pts_a, 11, (struct ivec3){0, 0, 0}, false);
    struct both *p = compare(n, grid(pts_b, 11, (struct ivec3){500, 0, -7}, false), true);

    assert_true(p->d.area_mm2 == 50 * 1e4);
    assert_true(p->d.outside_mm2 == 100 * 1e4);
    assert_true(p->d.bridged_mm2 == 0);
    assert_true(p->d.overlap == 0.5);
    assert_true(close_to(p->d.plain_mm, 7));
    p->a.surface.measured = 1; /* less than the common area: the overlap is at most 1 */
    measure(p, NULL, 1);
    assert_true(p->d.overlap == 1);
    p->a.surface.measured = 0;
    measure(p, NULL, 1);
    assert_true(p->d.overlap == 0);
    drop(p);

    p = compare(n, grid(pts_b, 11, (struct ivec3){5000, 0, 0}, false), true); /* apart */
    assert_true(p->d.area_mm2 == 0 && p->d.volume_mm3 == 0 && p->d.plain_mm == 0);
    assert_true(p->d.overlap == 0 && p->d.weighted_mm == 0);
    assert_int_equal(p->d.common, 0);
    drop(p);
}

/* Surface over a hole of the other surface does not count, whichever has the hole. */
TEST(test_hole)
{
    for (int side = 0; side < 2; side++) {
        struct ivec3 *whole = side == 0 ? pts_a : pts_b, *cut = side == 0 ? pts_b : pts_a;
        const size_t n = grid(whole, 21, (struct ivec3){0, 0, 0}, false);
        const size_t m = grid(cut, 21, (struct ivec3){0, 0, 0}, true);
        struct both *p;

        for (size_t i = 0; i < n; i++) /* a tower in the middle of the hole */
            if (abs(whole[i].x - 1000) <= 100 && abs(whole[i].y - 1000) <= 100)
                whole[i].z = 5000;
        p = compare(side == 0 ? n : m, side == 0 ? m : n, true);
        assert_true(p->d.volume_mm3 == 0);
        assert_true(p->d.bridged > 100 && p->d.outside == 0);
        assert_true(p->d.area_mm2 >= 300 * 1e4 &&
                    p->d.area_mm2 + p->d.bridged_mm2 == 400 * 1e4);
        assert_true(p->d.overlap > (side == 0 ? 0.74 : 0.94));
        drop(p);
        /* without the bridge marks the tower counts */
        p = compare(side == 0 ? n : m, side == 0 ? m : n, false);
        assert_true(p->d.volume_mm3 > 1e8);
        drop(p);
    }
    {
        const size_t n = grid(pts_a, 21, (struct ivec3){0, 0, 0}, true);
        struct both *p =
            compare(n, grid(pts_b, 21, (struct ivec3){50, 50, 9}, true), true);

        /* both have the hole, with other points around it: the wide cells across bridge */
        assert_true(p->d.bridged_mm2 > 70 * 1e4);
        assert_true(close_to(p->d.plain_mm, 9));
        drop(p);
    }
}

/* A point whose triangles are all bridges has no gap, even where the other mesh has the same
 * point; one measured triangle is enough. */
TEST(test_lone_point)
{
    const size_t n = grid(pts_a, 11, (struct ivec3){0, 0, 0}, false);
    struct both *p = compare(n, grid(pts_b, 11, (struct ivec3){0, 0, 40}, false), true);
    const uint32_t v = brute_locate(&p->b.surface.mesh, (struct ivec2){500, 500}).he;
    const uint32_t lone = p->b.surface.mesh.org[v];
    uint32_t h = v;

    do {
        measure(p, NULL, 1);
        assert_true(p->vertex[p->b_vertex[lone]].gap == 40);
        p->b.surface.bridge[h / 3] = 1;
        h = mesh_turn(&p->b.surface.mesh, h);
    } while (h != v);
    measure(p, NULL, 1);
    assert_true(isinf(p->vertex[p->b_vertex[lone]].gap));
    assert_true(p->d.bridged_mm2 >= 2e4 && p->d.bridged_mm2 <= 4e4);
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
    struct brute_rng r = {seed + 6};

    for (int round = 0; round < 3 * BRUTE_SHAPES; round++) {
        const size_t na =
            brute_points((enum brute_shape)(round % BRUTE_SHAPES), 150, &r, pts_a);
        const size_t nb = brute_points((enum brute_shape)(round / 3), 150, &r, pts_b);
        struct both *p;
        long double volume = 0;
        uint32_t cells = 0, bridged = 0, outside = 0;
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

            if (mesh_is_ghost(&p->general, t))
                continue;
            for (int i = 0; i < 3; i++) {
                g[i] = gap_again(p, v[i]);
                spread += (double)p->vertex[v[i]].spacing;
                assert_memory_equal(&g[i], &p->vertex[v[i]].gap,
                                    isnan(g[i]) ? 0 : sizeof g[i]);
                assert_int_equal(isnan(g[i]) != 0, isnan(p->vertex[v[i]].gap) != 0);
            }
            if (isnan(g[0] + g[1] + g[2])) {
                outside++;
            } else if (isinf(g[0] + g[1] + g[2]) ||
                       holes_wide(p->general.xy[v[0]], p->general.xy[v[1]],
                                  p->general.xy[v[2]], spread, &area)) {
                bridged++;
            } else {
                const int64_t twice = orient2d(p->general.xy[v[0]], p->general.xy[v[1]],
                                               p->general.xy[v[2]]);

                cells++;
                common += twice;
                volume +=
                    (long double)disparity_prism(0.5 * (double)twice, g[0], g[1], g[2]);
            }
        }
        check_spacings(p);
        assert_int_equal(p->d.common, cells);
        assert_int_equal(p->d.bridged, bridged);
        assert_int_equal(p->d.outside, outside);
        assert_true(p->d.area_mm2 == 0.5 * (double)common);
        assert_true(close_to(p->d.volume_mm3, (double)volume));
        drop(p);
    }
}

/* Heights so high that a plain sum drops most of the small cells: the exact volume is a
 * whole number of sixths. */
TEST(test_compensated)
{
    struct brute_rng r = {seed + 7};
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

/* ---- weights */

static float even(const void *arg, double x, double y, double z)
{
    (void)x, (void)y, (void)z;
    return *(const float *)arg;
}

static float right(const void *arg, double x, double y, double z)
{
    (void)arg, (void)y, (void)z;
    return x > 6 ? 1 : 0;
}

static float rising(const void *arg, double x, double y, double z)
{
    (void)arg, (void)z;
    return (float)(x + 2 * y);
}

/* Of surface a, whichever the vertex is from. */
static float high(const void *arg, double x, double y, double z)
{
    (void)arg, (void)x, (void)y;
    return z == 0 ? 2 : 1e6F;
}

static int32_t step(int32_t x, int32_t y)
{
    return x == 12 ? 30 : 10 + 0 * y;
}

TEST(test_weight)
{
    const float three = 3, none = 0;
    const struct disparity_weight all = {even, &three}, nothing = {even, &none};
    const struct disparity_weight half = {right, NULL}, tilted = {rising, NULL};
    const struct disparity_weight at_a = {high, NULL};
    struct both *p = compare(square(pts_a, level), square(pts_b, step), false);
    const double plain = p->d.plain_mm, volume = p->d.volume_mm3;

    /* Four cells of 36 round the middle, gaps 10 but 30 along x = 12: means 50 / 3 below
     * and above, 70 / 3 on the right, 10 on the left. */
    assert_true(close_to(volume, 36 * (50 + 50 + 70 + 30) / 3.0));
    measure(p, &all, 1);
    assert_true(close_to(p->d.weighted_mm, plain));
    assert_true(p->d.plain_mm == plain && p->d.volume_mm3 == volume);
    measure(p, &nothing, 1);
    assert_true(p->d.weighted_mm == 0 && p->d.plain_mm == plain);
    /* By the integral of the product of two linear functions: over 36 / 12 of a cell the
     * product of the sums and the sum of the products at its corners. */
    measure(p, &half, 1); /* 1 at (12, 0) and (12, 12) */
    assert_true(close_to(p->d.weighted_mm, 3.0 * (80 + 80 + 200) / 48));
    assert_true(close_to(p->d.weight_mm2, 48));
    measure(p, &tilted, 1); /* 0, 12, 36, 24 at the corners, 18 in the middle */
    assert_true(close_to(p->d.weighted_mm, 3.0 * (2040 + 6240 + 5400 + 1680) / 2592));
    measure(p, &at_a, 1);
    assert_true(close_to(p->d.weighted_mm, plain));
    assert_true(close_to(p->d.weight_mm2, 2 * p->d.area_mm2));
    drop(p);
}

BEFORE_ALL(set_up)
{
    seed = brute_seed("test_disparity");
}
