#include "fuse.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "encode.h"
#include "face.h"
#include "face_work.h"
#include "heatmap.h"
#include "heights.h"
#include "holes.h"
#include "lattice.h"
#include "locate.h"
#include "measure.h"
#include "mem.h"
#include "model.h"
#include "pose.h"
#include "quality.h"
#include "select.h"
#include "solve.h"

/* Two frames with fewer cells in common, a quarter of a face, are not registered. */
#define FUSE_CELLS 230

/* Registration: looks at the heights, and reweightings at each; Huber's limit, about twice the noise
 * of a cell of a depth camera. */
#define FUSE_LOOKS    2
#define FUSE_PASSES   4
#define FUSE_HUBER_MM 1.5

/* Averaging: Huber's limit about the median, and the distance beyond which a height is of
 * something else. */
#define FUSE_NEAR_MM 2.0
#define FUSE_FAR_MM  8.0

/* mm: the residual of a frame counts as no less: what is left of the best is not noise. */
#define FUSE_RESIDUAL_MM 0.2

/* The noise of the mean of some frames is taken at every n-th vertex of the base: less than 2 % of the
 * time that a frame takes. */
#define FUSE_NOISE_STRIDE 8

/* The gaps of the cells that both have, and what they depend on. */
struct fuse_gaps {
    uint32_t n;
    float gap[GRID_N]; /* mm, at right angles to the mean face */
    uint32_t cell[GRID_N];
};

double fuse_worth(const struct surface_face *f, const struct surface_work *w)
{
    const struct surface_model *m = w->model;
    const double noise = m->noise_factor * (double)f->encoding.residual_mm;

    return f->encoding.cells / (m->noise_floor_mm * m->noise_floor_mm + noise * noise);
}

enum status fuse_cells(const struct surface_face *f, struct surface_work *w,
                       float z[GRID_N])
{
    return heights_of(&f->surface, &f->frame.pose, &w->measure.scratch, z);
}

static void take_gaps(const struct encode_basis *e, const float *base, const float *frame,
                      struct fuse_gaps *out)
{
    out->n = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float gap = (frame[i] - base[i]) * e->normal_z[i];

        if (!(e->normal_z[i] > 0.0f) || isnan(gap))
            continue;
        out->gap[out->n] = gap;
        out->cell[out->n++] = i;
    }
}

/* The motion of the frame that explains most of the gaps. */
static void solve(const struct encode_basis *e, const struct fuse_gaps *g, double x[6])
{
    memset(x, 0, 6 * sizeof *x);
    for (int pass = 0; pass < FUSE_PASSES; pass++) {
        struct solve_normal sum = {{0}, {0}};

        for (uint32_t k = 0; k < g->n; k++) {
            const float *row = e->motion[g->cell[k]];
            double j[6], left = (double)g->gap[k];

            for (int i = 0; i < 6; i++) {
                j[i] = (double)row[i];
                left += j[i] * x[i];
            }
            solve_add(&sum, j, (double)g->gap[k],
                      fmin(1, FUSE_HUBER_MM / fmax(fabs(left), 1e-9)));
        }
        if (!solve_equations(&sum, SOLVE_DAMPING, x))
            return;
    }
    for (int i = 0; i < 6; i++)
        x[i] *= i < 3 ? ENCODE_MOTION_MM / POSE_LEVER_MM : ENCODE_MOTION_MM;
}

static double median_gap(const struct fuse_gaps *g)
{
    double size[GRID_N];

    for (uint32_t k = 0; k < g->n; k++)
        size[k] = fabs((double)g->gap[k]);
    return g->n >= FUSE_CELLS ? select_kth(size, g->n, g->n / 2) : (double)INFINITY;
}

/* The frame's canonical frame, at the size of the base's. */
static struct pose start_of(const struct surface_face *base, const struct surface_face *f)
{
    const double *r = base->frame.pose.r;
    const struct pose rigid = pose_unscaled(&f->frame.pose);

    return pose_scale(&rigid, sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
}

enum status fuse_register(const struct surface_face *base, const float z[GRID_N],
                          const struct surface_face *f, struct surface_work *w,
                          struct fuse_place *out, float own[GRID_N])
{
    const struct encode_basis *e = &w->encode;
    const struct dvec3 centre = {0, 0, -POSE_LEVER_MM};
    const struct pose onto = pose_unscaled(&base->frame.pose);
    struct pose move = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    struct pose pose = start_of(base, f), there;
    struct heights h;
    struct fuse_gaps g;
    double x[6];
    const enum status st = heights_take(&f->surface, &pose, &w->measure.scratch, &h);

    if (st != ST_OK)
        return st;
    for (int look = 0; look < FUSE_LOOKS; look++) {
        heights_at(&h, &move, own);
        take_gaps(e, z, own, &g);
        if (g.n < FUSE_CELLS)
            break;
        solve(e, &g, x);
        pose_move(&move, centre, x);
        pose_move(&pose, centre, x);
    }
    heights_at(&h, &move, own);
    take_gaps(e, z, own, &g);
    out->gap_mm = median_gap(&g);
    there = pose_unscaled(&pose);
    there = pose_after(&onto, &there);
    pose_to_matrix(&there, out->transform);
    return ST_OK;
}

/* above[v]: how far `other`, seen from above, lies above vertex v of `own`, mm; NAN where it has not
 * measured anything. */
static enum status above_vertices(const struct surface *own, const struct surface *other,
                                  struct measure_work *m, float *above)
{
    const struct mesh *a = &own->mesh, *b = &other->mesh;
    struct location *at = scratch_need(&m->arrays, a->nv * sizeof *at);
    const enum status st = at != NULL ? locate_mesh(b, a, at) : ST_ENOMEM;

    for (uint32_t v = 0; v < a->nv; v++)
        above[v] =
            st == ST_OK && at[v].where != LOCATE_OUTSIDE &&
                    holes_measured(b, other->bridge, at[v])
                ? (float)((locate_height(b, at[v], a->xy[v]) - a->z[v]) / LATTICE_PER_MM)
                : (float)NAN;
    return st;
}

/* The robust mean of the heights at vertex v above the base's, with its own: above[0], which is
 * 0. */
static double mean_at(const float *above, const double *weight, uint32_t n, uint32_t nv,
                      uint32_t v)
{
    double sorted[SURFACE_FRAMES_MAX];
    float middle;
    double sum = 0, all = 0;
    uint32_t k = 0;

    for (uint32_t i = 0; i < n; i++)
        if (!isnan(above[(size_t)i * nv + v]))
            sorted[k++] = (double)above[(size_t)i * nv + v];
    select_sort(sorted, k);
    middle = (float)((sorted[(k - 1) / 2] + sorted[k / 2]) / 2);
    for (uint32_t i = 0; i < n; i++) {
        const float one = above[(size_t)i * nv + v];
        const double far = fabs((double)(one - middle));

        if (far <= FUSE_FAR_MM) { /* NAN is not */
            const double by = weight[i] * fmin(1, FUSE_NEAR_MM / fmax(far, 1e-9));

            sum += by * (double)one;
            all += by;
        }
    }
    return all > 0 ? sum / all : 0;
}

static double weight_of(const struct surface_face *f)
{
    const double left = fmax((double)f->encoding.residual_mm, FUSE_RESIDUAL_MM);

    return 1 / (left * left);
}

/* One fusion. */
struct fusing {
    const struct surface_face *base;
    const struct surface_face *const *f; /* [n] */
    const struct fuse_place *at;         /* [n] */
    uint32_t n;
    struct measure_work *m;
    double weight[SURFACE_FRAMES_MAX]; /* the base's first */
    struct dvec3 *pts;                 /* the base's points, then those of the others that
                                          are not over what the base has measured */
    size_t end[SURFACE_FRAMES_MAX];    /* in pts, of the base's, and of each other's */
    float *above;                      /* [n + 1] of each of so many points */
};

/* Lays frame i over the base: how far it lies above the base's points, and its own points where the
 * base has not measured anything. */
static enum status lay(struct fusing *g, uint32_t i, float *above, float *base_above)
{
    const struct mesh *b = &g->base->surface.mesh;
    struct measure_work *m = g->m;
    const struct mesh *own = &m->moved.mesh;
    enum status st = surface_move(&g->f[i]->surface, g->at[i].transform, &m->points,
                                  &m->scratch, &m->moved);

    g->end[i + 1] = g->end[i];
    if (st != ST_OK) { /* seen edge-on: it has nothing to say */
        for (uint32_t v = 0; v < b->nv; v++)
            above[v] = (float)NAN;
        return st == ST_ENOMEM ? st : ST_OK;
    }
    st = above_vertices(&g->base->surface, &m->moved, m, above);
    if (st == ST_OK)
        st = above_vertices(&m->moved, &g->base->surface, m, base_above);
    for (uint32_t v = 0; st == ST_OK && v < own->nv; v++)
        if (isnan(base_above[v]))
            g->pts[g->end[i + 1]++] = lattice_to_mm(own->xy[v], own->z[v]);
    return st;
}

/* The noise at the base's points, of the base, and of the mean with each frame more, which is that of
 * mean_at() but for the middle, here the mean so far: so that each frame costs the same. */
static enum status noise_of(const struct fusing *g, double noise_mm[])
{
    struct mesh mean = g->base->surface.mesh;
    const int32_t *own = mean.z;
    float *so_far = mem_array(mean.nv, sizeof *so_far);
    float *all = mem_array(mean.nv, sizeof *all);
    enum status st = ST_OK;

    mean.z = mem_array(mean.nv, sizeof *mean.z);
    if (so_far == NULL || all == NULL || mean.z == NULL)
        st = ST_ENOMEM;
    for (uint32_t v = 0; st == ST_OK && v < mean.nv; v++)
        so_far[v] = all[v] = 0.0f;
    for (uint32_t i = 0; st == ST_OK && i <= g->n; i++) {
        const float *above = g->above + (size_t)i * mean.nv;

        for (uint32_t v = 0; v < mean.nv; v++) {
            const float far = above[v] - so_far[v];

            if (fabsf(far) <= (float)FUSE_FAR_MM) { /* NAN is not */
                const float by =
                    (float)g->weight[i] *
                    fminf(1.0f, (float)FUSE_NEAR_MM / fmaxf(fabsf(far), 1e-9f));

                all[v] += by;
                so_far[v] += by / all[v] * far;
            }
            mean.z[v] = own[v] + (int32_t)lrint((double)so_far[v] * LATTICE_PER_MM);
        }
        st = quality_noise(&mean, FUSE_NOISE_STRIDE, &g->m->arrays, &noise_mm[i]);
    }
    mem_free(so_far);
    mem_free(all);
    mem_free(mean.z);
    return st;
}

/* The base's points. */
static enum status fuse_base(struct fusing *g)
{
    const struct mesh *b = &g->base->surface.mesh;
    float *const last = g->above + (size_t)(g->n + 1) * b->nv;
    enum status st = ST_OK;

    for (uint32_t v = 0; v < b->nv; v++) {
        g->pts[v] = lattice_to_mm(b->xy[v], b->z[v]);
        g->above[v] = 0.0f;
    }
    g->end[0] = b->nv;
    for (uint32_t i = 0; st == ST_OK && i < g->n; i++)
        st = lay(g, i, g->above + (size_t)(i + 1) * b->nv, last);
    for (uint32_t v = 0; st == ST_OK && v < b->nv; v++)
        g->pts[v].z += mean_at(g->above, g->weight, g->n + 1, b->nv, v);
    return st;
}

/* How far frame i lies above n points in the base's frame, mm.  (Along its own z, which differs
 * from the base's by a few degrees.) */
static enum status above_points(struct fusing *g, uint32_t i, const struct dvec3 *pts,
                                size_t n, float *above)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    double *gap = scratch_need(&g->m->arrays, n * sizeof *gap), back[16];
    struct pose there;
    enum status st = ST_ENOMEM;

    pose_from_matrix(g->at[i].transform, &there);
    there = pose_after(&there, &still);
    pose_to_matrix(&there, back);
    if (gap != NULL)
        st = heatmap_gaps(&g->f[i]->surface, pts, n, back, gap);
    for (size_t k = 0; st == ST_OK && k < n; k++)
        above[k] = (float)-gap[k];
    return st;
}

/* The height of point p of frame i, one of n, over it: by its own frame and those behind it.  False: a
 * frame before it has measured there, too. */
static bool fuse_one(const struct fusing *g, uint32_t i, size_t p, size_t n, double *over)
{
    float later[SURFACE_FRAMES_MAX] = {0.0f}; /* the first: its own */

    for (uint32_t k = 0; k < i; k++)
        if (!isnan(g->above[k * n + p]))
            return false;
    for (uint32_t k = i + 1; k < g->n; k++)
        later[k - i] = g->above[k * n + p];
    *over = mean_at(later, g->weight + 1 + i, g->n - i, 1, 0);
    return true;
}

/* The points of the others where no frame before has measured anything, behind the base's: *npts in
 * all. */
static enum status fuse_others(struct fusing *g, size_t *npts)
{
    const struct dvec3 *pts = g->pts + g->end[0];
    const size_t n = g->end[g->n] - g->end[0];
    enum status st = ST_OK;
    double over;

    *npts = g->end[0];
    mem_free(g->above);
    if ((g->above = mem_array(g->n * n, sizeof *g->above)) == NULL)
        return ST_ENOMEM;
    for (uint32_t k = 0; st == ST_OK && n > 0 && k < g->n; k++)
        st = above_points(g, k, pts, n, g->above + k * n);
    for (uint32_t i = 0; st == ST_OK && i < g->n; i++)
        for (size_t p = g->end[i] - g->end[0]; p < g->end[i + 1] - g->end[0]; p++)
            if (fuse_one(g, i, p, n, &over)) {
                struct dvec3 one = pts[p]; /* it does not move backwards */

                one.z += over;
                g->pts[(*npts)++] = one;
            }
    return st;
}

enum status fuse_points(const struct surface_face *base, uint32_t n,
                        const struct surface_face *const f[],
                        const struct fuse_place at[], struct surface_work *w,
                        struct dvec3 **out, size_t *npts, double noise_mm[])
{
    struct fusing g = {.base = base, .f = f, .at = at, .n = n, .m = &w->measure};
    size_t most = base->surface.mesh.nv, room = most;
    enum status st = ST_ENOMEM;

    g.weight[0] = weight_of(base);
    for (uint32_t i = 0; i < n; i++) {
        const size_t nv = f[i]->surface.mesh.nv;

        g.weight[i + 1] = weight_of(f[i]);
        room += nv;
        most = nv > most ? nv : most;
    }
    g.pts = mem_array(room, sizeof *g.pts);
    g.above = mem_array((n + 2) * most, sizeof *g.above);
    if (g.pts != NULL && g.above != NULL)
        st = fuse_base(&g);
    if (st == ST_OK)
        st = noise_of(&g, noise_mm);
    if (st == ST_OK)
        st = fuse_others(&g, npts);
    mem_free(g.above);
    if (st != ST_OK) {
        mem_free(g.pts);
        g.pts = NULL;
    }
    *out = g.pts;
    return st;
}
