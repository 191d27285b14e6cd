/* Heights of cells: by hand where the mean is known exactly, holes and steep places left out, the
 * same whether the surface moves or the pose. */
#include "brute.h"
#include "faces.h"
#include "heights.h"
#include "toy.h"
#include "unit.h"

#define ROOM 70000

static struct scratch scratch;
static struct surface surface;
static struct dvec3 pts[ROOM];
static size_t n;
static float z[GRID_N];

static void heights(const struct pose *pose)
{
    assert_int_equal(heights_of(&surface, pose, &scratch, z), ST_OK);
}

/* The points of z = f(x, y), `step` apart, over a rectangle. */
static void sheet(double (*f)(double x, double y), double x0, double x1, double y0,
                  double y1, double step)
{
    n = 0;
    for (int j = 0; j <= (int)lround((y1 - y0) / step); j++)
        for (int i = 0; i <= (int)lround((x1 - x0) / step); i++) {
            const double x = x0 + i * step, y = y0 + j * step;

            assert_true(n < ROOM);
            pts[n++] = (struct dvec3){x, y, f(x, y)};
        }
}

static void measure(void)
{
    toy_surface(pts, n, &surface);
    heights(&toy_still);
}

static double flat(double x, double y)
{
    (void)x;
    (void)y;
    return -20;
}

static double tilted(double x, double y)
{
    return 0.6 * x - 0.4 * y - 30;
}

static bool has(uint32_t cell)
{
    return !isnan(z[cell]);
}

static void close_to(uint32_t cell, double want, double within)
{
    if (!(fabs((double)z[cell] - want) <= within))
        fail_msg("at %g, %g: %.6f, wanted %.6f", grid_x(cell), grid_y(cell),
                 (double)z[cell], want);
}

static bool in(uint32_t i, double x0, double x1, double y0, double y1)
{
    return grid_x(i) > x0 && grid_x(i) < x1 && grid_y(i) > y0 && grid_y(i) < y1;
}

/* Small triangles, of half of HEIGHTS_AREA_MM2, and large ones, which are taken in parts: of a
 * level plane each cell that is covered, and no other, has its height. */
TEST(test_flat)
{
    static const double step[] = {0.5, 1, 2, 4, 8, 40};

    for (size_t k = 0; k < sizeof step / sizeof *step; k++) {
        sheet(flat, -40, 40, -54, 66, step[k]);
        measure();
        for (uint32_t i = 0; i < GRID_N; i++)
            if (in(i, -40, 40, -54, 66))
                close_to(i, -20, 1e-5);
            else
                assert_false(has(i));
    }
}

static double tilted_toy(const void *arg, double x, double y)
{
    (void)arg;
    return tilted(x, y);
}

/* Where samples lie evenly in the cells the mean of a tilted plane is exact; anywhere else the
 * less so the fewer there are. */
TEST(test_tilted)
{
    static const double step[] = {0.5, 1, 2, 4};
    static const double most[] = {0.25, 0.22, 0.15}; /* mm, root mean square */
    struct draw rng = {brute_seed("tilted")};

    for (size_t k = 0; k < sizeof step / sizeof *step; k++) {
        sheet(tilted, -40, 40, -54, 66, step[k]);
        measure();
        for (uint32_t i = 0; i < GRID_N; i++)
            if (in(i, -40, 40, -54, 66))
                close_to(i, tilted(grid_x(i), grid_y(i)), 0.03);
            else
                assert_false(has(i));
    }
    for (size_t k = 0; k < sizeof most / sizeof *most; k++) {
        double squares = 0, cells = 0;

        toy_scan(tilted_toy, NULL, (uint32_t)1000 << 2 * k, NULL, &rng, &surface);
        heights(&toy_still);
        for (uint32_t i = 0; i < GRID_N; i++) {
            const double off = (double)z[i] - tilted(grid_x(i), grid_y(i));

            squares += has(i) ? off * off : 0;
            cells += has(i);
        }
        print_message("%u points: %.3f mm\n", 1000U << 2 * k, sqrt(squares / cells));
        assert_true(cells > 600);
        assert_true(sqrt(squares / cells) < most[k]);
    }
}

static double ramp(double x, double y)
{
    (void)y;
    return x;
}

/* Seen at 77 degrees, and at 79. */
TEST(test_steep)
{
    struct pose pose = toy_still;

    for (int k = 0; k < 2; k++) {
        const double a = (k == 0 ? 32 : 34) * 3.14159265358979 / 180;
        uint32_t seen = 0;

        sheet(ramp, -40, 40, -54, 66, 0.5); /* 45 degrees, and the rest by the pose */
        pose.r[0] = pose.r[8] = cos(a);
        pose.r[2] = -sin(a);
        pose.r[6] = sin(a);
        toy_surface(pts, n, &surface);
        heights(&pose);
        for (uint32_t i = 0; i < GRID_N; i++)
            seen += has(i);
        assert_true(k == 0 ? seen > 50 : seen == 0);
    }
}

/* From behind nothing is seen. */
TEST(test_behind)
{
    const struct pose turned = {{-1, 0, 0, 0, 1, 0, 0, 0, -1}, {0, 0, 0}};
    struct heights h;

    sheet(flat, -40, 40, -54, 66, 2);
    toy_surface(pts, n, &surface);
    heights(&turned);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_false(has(i));
    assert_int_equal(heights_take(&surface, &turned, &scratch, &h), ST_OK);
    assert_int_equal(h.n, 0); /* nor does it take away from what is seen */
}

/* What only bridges missing points is not there. */
TEST(test_hole)
{
    size_t kept = 0;

    sheet(flat, -40, 40, -54, 66, 1);
    for (size_t i = 0; i < n; i++) /* on its rim there are points */
        if (!(pts[i].x > -16 && pts[i].x < 16 && pts[i].y > -14 && pts[i].y < 18))
            pts[kept++] = pts[i];
    n = kept;
    measure();
    for (uint32_t i = 0; i < GRID_N; i++)
        if (in(i, -40, 40, -54, 66) && !in(i, -16, 16, -14, 18))
            close_to(i, -20, 1e-5);
        else
            assert_false(has(i));
    memset(surface.bridge, 1, surface.mesh.nt);
    heights(&toy_still);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_false(has(i));
}

/* Nor is what was cut out of a scan with one point a cell, as a pair of glasses is, while a point that is
 * missing here and there leaves no hole. */
TEST(test_hole_among_few)
{
    size_t kept = 0;

    sheet(flat, -58, 58, -54, 66, 4);
    for (size_t i = 0; i < n; i++)
        if (!(pts[i].y > 15 && pts[i].y < 33) && i % 41 != 0)
            pts[kept++] = pts[i];
    n = kept;
    measure();
    for (uint32_t i = 0; i < GRID_N; i++)
        if (in(i, -52, 52, -48, 14) || in(i, -52, 52, 34, 60))
            close_to(i, -20, 1e-5);
        else if (in(i, -52, 52, 18, 30))
            assert_false(has(i));
}

/* A cell counts from 0.45 of it covered. */
TEST(test_coverage)
{
    static const struct {
        double to;
        bool counts;
    } k[] = {{1.6, false}, {2, true}};

    for (size_t i = 0; i < sizeof k / sizeof *k; i++) {
        const uint32_t last = grid_cell(1, 10); /* from x = 0 to 4 */

        sheet(flat, -40, k[i].to, -54, 66, 0.4);
        measure();
        assert_true(has(last - 1));
        assert_true(has(last) == k[i].counts);
        assert_false(has(last + 1));
    }
}

/* On the grid's rim, and beside it. */
TEST(test_off_grid)
{
    static const double away[] = {60, 100, 300, 5000};

    sheet(flat, -100, 100, -130, 110, 2);
    measure();
    for (uint32_t i = 0; i < GRID_N; i++)
        close_to(i, -20, 1e-5);
    for (size_t k = 0; k < sizeof away / sizeof *away; k++) {
        struct pose pose = toy_still;

        sheet(flat, -40, 40, -54, 66, 2);
        toy_surface(pts, n, &surface);
        pose.t[0] = -away[k];
        heights(&pose);
        for (uint32_t i = 0; i < GRID_N; i++)
            if (in(i, -40 - away[k], 40 - away[k], -54, 66))
                close_to(i, -20, 1e-5);
            else
                assert_false(has(i));
    }
}

/* What is beside the grid may be moved onto it. */
TEST(test_beside)
{
    struct pose pose = toy_still;
    struct heights h;

    sheet(flat, 68, 100, -54, 66, 2);
    toy_surface(pts, n, &surface);
    assert_int_equal(heights_take(&surface, &toy_still, &scratch, &h), ST_OK);
    pose.t[0] = -36;
    heights_at(&h, &pose, z);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_int_equal(has(i), in(i, 32, 64, -54, 66));
}

/* ---- poses */

static void face(void)
{
    struct surface_face f = {0};

    faces_make(0, 0, &f);
    surface_free(&surface);
    surface = f.surface;
}

/* Samples are taken at one pose, and seen from another near it. */
TEST(test_samples)
{
    struct pose near;
    struct heights h;
    float direct[GRID_N];
    double squares = 0, cells = 0, area = 0;

    face();
    toy_pose(4, -3, 2, (struct dvec3){1, -2, 3}, &near);
    heights(&near);
    memcpy(direct, z, sizeof z);
    assert_int_equal(heights_take(&surface, &toy_still, &scratch, &h), ST_OK);
    heights_at(&h, &near, z);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(z[i]) || isnan(direct[i]))
            continue;
        squares += (double)(z[i] - direct[i]) * (double)(z[i] - direct[i]);
        cells++;
    }
    print_message("%g cells: %.3f mm\n", cells, sqrt(squares / cells));
    assert_true(cells > 700 && sqrt(squares / cells) < 0.1);
    for (uint32_t k = 0; k < h.n; k++) {
        assert_true(h.area[k] > 0.0f && h.area[k] <= 4.001f);
        area += (double)h.area[k];
    }
    assert_true(area > 0.8 * surface.measured / 1e6 && area <= surface.measured / 1e6);
    heights_at(&h, &toy_still, z); /* as it was taken: what heights_of() gives */
    memcpy(direct, z, sizeof z);
    heights(&toy_still);
    assert_memory_equal(z, direct, sizeof z);
}
