#include "align_field.h"

#include <math.h>
#include <string.h>

#include "grid.h"
#include "lattice.h"
#include "mesh.h"
#include "surface.h"
#include "tuning.h"

_Static_assert(sizeof(struct align_triangle) == 64, "a triangle is a cache line");

size_t align_field_bytes(uint32_t nt)
{
    return nt * sizeof(struct align_triangle);
}

/* plane(c, z): the slopes through the corners' heights z (lattice units). */
static void plane(struct align_triangle *c, const int32_t z[3])
{
    const double ax = c->x[1] - c->x[0], ay = c->y[1] - c->y[0];
    const double bx = c->x[2] - c->x[0], by = c->y[2] - c->y[0];
    const double az = z[1] - z[0], bz = z[2] - z[0];
    const double d = 1.0 / (ax * by - ay * bx);
    const double zx = (az * by - bz * ay) * d, zy = (bz * ax - az * bx) * d;

    c->z0 = (float)(z[0] / LATTICE_PER_MM);
    c->zx = (float)zx;
    c->zy = (float)zy;
    c->flat = (float)(1.0 / sqrt(1.0 + zx * zx + zy * zy));
}

static float weight_at(const struct align_weight *u, const struct align_triangle *c,
                       const int32_t z[3])
{
    const double third = 1.0 / (3 * LATTICE_PER_MM);
    const struct dvec3 q =
        align_pose_apply(&u->frame, (struct dvec3){(c->x[0] + c->x[1] + c->x[2]) * third,
                                                   (c->y[0] + c->y[1] + c->y[2]) * third,
                                                   (z[0] + z[1] + z[2]) * third});
    const uint32_t i = grid_cell(q.x, q.y);

    return i == GRID_NONE ? 0.0f : u->u[i];
}

void align_field_make(const struct surface *s, const struct align_weight *u,
                      struct align_triangle *triangles, struct align_field *f)
{
    const struct mesh *m = &s->mesh;

    f->triangle = triangles;
    f->n = m->nt;
    f->first = ALIGN_FIELD_NONE;
    for (uint32_t t = 0; t < m->nt; t++) {
        struct align_triangle *c = &triangles[t];
        int32_t z[3];

        if (mesh_is_ghost(m, t))
            continue;
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t h = 3 * t + i, v = m->org[h], across = m->twin[h] / 3;

            c->x[i] = m->xy[v].x;
            c->y[i] = m->xy[v].y;
            z[i] = m->z[v];
            c->next[i] = mesh_is_ghost(m, across) ? ALIGN_FIELD_NONE : across;
        }
        plane(c, z);
        c->weight = u == NULL ? 1.0f : weight_at(u, c, z);
        if (s->bridge[t])
            c->flat = 0.0f;
        f->first = t;
    }
}

/* walk(f, t, x, y): the triangle that contains (x, y), from triangle t; NULL when it lies
 * outside the hull.  *at becomes the last triangle seen.  The step limit matters only for
 * a template that is not a Delaunay triangulation. */
static const struct align_triangle *walk(const struct align_field *f, uint32_t *at,
                                         int64_t x, int64_t y)
{
    uint32_t t = *at;

    for (uint32_t steps = 0; steps < f->n; steps++) {
        const struct align_triangle *c = &f->triangle[t];
        const int64_t x0 = c->x[0] - x, x1 = c->x[1] - x, x2 = c->x[2] - x;
        const int64_t y0 = c->y[0] - y, y1 = c->y[1] - y, y2 = c->y[2] - y;
        uint32_t next;

        if (x0 * y1 < y0 * x1)
            next = c->next[0];
        else if (x1 * y2 < y1 * x2)
            next = c->next[1];
        else if (x2 * y0 < y2 * x0)
            next = c->next[2];
        else {
            *at = t;
            return c;
        }
        if (next == ALIGN_FIELD_NONE)
            break;
        t = next;
    }
    *at = t;
    return NULL;
}

/* What one residual adds to the sum: its weight in the normal equations, its cost, and the
 * share by which the cost is divided. */
struct pull {
    double weight, cost, share;
};

static struct pull pull_of(enum align_loss loss, double r, double u)
{
    const double a = fabs(r), soft = a > ALIGN_SOFT_MM ? a : ALIGN_SOFT_MM;
    double v, s;

    if (loss == ALIGN_LOSS_L1)
        return (struct pull){1.0 / soft, a < ALIGN_CAP_MM ? a : ALIGN_CAP_MM, 1.0};
    v = a / ALIGN_TUKEY_MM;
    s = v < 1.0 ? 1.0 - v * v : 0.0;
    return (struct pull){u * s * s, u * ALIGN_TUKEY_MM * (1.0 - s * s * s), u};
}

const struct align_triangle *align_field_find(const struct align_field *f,
                                              struct align_point *p, struct dvec3 q)
{
    const double limit = LATTICE_MAX / LATTICE_PER_MM;

    if (!(fabs(q.x) < limit && fabs(q.y) < limit))
        return NULL;
    return walk(f, &p->triangle, llrint(q.x * LATTICE_PER_MM),
                llrint(q.y * LATTICE_PER_MM));
}

void align_field_sum(const struct align_field *f, struct align_point *pts, uint32_t n,
                     uint32_t stride, const struct align_pose *pose, struct dvec3 c,
                     enum align_loss loss, struct align_sum *sum)
{
    uint32_t last = f->first, total = 0, within = 0;
    double share = 0.0;

    memset(sum, 0, sizeof *sum);
    for (uint32_t i = 0; i < n; i += stride, total++) {
        const struct dvec3 q = align_pose_apply(pose, pts[i].p);
        const struct align_triangle *triangle;
        struct pull pull;
        double r, flat, j[6];

        if (pts[i].triangle == ALIGN_FIELD_NONE)
            pts[i].triangle = last;
        triangle = align_field_find(f, &pts[i], q);
        last = pts[i].triangle;
        if (triangle == NULL || triangle->flat == 0.0f)
            continue;
        within++;
        flat = (double)triangle->flat;
        r = (q.z - align_field_height(triangle, q.x, q.y)) * flat;
        j[3] = -(double)triangle->zx * flat;
        j[4] = -(double)triangle->zy * flat;
        j[5] = flat;
        j[0] = (q.y - c.y) * j[5] - (q.z - c.z) * j[4];
        j[1] = (q.z - c.z) * j[3] - (q.x - c.x) * j[5];
        j[2] = (q.x - c.x) * j[4] - (q.y - c.y) * j[3];
        pull = pull_of(loss, r, (double)triangle->weight);
        align_solve_add(&sum->normal, j, r, pull.weight);
        sum->cost += pull.cost;
        share += pull.share;
    }
    if (total > 0)
        sum->within = (double)within / total;
    if (loss == ALIGN_LOSS_L1) {
        sum->cost += ALIGN_NO_GAP_MM * (total - within);
        share = total;
    }
    sum->cost = share > 0.0 ? sum->cost / share : INFINITY;
}
