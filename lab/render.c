#include "render.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#define NX (2 * GRID_NX)
#define NY (2 * GRID_NY)

/* Corners of a triangle just beside a sample still cover it. */
#define BESIDE 1e-5f

/* A corner in units of samples; z in mm. */
struct corner {
    float x, y, z;
};

static struct corner corner_of(const struct render_mesh *m, uint32_t v)
{
    const float over = 1.0f / (float)RENDER_MM, *at = m->at + 3 * (size_t)v;

    return (struct corner){(at[0] - (float)GRID_LEFT) * over - 0.5f,
                           (at[1] - (float)GRID_BOTTOM) * over - 0.5f, at[2]};
}

static float least(float a, float b, float c)
{
    return fminf(a, fminf(b, c));
}

static float most(float a, float b, float c)
{
    return fmaxf(a, fmaxf(b, c));
}

/* The samples between lo and hi, of n. */
static int first_of(float lo)
{
    return lo > 0.0f ? (int)ceilf(lo) : 0;
}

static int last_of(float hi, int n)
{
    return hi < (float)(n - 1) ? (int)floorf(hi) : n - 1;
}

static void draw(struct corner a, struct corner b, struct corner c, float z[NY][NX])
{
    const float lx = least(a.x, b.x, c.x), hx = most(a.x, b.x, c.x);
    const float ly = least(a.y, b.y, c.y), hy = most(a.y, b.y, c.y);
    const float twice = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);

    if (!(hx >= 0.0f && hy >= 0.0f && lx <= NX - 1 && ly <= NY - 1) ||
        !(fabsf(twice) > 1e-9f))
        return;
    for (int j = first_of(ly); j <= last_of(hy, NY); j++)
        for (int i = first_of(lx); i <= last_of(hx, NX); i++) {
            const float x = (float)i - a.x, y = (float)j - a.y;
            const float u = (x * (c.y - a.y) - y * (c.x - a.x)) / twice;
            const float v = ((b.x - a.x) * y - (b.y - a.y) * x) / twice;
            const float at = a.z + u * (b.z - a.z) + v * (c.z - a.z);

            if (u >= -BESIDE && v >= -BESIDE && u + v <= 1.0f + BESIDE &&
                !(z[j][i] >= at))
                z[j][i] = at;
        }
}

/* Bridge the slits of exactly gap samples in column i. */
static void bridge(float z[NY][NX], int gap, int i)
{
    for (int j = 1; j < NY - gap; j++) {
        const float from = z[j - 1][i], to = z[j + gap][i];
        bool slit = fabsf(to - from) < RENDER_STEP_MM;

        for (int k = 0; k < gap; k++)
            slit = slit && isnan(z[j + k][i]);
        for (int k = 0; slit && k < gap; k++)
            z[j + k][i] = from + (to - from) * (float)(k + 1) / (float)(gap + 1);
    }
}

/* The median of n values in rising order. */
static float middle(const float *v, int n)
{
    return 0.5f * (v[(n - 1) / 2] + v[n / 2]);
}

static float cell_height(const float sample[4])
{
    float v[4] = {0.0f}, sum = 0.0f, median;
    int n = 0, near = 0;

    for (int i = 0; i < 4; i++) {
        int at = n;

        if (isnan(sample[i]))
            continue;
        for (n++; at > 0 && v[at - 1] > sample[i]; at--)
            v[at] = v[at - 1];
        v[at] = sample[i];
    }
    if (n < 2)
        return (float)NAN;
    median = middle(v, n);
    for (int i = 0; i < n; i++)
        if (fabsf(v[i] - median) < RENDER_LAYER_MM) {
            sum += v[i];
            near++;
        }
    return near >= 2 ? sum / (float)near : (float)NAN;
}

void render_heights(const struct render_mesh *m, float out[GRID_N])
{
    float z[NY][NX];

    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++)
            z[j][i] = (float)NAN;
    for (uint32_t t = 0; t < m->nt; t++)
        draw(corner_of(m, m->corner[t][0]), corner_of(m, m->corner[t][1]),
             corner_of(m, m->corner[t][2]), z);
    for (int gap = 1; gap <= RENDER_SLIT; gap++)
        for (int i = 0; i < NX; i++)
            bridge(z, gap, i);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t x = 2 * (i % GRID_NX), y = 2 * (i / GRID_NX);

        out[i] = cell_height(
            (const float[4]){z[y][x], z[y][x + 1], z[y + 1][x], z[y + 1][x + 1]});
    }
}
