#include "shape_map.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define LANES 4
typedef float lanes __attribute__((vector_size(16)));
typedef int32_t masks __attribute__((vector_size(16)));

/* How deep points of the face, or beside it, may lie. */
static void deepest(const float height[GRID_N], float deep[GRID_N])
{
    float least = 0.0f;

    for (uint32_t i = 0; i < GRID_N; i++)
        least = height[i] < least ? height[i] : least;
    for (uint32_t i = 0; i < GRID_N; i++)
        deep[i] = (isnan(height[i]) ? least : height[i]) - (float)SHAPE_DEEP_MM;
}

/* v within 0..most, also if it is no number. */
static uint32_t within(double v, int most)
{
    return v > 0.0 ? v < most ? (uint32_t)v : (uint32_t)most : 0;
}

static bool is_near(struct dvec3 q, const float deep[GRID_N])
{
    const double rim = SHAPE_AROUND_MM / GRID_MM;
    const double i = (q.x - GRID_LEFT) / GRID_MM, j = (q.y - GRID_BOTTOM) / GRID_MM;
    const uint32_t cell = within(j, GRID_NY - 1) * GRID_NX + within(i, GRID_NX - 1);

    return (i > -rim) & (i < GRID_NX + rim) & (j > -rim) & (j < GRID_NY + rim) &
           (q.z > (double)deep[cell]) & (q.z < SHAPE_AROUND_MM);
}

/* Keep every n-th. */
static void thin(struct shape_points *p)
{
    const uint32_t step = p->n / SHAPE_POINTS + 1, n = p->n / step;

    for (uint32_t i = 0; step > 1 && i < n; i++) {
        p->x[i] = p->x[i * step];
        p->y[i] = p->y[i * step];
        p->z[i] = p->z[i * step];
    }
    p->n = n;
}

enum status shape_map_points(const struct dvec3 *pts, size_t n, const struct pose *pose,
                             const float height[GRID_N], struct scratch *s,
                             struct shape_points *out)
{
    const size_t room = mem_round((n + LANES) * sizeof(float));
    float deep[GRID_N];
    unsigned char *block = scratch_need(s, 5 * room);
    size_t at = 0;

    if (block == NULL)
        return ST_ENOMEM;
    out->x = mem_take(block, &at, 1, room);
    out->y = mem_take(block, &at, 1, room);
    out->z = mem_take(block, &at, 1, room);
    out->over = mem_take(block, &at, 1, room);
    out->cell = mem_take(block, &at, 1, room);
    out->n = 0;
    deepest(height, deep);
    for (size_t i = 0; i < n; i++) {
        const struct dvec3 q = pose_apply(pose, pts[i]);

        /* written always, counted when near: no branch */
        out->x[out->n] = (float)q.x;
        out->y[out->n] = (float)q.y;
        out->z[out->n] = (float)q.z;
        out->n += is_near(q, deep);
    }
    thin(out);
    for (uint32_t i = out->n; i % LANES != 0; i++)
        out->x[i] = out->y[i] = out->z[i] = 0.0f;
    return ST_OK;
}

/* The surface as a plane in each cell, through its middle; the last cell has none. */
struct planes {
    float z[GRID_N + 1], zx[GRID_N + 1], zy[GRID_N + 1];
};

/* The slope from the heights before, at and behind; one may be missing. */
static float slope(float before, float at, float behind)
{
    const float half = (float)(0.5 / GRID_MM), one = (float)(1 / GRID_MM);

    if (isnan(before))
        return isnan(behind) ? 0.0f : (behind - at) * one;
    return isnan(behind) ? (at - before) * one : (behind - before) * half;
}

void shape_map_slope(const float h[GRID_N], uint32_t i, float *zx, float *zy)
{
    const uint32_t column = i % GRID_NX, row = i / GRID_NX;
    const float none = (float)NAN;

    *zx =
        slope(column > 0 ? h[i - 1] : none, h[i], column < GRID_NX - 1 ? h[i + 1] : none);
    *zy = slope(row > 0 ? h[i - GRID_NX] : none, h[i],
                row < GRID_NY - 1 ? h[i + GRID_NX] : none);
}

/* Each point's cell, and how far it is in front of the surface there. */
static void place(struct shape_points *p, const struct pose *pose, const struct planes *s)
{
    float r[9], t[3];

    for (int i = 0; i < 9; i++)
        r[i] = (float)pose->r[i];
    for (int i = 0; i < 3; i++)
        t[i] = (float)pose->t[i];
    for (uint32_t i = 0; i < p->n; i += LANES) {
        lanes x, y, z, u, v, w, column, row;
        masks cx, cy, inside, cell;

        memcpy(&x, p->x + i, sizeof x);
        memcpy(&y, p->y + i, sizeof y);
        memcpy(&z, p->z + i, sizeof z);
        u = r[0] * x + r[1] * y + r[2] * z + t[0];
        v = r[3] * x + r[4] * y + r[5] * z + t[1];
        w = r[6] * x + r[7] * y + r[8] * z + t[2];
        column = (u - (float)GRID_LEFT) * (float)(1 / GRID_MM);
        row = (v - (float)GRID_BOTTOM) * (float)(1 / GRID_MM);
        inside = (column >= 0.0f) & (column < (float)GRID_NX) & (row >= 0.0f) &
                 (row < (float)GRID_NY);
        column = (lanes)((masks)column & inside);
        row = (lanes)((masks)row & inside);
        cx = __builtin_convertvector(column, masks);
        cy = __builtin_convertvector(row, masks);
        cell = ((cy * GRID_NX + cx) & inside) | (~inside & GRID_N);
        column -= __builtin_convertvector(cx, lanes) + 0.5f;
        row -= __builtin_convertvector(cy, lanes) + 0.5f;
        for (int k = 0; k < LANES; k++) {
            const int32_t c = cell[k];

            p->cell[i + (uint32_t)k] = (uint32_t)c;
            p->over[i + (uint32_t)k] =
                w[k] - (s->z[c] + (s->zx[c] * column[k] + s->zy[c] * row[k]));
        }
    }
}

/* Of a cell: the sum of its front-most points, and how many. */
typedef float tally __attribute__((vector_size(8)));
typedef int32_t pair __attribute__((vector_size(8)));

void shape_map_make(struct shape_points *p, const struct pose *pose,
                    const float height[GRID_N], float out[GRID_N])
{
    const float behind = (float)-SHAPE_BEHIND_MM;
    struct planes s;
    float front[GRID_N + 1];
    tally sum[GRID_N + 1];

    s.z[GRID_N] = (float)NAN;
    s.zx[GRID_N] = s.zy[GRID_N] = 0.0f;
    for (uint32_t i = 0; i < GRID_N; i++) {
        s.z[i] = height[i];
        shape_map_slope(height, i, &s.zx[i], &s.zy[i]);
        s.zx[i] *= (float)GRID_MM; /* per cell */
        s.zy[i] *= (float)GRID_MM;
    }
    place(p, pose, &s);
    for (uint32_t i = 0; i <= GRID_N; i++)
        front[i] = behind;
    memset(sum, 0, sizeof sum);
    for (uint32_t i = 0; i < p->n; i++) /* NAN is no larger */
        front[p->cell[i]] =
            p->over[i] > front[p->cell[i]] ? p->over[i] : front[p->cell[i]];
    for (uint32_t i = 0; i < p->n; i++) {
        const uint32_t c = p->cell[i];
        const int32_t first = -((p->over[i] > front[c] - (float)SHAPE_LAYER_MM) &
                                (p->over[i] > behind)); /* no branch */

        sum[c] += (tally)((pair){first, first} & (pair)(tally){p->over[i], 1.0f});
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        out[i] = sum[i][1] > 0.0f ? sum[i][0] / sum[i][1] : (float)NAN;
}

void shape_map_fill(const float height[GRID_N], float over[GRID_N])
{
    float was[GRID_N + 2 * GRID_NX];
    float *const at = was + GRID_NX; /* with a row of none below and above */

    for (uint32_t i = 0; i < GRID_N + 2 * GRID_NX; i++)
        was[i] = (float)NAN;
    memcpy(at, over, GRID_N * sizeof *at);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float none = (float)NAN;
        const float beside[4] = {i % GRID_NX > 0 ? at[i - 1] : none,
                                 i % GRID_NX < GRID_NX - 1 ? at[i + 1] : none, was[i],
                                 at[i + GRID_NX]};
        float sum = 0.0f, n = 0.0f;

        if (!isnan(over[i]) || isnan(height[i]))
            continue;
        for (int k = 0; k < 4; k++) {
            sum += isnan(beside[k]) ? 0.0f : beside[k];
            n += isnan(beside[k]) ? 0.0f : 1.0f;
        }
        over[i] = n > 1.0f ? sum / n : none;
    }
}
