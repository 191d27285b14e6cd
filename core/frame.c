#include "frame.h"

#include <math.h>
#include <string.h>

#include "align_solve.h"
#include "lattice.h"
#include "mem.h"
#include "model.h"
#include "model_digest.h"
#include "tuning.h"

/* Where a face keeps its shape from one scan to the next: 1 / variance of the gap. */
static void rigidity(const struct model_basis *b, float *out)
{
    float most = 0.0f;

    for (uint32_t i = 0; i < GRID_N; i++) {
        float v = b->rest[i] * b->rest[i];

        for (uint32_t k = 0; k < b->n; k++)
            v += b->mode[i][k] * b->mode[i][k];
        out[i] = b->rest[i] > 0.0f ? 1.0f / v : 0.0f;
        most = out[i] > most ? out[i] : most;
    }
    for (uint32_t i = 0; i < GRID_N && most > 0.0f; i++)
        out[i] /= most;
}

/* Identity: the mean face is in the canonical frame. */
static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/* What a search needs of the mean face, once for all searches. */
static enum status prepare(struct frame_mean *mean)
{
    const struct align_weight u = {mean->rigid, still};
    struct align_triangle *triangles =
        mem_array(align_field_bytes(mean->surface.mesh.nt), 1);

    if (triangles == NULL)
        return ST_ENOMEM;
    align_field_make(&mean->surface, &u, triangles, &mean->field);
    align_pose_axes(&mean->surface, &mean->axes);
    return ST_OK;
}

enum status frame_mean_make(const struct model *m, struct scratch *s,
                            struct frame_mean *out)
{
    struct ivec3 pts[GRID_N];
    size_t n = 0;
    enum status st;

    memset(out, 0, sizeof *out);
    out->mean_id = model_mean_id(m);
    rigidity(&m->motion, out->rigid);
    memcpy(out->height, m->mean, sizeof out->height);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(m->mean[i]))
            continue;
        pts[n++] = (struct ivec3){(int32_t)(grid_x(i) * LATTICE_PER_MM),
                                  (int32_t)(grid_y(i) * LATTICE_PER_MM),
                                  (int32_t)lrint((double)m->mean[i] * LATTICE_PER_MM)};
    }
    if (n < 3)
        return ST_EDEGENERATE;
    if ((st = surface_prepare(pts, n, false, s, &out->surface)) != ST_OK ||
        (st = prepare(out)) != ST_OK)
        frame_mean_free(out);
    return st;
}

void frame_mean_free(struct frame_mean *mean)
{
    surface_free(&mean->surface);
    mem_free(mean->field.triangle);
    memset(mean, 0, sizeof *mean);
}

enum status frame_find(const struct frame_mean *mean, const struct surface *face,
                       struct align_work *w, struct frame *out)
{
    const struct align_weight u = {mean->rigid, still};
    const struct align_how how = {.u = &u, .field = &mean->field, .axes = &mean->axes};
    struct align_result found;
    const enum status st = align_search(&mean->surface, face, &how, w, &found);

    if (st != ST_OK)
        return st;
    align_pose_from_matrix(found.transform, &out->pose);
    out->mean_id = mean->mean_id;
    out->cost_mm = found.cost_mm;
    out->within = found.within;
    out->likeness = frame_likeness(mean, face, &out->pose);
    return ST_OK;
}

/* The terms of a quadric at a cell, of order 1 wherever the grid is. */
static void quadric(uint32_t cell, double j[6])
{
    const double x = grid_x(cell) / (GRID_NX * GRID_MM / 2);
    const double y = (grid_y(cell) - GRID_BOTTOM) / (GRID_NY * GRID_MM / 2) - 1;

    j[0] = 1;
    j[1] = x;
    j[2] = y;
    j[3] = x * x;
    j[4] = x * y;
    j[5] = y * y;
}

/* The mean height of the face's points in each cell; 0 and n[i] = 0 where there are none.
 * By points, not by area: cheap, and enough for a likeness. */
static void mean_heights(const struct surface *face, const struct align_pose *pose,
                         double z[GRID_N], uint32_t n[GRID_N])
{
    const struct mesh *m = &face->mesh;

    memset(z, 0, GRID_N * sizeof *z);
    memset(n, 0, GRID_N * sizeof *n);
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 q = align_pose_apply(pose, lattice_to_mm(m->xy[v], m->z[v]));
        const uint32_t i = grid_cell(q.x, q.y);

        if (i == GRID_NONE)
            continue;
        z[i] += q.z;
        n[i]++;
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] /= n[i] != 0 ? n[i] : 1;
}

double frame_likeness(const struct frame_mean *mean, const struct surface *face,
                      const struct align_pose *pose)
{
    struct align_normal a = {0}, b = {0}; /* of the face, and of the mean face */
    double z[GRID_N], x[6], y[6], j[6], aa = 0, ab = 0, bb = 0;
    uint32_t n[GRID_N], common = 0;

    mean_heights(face, pose, z, n);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const double h = (double)mean->height[i];

        if (n[i] == 0 || isnan(h))
            continue;
        quadric(i, j);
        align_solve_add(&a, j, z[i], 1);
        for (int k = 0; k < 6; k++)
            b.g[k] += j[k] * h;
        aa += z[i] * z[i];
        ab += z[i] * h;
        bb += h * h;
        common++;
    }
    memcpy(b.h, a.h, sizeof b.h);
    if (common < FRAME_LIKENESS_CELLS || !align_solve(&a, 0, x) || !align_solve(&b, 0, y))
        return (double)NAN;
    /* x = -H^-1 g gives the products of the reliefs without another pass over the cells. */
    for (int k = 0; k < 6; k++) {
        aa += a.g[k] * x[k];
        ab += a.g[k] * y[k];
        bb += b.g[k] * y[k];
    }
    return aa > FRAME_RELIEF_MIN_MM2 * common && bb > FRAME_RELIEF_MIN_MM2 * common
               ? ab / sqrt(aa * bb)
               : 0;
}
