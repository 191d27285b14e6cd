#include "find_refine.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "align_solve.h"
#include "find_near.h"
#include "frame.h"
#include "tuning.h"

/* The foremost voxel over each cell of the mean face. */
struct front {
    float at[GRID_N][3]; /* canonical frame */
    float gap[GRID_N];   /* at right angles to the mean face, mm; NONE: none */
    uint32_t under[GRID_N];
};

#define NONE (-1e9f)

/* At most FIND_FRONT_MM in front of the mean face. */
static void front_make(const struct frame_mean *mean, const struct find_near *near,
                       const struct align_pose *pose, struct front *out)
{
    const struct align_grid *g = &mean->grid;
    float r[9], t[3];

    for (int i = 0; i < 9; i++)
        r[i] = (float)pose->r[i];
    for (int i = 0; i < 3; i++)
        t[i] = (float)pose->t[i];
    for (uint32_t i = 0; i < GRID_N; i++)
        out->gap[i] = NONE;
    for (uint32_t v = 0; v < near->n; v++) {
        const float px = near->x[v], py = near->y[v], pz = near->z[v];
        const float x = r[0] * px + r[1] * py + r[2] * pz + t[0];
        const float y = r[3] * px + r[4] * py + r[5] * pz + t[1];
        const float z = r[6] * px + r[7] * py + r[8] * pz + t[2];
        const float i = (x - (float)(GRID_LEFT + GRID_MM / 2)) * (float)(1 / GRID_MM);
        const float j = (y - (float)(GRID_BOTTOM + GRID_MM / 2)) * (float)(1 / GRID_MM);
        uint32_t cell;
        float u, w, gap;
        const struct align_patch *p;

        if (!((i >= 0) & (i < GRID_NX - 1) & (j >= 0) & (j < GRID_NY - 1)))
            continue;
        cell = (uint32_t)j * GRID_NX + (uint32_t)i;
        if (!(g->flat[cell] > 0))
            continue;
        u = i - (float)(uint32_t)i;
        w = j - (float)(uint32_t)j;
        p = &g->patch[cell];
        gap = (z - (p->z + p->zx * u + (p->zy + p->zxy * u) * w)) * g->flat[cell];
        if (gap > (float)FIND_FRONT_MM || gap < -(float)FIND_BEHIND_MM)
            continue;
        for (int k = 0; k < 4; k++) {
            static const uint32_t by[4] = {0, 1, GRID_NX, GRID_NX + 1};
            const uint32_t c = cell + by[k];

            if (gap > out->gap[c]) {
                out->gap[c] = gap;
                out->under[c] = cell;
                memcpy(out->at[c], (const float[3]){x, y, z}, sizeof out->at[c]);
            }
        }
    }
}

/* One step of a stage; the length of the motion, mm. */
static double step(const struct frame_mean *mean, const struct front *f, double tukey,
                   struct align_pose *pose)
{
    static const struct dvec3 centre = {0, 0, -POSE_LEVER_MM};
    const struct align_grid *g = &mean->grid;
    struct align_normal a = {{0}, {0}};
    double x[6], turn = 0, shift = 0;

    for (uint32_t c = 0; c < GRID_N; c++) {
        const struct align_patch *p;
        double n[3], q[3], w;
        uint32_t under;

        const double limit = f->gap[c] > 0 ? tukey * FIND_TUKEY_FRONT : tukey;
        if (isnan(mean->height[c]) || !(fabsf(f->gap[c]) < (float)limit))
            continue;
        under = f->under[c];
        p = &g->patch[under];
        n[2] = (double)g->flat[under];
        n[0] = -(double)(p->zx + 0.5f * p->zxy) / GRID_MM * n[2];
        n[1] = -(double)(p->zy + 0.5f * p->zxy) / GRID_MM * n[2];
        q[0] = (double)f->at[c][0] - centre.x;
        q[1] = (double)f->at[c][1] - centre.y;
        q[2] = (double)f->at[c][2] - centre.z;
        w = (double)f->gap[c] / limit;
        w = (1 - w * w) * (1 - w * w);
        align_solve_add(&a,
                        (const double[6]){q[1] * n[2] - q[2] * n[1],
                                          q[2] * n[0] - q[0] * n[2],
                                          q[0] * n[1] - q[1] * n[0], n[0], n[1], n[2]},
                        (double)f->gap[c], w);
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
static void judge(const struct frame_mean *mean, const struct front *f,
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
    fit->covered = (double)covered / all;
    fit->likeness = frame_likeness_heights(mean, z, n);
    if (isnan(fit->likeness))
        fit->likeness = 0;
    fit->key = sum / all + FIND_KEY_LIKENESS * fit->likeness;
}

void find_refine(const struct frame_mean *mean, const struct find_near *near,
                 struct find_fit *fit)
{
    static const double tukey[] = FIND_TUKEY_MM;
    struct front f;

    for (size_t stage = 0; stage < sizeof tukey / sizeof *tukey; stage++) {
        double moved = INFINITY;

        for (int k = 0; k < FIND_STEPS && moved > FIND_SHORT_MM; k++) {
            front_make(mean, near, &fit->pose, &f);
            moved = step(mean, &f, tukey[stage], &fit->pose);
        }
    }
    front_make(mean, near, &fit->pose, &f);
    judge(mean, &f, fit);
}
