#include "train_motion.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "align_pose.h"
#include "align_solve.h"
#include "cells.h"
#include "corpus.h"
#include "errinfo.h"
#include "face.h"
#include "learn.h"
#include "model.h"
#include "pool.h"
#include "train_set.h"

#define MODES 32   /* as good as 64 and half the work (docs/accuracy.md, "The pose") */
#define TIE   1e-4 /* to the origin, 1 / mm^2: a nose is right to 1 mm, the centre to 100 */

static const double pi = 3.14159265358979323846;

/* The inverse of the pose that the scan was given; the head's origin is the centre. */
static void true_pose(const struct corpus_scan *s, struct dvec3 centre,
                      struct align_pose *out)
{
    const double y = s->pose[0] * pi / 180, x = s->pose[1] * pi / 180;
    const double z = s->pose[2] * pi / 180;
    const double cy = cos(y), sy = sin(y), cx = cos(x), sx = sin(x), cz = cos(z),
                 sz = sin(z);
    /* Rz Rx Ry, row by row */
    const double r[3][3] = {{cz * cy - sz * sx * sy, -sz * cx, cz * sy + sz * sx * cy},
                            {sz * cy + cz * sx * sy, cz * cx, sz * sy - cz * sx * cy},
                            {-cx * sy, sx, cx * cy}};
    const double shift[3] = {s->pose[3] + centre.x, s->pose[4] + centre.y,
                             s->pose[5] + centre.z};

    for (int i = 0; i < 3; i++) {
        out->t[i] = 0;
        for (int k = 0; k < 3; k++) {
            out->r[3 * i + k] = r[k][i];
            out->t[i] -= r[k][i] * shift[k];
        }
    }
}

/* Where the frame says that the nose tip is, in the scanner's coordinates. */
static struct dvec3 nose(const struct face *f)
{
    const struct align_pose here = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct align_pose back = align_pose_after(&f->frame.pose, &here);

    return (struct dvec3){back.t[0], back.t[1], back.t[2]};
}

/* One nose in two scans: with the centre c, R = Ra Rb^T and the motion (R, t) that c = 0
 * gives,  a = R b + t + (I - R) c. */
static void add_pair(const struct train_set *set, uint32_t a, uint32_t b,
                     struct align_normal *sum)
{
    const struct dvec3 origin = {0, 0, 0}, to = nose(&set->face[a]);
    struct align_pose pa, pb, motion;
    struct dvec3 moved;
    double miss[3];

    true_pose(&set->corpus->scan[a], origin, &pa);
    true_pose(&set->corpus->scan[b], origin, &pb);
    motion = align_pose_after(&pa, &pb);
    moved = align_pose_apply(&motion, nose(&set->face[b]));
    miss[0] = moved.x - to.x;
    miss[1] = moved.y - to.y;
    miss[2] = moved.z - to.z;
    for (int i = 0; i < 3; i++) {
        double j[6] = {0, 0, 0, 0, 0, 0};

        for (int k = 0; k < 3; k++)
            j[k] = (i == k ? 1 : 0) - motion.r[3 * i + k];
        align_solve_add(sum, j, miss[i], 1);
    }
}

struct dvec3 train_motion_centre(const struct train_set *set)
{
    const struct corpus *c = set->corpus;
    struct align_normal sum;
    double x[6];

    memset(&sum, 0, sizeof sum);
    for (uint32_t i = 0; i < c->nscan; i++) {
        const uint32_t own = c->subject[c->scan[i].subject].enrolled;

        if (i != own && set->face[i].surface.mesh.nv > 0 &&
            set->face[own].surface.mesh.nv > 0)
            add_pair(set, own, i, &sum);
    }
    sum.h[0] += TIE;
    sum.h[6] += TIE;
    sum.h[11] += TIE;
    sum.h[15] = sum.h[18] = sum.h[20] = 1; /* unknowns that are not used */
    (void)align_solve(&sum, 0, x);
    return (struct dvec3){x[0], x[1], x[2]};
}

/* Pairs of scans of one subject. */
struct motion {
    const struct train_set *set;
    struct dvec3 centre;
    struct {
        uint32_t template, probe; /* of the corpus's scans */
    } * pair;
    size_t n;
    float *gap; /* [n][GRID_N] learn_sample() at the true pose */
};

/* Each item fills its own place, so their order does not matter. */
static enum status gap_true(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    const struct motion *q = arg;
    const uint32_t template = q->pair[i].template, probe = q->pair[i].probe;
    const struct face *face = q->set->face;
    struct align_pose to, from, motion;
    double transform[16];
    struct cells cells;
    enum status st;

    true_pose(&q->set->corpus->scan[template], q->centre, &to);
    true_pose(&q->set->corpus->scan[probe], q->centre, &from);
    motion = align_pose_after(&to, &from);
    align_pose_to_matrix(&motion, transform);
    st = face_gap(&face[template], &face[probe], transform, w, &cells);
    if (st != ST_OK)
        return errinfo_set(e, st, "the basis of motion: %s", status_message(st));
    learn_sample(&cells, q->gap + i * GRID_N);
    return ST_OK;
}

static void plan(struct motion *q)
{
    const struct corpus *c = q->set->corpus;
    const struct face *face = q->set->face;

    for (uint32_t i = 0; i < c->nscan; i++) {
        uint32_t found = 0;

        if (face[i].surface.mesh.nv == 0)
            continue;
        for (uint32_t k = i + 1; k < c->nscan && found < TRAIN_MOTION_PAIRS; k++) {
            if (c->scan[k].subject != c->scan[i].subject || face[k].surface.mesh.nv == 0)
                continue;
            q->pair[q->n].template = i;
            q->pair[q->n++].probe = k;
            found++;
        }
    }
}

enum status train_motion(const struct train_set *set, unsigned threads, struct model *m,
                         struct errinfo *e)
{
    struct motion q = {.set = set, .centre = train_motion_centre(set)};
    struct model_basis *basis = malloc(sizeof *basis);
    enum status st = ST_ENOMEM;

    q.pair = calloc((size_t)set->corpus->nscan * TRAIN_MOTION_PAIRS, sizeof *q.pair);
    if (q.pair != NULL) {
        plan(&q);
        q.gap = calloc(q.n + 1, GRID_N * sizeof *q.gap);
    }
    if (basis == NULL || q.gap == NULL)
        (void)errinfo_set(e, st, "out of memory");
    else if ((st = pool_run("true poses", threads, m, q.n, gap_true, &q, e)) == ST_OK &&
             (st = learn_modes(q.gap, q.n, MODES, LEARN_MAX_GAP, basis)) != ST_OK)
        (void)errinfo_set(e, st, "the basis of motion: %s", status_message(st));
    if (st == ST_OK)
        m->motion = *basis;
    free(q.gap);
    free(q.pair);
    free(basis);
    return st;
}
