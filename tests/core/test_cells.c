/* The gap per cell: a constant gap is constant in any frame; exchanging the surfaces changes
 * the sign; the sampling density does not matter; holes are not covered; the sampled mean
 * agrees with the exact one. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "align_field.h"
#include "brute.h"
#include "cells.h"
#include "lattice.h"
#include "measure.h"
#include "toy.h"
#include "tuning.h"

static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
static const double same_place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
static struct measure_work work;
static struct surface a, b;
static struct cells cells, other;
static double overlap;

static struct disparity gap_of(const struct surface *t, const struct surface *p,
                               const struct align_pose *frame, struct cells *out)
{
    struct disparity d;

    assert_int_equal(measure_at(t, p, same_place, NULL, &work, &d), ST_OK);
    assert_int_equal(cells_measure(t, &work, frame, out, &overlap), ST_OK);
    return d;
}

static struct align_pose inverse(const struct align_pose *p)
{
    return align_pose_after(p, &still);
}

struct plane {
    double zx, zy, up;
};

static double plane(const void *arg, double x, double y)
{
    const struct plane *p = arg;

    return p->zx * x + p->zy * y + p->up;
}

/* A ball 90 mm behind the origin, grown by *arg. */
static double ball(const void *arg, double x, double y)
{
    const double grown = *(const double *)arg, r = 90 + grown;

    return sqrt(r * r - x * x - y * y) - 90;
}

static double toy(const void *arg, double x, double y)
{
    return toy_height(x, y) + *(const double *)arg;
}

/* inner(c): is the cell wholly within the oval that was scanned, and is it covered? */
static bool inner(const struct cells *c, uint32_t i)
{
    const double u = grid_x(i) / 46, v = grid_y(i) / 60;

    return u * u + v * v < 1 && c->area[i] > 12.0f;
}

/* Planes 0.7 mm apart along their normal, of any slope, in any frame. */
static void test_constant(void **state)
{
    static const struct plane planes[] = {{0, 0, 0}, {0.3, -0.2, 5}, {-1.0, 0.5, -3}};
    struct brute_rng rng = {brute_seed("cells")};

    (void)state;
    for (size_t k = 0; k < sizeof planes / sizeof *planes; k++) {
        const struct plane p = planes[k];
        const double steep = sqrt(1 + p.zx * p.zx + p.zy * p.zy);
        const struct plane q = {p.zx, p.zy, p.up + 0.7 * steep};

        toy_scan(plane, &p, 2500, NULL, &rng, &a);
        toy_scan(plane, &q, 1500, NULL, &rng, &b);
        for (int turn = -2; turn <= 2; turn++) {
            struct align_pose frame;
            uint32_t covered = 0;
            double area = 0;
            struct disparity d;

            toy_pose(8 * turn, -5 * turn, 30 * turn, (struct dvec3){3, turn, 7}, &frame);
            d = gap_of(&a, &b, &frame, &cells);
            for (uint32_t i = 0; i < GRID_N; i++) {
                area += (double)cells.area[i];
                if (cells.area[i] < CELLS_COVERED)
                    continue;
                covered++;
                assert_true(fabs((double)cells.gap[i] - 0.7) < 0.002);
                assert_true(fabs(hypot(hypot((double)cells.normal[i][0],
                                             (double)cells.normal[i][1]),
                                       (double)cells.normal[i][2]) -
                                 1) < 1e-4);
            }
            assert_true(covered > 300);
            if (turn == 0) /* seen along z, the cells cover the whole common area */
                assert_true(fabs(area - d.area_mm2) < 0.03 * d.area_mm2);
        }
    }
}

/* Both surfaces turned alike, and the frame turned back: the same cells. */
static void test_turned_together(void **state)
{
    const double zero = 0, grown = 0.5;
    struct brute_rng rng = {1};

    (void)state;
    toy_scan(ball, &zero, 6000, NULL, &rng, &a);
    toy_scan(ball, &grown, 6000, NULL, &rng, &b);
    (void)gap_of(&a, &b, &still, &cells);
    for (int turn = 1; turn <= 3; turn++) {
        struct align_pose pose, back;
        double worst = 0;
        uint32_t n = 0;

        toy_pose(6 * turn, -4 * turn, 10 * turn, (struct dvec3){20, -30, 50}, &pose);
        back = inverse(&pose);
        rng.state = 1; /* the same points */
        toy_scan(ball, &zero, 6000, &pose, &rng, &a);
        toy_scan(ball, &grown, 6000, &pose, &rng, &b);
        (void)gap_of(&a, &b, &back, &other);
        for (uint32_t i = 0; i < GRID_N; i++) {
            if (!inner(&cells, i) || !inner(&other, i))
                continue;
            n++;
            worst = fmax(worst, fabs((double)(cells.gap[i] - other.gap[i])));
            assert_true(fabs((double)cells.gap[i] - 0.5) < 0.05);
            assert_true(fabs((double)(cells.z[i] - other.z[i])) < 0.3);
            for (int k = 0; k < 3; k++)
                assert_true(fabs((double)(cells.normal[i][k] - other.normal[i][k])) <
                            0.05);
        }
        printf("turned %d times: %u cells, gaps differ by up to %.4f mm\n", turn, n,
               worst);
        assert_true(n > 400 && worst < 0.05);
    }
}

/* Exchanging template and probe changes the sign of the gap. */
static void test_exchange(void **state)
{
    const double zero = 0, up = 0.4;
    struct brute_rng rng = {2};
    double sum = 0;
    uint32_t n = 0;

    (void)state;
    toy_scan(toy, &zero, 5000, NULL, &rng, &a);
    toy_scan(toy, &up, 3000, NULL, &rng, &b);
    (void)gap_of(&a, &b, &still, &cells);
    (void)gap_of(&b, &a, &still, &other);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (!inner(&cells, i) || !inner(&other, i))
            continue;
        n++;
        sum += fabs((double)(cells.gap[i] + other.gap[i]));
        assert_true(cells.gap[i] > 0.0f && other.gap[i] < 0.0f);
    }
    printf("exchanged: off by %.4f mm in the mean\n", sum / n);
    assert_true(n > 400 && sum / n < 0.02);
}

/* One curved surface, sampled sparsely and densely: the sparse one's triangles lie below the
 * surface by much more than the gap that the cells show. */
static void test_spacing(void **state)
{
    static const uint32_t points[][2] = {{800, 12000}, {12000, 800}, {1000, 1000}};
    const double zero = 0;
    struct brute_rng rng = {3};

    (void)state;
    for (size_t k = 0; k < sizeof points / sizeof *points; k++) {
        double square = 0, sum = 0;
        struct disparity d;
        uint32_t n = 0;

        toy_scan(ball, &zero, points[k][0], NULL, &rng, &a);
        toy_scan(ball, &zero, points[k][1], NULL, &rng, &b);
        d = gap_of(&a, &b, &still, &cells);
        for (uint32_t i = 0; i < GRID_N; i++) {
            if (!inner(&cells, i))
                continue;
            n++;
            sum += (double)cells.gap[i];
            square += (double)cells.gap[i] * (double)cells.gap[i];
        }
        printf("%u over %u points: plain %.4f mm, cells mean %+.4f, rms %.4f\n",
               points[k][1], points[k][0], d.plain_mm, sum / n, sqrt(square / n));
        assert_true(n > 400 && d.plain_mm > 0.015);
        assert_true(fabs(sum / n) < 0.01 && sqrt(square / n) < 0.5 * d.plain_mm);
    }
}

/* A hole in either surface is not covered; all else is. */
static void test_holes(void **state)
{
    static struct dvec3 pts[9000];
    const double zero = 0;
    struct brute_rng rng = {4};

    (void)state;
    for (int which = 0; which < 2; which++) {
        size_t n = 0;

        toy_scan(ball, &zero, 4000, NULL, &rng, &a);
        for (uint32_t v = 0; v < a.mesh.nv; v++) {
            const double x = a.mesh.xy[v].x / LATTICE_PER_MM;
            const double y = a.mesh.xy[v].y / LATTICE_PER_MM;

            if (hypot(x - 10, y - 5) > 16)
                pts[n++] = (struct dvec3){x, y, a.mesh.z[v] / LATTICE_PER_MM};
        }
        toy_surface(pts, n, &b);
        (void)gap_of(which == 0 ? &a : &b, which == 0 ? &b : &a, &still, &cells);
        for (uint32_t i = 0; i < GRID_N; i++) {
            const double off = hypot(grid_x(i) - 10, grid_y(i) - 5);
            const double u = grid_x(i) / 46, v = grid_y(i) / 60;

            if (off < 11)
                assert_true(cells.area[i] < CELLS_COVERED);
            else if (off > 22 && u * u + v * v < 1)
                assert_true(cells.area[i] >= CELLS_COVERED);
        }
    }
}

/* Cliffs and surface beyond the grid cover no cell, nor do surfaces with no common area. */
static void test_left_out(void **state)
{
    static const double far[16] = {1, 0, 0, 900, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const struct plane cliff = {5, 0, 0}, flat = {0, 0, 0};
    struct align_pose away = still;
    struct brute_rng rng = {5};
    struct disparity d;

    (void)state;
    toy_scan(plane, &cliff, 2000, NULL, &rng, &a);
    (void)gap_of(&a, &a, &still, &cells);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(cells.area[i] == 0.0f && cells.gap[i] == 0.0f);
    toy_scan(plane, &flat, 2000, NULL, &rng, &a);
    away.t[0] = 500;
    (void)gap_of(&a, &a, &away, &cells);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(cells.area[i] == 0.0f && cells.gap[i] == 0.0f);
    assert_int_equal(measure_at(&a, &a, far, NULL, &work, &d), ST_OK);
    assert_int_equal(cells_measure(&a, &work, &still, &cells, &overlap), ST_OK);
    assert_true(overlap == 0);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(cells.area[i] == 0.0f && cells.gap[i] == 0.0f);
}

/* Where both surfaces are dense, the sampled gaps agree with the exact ones. */
static void test_sample(void **state)
{
    static struct align_point pts[20000];
    const double zero = 0, up = 0.3;
    struct brute_rng rng = {6};
    struct align_field field;
    double sum = 0;
    uint32_t n = 0;

    (void)state;
    toy_scan(toy, &zero, 8000, NULL, &rng, &a);
    toy_scan(toy, &up, 8000, NULL, &rng, &b);
    (void)gap_of(&a, &b, &still, &cells);
    align_field_make(&a, NULL, &field);
    for (uint32_t v = 0; v < b.mesh.nv; v++)
        pts[v] = (struct align_point){{b.mesh.xy[v].x / LATTICE_PER_MM,
                                       b.mesh.xy[v].y / LATTICE_PER_MM,
                                       b.mesh.z[v] / LATTICE_PER_MM},
                                      (float)(3.14159265 * 55 * 70 / b.mesh.nv),
                                      ALIGN_FIELD_NONE};
    cells_sample(&field, pts, b.mesh.nv, &still, &still, &other);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (!inner(&cells, i))
            continue;
        n++; /* the points stand for equal parts of the plane here, not of the surface */
        assert_true(other.area[i] > 8.0f * cells.normal[i][2] &&
                    other.area[i] < 24.0f * cells.normal[i][2]);
        assert_true(fabs((double)(cells.gap[i] - other.gap[i])) < 0.15);
        sum += fabs((double)(cells.gap[i] - other.gap[i]));
    }
    printf("sampled: off by %.4f mm in the mean\n", sum / n);
    assert_true(n > 400 && sum / n < 0.03);
    pts[0].area = 0.0f; /* all of the point's triangles are bridges: it covers no cell */
    cells_sample(&field, pts, 1, &still, &still, &other);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(other.area[i] == 0.0f);
}

static int tear_down(void **state)
{
    (void)state;
    measure_work_free(&work);
    surface_free(&a);
    surface_free(&b);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_constant), cmocka_unit_test(test_turned_together),
        cmocka_unit_test(test_exchange), cmocka_unit_test(test_spacing),
        cmocka_unit_test(test_holes),    cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_sample),
    };

    return cmocka_run_group_tests(tests, NULL, tear_down);
}
