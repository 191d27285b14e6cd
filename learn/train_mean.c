#include "train_mean.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "align_pose.h"
#include "corpus.h"
#include "errinfo.h"
#include "face.h"
#include "grid.h"
#include "lattice.h"
#include "learn.h"
#include "model.h"
#include "pool.h"
#include "train_set.h"

#define ENOUGH     0.4 /* share of the faces, and their mirror images, that cover a cell */
#define UPRIGHT_MM 60.0 /* above and below the nose tip the mean face is as high */
#define DEVIATION  0.5  /* mm, before anything is known of change */

void train_mean_map(const struct surface *face, const struct align_pose *pose,
                    float z[GRID_N])
{
    const struct mesh *m = &face->mesh;
    double area[GRID_N] = {0}, sum[GRID_N] = {0};

    for (uint32_t t = 0; t < m->nt; t++) {
        struct dvec3 q[3];
        double twice, third = 1.0 / 3;
        uint32_t i;

        if (face->bridge[t] || mesh_is_ghost(m, t))
            continue;
        for (int k = 0; k < 3; k++) {
            const uint32_t v = m->org[3 * t + (uint32_t)k];

            q[k] = align_pose_apply(pose, lattice_to_mm(m->xy[v], m->z[v]));
        }
        twice =
            (q[1].x - q[0].x) * (q[2].y - q[0].y) - (q[1].y - q[0].y) * (q[2].x - q[0].x);
        i = grid_cell((q[0].x + q[1].x + q[2].x) * third,
                      (q[0].y + q[1].y + q[2].y) * third);
        if (i == GRID_NONE || twice <= 0)
            continue;
        area[i] += twice / 2;
        sum[i] += twice / 2 * (q[0].z + q[1].z + q[2].z) * third;
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = area[i] >= LEARN_COVERED ? (float)(sum[i] / area[i]) : (float)NAN;
}

/* A frame from the face alone. */
static void own_frame(const struct face *f, struct align_pose *out)
{
    struct align_axes own;

    align_pose_axes(&f->surface, &own);
    for (int i = 0; i < 3; i++) {
        const struct dvec3 a = own.axis[i];

        out->r[3 * i] = a.x;
        out->r[3 * i + 1] = a.y;
        out->r[3 * i + 2] = a.z;
        out->t[i] = -(a.x * own.nose.x + a.y * own.nose.y + a.z * own.nose.z);
    }
}

/* The mean height of the enrolled faces in their frames, made symmetric. */
static void average(const struct train_set *set, float *mean)
{
    double sum[GRID_N] = {0}, count[GRID_N] = {0}, faces = 0;

    for (uint32_t i = 0; i < set->corpus->nscan; i++) {
        const struct face *f = &set->face[i];
        float z[GRID_N];

        if (!set->corpus->scan[i].enrolled || f->surface.mesh.nv == 0)
            continue;
        train_mean_map(&f->surface, &f->frame.pose, z);
        faces++;
        for (uint32_t c = 0; c < GRID_N; c++) {
            if (isnan(z[c]))
                continue;
            sum[c] += (double)z[c];
            count[c]++;
        }
    }
    for (uint32_t c = 0; c < GRID_N; c++) {
        const uint32_t m = grid_mirror(c);
        const double n = count[c] + count[m];

        mean[c] = n >= 2 * ENOUGH * faces && n > 0 ? (float)((sum[c] + sum[m]) / n)
                                                   : (float)NAN;
    }
}

/* The mean's height in the middle, at the row of cells that holds y. */
static double middle(const float *mean, double y)
{
    const uint32_t c = grid_cell(-GRID_MM / 2, y);

    return c == GRID_NONE ? (double)NAN : (double)mean[c];
}

/* The motion that makes the mean upright and brings its nose tip to the origin. */
static void upright(const float *mean, struct align_pose *out)
{
    double best = -INFINITY, at = 0, pitch = 0, top, bottom, a, b, c;

    for (double y = -30; y <= 30; y += GRID_MM) {
        const double z = middle(mean, y);

        if (z > best) {
            best = z;
            at = grid_y(grid_cell(-GRID_MM / 2, y));
        }
    }
    a = middle(mean, at - GRID_MM); /* a parabola through the three highest */
    b = middle(mean, at);
    c = middle(mean, at + GRID_MM);
    if (a + c - 2 * b < 0)
        at += GRID_MM * 0.5 * (a - c) / (a + c - 2 * b);
    top = middle(mean, at + UPRIGHT_MM);
    bottom = middle(mean, at - UPRIGHT_MM);
    if (!isnan(top) && !isnan(bottom))
        pitch = (top - bottom) / (2 * UPRIGHT_MM);
    *out = (struct align_pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, -at, -best}};
    align_pose_move(out, (struct dvec3){0, 0, 0},
                    (const double[6]){-pitch, 0, 0, 0, 0, 0});
}

/* a becomes first a, then b. */
static void follow(struct align_pose *a, const struct align_pose *b)
{
    struct align_pose inverse = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

    inverse = align_pose_after(b, &inverse);
    *a = align_pose_after(&inverse, a);
}

static void neutral(struct model *m)
{
    for (uint32_t c = 0; c < GRID_N; c++) {
        const bool face = !isnan(m->mean[c]);
        const double below = grid_y(c) < -12 ? 0.1 : 1,
                     side = fabs(grid_x(c)) > 50 ? 0.3 : 1;

        m->weight[c] = 1.0f;
        m->change.rest[c] = face ? (float)DEVIATION : 0.0f;
        /* mouth and jaw change their shape, the sides a little */
        m->motion.rest[c] = face ? (float)(DEVIATION / sqrt(below * side)) : 0.0f;
    }
    m->motion.n = m->change.n = 0;
    m->cap_mm = 1.0f;
    m->decision = (struct decision){1.0, 0.1, 2, {{1.0, 0.001}, {10.0, 1.0}}};
}

/* Is the mean large enough to align faces to? */
static bool is_face(const float *mean)
{
    uint32_t n = 0;

    for (uint32_t c = 0; c < GRID_N; c++)
        n += isfinite(mean[c]) ? 1 : 0;
    return n >= MODEL_FACE_MIN;
}

struct placing {
    const struct train_set *set;
    bool all; /* else the enrolled ones */
};

static enum status place(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    const struct placing *p = arg;
    struct face *f = &p->set->face[i];
    enum status st = ST_OK;

    if (f->surface.mesh.nv > 0 && (p->all || p->set->corpus->scan[i].enrolled))
        st = face_place(f, w);
    return st == ST_OK ? ST_OK
                       : errinfo_set(e, st, "the mean face: %s", status_message(st));
}

enum status train_mean(const struct train_set *set, unsigned threads, struct model *m,
                       struct errinfo *e)
{
    const uint32_t n = set->corpus->nscan;

    for (uint32_t i = 0; i < n; i++)
        if (set->face[i].surface.mesh.nv > 0)
            own_frame(&set->face[i], &set->face[i].frame.pose);
    for (int round = 0;; round++) {
        struct placing p = {set, round == TRAIN_MEAN_ROUNDS};
        struct align_pose motion;
        enum status st;

        average(set, m->mean);
        upright(m->mean, &motion);
        for (uint32_t i = 0; i < n; i++)
            follow(&set->face[i].frame.pose, &motion);
        average(set, m->mean);
        if (!is_face(m->mean))
            return errinfo_set(e, ST_EINVAL,
                               "the scans have no surface in common to learn from: are "
                               "they faces?");
        neutral(m);
        st = pool_run("mean face", threads, m, n, place, &p, e);
        if (st != ST_OK || round == TRAIN_MEAN_ROUNDS)
            return st;
    }
}
