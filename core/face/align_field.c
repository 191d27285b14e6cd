#include "align_field.h"

#include <math.h>
#include <string.h>

#include "align_lanes.h"
#include "grid.h"
#include "lattice.h"
#include "mesh.h"
#include "surface.h"

/* Steps that a walk of the search is allowed, and the steps a triangle that all of them may
 * take beyond that: time, not results.  On scans a walk takes two or three; what needs more
 * than both is no face, and the search ends apart. */
#define ALIGN_WALK 8
#define ALIGN_WORK 40

void align_field_make(const struct surface *s, const struct align_weight *u,
                      struct align_field *f)
{
    *f = (struct align_field){s, u, 0, (int64_t)ALIGN_WORK * s->mesh.nt};
    while (mesh_is_ghost(&s->mesh, f->first))
        f->first++;
}

/* walk(m, t, q, left, out): whether q (x, y) lies in the hull of m: walk to the triangle that
 * contains it, from triangle *t.  *t becomes the last triangle seen.  *left falls by the steps
 * taken; below 0 the walk ends. */
static inline bool align_field_walk(const struct mesh *m, uint32_t *t, const double q[3],
                                    int64_t *left, struct align_corners *out)
{
    const int32_t x = (int32_t)lrint(q[0]), y = (int32_t)lrint(q[1]);

    for (; *left >= 0; --*left) {
        const uint32_t *v = &m->org[3 * *t], *twin = &m->twin[3 * *t];
        const struct ivec2 a = m->xy[v[0]], b = m->xy[v[1]], c = m->xy[v[2]];
        const int64_t x0 = a.x - x, x1 = b.x - x, x2 = c.x - x;
        const int64_t y0 = a.y - y, y1 = b.y - y, y2 = c.y - y;
        uint32_t next;

        if (x0 * y1 < y0 * x1) {
            next = twin[0] / 3;
        } else if (x1 * y2 < y1 * x2) {
            next = twin[1] / 3;
        } else if (x2 * y0 < y2 * x0) {
            next = twin[2] / 3;
        } else {
            *out = (struct align_corners){
                {{(float)x0, (float)y0, (float)(m->z[v[0]] - q[2])},
                 {(float)x1, (float)y1, (float)(m->z[v[1]] - q[2])},
                 {(float)x2, (float)y2, (float)(m->z[v[2]] - q[2])}}};
            return true;
        }
        if (mesh_is_ghost(m, next))
            break;
        *t = next;
    }
    return false;
}

static inline bool align_field_locate(struct align_field *f, struct align_point *p,
                                      struct dvec3 q, struct align_corners *out)
{
    const double at[3] = {q.x * LATTICE_PER_MM, q.y * LATTICE_PER_MM,
                          q.z * LATTICE_PER_MM};

    f->left += ALIGN_WALK;
    return fabs(at[0]) < LATTICE_MAX && fabs(at[1]) < LATTICE_MAX &&
           align_field_walk(&f->surface->mesh, &p->triangle, at, &f->left, out) &&
           !f->surface->bridge[p->triangle];
}

bool align_field_find(struct align_field *f, struct align_point *p, struct dvec3 q,
                      struct align_corners *out)
{
    return align_field_locate(f, p, q, out);
}

/* ALIGN_LANES points to be added. */
struct batch {
    struct align_corners corners[ALIGN_LANES];
    float q[ALIGN_LANES][3]; /* from the centre of rotations, mm */
    uint32_t n;
};

static inline align_lanes align_field_corner(const struct batch *b, int k, int axis)
{
    const struct align_corners *c = b->corners;

    return (align_lanes){c[0].at[k][axis], c[1].at[k][axis], c[2].at[k][axis],
                         c[3].at[k][axis]};
}

static inline align_lanes align_field_place(const struct batch *b, int axis)
{
    return (align_lanes){b->q[0][axis], b->q[1][axis], b->q[2][axis], b->q[3][axis]};
}

/* The weights of the points; r: from the centre of rotations, which is at c, to the frame. */
static inline align_lanes weights(const struct align_weight *w, struct dvec3 c,
                                  const struct align_under *s)
{
    const struct dvec3 t = pose_apply(&w->frame, c);
    const double *r = w->frame.r;
    const align_lanes x =
        s->x * (float)r[0] + s->y * (float)r[1] + s->z * (float)r[2] + (float)t.x;
    const align_lanes y =
        s->x * (float)r[3] + s->y * (float)r[4] + s->z * (float)r[5] + (float)t.y;
    align_lanes u = {0};

    for (int i = 0; i < ALIGN_LANES; i++) {
        const uint32_t cell = grid_cell((double)x[i], (double)y[i]);

        u[i] = cell == GRID_NONE ? 0.0f : w->u[cell];
    }
    return u;
}

static inline void add_batch(struct batch *b, const struct align_weight *u,
                             struct dvec3 c, enum solve_loss loss,
                             struct align_lanes_sums *sums)
{
    static const align_masks index = {0, 1, 2, 3};
    struct align_under s;
    align_lanes a[3], e[3], f[3], n[3], over;

    for (int i = 0; i < 3; i++) {
        a[i] = align_field_corner(b, 0, i);
        e[i] = align_field_corner(b, 1, i) - a[i];
        f[i] = align_field_corner(b, 2, i) - a[i];
    }
    n[0] = e[1] * f[2] - e[2] * f[1];
    n[1] = e[2] * f[0] - e[0] * f[2];
    n[2] = e[0] * f[1] - e[1] * f[0];
    over = 1.0f / align_lanes_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        s.normal[i] = n[i] * over;
    s.gap = (a[0] * s.normal[0] + a[1] * s.normal[1] + a[2] * s.normal[2]) *
            (float)(-1 / LATTICE_PER_MM);
    s.there = index < (int32_t)b->n;
    s.x = align_field_place(b, 0);
    s.y = align_field_place(b, 1);
    s.z = align_field_place(b, 2);
    s.weight =
        u != NULL && loss == SOLVE_LOSS_TUKEY ? weights(u, c, &s) : align_lanes_all(1.0f);
    align_lanes_add(sums, &s, loss);
    b->n = 0;
}

void align_field_sum(struct align_field *f, struct align_point *pts, uint32_t n,
                     uint32_t stride, const struct pose *pose, struct dvec3 c,
                     enum solve_loss loss, struct solve_sum *sum)
{
    uint32_t last = f->first, total = 0;
    struct align_lanes_sums sums = {0};
    struct batch batch;

    batch.n = 0;
    for (uint32_t i = 0; i < ALIGN_LANES;
         i++) /* in places that stay empty: any triangle */
        batch.corners[i] = (struct align_corners){{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    memset(batch.q, 0, sizeof batch.q);
    for (uint32_t i = 0; i < n; i += stride, total++) {
        struct align_point *p = &pts[i];
        const struct dvec3 q = pose_apply(pose, p->p);
        float *at = batch.q[batch.n];
        bool found;

        if (p->triangle == ALIGN_FIELD_NONE)
            p->triangle = last;
        at[0] = (float)(q.x - c.x);
        at[1] = (float)(q.y - c.y);
        at[2] = (float)(q.z - c.z);
        found = align_field_locate(f, p, q, &batch.corners[batch.n]);
        last = p->triangle;
        batch.n += found;
        if (batch.n == ALIGN_LANES)
            add_batch(&batch, f->u, c, loss, &sums);
    }
    add_batch(&batch, f->u, c, loss, &sums);
    align_lanes_finish(&sums, total, loss, sum);
}
