/* align_field.h -- the template as a height field, and the robust sum of the gaps between it
 * and points of the probe.
 * Each triangle of the template becomes a record of one cache line: plane, corners and
 * neighbours.  A moved point is rounded to the lattice and located by a visibility walk from
 * the triangle where it was before.  The walk is exact, so on a Delaunay triangulation it
 * ends. */
#ifndef CORE_ALIGN_FIELD_H
#define CORE_ALIGN_FIELD_H
#include <stddef.h>
#include <stdint.h>
#include "align_pose.h"
#include "align_solve.h"
#include "lattice.h"
#include "vec.h"

struct surface; /* surface.h */

/* The weight u(x, y) of places on the template. */
struct align_weight {
    const float *u;          /* [GRID_N] by cells of the canonical frame (grid.h) */
    struct align_pose frame; /* template -> canonical frame */
};

struct align_triangle {
    int32_t x[3], y[3]; /* corners, counter-clockwise, lattice units */
    uint32_t next[3];   /* across the edge from corner i to i + 1; or ALIGN_FIELD_NONE */
    float z0, zx, zy;   /* height at corner 0 (mm) and slopes */
    float flat;         /* 1 / sqrt(1 + zx^2 + zy^2); 0 where the triangle bridges missing
                           points: no gap is measured there */
    float weight;       /* u at the centroid */
    uint32_t spare[2];
};

#define ALIGN_FIELD_NONE UINT32_MAX

struct align_field {
    struct align_triangle *triangle;
    uint32_t n;     /* triangles of the template, ghosts included (never walked into) */
    uint32_t first; /* a triangle to start from */
};

/* align_field_bytes(nt): memory for a template of nt triangles. */
size_t align_field_bytes(uint32_t nt);

/* align_field_make(s, u, triangles, f): the field of s.
 * u          NULL: a weight of 1 everywhere; else 0 off the grid
 * triangles  align_field_bytes(s->mesh.nt) of memory, which f refers to
 * O(nt). */
void align_field_make(const struct surface *s, const struct align_weight *u,
                      struct align_triangle *triangles, struct align_field *f);

/* A point of the probe. */
struct align_point {
    struct dvec3 p;    /* mm */
    float area;        /* of the probe's surface that it stands for, mm^2 */
    uint32_t triangle; /* where it was last time, or ALIGN_FIELD_NONE */
};

enum align_loss {
    ALIGN_LOSS_L1,   /* |r|, r the gap at right angles to the template's triangle */
    ALIGN_LOSS_TUKEY /* u times Tukey's biweight of r at ALIGN_TUKEY_MM */
};

struct align_sum {
    struct align_normal normal;
    double cost;   /* mm.  L1: mean of |r|, capped; a point without a gap costs
                      ALIGN_NO_GAP_MM.  Tukey: weighted mean of the loss over the points
                      that have a gap */
    double within; /* share of the points that have a gap, 0..1 */
};

/* align_field_find(f, p, q): the triangle under q (mm), to which p has moved; NULL outside
 * the template's hull.  Starts at p->triangle, which must not be ALIGN_FIELD_NONE, and
 * leaves the last triangle of the walk there. */
const struct align_triangle *align_field_find(const struct align_field *f,
                                              struct align_point *p, struct dvec3 q);

/* align_field_height(c, x, y): the height of triangle c's plane, mm. */
static inline double align_field_height(const struct align_triangle *c, double x,
                                        double y)
{
    return (double)c->z0 + (double)c->zx * (x - c->x[0] / LATTICE_PER_MM) +
           (double)c->zy * (y - c->y[0] / LATTICE_PER_MM);
}

/* align_field_sum(f, pts, n, stride, pose, c, loss, sum): over the points 0, stride, 2
 * stride, ... below n, moved by pose; updates where each one is.  Rotations in the normal
 * equations are about c (template, mm). */
void align_field_sum(const struct align_field *f, struct align_point *pts, uint32_t n,
                     uint32_t stride, const struct align_pose *pose, struct dvec3 c,
                     enum align_loss loss, struct align_sum *sum);

#endif
