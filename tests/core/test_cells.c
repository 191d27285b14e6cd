/* The gap per cell from points of the probe: planes by hand, in any frame and at any pose; what
 * is steep, bridged or beside the template is left out. */
#include "align_field.h"
#include "brute.h"
#include "cells.h"
#include "toy.h"
#include "unit.h"

#define ROOM 20000

static struct surface tmpl;
static struct align_point pts[ROOM];
static uint32_t n;
static struct cells cells;

struct plane {
    double zx, zy, up;
};

static double plane(const void *arg, double x, double y)
{
    const struct plane *p = arg;

    return p->zx * x + p->zy * y + p->up;
}

static const struct plane slope = {0.5, -0.25, -20};
static const double flat = 0.87287156094396952; /* the z of its unit normal */

/* The template is the plane; the probe's points, 1 mm apart, lie mm above it, each for 1 mm^2
 * seen along z. */
static void make(const struct plane *p, double mm)
{
    struct draw rng = {4};

    toy_scan(plane, p, 4000, NULL, &rng, &tmpl);
    n = 0;
    for (int y = -65; y <= 65; y++)
        for (int x = -50; x <= 50; x++) {
            const double u = x + 0.5, v = y + 0.5;

            pts[n++] =
                (struct align_point){{u, v, plane(p, u, v) + mm},
                                     (float)sqrt(1 + p->zx * p->zx + p->zy * p->zy),
                                     ALIGN_FIELD_NONE};
        }
}

static void sample(const struct pose *pose, const struct pose *frame)
{
    struct align_field field;

    align_field_make(&tmpl, NULL, &field);
    cells_sample(&field, pts, n, pose, frame, &cells);
}

/* Inside of the template's oval, whose half axes are 55 and 70 mm. */
static bool inner(double x, double y)
{
    return x * x / (44.0 * 44) + y * y / (58.0 * 58) < 1;
}

TEST(test_plane)
{
    for (int k = -2; k <= 2; k++) {
        make(&slope, k);
        sample(&toy_still, &toy_still);
        for (uint32_t i = 0; i < GRID_N; i++) {
            const double x = grid_x(i), y = grid_y(i);

            if (!inner(x, y))
                continue;
            assert_true(fabs((double)cells.area[i] - GRID_MM * GRID_MM) < 0.05);
            assert_true(fabs((double)cells.gap[i] - k * flat) < 2e-3);
            assert_true(fabs((double)cells.z[i] - plane(&slope, x, y)) < 2e-3);
            assert_true(fabs((double)cells.normal[i][0] + 0.5 * flat) < 1e-3);
            assert_true(fabs((double)cells.normal[i][1] - 0.25 * flat) < 1e-3);
            assert_true(fabs((double)cells.normal[i][2] - flat) < 1e-3);
            assert_true(cells_cover(&cells, i) == 1.0f);
        }
        assert_true(cells.area[0] == 0.0f && cells.gap[0] == 0.0f &&
                    cells_cover(&cells, 0) == 0.0f);
    }
}

/* The gap does not depend on the frame; what the points have been moved by, the pose undoes. */
TEST(test_poses)
{
    struct pose frame, pose, back;
    uint32_t seen = 0;

    make(&slope, 1.5);
    toy_pose(9, -7, 20, (struct dvec3){3, -4, 12}, &frame);
    toy_pose(20, 10, -15, (struct dvec3){30, 40, -500}, &pose);
    back = pose_after(&pose, &toy_still);
    for (uint32_t i = 0; i < n; i++)
        pts[i].p = pose_apply(&back, pts[i].p);
    sample(&pose, &frame);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (cells_cover(&cells, i) < 1.0f)
            continue;
        seen++;
        assert_true(fabs((double)cells.gap[i] - 1.5 * flat) < 2e-3);
    }
    assert_true(seen > 500);
}

/* A cliff, what is beside the template, and points that cover nothing. */
TEST(test_left_out)
{
    const struct plane cliff = {5, 0, 0}, level = {0, 0, 0};
    struct pose away = toy_still;

    for (int k = 0; k < 4; k++) {
        make(k == 0 ? &cliff : &level, 1);
        away.t[0] = k == 1 ? 500 : 0;
        if (k == 2)
            memset(tmpl.bridge, 1, tmpl.mesh.nt);
        for (uint32_t i = 0; k == 3 && i < n; i++)
            pts[i].area = 0.0f;
        sample(&away, &toy_still);
        for (uint32_t i = 0; i < GRID_N; i++)
            assert_true(cells.area[i] == 0.0f && cells.gap[i] == 0.0f);
    }
}

/* In a cell the mean is weighted by area. */
TEST(test_weights)
{
    const struct plane level = {0, 0, 0};
    const uint32_t i = grid_cell(2, 4);

    make(&level, 0);
    pts[0] = (struct align_point){{1, 3, 4}, 3, ALIGN_FIELD_NONE};
    pts[1] = (struct align_point){{3, 5, -1}, 1, ALIGN_FIELD_NONE};
    n = 2;
    sample(&toy_still, &toy_still);
    assert_true(fabs((double)cells.area[i] - 4) < 1e-5);
    assert_true(fabs((double)cells.gap[i] - 2.75) < 1e-3);
}
