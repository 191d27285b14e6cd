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

/* Of a sample, leaving out every share-th point at either end of each axis. */
static void measure_extent(const struct dvec3 *pts, size_t n, size_t share,
                           struct extent *out)
{
    const size_t m = n < SAMPLE ? n : SAMPLE;
    double v[SAMPLE], middle[3];

    out->size = 0;
    for (int axis = 0; axis < 3; axis++) {
        double size;

        for (size_t i = 0; i < m; i++)
            v[i] = coordinate(pts[i * n / m], axis);
        qsort(v, m, sizeof *v, by_value);
        size = v[m - 1 - m / share] - v[m / share];
        out->size = size > out->size ? size : out->size;
        middle[axis] = v[m / 2];
    }
    out->middle = (struct dvec3){middle[0], middle[1], middle[2]};
}

struct start {
    uint32_t nose;
    struct find_place place;
};

#define FOUND 16

struct found {
    struct find_pose pose;
    struct dvec3 nose; /* the tip, mm, in the points' axes */
    uint64_t points;   /* on the face */
};

/* By falling key, no two the same. */
struct list {
    struct found found[FOUND];
    uint32_t n;
};

struct work {
    const struct frame_mean *mean;
    struct find_face_samples samples;
    struct find_near near;
    struct find_front front;
    struct find_nose nose[FIND_NOSES_ROOM];
    uint32_t noses;
    struct start start[FIND_STARTS];
    uint32_t starts;
    struct list best;
    int64_t left; /* points and voxels that may still be looked at */
};

/* ---- starting poses */

/* Keep the best starts, by rising cost. */
static void keep(struct work *w, uint32_t nose, const struct find_place *p)
{
    uint32_t i;

    if (w->starts == FIND_STARTS && !(p->cost < w->start[FIND_STARTS - 1].place.cost))
        return;
    i = w->starts < FIND_STARTS ? w->starts++ : FIND_STARTS - 1;
    for (; i > 0 && p->cost < w->start[i - 1].place.cost; i--)
        w->start[i] = w->start[i - 1];
    w->start[i] = (struct start){nose, *p};
}

/* The rolls about an axis that are better than their neighbours. */
static void roll(struct work *w, uint32_t nose, const float axis[3])
{
    struct find_place p[FIND_ROLLS];

    find_place_turn(&w->samples, &w->near, axis, p);
    for (int r = 0; r < FIND_ROLLS; r++)
        if (p[r].cost <= p[(r + 1) % FIND_ROLLS].cost &&
            p[r].cost < p[(r + FIND_ROLLS - 1) % FIND_ROLLS].cost)
            keep(w, nose, &p[r]);
}

static void collect(const struct find_grid *g, struct work *w, bool tilted)
{
    w->starts = 0;
    for (uint32_t k = 0; k < w->noses && w->left > 0; k++) {
        const float *axis = w->nose[k].axis;

        find_near_get(g, w->nose[k].at, &w->near);
        w->left -= FIND_ROLLS * FIND_SAMPLES + w->near.n * (tilted ? 1 + FIND_TILTS : 1);
        roll(w, k, axis);
        for (int t = 0; tilted && t < FIND_TILTS; t++) {
            float other[3];

            find_place_tilt(axis, t, other);
            roll(w, k, other);
        }
    }
}

/* ---- poses */

/* Less than FIND_SAME_MM and FIND_SAME_TRACE apart? */
static bool same(const struct found *a, const struct found *b)
{
    const struct align_pose d = align_pose_after(&a->pose.pose, &b->pose.pose);
    const struct dvec3 way = vec_sub(a->nose, b->nose);

    return a->pose.unit_mm == b->pose.unit_mm &&
           vec_dot(way, way) < FIND_SAME_MM * FIND_SAME_MM &&
           d.r[0] + d.r[4] + d.r[8] > FIND_SAME_TRACE;
}

static void take(struct list *l, const struct found *f)
{
    uint32_t i = 0;

    while (i < l->n && !same(&l->found[i], f))
        i++;
    if (i < l->n ? f->pose.key <= l->found[i].pose.key
                 : l->n == FOUND && f->pose.key <= l->found[FOUND - 1].pose.key)
        return;
    if (i == l->n)
        i = l->n < FOUND ? l->n++ : FOUND - 1;
    for (; i > 0 && f->pose.key > l->found[i - 1].pose.key; i--)
        l->found[i] = l->found[i - 1];
    l->found[i] = *f;
}

static bool plain(const struct work *w)
{
    return w->best.n > 0 && w->best.found[0].pose.key >= FIND_PLAIN;
}

/* Is a plain pose's face at a place already? */
static bool taken(const struct work *w, double unit_mm, struct dvec3 at)
{
    for (uint32_t i = 0; i < w->best.n && w->best.found[i].pose.key >= FIND_PLAIN; i++) {
        const struct dvec3 way = vec_sub(at, w->best.found[i].nose);

        if (w->best.found[i].pose.unit_mm != unit_mm ||
            vec_dot(way, way) < FIND_OTHER_MM * FIND_OTHER_MM)
            return true;
    }
    return false;
}

/* The pose that a start stands for. */
static struct found found_at(const struct find_grid *g, const struct work *w,
                             const struct start *s)
{
    const float *r = s->place.r, *at = w->nose[s->nose].at;
    const double *tip = w->samples.tip;
    struct found f = {.pose.unit_mm = g->unit_mm};
    double p[3] = {g->corner.x + (double)at[0], g->corner.y + (double)at[1],
                   g->corner.z + (double)at[2]};

    for (int i = 0; i < 9; i++)
        f.pose.pose.r[i] = (double)r[i];
    for (int i = 0; i < 3; i++)
        p[i] -= f.pose.pose.r[i] * tip[0] + f.pose.pose.r[3 + i] * tip[1] +
                f.pose.pose.r[6 + i] * tip[2];
    f.nose = (struct dvec3){p[0], p[1], p[2]};
    return f;
}

/* Refine f from its rotation and nose; the rest of it is filled. */
static void settle(const struct find_grid *g, struct work *w, bool fine, struct found *f)
{
    const struct dvec3 at = vec_sub(f->nose, g->corner);
    struct find_fit fit = {.pose = f->pose.pose};
    struct align_pose *p = &f->pose.pose;
    const struct dvec3 from = f->nose;

    memset(fit.pose.t, 0, sizeof fit.pose.t);
    find_near_get(g, (const float[3]){(float)at.x, (float)at.y, (float)at.z}, &w->near);
    find_refine(w->mean, &w->near, fine, &w->front, &fit);
    w->left -= GRID_N + w->front.n * 8;
    *p = fit.pose;
    for (int i = 0; i < 3; i++)
        p->t[i] -=
            p->r[3 * i] * from.x + p->r[3 * i + 1] * from.y + p->r[3 * i + 2] * from.z;
    f->nose = align_pose_origin(p);
    f->points = fit.points;
    f->pose.key = fit.key;
    f->pose.likeness = fit.likeness;
    f->pose.covered = fit.covered;
}

/* The best starts, until a face is plain; then those elsewhere that may well be another. */
static void refine(const struct find_grid *g, struct work *w, uint32_t most)
{
    struct list coarse = {.n = 0};

    for (uint32_t k = 0; k < w->starts && most > 0 && w->left > 0; k++) {
        struct found f = found_at(g, w, &w->start[k]);

        if (taken(w, g->unit_mm, f.nose) ||
            (plain(w) && w->start[k].place.cost > FIND_OTHER_COST_MM))
            continue;
        settle(g, w, false, &f);
        most--;
        if (f.pose.key >= FIND_HOPEFUL) {
            settle(g, w, true, &f);
            take(&w->best, &f);
        } else
            take(&coarse, &f);
    }
    for (uint32_t k = 0; k < coarse.n && k < FIND_FINE && !plain(w); k++) {
        settle(g, w, true, &coarse.found[k]);
        take(&w->best, &coarse.found[k]);
    }
}

/* ---- grids, parts and units */

struct effort {
    uint32_t noses, places;
    bool tilted;
};

static enum status search_grid(const struct find_grid *g, const struct effort *e,
                               struct work *w)
{
    enum status st;

    if ((w->left -= 8 * g->nvoxels) < 0)
        return ST_OK;
    st = find_nose_all(g, e->noses, w->nose, &w->noses);
    if (st == ST_OK) {
        collect(g, w, e->tilted);
        refine(g, w, e->places);
    }
    return st;
}

/* Until a face is plain: a cloud of a head's size as a whole, then by its parts; a larger one
 * by its parts, then as a whole. */
static enum status search(const struct dvec3 *pts, size_t n, double unit_mm,
                          const struct extent *extent, bool tilted, struct work *w)
{
    static const struct effort efforts[2] = {
        {FIND_NOSES, FIND_PLACES, false}, {FIND_NOSES_TILTED, FIND_PLACES_TILTED, true}};
    static const struct effort room = {FIND_NOSES_ROOM, FIND_PLACES_ROOM, false};
    const struct effort *e = &efforts[tilted];
    const struct dvec3 middle = {extent->middle.x * unit_mm, extent->middle.y * unit_mm,
                                 extent->middle.z * unit_mm};
    const bool head = extent->size * unit_mm < FIND_ROOM_MIN_MM;
    struct find_grid g, parts[FIND_PARTS];
    uint32_t nparts = 0;
    enum status st;

    if ((w->left -= 2 * (int64_t)n) < 0)
        return ST_OK;
    if ((st = find_grid_make(pts, n, unit_mm, middle, &g)) != ST_OK)
        return st;
    if (head)
        st = search_grid(&g, e, w);
    if (st == ST_OK && !(head && plain(w)))
        st = find_part_all(&g, parts, &nparts);
    for (uint32_t k = 0; k < nparts; k++) {
        if (st == ST_OK && !(head && nparts == 1))
            st = search_grid(&parts[k], e, w);
        find_grid_free(&parts[k]);
    }
    if (st == ST_OK && !head && !tilted && !plain(w))
        st = search_grid(&g, &room, w);
    find_grid_free(&g);
    return st;
}

/* The units by which the cloud is as large as a head; where no face is plain, as large as a
 * room; then both again with tilted axes. */
static enum status search_units(const struct dvec3 *pts, size_t n, double unit_mm,
                                const struct extent *e, struct work *w)
{
    static const double units[] = FIND_UNITS_MM;
    enum status st = ST_OK;

    for (int pass = 0; pass < 3 && st == ST_OK && !plain(w); pass++) {
        const double lo = pass == 1 ? FIND_ROOM_MIN_MM : FIND_HEAD_MIN_MM;
        const double hi = pass == 0 ? FIND_ROOM_MIN_MM : FIND_ROOM_MAX_MM;

        for (size_t i = 0; i < sizeof units / sizeof *units && st == ST_OK; i++) {
            const double mm = unit_mm > 0 ? unit_mm : units[i];

            if ((unit_mm > 0 && i > 0) || e->size * mm < lo || e->size * mm >= hi ||
                plain(w))
                continue;
            st = search(pts, n, mm, e, pass == 2, w);
        }
    }
    return st;
}

/* Of several plain faces the one with the most points; else the best poses. */
static void choose(const struct work *w, struct find *out)
{
    uint32_t first = 0;

    out->faces = 1;
    for (uint32_t i = 1; i < w->best.n && w->best.found[i].pose.key >= FIND_PLAIN; i++) {
        out->faces++;
        first = w->best.found[i].points > w->best.found[first].points ? i : first;
    }
    while (out->n < FIND_POSES && out->n < (plain(w) ? 1 : w->best.n)) {
        out->pose[out->n] = w->best.found[first + out->n].pose;
        out->n++;
    }
}

enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      const struct face_work *fw, struct find *out)
{
    struct work *w;
    struct extent e, core;
    enum status st;

    memset(out, 0, sizeof *out);
    if (n == 0)
        return ST_ENOFACE;
    if ((w = mem_array(1, sizeof *w)) == NULL)
        return ST_ENOMEM;
    w->mean = face_work_mean(fw);
    w->best.n = 0;
    w->left = FIND_WORK;
    find_place_samples(w->mean, &w->samples);
    measure_extent(pts, n, FIND_STRAY_IN, &e);
    st = search_units(pts, n, unit_mm, &e, w);
    measure_extent(pts, n, FIND_STRAYS_IN, &core);
    if (st == ST_OK && !plain(w) && core.size < e.size / 2) /* many strays */
        st = search_units(pts, n, unit_mm, &core, w);
    if (st == ST_OK && w->best.n == 0)
        st = ST_ENOFACE;
    if (st == ST_OK)
        choose(w, out);
    mem_free(w);
    return st;
}
