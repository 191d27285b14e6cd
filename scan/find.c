#include "find.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "find_grid.h"
#include "find_nose.h"
#include "find_part.h"
#include "find_search.h"
#include "mem.h"
#include "tuning.h"

#define SAMPLE  2048
#define TARGETS 12

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

    *out = (struct extent){0};
    if (m == 0)
        return;
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

/* A grid of a head's size, and the noses in it. */
struct target {
    struct find_grid g;
    struct find_nose nose[FIND_NOSES_TILTED];
    uint32_t noses;
    double key; /* the best so far */
};

/* One call of find_face(). */
struct finder {
    const struct dvec3 *pts;
    size_t n;
    double unit_mm; /* 0: to be found */
    struct extent extent;
    struct target target[TARGETS]; /* kept for another look */
    uint32_t targets;
    size_t voxels; /* of theirs */
    struct find_search s;
};

static bool plain(const struct finder *f)
{
    return find_search_plain(&f->s);
}

/* ---- targets */

static void free_targets(struct finder *f)
{
    while (f->targets > 0)
        find_grid_free(&f->target[--f->targets].g);
    f->voxels = 0;
}

/* Search g, which the next target takes over. */
static enum status search_target(struct finder *f, const struct find_grid *g)
{
    static const struct find_effort effort = {FIND_NOSES, FIND_PLACES, false};
    struct target *t = &f->target[f->targets];
    enum status st = ST_OK;

    t->g = *g;
    t->noses = 0;
    if (find_search_spend(&f->s, 8 * (int64_t)g->nvoxels))
        st = find_nose_all(g, FIND_NOSES_TILTED, t->nose, &t->noses);
    if (st == ST_OK)
        t->key = find_search_grid(&f->s, g, t->nose, t->noses, &effort);
    return st;
}

/* Keep the next target for another look, if there is room. */
static void keep_target(struct finder *f)
{
    struct find_grid *g = &f->target[f->targets].g;

    if (f->targets == TARGETS - 1 || f->voxels + g->nvoxels > FIND_KEPT_VOXELS) {
        find_grid_free(g);
    } else {
        f->targets++;
        f->voxels += g->nvoxels;
    }
}

/* The parts, which become targets; none where st is a failure already. */
static enum status search_parts(struct finder *f, const struct find_grid *parts,
                                uint32_t n, enum status st)
{
    for (uint32_t k = 0; k < n; k++) {
        f->target[f->targets].g = parts[k];
        if (st == ST_OK)
            st = search_target(f, &parts[k]);
        keep_target(f);
    }
    return st;
}

static void search_tilted(struct finder *f)
{
    static const struct find_effort effort = {FIND_NOSES_TILTED, FIND_PLACES_TILTED,
                                              true};

    for (uint32_t i = 0; i < FIND_TILTED && !plain(f); i++) {
        struct target *best = NULL;

        if (i > 0 && find_search_likely(&f->s))
            return;

        for (uint32_t k = 0; k < f->targets; k++)
            if (f->target[k].key > (best != NULL ? best->key : -1))
                best = &f->target[k];
        if (best == NULL)
            return;
        best->key = -1;
        (void)find_search_grid(&f->s, &best->g, best->nose, best->noses, &effort);
    }
}

/* ---- units */

static enum status make_grid(struct finder *f, double unit_mm, struct find_grid *g)
{
    const struct dvec3 m = f->extent.middle;

    return find_grid_make(f->pts, find_search_spend(&f->s, 2 * (int64_t)f->n) ? f->n : 0,
                          unit_mm,
                          (struct dvec3){m.x * unit_mm, m.y * unit_mm, m.z * unit_mm}, g);
}

/* A cloud of a head's size as a whole, and where it has several parts of that size by them. */
static enum status search_head(struct finder *f, double unit_mm)
{
    struct find_grid g, parts[FIND_PARTS];
    uint32_t n = 0;
    enum status st = make_grid(f, unit_mm, &g);

    if (st != ST_OK)
        return st;
    st = search_target(f, &g);
    if (st == ST_OK && !plain(f))
        st = find_part_all(&g, parts, &n);
    keep_target(f);
    if (n > 1)
        return search_parts(f, parts, n, st);
    if (n == 1) /* the whole, which has been searched */
        find_grid_free(&parts[0]);
    return st;
}

/* A room by its parts of a head's size. */
static enum status search_room(struct finder *f, double unit_mm)
{
    struct find_grid g, parts[FIND_PARTS];
    uint32_t n = 0;
    enum status st = make_grid(f, unit_mm, &g);

    if (st != ST_OK)
        return st;
    st = find_part_all(&g, parts, &n);
    find_grid_free(&g);
    return search_parts(f, parts, n, st);
}

/* A room as a whole: somebody leans on a wall. */
static enum status search_whole(struct finder *f, double unit_mm)
{
    static const struct find_effort effort = {FIND_NOSES_ROOM, FIND_PLACES_ROOM, false};
    struct find_nose nose[FIND_NOSES_ROOM];
    struct find_grid g;
    uint32_t n;
    enum status st = make_grid(f, unit_mm, &g);

    if (st != ST_OK)
        return st;
    (void)find_search_spend(&f->s, 8 * (int64_t)g.nvoxels);
    st = find_nose_all(&g, FIND_NOSES_ROOM, nose, &n);
    if (st == ST_OK)
        find_search_grid(&f->s, &g, nose, n, &effort);
    find_grid_free(&g);
    return st;
}

/* By each unit that makes the cloud as large as that, until a face is plain. */
static enum status search_units(struct finder *f, double from_mm, double to_mm,
                                enum status (*search)(struct finder *, double))
{
    static const double units[] = FIND_UNITS_MM;
    const size_t n = f->unit_mm > 0 ? 1 : sizeof units / sizeof *units;
    enum status st = ST_OK;

    for (size_t i = 0; i < n && st == ST_OK && !plain(f) && !find_search_stopped(&f->s);
         i++) {
        const double mm = f->unit_mm > 0 ? f->unit_mm : units[i];

        if (f->extent.size * mm >= from_mm && f->extent.size * mm < to_mm)
            st = search(f, mm);
    }
    return st;
}

/* Cheap ways first. */
static enum status search_all(struct finder *f)
{
    enum status st = search_units(f, FIND_HEAD_MIN_MM, FIND_ROOM_MIN_MM, search_head);

    if (st == ST_OK)
        st = search_units(f, FIND_ROOM_MIN_MM, FIND_ROOM_MAX_MM, search_room);
    if (st == ST_OK)
        search_tilted(f);
    if (st == ST_OK && !find_search_likely(&f->s))
        st = search_units(f, FIND_ROOM_MIN_MM, FIND_ROOM_MAX_MM, search_whole);
    free_targets(f);
    return st == ST_OK && find_search_stopped(&f->s) ? ST_EBUSY : st;
}

/* Is found[i] plainly a face, and another one than those before it? */
static bool another(const struct find_list *l, uint32_t i)
{
    for (uint32_t k = 0; k < i; k++) {
        const struct dvec3 way = vec_sub(l->found[i].nose, l->found[k].nose);

        if (vec_dot(way, way) < FIND_OTHER_MM * FIND_OTHER_MM)
            return false;
    }
    return l->found[i].key >= FIND_PLAIN;
}

static struct find_pose pose_of(const struct find_found *f)
{
    return (struct find_pose){.unit_mm = f->unit_mm,
                              .pose = f->pose,
                              .key = f->key,
                              .likeness = f->likeness,
                              .covered = f->covered};
}

/* How near the nose is to a scanner with the agreed axes (side 1) or a camera's (-1: y down
 * and z away), if the face is turned to it; else false. */
static bool nearness(const struct find_found *f, double side, double *near)
{
    const double *r = f->pose.r;

    *near = side * f->nose.z;
    return r[0] + side * (r[4] + r[8]) >= SCAN_AXES_TRACE;
}

/* Is a to be taken rather than b: nearer, where both are seen along the same axes; else with
 * more points? */
static bool rather(const struct find_found *a, const struct find_found *b)
{
    double near_a, near_b;

    for (int side = 1; side >= -1; side -= 2)
        if (nearness(a, side, &near_a) && nearness(b, side, &near_b))
            return near_a > near_b;
    return a->points > b->points;
}

/* Of several plain faces the nearest; else the best poses, of one unit. */
static void choose(const struct find_list *l, struct find *out)
{
    uint32_t first = 0;

    out->faces = 1;
    for (uint32_t i = 1; i < l->n; i++) {
        if (!another(l, i))
            continue;
        out->faces++;
        first = rather(&l->found[i], &l->found[first]) ? i : first;
    }
    out->pose[out->n++] = pose_of(&l->found[first]);
    if (out->pose[0].key >= FIND_PLAIN)
        return;
    for (uint32_t i = 1; i < l->n && out->n < FIND_POSES; i++)
        if (l->found[i].unit_mm == out->pose[0].unit_mm)
            out->pose[out->n++] = pose_of(&l->found[i]);
}

enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      const struct face_work *w, const atomic_bool *stop,
                      struct find *out)
{
    struct finder *f;
    struct extent core;
    enum status st;

    memset(out, 0, sizeof *out);
    if (n == 0)
        return ST_ENOFACE;
    if ((f = mem_array(1, sizeof *f)) == NULL)
        return ST_ENOMEM;
    f->pts = pts;
    f->n = n;
    f->unit_mm = unit_mm;
    f->targets = 0;
    f->voxels = 0;
    find_search_begin(face_work_mean(w), stop, &f->s);
    measure_extent(pts, n, FIND_STRAY_IN, &f->extent);
    st = search_all(f);
    measure_extent(pts, n, FIND_STRAYS_IN, &core);
    if (st == ST_OK && !find_search_likely(&f->s) && core.size < f->extent.size / 2) {
        f->extent = core; /* there are many strays */
        st = search_all(f);
    }
    if (st == ST_OK && f->s.best.n == 0)
        st = ST_ENOFACE;
    if (st == ST_OK)
        choose(&f->s.best, out);
    mem_free(f);
    return st;
}
