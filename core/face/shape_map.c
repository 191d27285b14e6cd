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
    const double up = v > 0.0 ? v : 0.0;

    return (uint32_t)(int32_t)(up < most ? up : most);
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

/* A grid with a rim of no cells, so that each of its cells has four beside it. */
#define WIDE (GRID_NX + 2)

_Static_assert(GRID_NX % LANES == 0, "a row is whole lanes");

static void put_rim(const float in[GRID_N], float out[(GRID_NY + 2) * WIDE])
{
    for (uint32_t i = 0; i < (GRID_NY + 2) * WIDE; i++)
        out[i] = (float)NAN;
    for (uint32_t j = 0; j < GRID_NY; j++)
        memcpy(&out[(j + 1) * WIDE + 1], &in[j * GRID_NX], GRID_NX * sizeof *in);
}

static inline lanes shape_map_load(const float *from)
{
    lanes v;

    memcpy(&v, from, sizeof v);
    return v;
}

/* The surface as a plane in each cell, through its middle; the last cell has none. */
struct planes {
    float z[GRID_N + 1], zx[GRID_N + 1], zy[GRID_N + 1];
};

/* The slope from the heights before, at and behind; one may be missing. */
static inline lanes slope(lanes before, lanes at, lanes behind)
{
    const float half = (float)(0.5 / GRID_MM), one = (float)(1 / GRID_MM);
    const masks first = before != before, last = behind != behind;
    const masks both = (masks)((behind - before) * half);
    const masks up = (masks)((behind - at) * one), down = (masks)((at - before) * one);

    return (lanes)((~first & ~last & both) | (first & ~last & up) |
                   (~first & last & down));
}

void shape_map_slope(const float h[GRID_N], uint32_t i, float *zx, float *zy)
{
    const uint32_t column = i % GRID_NX, row = i / GRID_NX;
    const float none = (float)NAN;
    const lanes before = {column > 0 ? h[i - 1] : none, row > 0 ? h[i - GRID_NX] : none};
    const lanes at = {h[i], h[i]};
    const lanes behind = {column < GRID_NX - 1 ? h[i + 1] : none,
                          row < GRID_NY - 1 ? h[i + GRID_NX] : none};
    const lanes z = slope(before, at, behind);

    *zx = z[0];
    *zy = z[1];
}

/* With slopes per cell. */
static void make_planes(const float height[GRID_N], struct planes *s)
{
    float in[(GRID_NY + 2) * WIDE];

    put_rim(height, in);
    memcpy(s->z, height, GRID_N * sizeof *height);
    for (uint32_t i = 0; i < GRID_N; i += LANES) {
        const float *at = &in[(i / GRID_NX + 1) * WIDE + i % GRID_NX + 1];
        const lanes here = shape_map_load(at);
        const lanes zx =
            slope(shape_map_load(at - 1), here, shape_map_load(at + 1)) * (float)GRID_MM;
        const lanes zy =
            slope(shape_map_load(at - WIDE), here, shape_map_load(at + WIDE)) *
            (float)GRID_MM;

        memcpy(&s->zx[i], &zx, sizeof zx);
        memcpy(&s->zy[i], &zy, sizeof zy);
    }
    s->z[GRID_N] = (float)NAN;
    s->zx[GRID_N] = s->zy[GRID_N] = 0.0f;
}

/* Each point's cell, and how far it is in front of the surface there. */
static void shape_map_place(struct shape_points *p, const struct pose *pose,
                            const struct planes *s)
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

    make_planes(height, &s);
    shape_map_place(p, pose, &s);
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
        out[i] = sum[i][0] / sum[i][1]; /* of none: 0 / 0, NAN */
}

void shape_map_fill(const float height[GRID_N], float over[GRID_N])
{
    float was[(GRID_NY + 2) * WIDE];

    put_rim(over, was);
    for (uint32_t i = 0; i < GRID_N; i += LANES) {
        const float *at = &was[(i / GRID_NX + 1) * WIDE + i % GRID_NX + 1];
        const lanes beside[4] = {shape_map_load(at - 1), shape_map_load(at + 1),
                                 shape_map_load(at - WIDE), shape_map_load(at + WIDE)};
        const lanes here = shape_map_load(at), face = shape_map_load(&height[i]);
        const masks known = here == here;
        masks n = {0}, made;
        lanes sum = {0.0f};

        for (int k = 0; k < 4; k++) {
            const masks there = beside[k] == beside[k];

            sum += (lanes)(there & (masks)beside[k]);
            n -= there;
        }
        made = (masks)(sum / __builtin_convertvector(n, lanes));
        made |= ~((face == face) & (n > 1)); /* NAN */
        made = (known & (masks)here) | (~known & made);
        memcpy(&over[i], &made, sizeof made);
    }
}
