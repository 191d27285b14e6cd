/* The grid as a template: heights between the cells, missing corners, and the robust sum
 * against the same in double precision, one point at a time. */
#include "align_grid.h"
#include "align_lanes.h"
#include "brute.h"
#include "unit.h"

#define POINTS 203

static float height[GRID_N], weight[GRID_N];
static struct align_grid grid;

/* A hilly oval, with a hole of one cell. */
static void make(void)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        const double x = grid_x(i), y = grid_y(i);

        height[i] =
            (float)(30 - 0.008 * x * x - 0.005 * y * y + 3 * sin(x * 0.2 + y * 0.1));
        if (x * x / (60 * 60) + (y + 10) * (y + 10) / (80 * 80) > 1)
            height[i] = (float)NAN;
        weight[i] = (float)(0.5 + 0.4 * sin(0.1 * x - 0.07 * y));
    }
    height[grid_cell(10, 10)] = (float)NAN;
}

/* The surface under (x, y) in double precision; false: none. */
static bool under(double x, double y, double *z, double *zx, double *zy, double *flat,
                  double *u)
{
    const double i = (x - GRID_LEFT) / GRID_MM - 0.5,
                 j = (y - GRID_BOTTOM) / GRID_MM - 0.5;
    uint32_t cell;
    double k[4], missing = 0, a = i - floor(i), b = j - floor(j), mx, my;

    if (!(i >= 0 && i < GRID_NX - 1 && j >= 0 && j < GRID_NY - 1))
        return false;
    cell = (uint32_t)j * GRID_NX + (uint32_t)i;
    *u = 0;
    for (uint32_t c = 0; c < 4; c++) {
        const uint32_t at = cell + c % 2 + c / 2 * GRID_NX;

        k[c] = (double)height[at];
        *u += (double)weight[at] / 4;
        missing += isnan(k[c]);
    }
    if (missing > 1)
        return false;
    for (uint32_t c = 0; c < 4; c++)
        if (isnan(k[c]))
            k[c] = k[c ^ 1] + k[c ^ 2] - k[c ^ 3];
    *z =
        (1 - a) * (1 - b) * k[0] + a * (1 - b) * k[1] + (1 - a) * b * k[2] + a * b * k[3];
    *zx = ((k[1] - k[0]) * (1 - b) + (k[3] - k[2]) * b) / GRID_MM;
    *zy = ((k[2] - k[0]) * (1 - a) + (k[3] - k[1]) * a) / GRID_MM;
    mx = (k[1] - k[0] + k[3] - k[2]) / 2 / GRID_MM;
    my = (k[2] - k[0] + k[3] - k[1]) / 2 / GRID_MM;
    *flat = 1 / sqrt(1 + mx * mx + my * my);
    return true;
}

static void slow_sum(const struct align_point *pts, uint32_t n, uint32_t stride,
                     const struct pose *pose, struct dvec3 c, enum solve_loss loss,
                     struct solve_sum *sum)
{
    double total = 0, within = 0, share = 0;

    memset(sum, 0, sizeof *sum);
    for (uint32_t i = 0; i < n; i += stride, total++) {
        const struct dvec3 q = pose_apply(pose, pts[i].p), d = vec_sub(q, c);
        double z, zx, zy, flat, u, r, s, w;

        if (!under(q.x, q.y, &z, &zx, &zy, &flat, &u))
            continue;
        within++;
        r = (q.z - z) * flat;
        s = 1 - fmin(1, r * r / ALIGN_TUKEY_MM / ALIGN_TUKEY_MM);
        w = loss == SOLVE_LOSS_L1 ? 1 / fmax(fabs(r), ALIGN_SOFT_MM) : u * s * s;
        sum->cost += loss == SOLVE_LOSS_L1 ? fmin(fabs(r), ALIGN_CAP_MM)
                                           : u * ALIGN_TUKEY_MM * (1 - s * s * s);
        share += u;
        solve_add(&sum->normal,
                  (const double[6]){flat * (d.y + d.z * zy), flat * (-d.z * zx - d.x),
                                    flat * (d.y * zx - d.x * zy), -zx * flat, -zy * flat,
                                    flat},
                  r, w);
    }
    sum->within = within / total;
    if (loss == SOLVE_LOSS_L1)
        sum->cost = (sum->cost + ALIGN_NO_GAP_MM * (total - within)) / total;
    else
        sum->cost = share > 0 ? sum->cost / share : (double)INFINITY;
}

/* To 1 %: a place next to the border of a patch may be taken for one beyond, where the slopes
 * are others. */
static void near(double a, double b, double scale)
{
    if (!(fabs(a - b) <= 1e-2 * scale))
        fail_msg("%.9g instead of %.9g, of terms of %.3g", a, b, scale);
}

static void compare(const struct align_point *pts, uint32_t n, uint32_t stride,
                    const struct pose *pose, enum solve_loss loss)
{
    const struct dvec3 c = {1, 2, -70};
    struct solve_sum fast, slow;
    const double *h = slow.normal.h;
    double size[6];

    align_grid_sum(&grid, pts, n, stride, pose, c, loss, &fast);
    slow_sum(pts, n, stride, pose, c, loss, &slow);
    near(fast.cost, slow.cost, 1);
    assert_true(fast.within == slow.within);
    for (int i = 0, k = 0; i < 6; k += 6 - i++)
        size[i] = sqrt(h[k]);
    for (int i = 0, k = 0; i < 6; i++) {
        near(fast.normal.g[i], slow.normal.g[i], size[i] * size[5]);
        for (int j = i; j < 6; j++, k++)
            near(fast.normal.h[k], h[k], size[i] * size[j]);
    }
}

TEST(test_sum)
{
    static struct align_point pts[POINTS];
    struct draw rng = {brute_seed("align_grid")};

    for (int round = 0; round < 50; round++) {
        /* The points may lie far from the origin: the pose brings them back. */
        const struct dvec3 far = {round % 5 * 2000.0, round % 3 * -3000.0, 5000.0};
        struct pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {-far.x, -far.y, -far.z}};
        const double x[6] = {draw_uniform(&rng, 0, 0.2), 0.2, -0.1, 3, 2, 1};

        for (uint32_t i = 0; i < POINTS; i++) {
            const double px = draw_uniform(&rng, -75, 75);
            const double py = draw_uniform(&rng, -110, 90);

            pts[i].p = (struct dvec3){far.x + px, far.y + py,
                                      far.z + 30 - 0.008 * px * px - 0.005 * py * py +
                                          draw_uniform(&rng, -10, 10)};
        }
        pose_move(&pose, (struct dvec3){0, 0, -80}, x);
        for (uint32_t stride = 1; stride < 9; stride += 1 + stride / 3) {
            compare(pts, POINTS - (uint32_t)round % 7, stride, &pose, SOLVE_LOSS_L1);
            compare(pts, POINTS - (uint32_t)round % 7, stride, &pose, SOLVE_LOSS_TUKEY);
        }
    }
}

/* Nothing over the grid, which covers every cell: no gap, and a cost that no pose with a gap
 * has. */
TEST(test_apart)
{
    static float z[GRID_N];
    static struct align_grid whole;
    const struct pose off = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {90000, -90000, 0}};
    const struct align_point p[2] = {{{0, 0, 0}, 0, 0}, {{1e5, -1e5, 1e5}, 0, 0}};
    const struct dvec3 c = {0, 0, 0};
    struct solve_sum sum;

    (void)align_grid_make(z, weight, &whole);
    align_grid_sum(&whole, p, 2, 1, &off, c, SOLVE_LOSS_L1, &sum);
    assert_true(sum.within == 0 && sum.cost == ALIGN_NO_GAP_MM && sum.normal.h[0] == 0);
    align_grid_sum(&whole, p, 2, 1, &off, c, SOLVE_LOSS_TUKEY, &sum);
    assert_true(sum.within == 0 && isinf(sum.cost) && sum.normal.h[20] == 0);
}

/* Four corners, or three, make a patch; two make none; the last row and column have none. */
TEST(test_patches)
{
    static float z[GRID_N];
    static struct align_grid g;

    assert_int_equal(align_grid_make(z, weight, &g), (GRID_NX - 1) * (GRID_NY - 1));
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = (float)NAN;
    assert_int_equal(align_grid_make(z, weight, &g), 0);
    z[0] = 1.0f;
    z[1] = 3.0f;
    assert_int_equal(align_grid_make(z, weight, &g), 0);
    z[GRID_NX] = 2.0f;
    assert_int_equal(align_grid_make(z, weight, &g), 1);
    assert_true(g.patch[0].z == 1.0f && g.patch[0].zx == 2.0f && g.patch[0].zy == 1.0f &&
                g.patch[0].zxy == 0.0f);
}

BEFORE_ALL(set_up)
{
    make();
    (void)align_grid_make(height, weight, &grid);
}
