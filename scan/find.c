#include "find.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "find_grid.h"
#include "find_near.h"
#include "find_nose.h"
#include "find_part.h"
#include "find_place.h"
#include "find_refine.h"
#include "mem.h"
#include "tuning.h"

#define SAMPLE 2048

struct extent {
    struct dvec3 middle; /* in the points' unit */
    double size;
};

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static double coordinate(struct dvec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

static void measure_extent(const struct dvec3 *pts, size_t n, struct extent *out)
{
    double v[SAMPLE], middle[3];

    out->size = 0;
    for (int axis = 0; axis < 3; axis++) {
        const size_t m = n < SAMPLE ? n : SAMPLE;
        double size;

        for (size_t i = 0; i < m; i++)
            v[i] = coordinate(pts[i * n / m], axis);
        qsort(v, m, sizeof *v, by_value);
        size = v[m - 1 - m / 100] - v[m / 100];
        out->size = size > out->size ? size : out->size;
        middle[axis] = v[m / 2];
    }
    out->middle = (struct dvec3){middle[0], middle[1], middle[2]};
}

struct start {
    uint32_t nose;
    struct find_place place;
};

struct work {
    const struct frame_mean *mean;
    struct find_face_samples samples;
    struct find_near near;
    struct find_nose nose[FIND_NOSES_TILTED];
    uint32_t noses;
    struct start start[FIND_PLACES_TILTED];
    uint32_t starts;
};

/* Keep the best starts, by falling cost. */
static void keep(struct work *w, uint32_t nose, const struct find_place *p, uint32_t most)
{
    uint32_t i;

    if (w->starts == most && !(p->cost < w->start[most - 1].place.cost))
        return;
    i = w->starts < most ? w->starts++ : most - 1;
    for (; i > 0 && p->cost < w->start[i - 1].place.cost; i--)
        w->start[i] = w->start[i - 1];
    w->start[i] = (struct start){nose, *p};
}

static void collect(const struct find_grid *g, struct work *w, bool tilted)
{
    const uint32_t most = tilted ? FIND_PLACES_TILTED : FIND_PLACES;

    w->starts = 0;
    for (uint32_t k = 0; k < w->noses; k++) {
        const struct find_nose *nose = &w->nose[k];
        struct find_place p[FIND_ROLLS];

        find_near_get(g, nose->at, &w->near);
        for (int t = 0; t < (tilted ? 7 : 1); t++) {
            float axis[3] = {nose->axis[0], nose->axis[1], nose->axis[2]};

            if (t > 0) {
                static const float c[6] = {1, 0.5f, -0.5f, -1, -0.5f, 0.5f};
                static const float d[6] = {0, 0.866025404f,  0.866025404f,
                                           0, -0.866025404f, -0.866025404f};
                float u[3], v[3], l;
                const int least = fabsf(axis[0]) < 0.6f ? 0 : 1;

                u[0] = (least == 0) - axis[least] * axis[0];
                u[1] = (least == 1) - axis[least] * axis[1];
                u[2] = -axis[least] * axis[2];
                l = 1 / sqrtf(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
                for (int i = 0; i < 3; i++)
                    u[i] *= l;
                v[0] = axis[1] * u[2] - axis[2] * u[1];
                v[1] = axis[2] * u[0] - axis[0] * u[2];
                v[2] = axis[0] * u[1] - axis[1] * u[0];
                for (int i = 0; i < 3; i++)
                    axis[i] = 0.882947593f * axis[i] +
                              0.469471563f * (c[t - 1] * u[i] + d[t - 1] * v[i]);
            }
            find_place_turn(&w->samples, &w->near, axis, p);
            for (int r = 0; r < FIND_ROLLS; r++)
                if (p[r].cost <= p[(r + 1) % FIND_ROLLS].cost &&
                    p[r].cost < p[(r + FIND_ROLLS - 1) % FIND_ROLLS].cost)
                    keep(w, k, &p[r], most);
        }
    }
}

/* Less than FIND_SAME_MM and FIND_SAME_DEG apart? */
static bool same(const struct find_pose *a, const struct find_pose *b)
{
    const struct align_pose d = align_pose_after(&a->pose, &b->pose); /* of the points */
    const struct align_pose *q = &a->pose;
    /* where b's points for the tip of the nose are in a's frame, and the turn's trace */
    const struct dvec3 s = {-(b->pose.r[0] * b->pose.t[0] + b->pose.r[3] * b->pose.t[1] +
                              b->pose.r[6] * b->pose.t[2]),
                            -(b->pose.r[1] * b->pose.t[0] + b->pose.r[4] * b->pose.t[1] +
                              b->pose.r[7] * b->pose.t[2]),
                            -(b->pose.r[2] * b->pose.t[0] + b->pose.r[5] * b->pose.t[1] +
                              b->pose.r[8] * b->pose.t[2])};
    const struct dvec3 at = align_pose_apply(q, s);

    return a->unit_mm == b->unit_mm && vec_dot(at, at) < FIND_SAME_MM * FIND_SAME_MM &&
           d.r[0] + d.r[4] + d.r[8] > FIND_SAME_TRACE;
}

static void take(struct find *out, const struct find_pose *p)
{
    uint32_t i;

    for (i = 0; i < out->n && !same(&out->pose[i], p); i++)
        ;
    if (i < out->n) { /* the better one of the two */
        if (p->key <= out->pose[i].key)
            return;
        for (; i > 0 && p->key > out->pose[i - 1].key; i--)
            out->pose[i] = out->pose[i - 1];
        out->pose[i] = *p;
        return;
    }
    if (out->n == FIND_POSES && p->key <= out->pose[FIND_POSES - 1].key)
        return;
    i = out->n < FIND_POSES ? out->n++ : FIND_POSES - 1;
    for (; i > 0 && p->key > out->pose[i - 1].key; i--)
        out->pose[i] = out->pose[i - 1];
    out->pose[i] = *p;
}

static void refine(const struct find_grid *g, struct work *w, struct find *out)
{
    for (uint32_t k = 0; k < w->starts; k++) {
        const struct start *s = &w->start[k];
        const float *at = w->nose[s->nose].at;
        const struct dvec3 from = {g->corner.x + (double)at[0],
                                   g->corner.y + (double)at[1],
                                   g->corner.z + (double)at[2]};
        struct find_fit fit;
        struct find_pose p = {.unit_mm = g->unit_mm};
        struct dvec3 t;

        find_near_get(g, at, &w->near);
        for (int i = 0; i < 9; i++)
            fit.pose.r[i] = (double)s->place.r[i];
        memcpy(fit.pose.t, w->samples.tip, sizeof fit.pose.t);
        find_refine(w->mean, &w->near, &fit);
        p.pose = fit.pose;
        p.pose.t[0] = p.pose.t[1] = p.pose.t[2] = 0;
        t = align_pose_apply(&p.pose, from);
        p.pose.t[0] = fit.pose.t[0] - t.x;
        p.pose.t[1] = fit.pose.t[1] - t.y;
        p.pose.t[2] = fit.pose.t[2] - t.z;
        p.key = fit.key;
        p.likeness = fit.likeness;
        p.covered = fit.covered;
        take(out, &p);
    }
}

static bool plain(const struct find *f)
{
    return f->n > 0 && f->pose[0].key >= FIND_PLAIN;
}

static enum status search_grid(const struct find_grid *g, struct work *w, bool tilted,
                               struct find *out)
{
    const enum status st =
        find_nose_all(g, tilted ? FIND_NOSES_TILTED : FIND_NOSES, w->nose, &w->noses);

    if (st == ST_OK) {
        collect(g, w, tilted);
        refine(g, w, out);
    }
    return st;
}

/* A cloud of a head's size is searched as a whole first, and by its parts where no face was
 * plain; a larger one by its parts alone. */
static enum status search(const struct dvec3 *pts, size_t n, double unit_mm,
                          const struct extent *e, struct work *w, bool tilted,
                          struct find *out)
{
    const struct dvec3 middle = {e->middle.x * unit_mm, e->middle.y * unit_mm,
                                 e->middle.z * unit_mm};
    const bool whole = e->size * unit_mm < FIND_ROOM_MIN_MM;
    struct find_grid g, parts[FIND_PARTS];
    uint32_t nparts;
    enum status st;

    if ((st = find_grid_make(pts, n, unit_mm, middle, &g)) != ST_OK)
        return st;
    if (whole)
        st = search_grid(&g, w, tilted, out);
    if (st == ST_OK && !(whole && plain(out)) &&
        (st = find_part_all(&g, parts, &nparts)) == ST_OK) {
        for (uint32_t k = 0; k < nparts; k++) {
            if (st == ST_OK && !(whole && nparts == 1))
                st = search_grid(&parts[k], w, tilted, out);
            find_grid_free(&parts[k]);
        }
    }
    find_grid_free(&g);
    return st;
}

enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      const struct face_work *fw, struct find *out)
{
    static const double units[] = {1, 10, 1000, 25.4, 0.001};
    struct extent e;
    struct work *w;
    enum status st = ST_OK;

    memset(out, 0, sizeof *out);
    if (n == 0)
        return ST_ENOFACE;
    measure_extent(pts, n, &e);
    if ((w = mem_array(1, sizeof *w)) == NULL)
        return ST_ENOMEM;
    w->mean = face_work_mean(fw);
    find_place_samples(w->mean, &w->samples);
    for (int pass = 0; pass < 3 && !plain(out); pass++) {
        const double lo = pass == 1 ? FIND_ROOM_MIN_MM : FIND_HEAD_MIN_MM;
        const double hi = pass == 0 ? FIND_ROOM_MIN_MM : FIND_ROOM_MAX_MM;

        for (size_t i = 0; i < sizeof units / sizeof *units && st == ST_OK; i++) {
            const double mm = unit_mm > 0 ? unit_mm : units[i];

            if (unit_mm > 0 ? i > 0 : e.size * mm < lo || e.size * mm >= hi)
                continue;
            st = search(pts, n, mm, &e, w, pass == 2, out);
        }
    }
    if (plain(out))
        out->n = 1;
    mem_free(w);
    out->faces = 1;
    return st == ST_OK && out->n == 0 ? ST_ENOFACE : st;
}
