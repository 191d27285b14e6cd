#include "find_place.h"

#include <math.h>
#include <string.h>

#include "find_near.h"
#include "frame.h"
#include "tuning.h"

#define MAP_N  48
#define MAP_MM 6.0f
#define NONE   (-1e9f)

/* cos and sin of 360 / FIND_ROLLS degrees */
#define ROLL_COS 0.93969262078590838405
#define ROLL_SIN 0.34202014332566873304
#define SIN_60   0.86602540378443864676

/* Axes at right angles, of which the third is given. */
static void axes_about(const double z[3], double out[9])
{
    const int least = fabs(z[0]) <= fabs(z[1]) && fabs(z[0]) <= fabs(z[2]) ? 0
                      : fabs(z[1]) <= fabs(z[2])                           ? 1
                                                                           : 2;
    double x[3], l = 0;

    for (int i = 0; i < 3; i++) {
        x[i] = (i == least) - z[least] * z[i];
        l += x[i] * x[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = x[i] / sqrt(l);
    out[3] = z[1] * out[2] - z[2] * out[1];
    out[4] = z[2] * out[0] - z[0] * out[2];
    out[5] = z[0] * out[1] - z[1] * out[0];
    memcpy(out + 6, z, 3 * sizeof *out);
}

static void turned(const double r[9], const double p[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = r[3 * i] * p[0] + r[3 * i + 1] * p[1] + r[3 * i + 2] * p[2];
}

/* a^T b */
static void after(const double a[9], const double b[9], double out[9])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[3 * i + k] = a[i] * b[k] + a[3 + i] * b[3 + k] + a[6 + i] * b[6 + k];
}

/* The highest cell, and the direction in which it sticks out, as find_nose.h has it. */
static void find_tip(const struct frame_mean *mean, struct find_face_samples *out)
{
    double c[3] = {0, 0, 0}, axis[3], l = 0;
    uint32_t top = 0, n = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (mean->height[i] > mean->height[top] || isnan(mean->height[top]))
            top = i;
    out->tip[0] = grid_x(top) < 0 ? grid_x(top) + GRID_MM / 2 : grid_x(top) - GRID_MM / 2;
    out->tip[1] = grid_y(top);
    out->tip[2] = (double)mean->height[top];
    for (uint32_t i = 0; i < GRID_N; i++) {
        const double d[3] = {grid_x(i) - out->tip[0], grid_y(i) - out->tip[1],
                             (double)mean->height[i] - out->tip[2]};

        if (!(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < FIND_BALL_MM * FIND_BALL_MM))
            continue;
        for (int k = 0; k < 3; k++)
            c[k] += d[k];
        n++;
    }
    for (int k = 0; k < 3; k++)
        l += c[k] * c[k];
    for (int k = 0; k < 3; k++)
        axis[k] = -c[k] / sqrt(l);
    axes_about(axis, out->axes);
}

void find_place_samples(const struct frame_mean *mean, struct find_face_samples *out)
{
    out->n = 0;
    find_tip(mean, out);
    for (uint32_t i = 0; i < GRID_N && out->n < FIND_SAMPLES; i++) {
        struct find_sample *s = &out->sample[out->n];
        const double d[3] = {grid_x(i) - out->tip[0], grid_y(i) - out->tip[1],
                             (double)mean->height[i] - out->tip[2]};
        double p[3];

        if (i % GRID_NX % 3 != 0 || i / GRID_NX % 3 != 1 || isnan(mean->height[i]))
            continue;
        turned(out->axes, d, p);
        for (int k = 0; k < 3; k++)
            s->at[k] = (float)p[k];
        s->flat = mean->grid.flat[i] > 0 ? mean->grid.flat[i] : 0.7f;
        out->n++;
    }
}

/* Heights along an axis of the foremost voxels, from the place. */
struct map {
    float z[MAP_N * MAP_N];
};

static inline int cell_of(float x, float y)
{
    const float i = (x + (float)(MAP_N / 2) * MAP_MM) * (1 / MAP_MM);
    const float j = (y + (float)(MAP_N / 2) * MAP_MM) * (1 / MAP_MM);

    if (!((i >= 0) & (i < MAP_N) & (j >= 0) & (j < MAP_N)))
        return -1;
    return (int)j * MAP_N + (int)i;
}

static void map_make(const struct find_near *near, const double axes[9], struct map *out)
{
    struct map bare;
    float r[9];

    for (int i = 0; i < 9; i++)
        r[i] = (float)axes[i];
    for (int i = 0; i < MAP_N * MAP_N; i++)
        bare.z[i] = NONE;
    for (uint32_t v = 0; v < near->n; v++) {
        const float x = near->x[v], y = near->y[v], z = near->z[v];
        const float h = r[6] * x + r[7] * y + r[8] * z;
        const int c =
            cell_of(r[0] * x + r[1] * y + r[2] * z, r[3] * x + r[4] * y + r[5] * z);

        if (c >= 0 && h > bare.z[c] && h < (float)FIND_FRONT_MM)
            bare.z[c] = h;
    }
    *out = bare;
    for (int j = 1; j < MAP_N - 1; j++)
        for (int i = 1; i < MAP_N - 1; i++) {
            const float *at = &bare.z[j * MAP_N + i];
            float most = NONE;

            if (*at > NONE)
                continue;
            for (int k = 0; k < 4; k++) {
                static const int by[4] = {-1, 1, -MAP_N, MAP_N};

                most = at[by[k]] > most ? at[by[k]] : most;
            }
            out->z[j * MAP_N + i] = most;
        }
}

static float cost_of(const struct find_face_samples *s, const struct map *map, float c,
                     float d)
{
    float sum = 0;

    for (uint32_t i = 0; i < s->n; i++) {
        const struct find_sample *p = &s->sample[i];
        /* from the face's axes to the map's: the inverse of the roll */
        const int at = cell_of(c * p->at[0] + d * p->at[1], c * p->at[1] - d * p->at[0]);
        float gap = at < 0 ? (float)FIND_FAR_MM : fabsf(map->z[at] - p->at[2]) * p->flat;

        sum += gap < (float)FIND_FAR_MM ? gap : (float)FIND_FAR_MM;
    }
    return sum / (float)s->n;
}

void find_place_turn(const struct find_face_samples *s, const struct find_near *near,
                     const float axis[3], struct find_place out[FIND_ROLLS])
{
    const double z[3] = {(double)axis[0], (double)axis[1], (double)axis[2]};
    double axes[9], c = 1, d = 0;
    struct map map;

    axes_about(z, axes);
    map_make(near, axes, &map);
    for (int k = 0; k < FIND_ROLLS; k++) {
        const double next = c * ROLL_COS - d * ROLL_SIN;
        double m[9], r[9];

        for (int i = 0; i < 3; i++) {
            m[i] = c * axes[i] - d * axes[3 + i];
            m[3 + i] = d * axes[i] + c * axes[3 + i];
            m[6 + i] = axes[6 + i];
        }
        after(s->axes, m, r);
        for (int i = 0; i < 9; i++)
            out[k].r[i] = (float)r[i];
        out[k].cost = cost_of(s, &map, (float)c, (float)d);
        d = c * ROLL_SIN + d * ROLL_COS;
        c = next;
    }
}

void find_place_tilt(const float axis[3], int k, float out[3])
{
    static const double by[FIND_TILTS][2] = {{1, 0},  {0.5, SIN_60},   {-0.5, SIN_60},
                                             {-1, 0}, {-0.5, -SIN_60}, {0.5, -SIN_60}};
    const double z[3] = {(double)axis[0], (double)axis[1], (double)axis[2]};
    double a[9];

    axes_about(z, a);
    for (int i = 0; i < 3; i++)
        out[i] = (float)(FIND_TILT_COS * z[i] +
                         FIND_TILT_SIN * (by[k][0] * a[i] + by[k][1] * a[3 + i]));
}
