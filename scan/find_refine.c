#include "find_refine.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "align_solve.h"
#include "find_near.h"
#include "frame.h"
#include "tuning.h"

#define NONE (-1e9f)

/* The middle of the first cell. */
#define LEFT   ((float)(GRID_LEFT + GRID_MM / 2))
#define BOTTOM ((float)(GRID_BOTTOM + GRID_MM / 2))

static void move(const struct align_pose *pose, const float *const at[3], uint32_t n,
                 float *const out[3])
{
    for (int i = 0; i < 3; i++) {
        const float a = (float)pose->r[3 * i], b = (float)pose->r[3 * i + 1],
                    c = (float)pose->r[3 * i + 2], t = (float)pose->t[i];

        for (uint32_t v = 0; v < n; v++)
            out[i][v] = a * at[0][v] + b * at[1][v] + c * at[2][v] + t;
    }
}

/* Those that may come to lie over the mean face from a pose. */
static void take_near(const struct find_near *near, const struct align_pose *pose,
                      uint32_t stride, struct find_front *f)
{
    const float *const all[3] = {near->x, near->y, near->z};
    float *const moved[3] = {f->moved[0], f->moved[1], f->moved[2]};

    f->n = 0;
    move(pose, all, near->n, moved);
    for (uint32_t v = 0; v < near->n; v += stride) {
        const float x = moved[0][v], y = moved[1][v], z = moved[2][v];

        f->at[0][f->n] = near->x[v];
        f->at[1][f->n] = near->y[v];
        f->at[2][f->n] = near->z[v];
        f->points[f->n] = near->points[v];
        f->n += (fabsf(x) < (float)FIND_BOX_X_MM) &
                (fabsf(y + 12) < (float)FIND_BOX_Y_MM) & (z > -(float)FIND_BOX_Z_MM);
    }
}

/* The patch under a place of the canonical frame; GRID_N: none. */
static inline uint32_t patch_at(float u, float w)
{
    if (!((u >= 0) & (u < GRID_NX - 1) & (w >= 0) & (w < GRID_NY - 1)))
        return GRID_N;
    return (uint32_t)w * GRID_NX + (uint32_t)u;
}

/* How far voxel v is in front of the mean face, and the patch under it; NAN: none is. */
static inline float gap_of(const struct align_grid *g, const struct find_front *f,
                           uint32_t v, uint32_t *patch)
{
    const float u = (f->moved[0][v] - LEFT) * (float)(1 / GRID_MM);
    const float w = (f->moved[1][v] - BOTTOM) * (float)(1 / GRID_MM);
    const uint32_t c = patch_at(u, w);
    const float i = u - (float)(int32_t)u, j = w - (float)(int32_t)w;
    const struct align_patch *p = &g->patch[c];

    *patch = c;
    if (!(g->flat[c] > 0))
        return NAN;
    return (f->moved[2][v] - (p->z + p->zx * i + (p->zy + p->zxy * i) * j)) * g->flat[c];
}

/* At most FIND_FRONT_MM in front of the mean face and FIND_BEHIND_MM behind it. */
static void front_make(const struct align_grid *g, const struct align_pose *pose,
                       struct find_front *f)
{
    const float *const at[3] = {f->at[0], f->at[1], f->at[2]};
    float *const moved[3] = {f->moved[0], f->moved[1], f->moved[2]};

    move(pose, at, f->n, moved);
    for (uint32_t i = 0; i < GRID_N; i++)
        f->gap[i] = NONE;
    for (uint32_t v = 0; v < f->n; v++) {
        uint32_t patch;
        const float gap = gap_of(g, f, v, &patch);

        if (!(gap <= (float)FIND_FRONT_MM) || gap < -(float)FIND_BEHIND_MM)
            continue;
        for (int k = 0; k < 4; k++) {
            static const uint32_t by[4] = {0, 1, GRID_NX, GRID_NX + 1};
            const uint32_t c = patch + by[k];
            const bool more = gap > f->gap[c];

            f->gap[c] = more ? gap : f->gap[c];
            f->voxel[c] = more ? v : f->voxel[c];
        }
    }
}

/* One step of a stage; the length of the motion, mm. */
static double step(const struct frame_mean *mean, const struct find_front *f,
                   double tukey, uint32_t stride, struct align_pose *pose)
{
    static const struct dvec3 centre = {0, 0, -POSE_LEVER_MM};
    const struct align_grid *g = &mean->grid;
    struct align_normal a = {{0}, {0}};
    double x[6], turn = 0, shift = 0;

    for (uint32_t c = 0; c < GRID_N; c += stride) {
        const double gap = (double)f->gap[c];
        const double limit = gap > 0 ? tukey * FIND_TUKEY_FRONT : tukey;
        const struct align_patch *p;
        double n[3], q[3], w;
        uint32_t patch;

        if (isnan(mean->height[c]) || !(fabs(gap) < limit))
            continue;
        (void)gap_of(g, f, f->voxel[c], &patch);
        p = &g->patch[patch];
        n[2] = (double)g->flat[patch];
        n[0] = -(double)(p->zx + 0.5f * p->zxy) / GRID_MM * n[2];
        n[1] = -(double)(p->zy + 0.5f * p->zxy) / GRID_MM * n[2];
        q[0] = (double)f->moved[0][f->voxel[c]] - centre.x;
        q[1] = (double)f->moved[1][f->voxel[c]] - centre.y;
        q[2] = (double)f->moved[2][f->voxel[c]] - centre.z;
        w = gap / limit;
        w = (1 - w * w) * (1 - w * w);
        align_solve_add(&a,
                        (const double[6]){q[1] * n[2] - q[2] * n[1],
                                          q[2] * n[0] - q[0] * n[2],
                                          q[0] * n[1] - q[1] * n[0], n[0], n[1], n[2]},
                        gap, w);
    }
    if (!align_solve(&a, FIND_DAMPING, x))
        return 0;
    for (int i = 0; i < 3; i++) {
        turn += x[i] * x[i];
        shift += x[3 + i] * x[3 + i];
    }
    turn = sqrt(turn);
    shift = sqrt(shift);
    for (int i = 0; i < 3; i++) {
        x[i] *= turn > ALIGN_MAX_TURN_RAD ? ALIGN_MAX_TURN_RAD / turn : 1;
        x[3 + i] *= shift > ALIGN_MAX_SHIFT_MM ? ALIGN_MAX_SHIFT_MM / shift : 1;
    }
    align_pose_move(pose, centre, x);
    return turn * POSE_LEVER_MM + shift;
}

static double flat_of(const struct frame_mean *mean, uint32_t cell)
{
    return mean->grid.flat[cell] > 0 ? (double)mean->grid.flat[cell] : FIND_EDGE_FLAT;
}

/* What stands farther in front than FIND_COVER_MM covers the face: it tells nothing of the
 * face's shape.  What is behind by as much tells against it. */
static void judge(const struct frame_mean *mean, const struct find_front *f,
                  struct find_fit *fit)
{
    double z[GRID_N] = {0}, n[GRID_N] = {0}, sum = 0;
    uint32_t all = 0, covered = 0;

    for (uint32_t c = 0; c < GRID_N; c++) {
        const double gap = (double)f->gap[c];
        const double w = fmin(fabs(gap) / FIND_SCORE_MM, 1);

        if (isnan(mean->height[c]))
            continue;
        all++;
        if (!(f->gap[c] > NONE))
            continue;
        covered++;
        sum += (1 - w * w) * (1 - w * w) - (gap < -FIND_COVER_MM ? 1 : 0);
        if (gap > FIND_COVER_MM)
            continue;
        n[c] = 1;
        z[c] = (double)mean->height[c] + gap / flat_of(mean, c);
    }
    fit->points = 0;
    for (uint32_t v = 0; v < f->n; v++) {
        uint32_t patch;

        if (fabsf(gap_of(&mean->grid, f, v, &patch)) < (float)FIND_COVER_MM)
            fit->points += f->points[v];
    }
    fit->covered = (double)covered / all;
    fit->likeness = frame_likeness_heights(mean, z, n);
    if (isnan(fit->likeness))
        fit->likeness = 0;
    fit->key = sum / all + FIND_KEY_LIKENESS * fit->likeness;
}

void find_refine(const struct frame_mean *mean, const struct find_near *near, bool fine,
                 struct find_front *f, struct find_fit *fit)
{
    static const double tukey[2][2] = {FIND_TUKEY_COARSE_MM, FIND_TUKEY_FINE_MM};

    take_near(near, &fit->pose, fine ? 1 : 2, f);
    for (int stage = 0; stage < 2; stage++) {
        double moved = INFINITY;

        for (int k = 0; k < FIND_STEPS && moved > FIND_SHORT_MM; k++) {
            front_make(&mean->grid, &fit->pose, f);
            moved = step(mean, f, tukey[fine][stage], fine ? 1 : 2, &fit->pose);
        }
    }
    front_make(&mean->grid, &fit->pose, f);
    judge(mean, f, fit);
}
