/* Meshes whose heights per cell are known by hand. */
#include "render.h"
#include "unit.h"

#define MOST 64

static float at[3 * MOST], out[GRID_N];
static uint32_t corner[MOST][3];
static struct render_mesh mesh = {.at = at, .corner = (const uint32_t (*)[3])corner};
static uint32_t nv;

static void begin(void)
{
    nv = mesh.nt = 0;
}

static uint32_t vertex(double x, double y, double z)
{
    at[3 * nv] = (float)x;
    at[3 * nv + 1] = (float)y;
    at[3 * nv + 2] = (float)z;
    return nv++;
}

static void triangle(uint32_t a, uint32_t b, uint32_t c)
{
    corner[mesh.nt][0] = a;
    corner[mesh.nt][1] = b;
    corner[mesh.nt++][2] = c;
}

/* A rectangle of the plane z + zx x + zy y, as two triangles. */
static void rectangle(double x0, double y0, double x1, double y1, double z, double zx,
                      double zy)
{
    const uint32_t a = vertex(x0, y0, z + zx * x0 + zy * y0);
    const uint32_t b = vertex(x1, y0, z + zx * x1 + zy * y0);
    const uint32_t c = vertex(x1, y1, z + zx * x1 + zy * y1);
    const uint32_t d = vertex(x0, y1, z + zx * x0 + zy * y1);

    triangle(a, b, c);
    triangle(c, d, a);
}

static float rendered(double x, double y)
{
    render_heights(&mesh, out);
    return out[grid_cell(x, y)];
}

TEST(test_plane)
{
    begin();
    rectangle(-200, -200, 200, 200, -30, 0.25, -0.125);
    render_heights(&mesh, out);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(fabs((double)out[i] - (-30 + 0.25 * grid_x(i) - 0.125 * grid_y(i))) <
                    1e-4);
}

/* A cell has four samples, 1 mm from its middle; with two of them it has a height. */
TEST(test_edges)
{
    begin();
    rectangle(-0.5, -62, 5.5, 62, 7, 0, 0); /* samples at 1, 3 and 5 */
    render_heights(&mesh, out);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const bool in = grid_x(i) > 0 && grid_x(i) < 8 && fabs(grid_y(i)) < 62;

        assert_int_equal(isnan(out[i]), !in);
        assert_true(!in || fabs((double)out[i] - 7) < 1e-5);
    }
    begin();
    rectangle(0.5, 0.5, 1.5, 1.5, 7, 0, 0); /* one sample */
    assert_true(isnan(rendered(1, 1)));
    begin();
    assert_true(isnan(rendered(1, 1))); /* nothing at all */
}

/* The front-most surface, in whatever order and with whichever side in front. */
TEST(test_front)
{
    for (int order = 0; order < 2; order++) {
        begin();
        if (order == 0)
            rectangle(-64, -94, 64, 70, -10, 0, 0);
        rectangle(20, 20, -20, -20, 5, 0, 0);
        rectangle(-64, -94, 64, 70, -40, 0, 0);
        if (order == 1)
            rectangle(-64, -94, 64, 70, -10, 0, 0);
        assert_true(fabs((double)rendered(2, 2) - 5) < 1e-5);
        assert_true(fabs((double)rendered(30, 2) + 10) < 1e-5);
    }
}

/* Slits along y of up to three samples are bridged, between sides of about one height. */
TEST(test_slits)
{
    for (int samples = 1; samples <= 5; samples++)
        for (int step = 0; step <= 9; step += 3) {
            const double low = 1.5, high = low + 2 * samples;

            begin();
            rectangle(-64, -94, 64, low, 0, 0, 0);
            rectangle(-64, high, 64, 70, step, 0, 0);
            render_heights(&mesh, out);
            for (double y = 0; y < 30; y += 4) {
                const float z = out[grid_cell(2, y)];

                if (samples <= 3 && step < 8)
                    assert_true(z >= 0.0f && z <= (float)step);
                else if (y - 1 > low && y + 1 < high)
                    assert_true(isnan(z));
            }
        }
    begin(); /* along x they are not */
    rectangle(-64, -94, 0, 70, 0, 0, 0);
    rectangle(6, -94, 64, 70, 0, 0, 0);
    assert_true(isnan(rendered(2, 2)));
}

/* Of two layers in one cell that are far apart, neither is half of a height. */
TEST(test_layers)
{
    begin();
    rectangle(-64, -94, 64, 70, -20, 0, 0);
    rectangle(0, 2, 2, 4, 0, 0, 0); /* one sample of four */
    assert_true(fabs((double)rendered(2, 4) + 20) < 1e-5);
    rectangle(0, 2, 2, 6, 0, 0, 0); /* two of four: neither is near the median */
    assert_true(isnan(rendered(2, 4)));
    rectangle(0, 2, 4, 4, 0, 0, 0); /* three */
    assert_true(fabs((double)rendered(2, 4)) < 1e-5);
    begin();
    rectangle(-64, -94, 64, 70, -3, 0, 0);
    rectangle(0, 2, 2, 6, 0, 0, 0); /* near each other: their mean */
    assert_true(fabs((double)rendered(2, 4) + 1.5) < 1e-5);
}

/* Triangles without area, beside the grid, and far larger than it. */
TEST(test_odd)
{
    begin();
    rectangle(-1e6, -1e6, 1e6, 1e6, -50, 0, 0);
    triangle(vertex(0, 0, 9), vertex(10, 10, 9), vertex(20, 20, 9));
    triangle(vertex(5, 5, 9), vertex(5, 5, 9), vertex(5, 5, 9));
    rectangle(64.5, -94, 70, 70, 9, 0, 0);
    rectangle(-64, 70.5, 64, 80, 9, 0, 0);
    rectangle(-64, -99, 64, -94.5, 9, 0, 0);
    render_heights(&mesh, out);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(fabs((double)out[i] + 50) < 1e-3);
}
