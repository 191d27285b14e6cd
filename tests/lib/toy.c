#include "toy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lattice.h"
#include "mem.h"
#include "shape_map.h"

#define CHANGE   6 /* modes */
#define IDENTITY 12

static void require(bool holds)
{
    if (holds)
        return;
    (void)fputs("toy: cannot be made\n", stderr);
    abort();
}

/* 1 at (x0, y0), falling off within sx, sy. */
static double hill(double x, double y, double x0, double y0, double sx, double sy)
{
    const double u = (x - x0) / sx, v = (y - y0) / sy, w = 1 + 0.5 * (u * u + v * v);

    return 1 / (w * w);
}

double toy_height(double x, double y)
{
    static const double part[9][5] = {{24, 38, 16, 12, -19.5}, /* orbits */
                                      {30, 30, 10, 8, 11.5},   /* eyeballs */
                                      {28, 48, 26, 10, 9},     /* brow */
                                      {28, 18, 14, 14, -14},   /* beside the nose */
                                      {12, -2, 5, 7, 7},       /* wings of the nose */
                                      {48, 8, 22, 14, 4},      /* cheekbones */
                                      {0, -29, 18, 8, 11},     /* lips */
                                      {0, -44, 20, 10, 6.5},   /* below them */
                                      {0, -66, 20, 14, 11.5}}; /* chin */
    const double nose = y > 0 ? 1 - y / 50 : 1 + y / 14;
    const double ridge = nose > 0 ? nose * nose * (3 - 2 * nose) : 0;
    const double xx = x * x / 1000;
    double z = -18.5 - 7.2 * xx - 0.66 * xx * xx + 0.08 * y - 0.0017 * y * y +
               18 * ridge * hill(x, 0, 0, 0, 11, 1);

    for (int i = 0; i < 9; i++) {
        const double *a = part[i];

        z += a[4] * hill(x, y, a[0], a[1], a[2], a[3]);
        z += a[0] > 0 ? a[4] * hill(x, y, -a[0], a[1], a[2], a[3]) : 0;
    }
    return z;
}

/* The k-th mode of change of the model. */
static double change(uint32_t k, double x, double y)
{
    static const double at[CHANGE][5] = {{33, -8, 11, 1, 1.6}, {33, -8, 11, -1, 0.7},
                                         {0, -34, 18, 0, 1.5}, {25, -25, 8, 1, 1.2},
                                         {26, 48, 14, 1, 0.6}, {48, 5, 15, 1, 0.5}};
    const double *a = at[k];

    return a[4] * (hill(x, y, a[0], a[1], a[2], a[2]) +
                   a[3] * hill(x, y, -a[0], a[1], a[2], a[2]));
}

/* The k-th mode of identity. */
static double identity(uint32_t k, double x, double y)
{
    static const double at[IDENTITY][2] = {{0, -62},  {0, -32},  {0, 12},  {0, 50},
                                           {22, -56}, {24, -12}, {30, 34}, {24, 56},
                                           {40, -34}, {46, -4},  {46, 26}, {12, 24}};
    const double *a = at[k];

    return 2.5 * (hill(x, y, a[0], a[1], 12, 12) + hill(x, y, -a[0], a[1], 12, 12));
}

char *toy_text(const struct surface_model *m, size_t *len)
{
    char *text;

    *len = surface_model_write(m, NULL, 0);
    require((text = malloc(*len + 1)) != NULL);
    require(surface_model_write(m, text, *len + 1) == *len);
    return text;
}

void toy_model(struct surface_model *m)
{
    char *text;
    size_t len;

    memset(m, 0, sizeof *m);
    strcpy(m->name, "a toy");
    m->kinship = 0.3;
    m->noise_floor_mm = 0.5;
    m->noise_factor = 1.2;
    m->change.n = CHANGE;
    m->identity.n = IDENTITY;
    m->shape.n = CHANGE + IDENTITY;
    m->calibration = (struct surface_calibration){
        8, 3, {{-50, 1}, {0, 0.02}, {15, 0.00001}}, {0.000008, 6, 5000}};
    for (uint32_t c = 0; c < GRID_N; c++) {
        const double x = grid_x(c), y = grid_y(c);
        const double u = x / 60, v = (y + 3) / 78;

        m->mean[c] = (float)NAN;
        if (u * u + v * v > 1)
            continue;
        m->mean[c] = (float)toy_height(x, y);
        m->change.rest[c] = 0.15f;
        m->shape.rest[c] = (float)(0.4 + 0.2 * hill(x, y, 0, -45, 40, 20));
        for (uint32_t k = 0; k < CHANGE; k++) {
            m->change.mode[c][k] = (float)change(k, x, y);
            m->shape.mode[c][k] = (float)(3 * change(k, x, y));
        }
        for (uint32_t k = 0; k < IDENTITY; k++) {
            m->identity.mode[c][k] = (float)identity(k, x, y);
            m->shape.mode[c][CHANGE + k] = m->identity.mode[c][k];
        }
    }
    text = toy_text(m, &len);
    require(model_parse(text, len, m, NULL) == ST_OK);
    free(text);
}

void toy_cells(const struct surface_model *m, const float from[GRID_N],
               const float to[GRID_N], struct cells *out)
{
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < GRID_N; i++) {
        float zx, zy, flat;

        if (!(m->change.rest[i] > 0.0f) || isnan(from[i]) || isnan(to[i]))
            continue;
        shape_map_slope(m->mean, i, &zx, &zy);
        flat = 1.0f / sqrtf(1.0f + zx * zx + zy * zy);
        out->area[i] = (float)(GRID_MM * GRID_MM);
        out->gap[i] = (to[i] - from[i]) * flat;
        out->z[i] = m->mean[i];
        out->normal[i][0] = -zx * flat;
        out->normal[i][1] = -zy * flat;
        out->normal[i][2] = flat;
    }
}

void toy_surface(const struct dvec3 *pts, size_t n, struct surface *out)
{
    struct ivec3 *lattice = mem_array(n, sizeof *lattice);
    struct scratch scratch = {0};

    require(lattice != NULL);
    require(lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, NULL) == ST_OK);
    require(surface_prepare(lattice, n, false, &scratch, out) == ST_OK);
    mem_free(lattice);
    scratch_free(&scratch);
}

void toy_scan(toy_heights *z, const void *arg, uint32_t n, const struct pose *pose,
              struct draw *rng, struct surface *out)
{
    const double step = sqrt(3.14159265358979 * 55 * 70 / n);
    struct dvec3 *pts = mem_array(2 * (size_t)n + 1000, sizeof *pts);
    size_t count = 0;

    require(pts != NULL);
    for (double y = -70; y < 70; y += step)
        for (double x = -55; x < 55; x += step) {
            const double u = x + step * draw_uniform(rng, 0.1, 0.9);
            const double v = y + step * draw_uniform(rng, 0.1, 0.9);

            if (u * u / (55 * 55) + v * v / (70 * 70) >= 1)
                continue;
            pts[count] = (struct dvec3){u, v, z(arg, u, v)};
            if (pose != NULL)
                pts[count] = pose_apply(pose, pts[count]);
            count++;
        }
    toy_surface(pts, count, out);
    mem_free(pts);
}

const struct pose toy_still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

void toy_pose(double yaw, double pitch, double roll, struct dvec3 shift, struct pose *p)
{
    const double half = 3.14159265358979323846 / 360;
    const struct dvec3 centre = {0, 0, -80};
    const double turn[6] = {0, 0, 2 * tan(roll * half), shift.x, shift.y, shift.z};

    *p = toy_still;
    pose_tilt(p, centre, tan(yaw * half), tan(pitch * half));
    pose_move(p, centre, turn);
}

struct pose toy_then(const struct pose *a, const struct pose *b)
{
    const struct pose back = pose_after(b, &toy_still);

    return pose_after(&back, a);
}

double toy_at(const float h[GRID_N], double x, double y)
{
    const double i = (x - GRID_LEFT) / GRID_MM - 0.5,
                 j = (y - GRID_BOTTOM) / GRID_MM - 0.5;
    const float *at = h + (uint32_t)j * GRID_NX + (uint32_t)i;
    const double u = i - (uint32_t)i, v = j - (uint32_t)j;

    return (1 - v) * ((1 - u) * (double)at[0] + u * (double)at[1]) +
           v * ((1 - u) * (double)at[GRID_NX] + u * (double)at[GRID_NX + 1]);
}
