#include "cells.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "align_field.h"
#include "disparity.h"
#include "lattice.h"
#include "measure.h"
#include "mesh.h"
#include "tuning.h"

/* A piece of the template's surface, in its frame, with the gap over it. */
struct piece {
    struct dvec3 normal;
    double gap;  /* along the normal, mm */
    double area; /* mm^2, of the surface itself: whichever side it was scanned from */
};

/* flat: the normal's share of the scanner's z; zx, zy: slopes of the template there. */
static inline struct dvec3 normal_of(const struct align_pose *frame, double zx, double zy,
                                     double flat)
{
    const double *r = frame->r;

    return (struct dvec3){(r[2] - r[0] * zx - r[1] * zy) * flat,
                          (r[5] - r[3] * zx - r[4] * zy) * flat,
                          (r[8] - r[6] * zx - r[7] * zy) * flat};
}

/* p: where the piece is, in the template's coordinates, mm. */
static inline void add(struct cells *c, const struct align_pose *frame, struct dvec3 p,
                       const struct piece *s)
{
    const struct dvec3 q = align_pose_apply(frame, p);
    const uint32_t i = grid_cell(q.x, q.y);
    double area;

    if (i == GRID_NONE || s->normal.z < CELLS_STEEP)
        return;
    area = s->area * s->normal.z; /* seen along the frame's z */
    c->area[i] += (float)area;
    c->gap[i] += (float)(area * s->gap);
    c->z[i] += (float)(area * q.z);
    c->normal[i][0] += (float)(area * s->normal.x);
    c->normal[i][1] += (float)(area * s->normal.y);
    c->normal[i][2] += (float)(area * s->normal.z);
}

/* From sums to means. */
static void finish(struct cells *c)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float scale = c->area[i] > 0.0f ? 1.0f / c->area[i] : 0.0f;

        c->gap[i] *= scale;
        c->z[i] *= scale;
        for (int k = 0; k < 3; k++)
            c->normal[i][k] *= scale;
    }
}

/* One surface's triangles, with the gap at their corners. */
struct side {
    const struct surface *surface;
    const double *gap; /* [nv] measure_gaps() */
    bool above;        /* the surface is the probe: the template lies gap below it */
};

/* Where a triangle is sampled: by its size, so that no cell under it is passed over. */
static const double samples[7][3] = {{1. / 3, 1. / 3, 1. / 3}, /* small */
                                     {4. / 6, 1. / 6, 1. / 6},
                                     {1. / 6, 4. / 6, 1. / 6},
                                     {1. / 6, 1. / 6, 4. / 6}};

static void add_side(const struct side *side, const struct align_pose *frame,
                     struct cells *out)
{
    const double mm = 1.0 / LATTICE_PER_MM;
    const struct mesh *m = &side->surface->mesh;

    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        double gap[3], x[3], y[3], z[3], ax, ay, az, bx, by, bz, twice, over, zx, zy,
            flat;
        struct piece s;
        int first, last;

        if (side->surface->bridge[t] || mesh_is_ghost(m, t))
            continue;
        for (int i = 0; i < 3; i++) {
            gap[i] = side->gap[v[i]];
            x[i] = mm * m->xy[v[i]].x;
            y[i] = mm * m->xy[v[i]].y;
            z[i] = mm * (m->z[v[i]] - (side->above ? gap[i] : 0));
        }
        if (!(fabs(gap[0] + gap[1] + gap[2]) < (double)INFINITY))
            continue;
        ax = x[1] - x[0];
        ay = y[1] - y[0];
        az = z[1] - z[0];
        bx = x[2] - x[0];
        by = y[2] - y[0];
        bz = z[2] - z[0];
        twice = ax * by - ay * bx;
        over = 1.0 / twice;
        zx = (az * by - bz * ay) * over;
        zy = (bz * ax - az * bx) * over;
        flat = 1.0 / sqrt(1.0 + zx * zx + zy * zy);
        s.normal = normal_of(frame, zx, zy, flat);
        first = twice < 2 * CELLS_SMALL_MM2 ? 0 : 1;
        last = twice < 2 * CELLS_SMALL_MM2 ? 0 : 3;
        s.area = 0.5 * twice / (flat * (last - first + 1));
        for (int k = first; k <= last; k++) {
            const double *b = samples[k];

            s.gap = mm * flat * (b[0] * gap[0] + b[1] * gap[1] + b[2] * gap[2]);
            add(out, frame,
                (struct dvec3){b[0] * x[0] + b[1] * x[1] + b[2] * x[2],
                               b[0] * y[0] + b[1] * y[1] + b[2] * y[2],
                               b[0] * z[0] + b[1] * z[1] + b[2] * z[2]},
                &s);
        }
    }
    finish(out);
}

/* The mean of a and b: b counts share_b, each cell as far as it is covered. */
static void blend(const struct cells *a, const struct cells *b, double share_b,
                  struct cells *out)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float areas = a->area[i] * (float)(1 - share_b),
                    areab = b->area[i] * (float)share_b;
        const float area = areas + areab, wa = area > 0.0f ? areas / area : 0.0f;
        const float wb = area > 0.0f ? areab / area : 0.0f;

        out->area[i] = area;
        out->gap[i] = wa * a->gap[i] + wb * b->gap[i];
        out->z[i] = wa * a->z[i] + wb * b->z[i];
        for (int k = 0; k < 3; k++)
            out->normal[i][k] = wa * a->normal[i][k] + wb * b->normal[i][k];
    }
}

void cells_measure(const struct surface *tmpl, const struct measure_work *w,
                   const struct align_pose *frame, struct cells *out)
{
    const struct side sides[2] = {
        {tmpl, w->tmpl_gap, false},
        {&w->moved, w->moved_gap, true},
    };
    struct cells at_tmpl, at_probe;
    double ha, hb;

    memset(out, 0, sizeof *out);
    if (w->moved.mesh.nv == 0)
        return;
    memset(&at_tmpl, 0, sizeof at_tmpl);
    memset(&at_probe, 0, sizeof at_probe);
    add_side(&sides[0], frame, &at_tmpl);
    add_side(&sides[1], frame, &at_probe);
    ha = tmpl->measured / tmpl->mesh.nv; /* the spacing's square */
    hb = w->moved.measured / w->moved.mesh.nv;
    blend(&at_tmpl, &at_probe, hb * hb / (ha * ha + hb * hb), out);
}

void cells_sample(const struct align_field *field, struct align_point *pts, uint32_t n,
                  const struct align_pose *pose, const struct align_pose *frame,
                  struct cells *out)
{
    uint32_t last = field->first; /* neighbours follow each other: a short way */

    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < n; i++) {
        const struct dvec3 q = align_pose_apply(pose, pts[i].p);
        const struct align_triangle *c;
        struct piece s;
        double rise;

        if (pts[i].triangle == ALIGN_FIELD_NONE)
            pts[i].triangle = last;
        c = align_field_find(field, &pts[i], q);
        last = pts[i].triangle;
        if (c == NULL || c->flat == 0.0f || pts[i].area <= 0.0f)
            continue;
        rise = q.z - align_field_height(c, q.x, q.y);
        s.normal = normal_of(frame, (double)c->zx, (double)c->zy, (double)c->flat);
        s.gap = rise * (double)c->flat;
        s.area = (double)pts[i].area;
        add(out, frame, (struct dvec3){q.x, q.y, q.z - rise}, &s);
    }
    finish(out);
}
