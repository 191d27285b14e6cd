/* Restored points: inside holes alone, on the scan's surface, apart from the scan's points, as
 * dense as those; filling again adds nothing; the order of the points does not matter. */
/* link: -Wl,--wrap=aligned_alloc */
#include "brute.h"
#include "clouds.h"
#include "fail_alloc.h"
#include "fill.h"
#include "holes.h"
#include "lattice.h"
#include "locate.h"
#include "mem.h"
#include "surface.h"
#include "unit.h"

#define MOST  40000
#define PITCH 1000

static struct draw rng;
static struct scratch scratch;
static struct ivec3 pts[MOST];
static struct surface scan;
static struct fill fill;

static void prepare(const struct ivec3 *p, size_t n, struct surface *s)
{
    assert_int_equal(surface_prepare(p, n, true, &scratch, s), ST_OK);
}

/* A grid of 60 x 60 points on a plane, as far as in() says so; returns how many. */
static size_t grid(bool (*in)(int x, int y))
{
    size_t n = 0;

    for (int y = 0; y < 60; y++)
        for (int x = 0; x < 60; x++)
            if (in(x, y))
                pts[n++] =
                    (struct ivec3){PITCH * x, PITCH * y, 2 * PITCH * x - PITCH * y};
    return n;
}

/* A scan of n points with round holes of random sizes cut out. */
static size_t cut_scan(uint64_t k, size_t n, int holes)
{
    struct dvec3 *mm = malloc(n * sizeof *mm);
    size_t left = clouds_scan(k, k, n, mm);

    assert_non_null(mm);
    for (int i = 0; i < holes; i++) {
        const struct dvec3 c = mm[draw_next(&rng) % left];
        const double radius = draw_uniform(&rng, 2, 20);
        size_t kept = 0;

        for (size_t p = 0; p < left; p++)
            if (hypot(mm[p].x - c.x, mm[p].y - c.y) > radius)
                mm[kept++] = mm[p];
        left = kept;
    }
    assert_int_equal(lattice_from_mm(mm, left, LATTICE_PER_MM, pts, NULL), ST_OK);
    free(mm);
    return left;
}

static double distance(struct ivec3 p, struct ivec2 q)
{
    return hypot((double)p.x - q.x, (double)p.y - q.y);
}

/* A point restored in s: inside the hull, between the corners of its triangle, on it; returns
 * whether the triangle bridges. */
static bool check_point(const struct surface *s, struct ivec3 p)
{
    const struct mesh *m = &s->mesh;
    const struct ivec2 q = {p.x, p.y};
    uint32_t h = m->out[0];
    struct location at;
    int32_t low = INT32_MAX, high = INT32_MIN;

    while (mesh_is_ghost(m, h / 3))
        h = mesh_turn(m, h);
    at = locate_point(m, h, m->xy[0], q, NULL);
    assert_true(at.where == LOCATE_INSIDE || at.where == LOCATE_EDGE);
    for (uint32_t i = at.he / 3 * 3; i < at.he / 3 * 3 + 3; i++) {
        low = m->z[m->org[i]] < low ? m->z[m->org[i]] : low;
        high = m->z[m->org[i]] > high ? m->z[m->org[i]] : high;
    }
    assert_true(low <= p.z && p.z <= high);
    assert_true(fabs(locate_height(m, at, q) - p.z) <= 0.5);
    return s->bridge[at.he / 3] || s->bridge[m->twin[at.he] / 3];
}

/* The points of one hole: no two of them nearer than the side of their triangles, none of
 * the scan's nearer than its share. */
static void check_apart(const struct surface *s, const struct ivec3 *p, uint32_t n)
{
    double side = INFINITY;

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++)
            side = fmin(side, distance(p[i], (struct ivec2){p[j].x, p[j].y}));
    assert_true(side > 1);
    for (uint32_t i = 0; n > 1 && i < n; i++)
        for (uint32_t v = 0; v < s->mesh.nv; v++)
            assert_true(distance(p[i], s->mesh.xy[v]) >= FILL_APART * side - 2);
}

/* Returns how many points lie in triangles of s that bridge; the others in such as became
 * bridges by the points that were restored first. */
static unsigned check(const struct surface *s, const struct fill *f)
{
    unsigned bridged = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < f->nholes; n += f->hole[i++].points) {
        const struct fill_hole *h = &f->hole[i];

        assert_true(h->points > 0 && n + h->points <= f->n);
        assert_true(fabs(h->diameter * h->diameter * 0.7853981633974483 - h->area) <
                    1e-9 * h->area);
        check_apart(s, f->pts + n, h->points);
    }
    assert_int_equal(n, f->n);
    for (uint32_t i = 0; i < f->n; i++)
        bridged += check_point(s, f->pts[i]);
    return bridged;
}

/* Filling the n points and f's: nothing is missing. */
static void check_again(size_t n, const struct fill *f)
{
    struct surface all = {0};
    struct fill again = {0};

    assert_true(n + f->n <= MOST);
    if (f->n > 0)
        memcpy(pts + n, f->pts, f->n * sizeof *pts);
    prepare(pts, n + f->n, &all);
    assert_int_equal(fill_holes(&all, MOST, &scratch, &again), ST_OK);
    assert_int_equal(again.n, 0);
    assert_int_equal(again.nholes, 0);
    surface_free(&all);
    fill_free(&again);
}

TEST(test_scans)
{
    unsigned filled = 0, bridged = 0, all = 0;

    for (uint64_t k = 0; k < 40; k++) {
        const size_t n = cut_scan(k, k % 4 == 3 ? 10000 : 3000, (int)(k % 8));

        prepare(pts, n, &scan);
        assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
        bridged += check(&scan, &fill);
        check_again(n, &fill);
        filled += fill.nholes;
        all += fill.n;
    }
    assert_true(filled > 40);
    print_message("%u holes, %u points, %u beside bridges\n", filled, all, all - bridged);
    assert_true(bridged >= 0.99 * all);
}

TEST(test_shapes)
{
    for (int round = 0; round < 20 * BRUTE_SHAPES; round++) {
        const enum brute_shape shape = (enum brute_shape)(round % BRUTE_SHAPES);
        const size_t n = brute_points(shape, 8 + 4 * (size_t)round, &rng, pts);
        enum status st;

        prepare(pts, n, &scan);
        st = fill_holes(&scan, (uint32_t)(MOST - n), &scratch, &fill);
        assert_true(st == ST_OK || st == ST_ELIMIT);
        if (st == ST_OK) {
            for (uint32_t i = 0; i < fill.n; i++)
                (void)check_point(&scan, fill.pts[i]);
            check_again(n, &fill);
        }
    }
}

static bool whole(int x, int y)
{
    return x >= 0 && y >= 0;
}

static bool with_hole(int x, int y)
{
    return x < 20 || x >= 30 || y < 20 || y >= 30;
}

static bool with_notch(int x, int y)
{
    return x < 20 || x >= 30 || y >= 10;
}

static bool with_island(int x, int y)
{
    return x < 15 || x >= 35 || y < 15 || y >= 35 || (x == 25 && y == 24);
}

/* 10 x 10 points of a grid are missing: as many are restored, on the plane. */
TEST(test_grid)
{
    size_t n = grid(whole);

    prepare(pts, n, &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    assert_int_equal(fill.n, 0);
    assert_int_equal(fill.beyond, 0);

    n = grid(with_hole);
    prepare(pts, n, &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    assert_int_equal(fill.nholes, 1);
    /* (The triangles in the corners of the hole are no wider than elsewhere.) */
    assert_in_range(fill.hole[0].area, 100 * PITCH * PITCH, 11 * 11 * PITCH * PITCH);
    assert_in_range(fill.n, 90, 110);
    for (uint32_t i = 0; i < fill.n; i++)
        assert_int_equal(fill.pts[i].z, 2 * fill.pts[i].x - fill.pts[i].y);
    assert_int_equal(check(&scan, &fill), fill.n);
    check_again(n, &fill);

    n = grid(with_island);
    prepare(pts, n, &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    assert_int_equal(fill.nholes, 1);
    assert_in_range(fill.n, 350, 420);
    assert_int_equal(check(&scan, &fill), fill.n);
    check_again(n, &fill);
}

/* A place for a point on an edge that two triangles of the hole share: the origin, where a
 * grid point always is. */
TEST(test_edge)
{
    const size_t n = grid(with_hole);
    unsigned there = 0;

    for (size_t i = 0; i < n; i++) {
        pts[i].x -= 49 * PITCH / 2;
        pts[i].y -= 49 * PITCH / 2;
    }
    prepare(pts, n, &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    for (uint32_t i = 0; i < fill.n; i++)
        there += fill.pts[i].x == 0 && fill.pts[i].y == 0;
    assert_int_equal(there, 1);
}

/* What is open to the outside was perhaps never there. */
TEST(test_outline)
{
    const size_t n = grid(with_notch);

    prepare(pts, n, &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    assert_int_equal(fill.n, 0);
    assert_in_range(fill.beyond, 90 * PITCH * PITCH, 11 * 10 * PITCH * PITCH);
}

TEST(test_limit)
{
    uint32_t n;

    prepare(pts, grid(with_hole), &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    n = fill.n;
    assert_int_equal(fill_holes(&scan, n, &scratch, &fill), ST_OK);
    assert_int_equal(fill_holes(&scan, n - 1, &scratch, &fill), ST_ELIMIT);
    assert_int_equal(fill_holes(&scan, 0, &scratch, &fill), ST_ELIMIT);
}

TEST(test_error)
{
    static const double size[FILL_SIZES] = FILL_SIZE_MM, rms[FILL_SIZES] = FILL_RMS_MM,
                        most[FILL_SIZES] = FILL_95_MM;
    double r, m, last = 0;

    for (int k = 0; k < FILL_SIZES; k++) {
        fill_error(size[k], &r, &m);
        assert_true(fabs(r - rms[k]) < 1e-12 && fabs(m - most[k]) < 1e-12);
        assert_true(m > r && r >= last);
        last = r;
    }
    fill_error((size[2] + size[3]) / 2, &r, &m);
    assert_true(fabs(r - (rms[2] + rms[3]) / 2) < 1e-12);
    fill_error(0, &r, &m);
    assert_true(r == rms[0] && m == most[0]);
    fill_error(size[FILL_SIZES - 1] + 1e-9, &r, &m);
    assert_true(isnan(r) && isnan(m));
}

static enum status fill_fresh(void *out)
{
    struct scratch s = {0};
    const enum status st = fill_holes(&scan, MOST, &s, out);

    scratch_free(&s);
    return st;
}

TEST(test_memory)
{
    struct fill other = {0};

    prepare(pts, cut_scan(9, 3000, 5), &scan);
    assert_int_equal(fill_holes(&scan, MOST, &scratch, &fill), ST_OK);
    assert_true(fail_alloc_walk(fill_fresh, &other) > 4);
    assert_int_equal(other.n, fill.n);
    assert_memory_equal(other.pts, fill.pts, fill.n * sizeof *fill.pts);
    fill_free(&other);
}

BEFORE_ALL(set_up)
{
    rng.x = brute_seed("fill");
}
