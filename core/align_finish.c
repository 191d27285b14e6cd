/* align_finish() of align.h: downhill on the exact measure.
 * At a pose that measure_at() has measured, every other vertex of either surface that lies
 * over a measured triangle of the other is a sample of the gap, worth the area round it.  To
 * first order a small motion changes the gap by the slope of the surface under the vertex;
 * the sum of |gap| over the samples, so linearised, is minimised by reweighted least
 * squares, and the exact measure is taken at the pose this leads to.  The lower one stays. */
#include "align.h"

#include <math.h>
#include <string.h>

#include "align_pose.h"
#include "align_solve.h"
#include "lattice.h"
#include "measure.h"

#define PASSES   2    /* reweightings of one linearised measure */
#define SAMPLES  3000 /* about so many vertices, or every other, are samples */
#define SOFT_MM  0.03 /* |gap| is rounded off below this */
#define DAMPING  1e-4
#define WORTH    5e-3   /* a promised gain below this share, or below WORTH_MM, is not */
#define WORTH_MM 1.5e-3 /* worth measuring */
#define LEVER_MM 80.0   /* centre of turns behind the surface, as in the search */

struct sample {
    double j[6], gap, weight;
};

/* areas(m, bridge, area): a third of the measured triangles round each vertex, mm^2. */
static void areas(const struct mesh *m, const uint8_t *bridge, float *area)
{
    memset(area, 0, m->nv * sizeof *area);
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        double ax, ay, bx, by;

        if (bridge[t])
            continue;
        ax = (m->xy[v[1]].x - m->xy[v[0]].x) / LATTICE_PER_MM;
        ay = (m->xy[v[1]].y - m->xy[v[0]].y) / LATTICE_PER_MM;
        bx = (m->xy[v[2]].x - m->xy[v[0]].x) / LATTICE_PER_MM;
        by = (m->xy[v[2]].y - m->xy[v[0]].y) / LATTICE_PER_MM;
        for (int i = 0; i < 3; i++)
            area[v[i]] += (float)((ax * by - ay * bx) / 6.0);
    }
}

/* slopes(m, t, zx, zy): of the plane of triangle t. */
static void slopes(const struct mesh *m, uint32_t t, double *zx, double *zy)
{
    const uint32_t *v = &m->org[3 * t];
    const double ax = m->xy[v[1]].x - m->xy[v[0]].x, ay = m->xy[v[1]].y - m->xy[v[0]].y;
    const double bx = m->xy[v[2]].x - m->xy[v[0]].x, by = m->xy[v[2]].y - m->xy[v[0]].y;
    const double az = m->z[v[1]] - m->z[v[0]], bz = m->z[v[2]] - m->z[v[0]];
    const double d = 1.0 / (ax * by - ay * bx);

    *zx = (az * by - bz * ay) * d;
    *zy = (bz * ax - az * bx) * d;
}

/* One side's vertices, and the other surface that they lie over. */
struct view {
    const struct mesh *mesh, *other;
    const uint8_t *other_bridge;
    const struct location *loc;
    const double *height; /* of the other surface */
    double sign;          /* of own height minus the other's in moved minus template */
};

/* gather(view, stride, area, u, c, out): the samples at every stride-th vertex;
 * returns how many. */
static size_t gather(const struct view *view, uint32_t stride, const float *area,
                     const struct disparity_weight *u, struct dvec3 c, struct sample *out)
{
    const struct mesh *m = view->mesh;
    size_t n = 0;

    for (uint32_t v = 0; v < m->nv; v += stride) {
        const struct location loc = view->loc[v];
        struct sample *s = &out[n];
        double zx, zy, x, y, z;

        if (area[v] <= 0.0f || loc.where == LOCATE_OUTSIDE ||
            view->other_bridge[loc.he / 3])
            continue;
        slopes(view->other, loc.he / 3, &zx, &zy);
        x = m->xy[v].x / LATTICE_PER_MM - c.x;
        y = m->xy[v].y / LATTICE_PER_MM - c.y;
        z = m->z[v] / LATTICE_PER_MM - c.z;
        s->gap = view->sign * (m->z[v] - view->height[v]) / LATTICE_PER_MM;
        s->weight = (double)area[v];
        if (u != NULL)
            s->weight *= u->at(u->arg, m->xy[v].x, m->xy[v].y);
        s->j[0] = y + z * zy;
        s->j[1] = -z * zx - x;
        s->j[2] = y * zx - x * zy;
        s->j[3] = -zx;
        s->j[4] = -zy;
        s->j[5] = 1.0;
        n++;
    }
    return n;
}

static double gap_after(const struct sample *s, const double x[6])
{
    return s->gap + s->j[0] * x[0] + s->j[1] * x[1] + s->j[2] * x[2] + s->j[3] * x[3] +
           s->j[4] * x[4] + s->j[5] * x[5];
}

/* minimise(s, n, x): the motion that makes the linearised sum of weighted |gap| least.
 * Returns the share of the sum that it promises to save. */
static double minimise(const struct sample *s, size_t n, double x[6])
{
    double first = 0.0, best = INFINITY, now[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};

    for (int pass = 0; pass <= PASSES; pass++) {
        struct align_normal normal;
        double sum = 0.0, dx[6];

        memset(&normal, 0, sizeof normal);
        for (size_t i = 0; i < n; i++) {
            const double g = gap_after(&s[i], now), a = fabs(g);

            align_solve_add(&normal, s[i].j, g,
                            s[i].weight / (a > SOFT_MM ? a : SOFT_MM));
            sum += s[i].weight * a;
        }
        if (pass == 0)
            first = sum;
        if (sum < best) {
            best = sum;
            memcpy(x, now, sizeof now);
        }
        if (!align_solve(&normal, DAMPING, dx))
            break;
        for (int i = 0; i < 6; i++)
            now[i] += dx[i];
    }
    return first > 0.0 ? 1.0 - best / first : 0.0;
}

/* promise(tmpl, u, w, c, x): at the pose last measured in w, the best small motion about
 * c.  Returns the share it promises to save, or a negative number when out of memory. */
static double promise(const struct measure_surface *tmpl,
                      const struct disparity_weight *u, struct measure_work *w,
                      struct dvec3 c, double x[6])
{
    const struct mesh *a = tmpl->mesh, *b = &w->moved;
    const struct view views[2] = {
        {b, a, tmpl->bridge, w->moved_in_tmpl, w->moved_other, 1.0},
        {a, b, w->bridge, w->tmpl_in_moved, w->tmpl_other, -1.0},
    };
    const uint32_t all = a->nv + b->nv, stride = all > 3 * SAMPLES ? all / SAMPLES : 2;
    const size_t most = all / stride + 2;
    const size_t head = mem_round((a->nv > b->nv ? a->nv : b->nv) * sizeof(float));
    unsigned char *block = scratch_need(&w->scratch, head + most * sizeof(struct sample));
    struct sample *s;
    size_t n = 0;

    if (block == NULL)
        return -1.0;
    s = (struct sample *)(void *)(block + head);
    for (int i = 0; i < 2; i++) {
        areas(views[i].mesh, i == 0 ? w->bridge : tmpl->bridge, (float *)(void *)block);
        n += gather(&views[i], stride, (const float *)(void *)block, u, c, s + n);
    }
    return minimise(s, n, x);
}

enum status align_finish(const struct measure_surface *tmpl,
                         const struct measure_surface *probe,
                         const struct disparity_weight *u, struct measure_work *w,
                         struct align_result *io, struct disparity *out)
{
    struct align_pose pose;
    struct dvec3 centre;
    enum status st = measure_at(tmpl, probe, io->transform, u, w, out);

    io->exact = 1;
    if (st != ST_OK || io->stop == ALIGN_APART || out->cells == 0)
        return st;
    io->stop = ALIGN_STEPS;
    centre = align_pose_centre(tmpl->mesh);
    centre.z -= LEVER_MM;
    align_pose_from_matrix(io->transform, &pose);
    while (io->exact < ALIGN_MAX_EXACT) {
        double x[6], gain = promise(tmpl, u, w, centre, x), matrix[16];
        struct disparity next;

        if (gain < 0.0)
            return ST_ENOMEM;
        if (gain < WORTH || gain * out->weighted_mm < WORTH_MM) {
            io->stop = ALIGN_CONVERGED;
            break;
        }
        align_pose_move(&pose, centre, x);
        align_pose_to_matrix(&pose, matrix);
        if ((st = measure_at(tmpl, probe, matrix, u, w, &next)) != ST_OK)
            return st;
        io->exact++;
        /* a lower mean over a smaller common area would be won by sliding apart */
        if (next.weighted_mm >= out->weighted_mm || next.overlap < 0.98 * out->overlap) {
            io->stop = ALIGN_CONVERGED;
            break;
        }
        *out = next;
        memcpy(io->transform, matrix, sizeof matrix);
    }
    return ST_OK;
}
