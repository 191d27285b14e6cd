#include "cells.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "align_field.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"
#include "tuning.h"

/* Sums over a cell, as vectors.  Lanes 0 to 2 of normal: of the normals, each as long as the
 * area of its piece, so that lane 2 is the area seen along the frame's z.  Lanes 2 and 3 of
 * level: that area times the height, and times the gap. */
typedef float lane4 __attribute__((vector_size(16)));
typedef int32_t whole4 __attribute__((vector_size(16)));
typedef double wide4 __attribute__((vector_size(32)));

struct sums {
    lane4 normal, level;
};

/* One surface's triangles, with the gap at their corners. */
struct side {
    const struct surface *surface;
    const double *gap;  /* [nv] measure_gaps() */
    const float *trust; /* [nv] likewise */
    bool above;         /* the surface is the probe: the template lies gap below it */
    float share;        /* what its area counts */
};

/* The template's points under the side's vertices, in the frame, and the gap there: x, y, z,
 * gap, mm. */
static void place(const struct side *side, const struct align_pose *frame, lane4 *at)
{
    const double *r = frame->r, *t = frame->t, mm = 1.0 / LATTICE_PER_MM;
    const wide4 x = {mm * r[0], mm * r[3], mm * r[6], 0};
    const wide4 y = {mm * r[1], mm * r[4], mm * r[7], 0};
    const wide4 z = {mm * r[2], mm * r[5], mm * r[8], 0};
    const wide4 origin = {t[0], t[1], t[2], 0}, up = {0, 0, 0, mm};
    const struct mesh *m = &side->surface->mesh;
    const double below = side->above ? 1 : 0;

    for (uint32_t v = 0; v < m->nv; v++) {
        const double gap = side->gap[v];
        const wide4 q = origin + m->xy[v].x * x + m->xy[v].y * y +
                        (m->z[v] - below * gap) * z + gap * up;

        at[v] = __builtin_convertvector(q, lane4);
    }
}

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

static inline void add_piece(struct sums *sums, lane4 q, bool used, lane4 normal,
                             lane4 level)
{
    const uint32_t i = used ? cell_of(q) : GRID_N;

    sums[i].normal += normal;
    sums[i].level += level * q;
}

/* at: place().  Returns twice the area, in square lattice units, of the triangles that do not
 * bridge but have no gap at a corner: whole numbers below 2^52, exact. */
static double add_side(const struct side *side, const struct align_pose *frame,
                       const lane4 *at, struct sums *sums)
{
    const float ux = (float)frame->r[2], uy = (float)frame->r[5], uz = (float)frame->r[8];
    const struct mesh *m = &side->surface->mesh;
    double missed = 0;

    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        lane4 a, b, c, sum, n, level;
        float length, twice, half, area;
        bool used;

        if (side->surface->bridge[t])
            continue;
        a = at[v[0]];
        b = at[v[1]];
        c = at[v[2]];
        sum = a + b + c;
        if (!(fabsf(sum[3]) < INFINITY)) {
            missed += (double)orient2d(m->xy[v[0]], m->xy[v[1]], m->xy[v[2]]);
            continue;
        }
        n = cross(b - a, c - a); /* twice as long as the area */
        length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        used = n[2] > (float)CELLS_STEEP * length;
        twice = n[0] * ux + n[1] * uy + n[2] * uz; /* seen along the scanner's z */
        half = side->share * (1.0f / 6) *
               (side->trust[v[0]] + side->trust[v[1]] + side->trust[v[2]]);
        area = half * n[2];
        level = (lane4){0, 0, area, area * twice / length};
        n *= half;
        if (twice < (float)(2 * CELLS_SMALL_MM2)) {
            add_piece(sums, sum * (1.0f / 3), used, n, level);
        } else { /* at three points */
            n *= 1.0f / 3;
            level *= 1.0f / 3;
            sum *= 1.0f / 6;
            add_piece(sums, sum + 0.5f * a, used, n, level);
            add_piece(sums, sum + 0.5f * b, used, n, level);
            add_piece(sums, sum + 0.5f * c, used, n, level);
        }
    }
    return missed;
}

/* From sums to means. */
static void means(const struct sums *sums, struct cells *c)
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

enum status cells_measure(const struct surface *tmpl, struct measure_work *w,
                          const struct align_pose *frame, struct cells *out,
                          double *overlap)
{
    const struct surface *probe = &w->moved;
    const uint32_t na = tmpl->mesh.nv, nb = probe->mesh.nv;
    double ha, hb, share, missed;
    struct sums *sums;
    lane4 *at;

    *overlap = 0;
    memset(out, 0, sizeof *out);
    if (nb == 0)
        return ST_OK;
    sums = scratch_need(&w->scratch,
                        (GRID_N + 1) * sizeof *sums + (na > nb ? na : nb) * sizeof *at);
    if (sums == NULL)
        return ST_ENOMEM;
    at = &sums[GRID_N + 1].normal;
    memset(sums, 0, (GRID_N + 1) * sizeof *sums);
    ha = tmpl->measured / na; /* the spacing's square */
    hb = probe->measured / nb;
    share = hb / (ha + hb);
    for (int i = 0; i < 2; i++) {
        const struct side side = {i == 0 ? tmpl : probe,
                                  i == 0 ? w->tmpl_gap : w->moved_gap,
                                  i == 0 ? w->tmpl_trust : w->moved_trust, i == 1,
                                  (float)(i == 0 ? 1 - share : share)};

        place(&side, frame, at);
        missed = add_side(&side, frame, at, sums);
        if (i == 0 && tmpl->measured > 0)
            *overlap = (tmpl->measured - 0.5 * missed) / tmpl->measured;
    }
    means(sums, out);
    return ST_OK;
}

void cells_sample(struct align_field *field, struct align_point *pts, uint32_t n,
                  const struct align_pose *pose, const struct align_pose *frame,
                  struct cells *out)
{
    const double *r = frame->r, *t = frame->t;
    const lane4 x = {(float)r[0], (float)r[3], (float)r[6], 0};
    const lane4 y = {(float)r[1], (float)r[4], (float)r[7], 0};
    const lane4 z = {(float)r[2], (float)r[5], (float)r[8], 0};
    const lane4 origin = {(float)t[0], (float)t[1], (float)t[2], 0};
    const float mm = (float)(1 / LATTICE_PER_MM);
    uint32_t last = field->first; /* neighbours follow each other: a short way */
    struct sums sums[GRID_N + 1];

    memset(sums, 0, sizeof sums);
    for (uint32_t i = 0; i < n; i++) {
        const struct dvec3 q = align_pose_apply(pose, pts[i].p);
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
