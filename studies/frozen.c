#include "frozen.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "disparity.h"
#include "face.h"
#include "field.h"
#include "lab.h"
#include "lattice.h"
#include "measure.h"

#define DIM  DESCENT_DIM
#define CUTS 2

struct corner {
    double y[3]; /* at P0, from the centre */
    bool of_probe;
};

struct cell {
    uint32_t v[3];
    double share; /* of the area */
};

struct frozen {
    struct field *tmpl, *probe;
    struct dvec3 centre;
    size_t corners, cells;
    struct corner *corner;
    struct cell *cell;
    double *gap, *weight[CUTS]; /* [corners]; weight[0]: by the signs at P0 */
    double hessian[DIM][DIM];   /* of F at P0, about: where a box is lowest */
};

/* ---- motions */

/* A corner's position from the centre is r (y - before) + after.  One for the probe's corners,
 * one, the inverse, for the template's.  The derivatives of r are for turns counted as
 * lengths. */
struct motion {
    double r[3][3], before[3], after[3];
    double first[3][3][3], second[3][3][3][3];
};

static void turn_matrix(const int order[3], const double x[DIM], double scale,
                        double r[3][3], double inverse[3][3])
{
    descent_turn(order, x, r);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            r[i][j] *= scale;
            inverse[j][i] = r[i][j];
        }
}

static void motion_of(const double x[DIM], struct motion *probe, struct motion *tmpl)
{
    const double per = 1 / DESCENT_LEVER;
    int order[3] = {0, 0, 0};

    turn_matrix(order, x, 1, probe->r, tmpl->r);
    for (int k = 0; k < 3; k++) {
        probe->before[k] = tmpl->after[k] = 0;
        probe->after[k] = tmpl->before[k] = x[3 + k];
        order[k]++;
        turn_matrix(order, x, per, probe->first[k], tmpl->first[k]);
        for (int l = 0; l < 3; l++) {
            order[l]++;
            turn_matrix(order, x, per * per, probe->second[k][l], tmpl->second[k][l]);
            order[l]--;
        }
        order[k]--;
    }
}

/* y from where the motion turns it. */
static void lever(const struct motion *m, const double y[3], double d[3])
{
    for (int i = 0; i < 3; i++)
        d[i] = y[i] - m->before[i];
}

static void apply(const double r[3][3], const double d[3], double v[3])
{
    for (int i = 0; i < 3; i++)
        v[i] = r[i][0] * d[0] + r[i][1] * d[1] + r[i][2] * d[2];
}

/* Where a corner with that lever lies. */
static struct dvec3 place(const struct frozen *f, const struct motion *m,
                          const double d[3])
{
    double v[3];

    apply(m->r, d, v);
    return (struct dvec3){v[0] + m->after[0] + f->centre.x,
                          v[1] + m->after[1] + f->centre.y,
                          v[2] + m->after[2] + f->centre.z};
}

/* ---- values */

/* The gap of a corner at a pose. */
static double gap_at(const struct frozen *f, const struct corner *c,
                     const struct motion *probe, const struct motion *tmpl)
{
    const struct motion *const m = c->of_probe ? probe : tmpl;
    struct dvec3 p;
    double d[3], off;

    lever(m, c->y, d);
    p = place(f, m, d);
    off = p.z - field_at(c->of_probe ? f->tmpl : f->probe, p.x, p.y);
    return c->of_probe ? off : -off;
}

static void gaps_at(struct frozen *f, const double x[DIM])
{
    struct motion probe, tmpl;

    motion_of(x, &probe, &tmpl);
    for (size_t i = 0; i < f->corners; i++)
        f->gap[i] = gap_at(f, &f->corner[i], &probe, &tmpl);
}

/* weight[v] = the integral of the sign of the gap times the corner's own linear function,
 * over all cells: the sum of weight times gap is F at the gaps given. */
static void weigh(const struct frozen *f, double *weight)
{
    memset(weight, 0, f->corners * sizeof *weight);
    for (size_t i = 0; i < f->cells; i++) {
        const uint32_t *const v = f->cell[i].v;
        const double g[3] = {f->gap[v[0]], f->gap[v[1]], f->gap[v[2]]};
        const int above = (g[0] > 0) + (g[1] > 0) + (g[2] > 0);
        const int below = (g[0] < 0) + (g[1] < 0) + (g[2] < 0);
        int lone = 0, b, c;
        double sign, s, t;

        if (above == 0 || below == 0) {
            for (int k = 0; k < 3; k++)
                weight[v[k]] += (below > 0 ? -1 : 1) * f->cell[i].share / 3;
            continue;
        }
        /* The line of zeros cuts off the tip at the corner that is alone on its side. */
        sign = above == 1 ? 1 : -1;
        while (!(sign * g[lone] > 0))
            lone++;
        b = (lone + 1) % 3;
        c = (lone + 2) % 3;
        s = g[lone] / (g[lone] - g[b]);
        t = g[lone] / (g[lone] - g[c]);
        sign *= f->cell[i].share / 3;
        weight[v[lone]] += sign * (2 * s * t * (3 - s - t) - 1);
        weight[v[b]] += sign * (2 * s * t * s - 1);
        weight[v[c]] += sign * (2 * s * t * t - 1);
    }
}

double frozen_value(struct frozen *f, const double x[DIM])
{
    double sum = 0;

    gaps_at(f, x);
    for (size_t i = 0; i < f->cells; i++) {
        const uint32_t *const v = f->cell[i].v;

        sum +=
            disparity_prism(f->cell[i].share, f->gap[v[0]], f->gap[v[1]], f->gap[v[2]]);
    }
    return sum;
}

/* ---- the bound */

/* The pose of the box where F, taken for quadratic about P0, is least: where to take signs. */
static void lowest(const struct frozen *f, struct frozen_box *box)
{
    double *const x = box->low;

    for (int k = 0; k < DIM; k++)
        x[k] = fmax(box->c[k] - box->h[k], fmin(box->c[k] + box->h[k], 0));
    for (int sweep = 0; sweep < 30; sweep++)
        for (int k = 0; k < DIM; k++) {
            double pull = 0;

            for (int j = 0; j < DIM; j++)
                pull += j != k ? f->hessian[k][j] * x[j] : 0;
            x[k] = fmax(box->c[k] - box->h[k],
                        fmin(box->c[k] + box->h[k], -pull / f->hessian[k][k]));
        }
}

/* F >= least + g d + d q d for every way d from the middle of the box; q: of turns with turns
 * and with shifts, q[k][l] for both orders of two turns. */
struct minorant {
    double least, g[DIM], q[3][DIM];
};

static double over_box(const struct minorant *a, const struct minorant *b, double share,
                       const double h[DIM])
{
    const double rest = 1 - share;
    double sum = share * a->least + rest * b->least;

    for (int k = 0; k < DIM; k++)
        sum -= fabs(share * a->g[k] + rest * b->g[k]) * h[k];
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < DIM; l++) {
            const double q = share * a->q[k][l] + rest * b->q[k][l];

            sum -= (k == l ? fmax(0, -q) : fabs(q)) * h[k] * h[l];
        }
    return sum;
}

/* The best mixture of two, by ternary search of a concave function. */
static double best_share(const struct minorant *a, const struct minorant *b,
                         const double h[DIM])
{
    double lo = 0, hi = 1;

    for (int i = 0; i < 30; i++) {
        const double p = lo + (hi - lo) / 3, q = hi - (hi - lo) / 3;

        if (over_box(a, b, p, h) < over_box(a, b, q, h))
            lo = p;
        else
            hi = q;
    }
    return (lo + hi) / 2;
}

/* Sums over the corners of one surface, for a weight: of the gap's bound where the box has its
 * middle; of w n and of w n d', n the normal (-sx, -sy, 1) of the plane, d the lever. */
struct sums {
    double least, normal[3], moment[3][3];
};

/* How far corners move over a box, and what the box loses to each coordinate. */
struct reach {
    const double *h;
    double turn, shift; /* of a turn (radians, the three added), of a shift (mm) */
    double lost[DIM];
};

static bool add_corner(const struct frozen *f, size_t i, const struct motion *m,
                       struct reach *r, struct sums sum[CUTS])
{
    const struct corner *const c = &f->corner[i];
    double d[3], by[DIM], far[2] = {0, 0}, arm, second, third, half, off;
    struct field_plane p;
    struct dvec3 at;

    lever(m, c->y, d);
    at = place(f, m, d);
    arm = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    second = r->turn * r->turn / 2 * arm + (c->of_probe ? 0 : r->turn * r->shift);
    third = r->turn * r->turn * (r->turn / 6 * arm + (c->of_probe ? 0 : r->shift / 2));
    for (int k = 0; k < DIM; k++) {
        by[k] = 0;
        for (int j = 0; j < 2; j++) {
            const double *const t = k < 3 ? m->first[k][j] : NULL;
            const double move = k < 3         ? t[0] * d[0] + t[1] * d[1] + t[2] * d[2]
                                : c->of_probe ? j == k - 3
                                              : m->r[j][k - 3];

            far[j] += fabs(move) * r->h[k];
            by[k] += fabs(move) * r->h[k];
        }
    }
    if (!field_enclose(c->of_probe ? f->tmpl : f->probe, at.x, at.y,
                       fmax(far[0], far[1]) + second, &p))
        return false;
    half = (p.hi - p.lo) / 2 + third * sqrt(1 + p.sx * p.sx + p.sy * p.sy);
    off = at.z - p.sx * (at.x - p.x) - p.sy * (at.y - p.y) - (p.lo + p.hi) / 2;
    for (int n = 0; n < CUTS; n++) {
        const double w = c->of_probe ? f->weight[n][i] : -f->weight[n][i];
        const double normal[3] = {-w * p.sx, -w * p.sy, w};

        sum[n].least += w * off - fabs(w) * half;
        for (int j = 0; j < 3; j++) {
            sum[n].normal[j] += normal[j];
            for (int k = 0; k < 3; k++)
                sum[n].moment[j][k] += normal[j] * d[k];
        }
    }
    half *= fabs(f->weight[CUTS - 1][i]) / (far[0] + far[1]);
    for (int k = 0; k < DIM; k++)
        r->lost[k] += half * by[k];
    return true;
}

static double product(const double a[3][3], const double b[3][3])
{
    double sum = 0;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            sum += a[i][j] * b[i][j];
    return sum;
}

/* The minorant of both surfaces' sums. */
static struct minorant minorant_of(const struct motion *probe, const struct sums *p,
                                   const struct motion *tmpl, const struct sums *t)
{
    struct minorant a = {.least = p->least + t->least};

    for (int k = 0; k < 3; k++) {
        a.g[k] = product(probe->first[k], p->moment) + product(tmpl->first[k], t->moment);
        a.g[3 + k] = p->normal[k];
        for (int i = 0; i < 3; i++)
            a.g[3 + k] -= tmpl->r[i][k] * t->normal[i];
        for (int l = 0; l < 3; l++) {
            a.q[k][l] = (product(probe->second[k][l], p->moment) +
                         product(tmpl->second[k][l], t->moment)) /
                        2;
            for (int i = 0; i < 3; i++)
                a.q[k][3 + l] -= tmpl->first[k][i][l] * t->normal[i];
        }
    }
    return a;
}

static struct reach reach_of(const double h[DIM])
{
    return (struct reach){h,
                          (h[0] + h[1] + h[2]) / DESCENT_LEVER,
                          sqrt(h[3] * h[3] + h[4] * h[4] + h[5] * h[5]),
                          {0}};
}

void frozen_bound(struct frozen *f, struct frozen_box *box)
{
    const double *const h = box->h;
    struct reach r = reach_of(h);
    struct sums of_probe[CUTS] = {{0}}, of_tmpl[CUTS] = {{0}};
    struct minorant a[CUTS];
    struct motion probe, tmpl;
    double share, most = -1;
    bool told = true;

    lowest(f, box);
    gaps_at(f, box->low);
    weigh(f, f->weight[1]);
    motion_of(box->c, &probe, &tmpl);
    for (size_t i = 0; i < f->corners && told; i++)
        told = f->corner[i].of_probe ? add_corner(f, i, &probe, &r, of_probe)
                                     : add_corner(f, i, &tmpl, &r, of_tmpl);
    for (int n = 0; n < CUTS; n++)
        a[n] = minorant_of(&probe, &of_probe[n], &tmpl, &of_tmpl[n]);
    share = best_share(&a[0], &a[1], h);
    box->least = told ? fmax(0, over_box(&a[0], &a[1], share, h)) : 0;
    for (int k = 0; k < DIM; k++) {
        const double slope = fabs(share * a[0].g[k] + (1 - share) * a[1].g[k]);
        const double loss = told ? slope * h[k] + r.lost[k] : h[k];

        if (loss > most) {
            most = loss;
            box->widest = k;
        }
    }
}

/* ---- a check of single corners */

static double minorant_at(const struct minorant *a, const double d[DIM])
{
    double sum = a->least;

    for (int k = 0; k < DIM; k++)
        sum += a->g[k] * d[k];
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < DIM; l++)
            sum += a->q[k][l] * d[k] * d[l];
    return sum;
}

size_t frozen_outside(struct frozen *f, const struct frozen_box *box, const double x[DIM])
{
    double d[DIM], *const was = f->weight[0],
                          *const one = lab_alloc(f->corners, sizeof *one);
    struct reach r = reach_of(box->h);
    struct motion probe, tmpl;
    size_t outside = 0;

    for (int k = 0; k < DIM; k++)
        d[k] = x[k] - box->c[k];
    motion_of(box->c, &probe, &tmpl);
    gaps_at(f, x);
    f->weight[0] = one;
    for (size_t i = 0; i < f->corners; i++)
        for (int sign = -1; sign <= 1; sign += 2) { /* the gap, and less the gap */
            struct sums of_probe[CUTS] = {{0}}, of_tmpl[CUTS] = {{0}};
            struct minorant a;
            double least;

            one[i] = sign;
            if (!(f->corner[i].of_probe ? add_corner(f, i, &probe, &r, of_probe)
                                        : add_corner(f, i, &tmpl, &r, of_tmpl)))
                continue;
            a = minorant_of(&probe, of_probe, &tmpl, of_tmpl);
            least = minorant_at(&a, d);
            outside += least > sign * f->gap[i] + 1e-9 ||
                       least < over_box(&a, &a, 1, box->h) - 1e-9;
            one[i] = 0;
        }
    f->weight[0] = was;
    free(one);
    return outside;
}

/* ---- from a measure */

/* For lowest(): sum of J J' / (|gap| + s) over the corners, J the derivative of the gap. */
static void curvature(struct frozen *f)
{
    static const double zero[DIM];
    double *const area = lab_alloc(f->corners, sizeof *area), mean = 0;
    struct motion probe, tmpl;

    for (size_t i = 0; i < f->cells; i++)
        for (int k = 0; k < 3; k++)
            area[f->cell[i].v[k]] += f->cell[i].share / 3;
    motion_of(zero, &probe, &tmpl);
    for (size_t i = 0; i < f->corners; i++)
        mean += area[i] * fabs(f->gap[i]);
    for (size_t i = 0; i < f->corners; i++) {
        const struct corner *const c = &f->corner[i];
        const struct motion *const t = c->of_probe ? &probe : &tmpl;
        double g[DIM], v[3];
        struct field_plane p;

        if (!field_enclose(c->of_probe ? f->tmpl : f->probe, c->y[0] + f->centre.x,
                           c->y[1] + f->centre.y, 1, &p))
            continue;
        for (int k = 0; k < 3; k++) {
            apply(t->first[k], c->y, v);
            g[k] = v[2] - p.sx * v[0] - p.sy * v[1];
        }
        g[3] = c->of_probe ? -p.sx : p.sx;
        g[4] = c->of_probe ? -p.sy : p.sy;
        g[5] = c->of_probe ? 1 : -1;
        for (int k = 0; k < DIM; k++)
            for (int l = 0; l < DIM; l++)
                f->hessian[k][l] +=
                    area[i] * g[k] * g[l] / (fabs(f->gap[i]) + 0.3 * mean);
    }
    free(area);
}

static void take_cells(struct frozen *f, const struct face *tmpl,
                       const struct measure_work *m)
{
    const struct mesh *const g = &m->general;
    uint32_t *const number = lab_alloc(g->nv, sizeof *number);
    double all = 0, twice;

    for (uint32_t h = 0; h < 3 * g->nt; h += 3) {
        struct cell *const c = &f->cell[f->cells];

        if (mesh_is_ghost(g, h / 3) ||
            disparity_kind(g, m->vertex, h, &twice) != DISPARITY_COMMON)
            continue;
        for (int k = 0; k < 3; k++) {
            const uint32_t v = g->org[h + (uint32_t)k];

            if (number[v] == 0) { /* a corner's number and one */
                const struct dvec3 p = lattice_to_mm(g->xy[v], g->z[v]);

                f->corner[f->corners++] =
                    (struct corner){{p.x, p.y, p.z}, v >= tmpl->surface.mesh.nv};
                number[v] = (uint32_t)f->corners;
            }
            c->v[k] = number[v] - 1;
        }
        c->share = twice;
        all += twice;
        f->cells++;
    }
    for (size_t i = 0; i < f->cells; i++)
        f->cell[i].share /= all;
    free(number);
}

struct frozen *frozen_new(const struct face *tmpl, const struct measure_work *m)
{
    static const double zero[DIM];
    struct frozen *f = lab_alloc(1, sizeof *f);

    f->corner = lab_alloc(m->general.nv, sizeof *f->corner);
    f->cell = lab_alloc(m->general.nt, sizeof *f->cell);
    take_cells(f, tmpl, m);
    for (size_t i = 0; i < f->corners; i++) {
        const double *const y = f->corner[i].y;
        const double n = (double)f->corners;

        f->centre = vec_along(f->centre, 1 / n, (struct dvec3){y[0], y[1], y[2]});
    }
    for (size_t i = 0; i < f->corners; i++) {
        double *const y = f->corner[i].y;

        y[0] -= f->centre.x;
        y[1] -= f->centre.y;
        y[2] -= f->centre.z;
    }
    f->tmpl = field_new(&tmpl->surface.mesh);
    f->probe = field_new(&m->moved.mesh);
    f->gap = lab_alloc(f->corners, sizeof *f->gap);
    for (int n = 0; n < CUTS; n++)
        f->weight[n] = lab_alloc(f->corners, sizeof *f->weight[n]);
    gaps_at(f, zero);
    weigh(f, f->weight[0]);
    curvature(f);
    return f;
}

void frozen_free(struct frozen *f)
{
    if (f == NULL)
        return;
    field_free(f->tmpl);
    field_free(f->probe);
    free(f->corner);
    free(f->cell);
    free(f->gap);
    for (int n = 0; n < CUTS; n++)
        free(f->weight[n]);
    free(f);
}

struct dvec3 frozen_centre(const struct frozen *f)
{
    return f->centre;
}
