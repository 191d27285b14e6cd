#include "cells.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "align_field.h"
#include "lattice.h"

/* Cosine between a normal and the frame's z (75 degrees) below which a place is left out: a
 * gap at right angles says little there, and the area is seen edge-on. */
#define CELLS_STEEP 0.25

/* Sums over a cell, as vectors.  Lanes 0 to 2 of normal: of the normals, each as long as the
 * area of its piece, so that lane 2 is the area seen along the frame's z.  Lanes 2 and 3 of
 * level: that area times the height, and times the gap. */
typedef float lane4 __attribute__((vector_size(16)));
typedef int32_t whole4 __attribute__((vector_size(16)));

struct cells_sums {
    lane4 normal, level;
};

static inline lane4 cross(lane4 a, lane4 b)
{
    const lane4 p = __builtin_shufflevector(a, a, 1, 2, 0, 3);
    const lane4 q = __builtin_shufflevector(b, b, 1, 2, 0, 3);
    const lane4 s = a * q - p * b;

    return __builtin_shufflevector(s, s, 1, 2, 0, 3);
}

/* grid_cell() of the place q, or GRID_N: what is added there is not used.  Without a branch:
 * coordinates are below 10^5 mm, which an integer holds. */
static inline uint32_t cell_of(lane4 q)
{
    const int32_t far = 1 << 15; /* cells; so that rounding towards 0 is rounding down */
    const float over = (float)(1 / GRID_MM);
    const lane4 scale = {over, over, 0, 0};
    const lane4 origin = {(float)(far - GRID_LEFT / GRID_MM),
                          (float)(far - GRID_BOTTOM / GRID_MM), 0, 0};
    const whole4 i = __builtin_convertvector(q * scale + origin, whole4);
    const uint32_t x = (uint32_t)(i[0] - far), y = (uint32_t)(i[1] - far);

    return ((x < GRID_NX) & (y < GRID_NY)) != 0 ? y * GRID_NX + x : GRID_N;
}

static inline void add_piece(struct cells_sums *sums, lane4 q, bool used, lane4 normal,
                             lane4 level)
{
    const uint32_t i = used ? cell_of(q) : GRID_N;

    sums[i].normal += normal;
    sums[i].level += level * q;
}

/* From sums to means. */
static void means(const struct cells_sums *sums, struct cells *c)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        const lane4 n = sums[i].normal;
        const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const float over = n[2] > 0.0f ? 1.0f / n[2] : 0.0f;
        const float unit = n[2] > 0.0f ? 1.0f / length : 0.0f;

        c->area[i] = n[2];
        c->gap[i] = sums[i].level[3] * over;
        c->z[i] = sums[i].level[2] * over;
        for (int k = 0; k < 3; k++)
            c->normal[i][k] = n[k] * unit;
    }
}

void cells_sample(struct align_field *field, struct align_point *pts, uint32_t n,
                  const struct pose *pose, const struct pose *frame, struct cells *out)
{
    const double *r = frame->r, *t = frame->t;
    const lane4 x = {(float)r[0], (float)r[3], (float)r[6], 0};
    const lane4 y = {(float)r[1], (float)r[4], (float)r[7], 0};
    const lane4 z = {(float)r[2], (float)r[5], (float)r[8], 0};
    const lane4 origin = {(float)t[0], (float)t[1], (float)t[2], 0};
    const float mm = (float)(1 / LATTICE_PER_MM);
    uint32_t last = field->first; /* neighbours follow each other: a short way */
    struct cells_sums sums[GRID_N + 1];

    memset(sums, 0, sizeof sums);
    for (uint32_t i = 0; i < n; i++) {
        const struct dvec3 q = pose_apply(pose, pts[i].p);
        struct align_corners k;
        lane4 a, b, c, normal, at;
        const float area = pts[i].area;
        float gap;
        bool found;

        if (pts[i].triangle == ALIGN_FIELD_NONE)
            pts[i].triangle = last;
        found = align_field_find(field, &pts[i], q, &k);
        last = pts[i].triangle;
        if (!found || area <= 0.0f)
            continue;
        a = (lane4){k.at[0][0], k.at[0][1], k.at[0][2], 0};
        b = (lane4){k.at[1][0], k.at[1][1], k.at[1][2], 0};
        c = (lane4){k.at[2][0], k.at[2][1], k.at[2][2], 0};
        c = cross(b - a, c - a); /* the normal */
        c *= 1.0f / sqrtf(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        gap = -mm * (a[0] * c[0] + a[1] * c[1] + a[2] * c[2]);
        at = origin + (float)q.x * x + (float)q.y * y + ((float)q.z - gap / c[2]) * z;
        at[3] = gap;
        normal = c[0] * x + c[1] * y + c[2] * z;
        normal *= area;
        add_piece(sums, at, normal[2] >= (float)CELLS_STEEP * area, normal,
                  (lane4){0, 0, normal[2], normal[2]});
    }
    means(sums, out);
}
