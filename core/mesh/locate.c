#include "locate.h"

#include <math.h>
#include <stdbool.h>

#include "chains.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"

/* Steps per point, on average, before locate_mesh() locates the others by bisection.  Two
 * scans of a face need about 3; contrived input would need N. */
#define LOCATE_WORK 40

/* A walk along the segment from -> q.  It stands in one of three states:
 *   crossing  it leaves its triangle through the inside of the edge he;
 *   vertex    it has reached the vertex org[he], which lies on the segment before q;
 *   done      `at` holds the answer. */
struct locate_walk {
    const struct mesh *m;
    struct ivec2 from, q;
    uint32_t he;
    struct location at;
    const struct locate_trace *trace;
};

enum state { CROSSING, VERTEX, DONE };

static inline void enter(const struct locate_walk *w, uint32_t he)
{
    if (w->trace != NULL)
        w->trace->enter(w->trace->arg, he / 3);
}

static inline enum state done(struct locate_walk *w, uint32_t he, enum locate_where where)
{
    w->at.he = he;
    w->at.where = where;
    return DONE;
}

/* How far p lies ahead of o in the direction of d, as a dot product (< 2^52). */
static inline int64_t ahead(struct ivec2 o, struct ivec2 p, struct ivec2 d_from,
                            struct ivec2 d_to)
{
    return (int64_t)(p.x - o.x) * (d_to.x - d_from.x) +
           (int64_t)(p.y - o.y) * (d_to.y - d_from.y);
}

static inline int64_t side_of(const struct mesh *m, uint32_t he, struct ivec2 q)
{
    return orient2d(m->xy[m->org[he]], m->xy[mesh_dest(m, he)], q);
}

/* From a triangle left through the inside of the edge he, on to the next, and so on. */
static inline enum state cross(struct locate_walk *w)
{
    const struct mesh *m = w->m;

    for (;;) {
        const uint32_t h = m->twin[w->he], last = mesh_prev(h), c = m->org[last];
        int64_t side, beyond;

        if (c == m->nv)
            return done(w, w->he, LOCATE_OUTSIDE);
        enter(w, h);
        side = orient2d(w->from, w->q, m->xy[c]);
        if (side == 0) { /* the segment's line meets the corner c */
            beyond = ahead(m->xy[c], w->q, w->from, w->q);
            if (beyond < 0)
                return done(w, last, LOCATE_INSIDE);
            if (beyond == 0)
                return done(w, last, LOCATE_VERTEX);
            w->he = last;
            return VERTEX;
        }
        w->he = side > 0 ? mesh_next(h) : last;
        beyond = side_of(m, w->he, w->q);
        if (beyond >= 0)
            return done(w, w->he, beyond > 0 ? LOCATE_INSIDE : LOCATE_EDGE);
    }
}

/* The walk runs from a vertex along the edge he, whose triangle is real, to the vertex far
 * at its other end; g is the half-edge of that triangle that leaves far. */
static enum state along(struct locate_walk *w, uint32_t he, uint32_t g)
{
    const struct mesh *m = w->m;
    const int64_t beyond = ahead(m->xy[m->org[g]], w->q, w->from, w->q);

    enter(w, he);
    if (beyond < 0)
        return done(w, he, LOCATE_EDGE);
    if (beyond == 0)
        return done(w, g, LOCATE_VERTEX);
    w->he = g;
    return VERTEX;
}

/* At a vertex on the segment: turn about it to the triangle or edge that leads on. */
static enum state locate_turn(struct locate_walk *w)
{
    const struct mesh *m = w->m;
    const uint32_t first = w->he;
    const struct ivec2 o = m->xy[m->org[first]], q = w->q;
    uint32_t g = first, hull = first;

    do {
        const uint32_t b = mesh_dest(m, g), c = m->org[mesh_prev(g)];

        if (c == m->nv) { /* the ghost of the hull edge that ends here */
            hull = m->twin[g];
            if (orient2d(o, m->xy[b], q) == 0 && ahead(o, q, o, m->xy[b]) > 0)
                return along(w, hull, hull);
        } else if (b != m->nv && orient2d(o, m->xy[b], q) >= 0 &&
                   orient2d(o, m->xy[c], q) < 0) {
            const uint32_t e = mesh_next(g);
            int64_t beyond;

            if (orient2d(o, m->xy[b], q) == 0)
                return along(w, g, e);
            enter(w, g);
            beyond = side_of(m, e, q);
            if (beyond >= 0)
                return done(w, e, beyond > 0 ? LOCATE_INSIDE : LOCATE_EDGE);
            w->he = e;
            return CROSSING;
        }
        g = mesh_turn(m, g);
    } while (g != first);
    /* Past the hull: one of the two hull edges that meet here faces q. */
    if (side_of(m, hull, q) >= 0)
        hull = m->twin[mesh_prev(m->twin[mesh_prev(m->twin[hull])])]; /* the next one */
    return done(w, hull, LOCATE_OUTSIDE);
}

/* q lies in the closed triangle of he, at o[i] >= 0 from its edges. */
static enum state within(struct locate_walk *w, uint32_t he, const int64_t o[3])
{
    const uint32_t e1 = mesh_next(he), e2 = mesh_prev(he);

    if ((o[0] != 0) & (o[1] != 0) & (o[2] != 0))
        return done(w, he, LOCATE_INSIDE);
    if (o[0] == 0 && o[1] == 0)
        return done(w, e1, LOCATE_VERTEX);
    if (o[1] == 0 && o[2] == 0)
        return done(w, e2, LOCATE_VERTEX);
    if (o[2] == 0 && o[0] == 0)
        return done(w, he, LOCATE_VERTEX);
    return done(w, o[0] == 0 ? he : o[1] == 0 ? e1 : e2, LOCATE_EDGE);
}

/* The first step, out of the closed triangle of he, which contains `from`. */
static inline enum state locate_start(struct locate_walk *w, uint32_t he)
{
    const struct mesh *m = w->m;
    const uint32_t e[3] = {he, mesh_next(he), mesh_prev(he)};
    const struct ivec2 v[3] = {m->xy[m->org[e[0]]], m->xy[m->org[e[1]]],
                               m->xy[m->org[e[2]]]};
    const struct ivec2 from = w->from, q = w->q;
    const int64_t o[3] = {orient2d(v[0], v[1], q), orient2d(v[1], v[2], q),
                          orient2d(v[2], v[0], q)};
    int64_t s[3], far = -1;
    bool out0, out1, out2;

    enter(w, he);
    if ((o[0] | o[1] | o[2]) >= 0)
        return within(w, he, o);
    for (int i = 0; i < 3; i++)
        s[i] = orient2d(from, q, v[i]);
    /* Edge i is crossed if q lies beyond it and its ends on either side of the line. */
    out0 = (o[0] < 0) & (s[0] < 0) & (s[1] > 0);
    out1 = (o[1] < 0) & (s[1] < 0) & (s[2] > 0);
    out2 = (o[2] < 0) & (s[2] < 0) & (s[0] > 0);
    if (out0 | out1 | out2) {
        w->he = out1 ? e[1] : out2 ? e[2] : e[0];
        return CROSSING;
    }
    /* Else the triangle is left at a corner: the one farthest ahead on the line. */
    for (int i = 0; i < 3; i++) {
        const int64_t d = s[i] == 0 ? ahead(from, v[i], from, q) : -1;

        if (d > far) {
            far = d;
            w->he = e[i];
        }
    }
    return VERTEX;
}

struct location locate_point(const struct mesh *m, uint32_t he, struct ivec2 from,
                             struct ivec2 q, const struct locate_trace *trace)
{
    struct locate_walk w = {m, from, q, he, {he, LOCATE_OUTSIDE}, trace};
    enum state st = locate_start(&w, he);

    while (st != DONE)
        st = st == CROSSING ? cross(&w) : locate_turn(&w);
    return w.at;
}

/* Where q lies, without a walk.  Of q on an edge or a vertex it may give another triangle there. */
static struct location locate_find(const struct chains *c, struct ivec2 q)
{
    const struct mesh *m = c->m;
    struct locate_walk w = {.m = m};
    struct ivec2 v[3];
    uint32_t he;

    if (!chains_find(c, q, &he))
        return (struct location){he, LOCATE_OUTSIDE};
    for (uint32_t i = 0, h = he; i < 3; i++, h = mesh_next(h))
        v[i] = m->xy[m->org[h]];
    (void)within(&w, he,
                 (const int64_t[3]){orient2d(v[0], v[1], q), orient2d(v[1], v[2], q),
                                    orient2d(v[2], v[0], q)});
    return w.at;
}

/* Where q lies, from the triangle of he across any edge that q lies beyond: fewer tests than
 * straight.  Each step gets nearer where m is a Delaunay triangulation; elsewhere the way may be
 * a circle.  *left counts down the steps; false: there were no more. */
static inline bool nearby(const struct mesh *m, uint32_t he, struct ivec2 q,
                          uint64_t *left, struct location *loc)
{
    uint32_t t = he / 3;

    for (; *left > 0; --*left) {
        const uint32_t h = 3 * t, *v = &m->org[h], *twin = &m->twin[h];
        const struct ivec2 a = m->xy[v[0]], b = m->xy[v[1]], c = m->xy[v[2]];
        const int64_t o[3] = {orient2d(a, b, q), orient2d(b, c, q), orient2d(c, a, q)};
        uint32_t beyond;

        if (o[0] < 0) {
            beyond = 0;
            t = twin[0] / 3;
        } else if (o[1] < 0) {
            beyond = 1;
            t = twin[1] / 3;
        } else if (o[2] < 0) {
            beyond = 2;
            t = twin[2] / 3;
        } else {
            struct locate_walk w = {.m = m};

            (void)within(&w, h, o);
            *loc = w.at;
            return true;
        }
        if (mesh_is_ghost(m, t)) {
            *loc = (struct location){h + beyond, LOCATE_OUTSIDE};
            return true;
        }
    }
    return false;
}

enum status locate_mesh(const struct mesh *in, const struct mesh *pts,
                        struct location *loc)
{
    uint64_t left = (uint64_t)LOCATE_WORK * ((uint64_t)in->nv + pts->nv);
    uint32_t he = in->out[0], v;
    struct scratch scratch = {0};
    struct chains chains;
    enum status st;

    while (mesh_is_ghost(in, he / 3))
        he = mesh_turn(in, he);
    for (v = 0; v < pts->nv; v++) {
        if (v > 0)
            he = loc[pts->parent[v]].he;
        if (!nearby(in, he, pts->xy[v], &left, &loc[v]))
            break;
    }
    if (v == pts->nv)
        return ST_OK;
    st = chains_make(in, &scratch, &chains);
    for (; st == ST_OK && v < pts->nv; v++)
        loc[v] = locate_find(&chains, pts->xy[v]);
    scratch_free(&scratch);
    return st;
}

/* ---- heights */

/* Heights relative to the corner org[he], so that one formula serves the inside (three
 * weights), an edge (the third weight is an exact 0) and a vertex (two are 0).  Each weight
 * is twice the area opposite a corner, an integer below 2^53: exact. */
static inline double height(const struct mesh *m, struct location loc, struct ivec2 q)
{
    uint32_t a, b, c;
    int64_t wb, wc, area;

    if (loc.where == LOCATE_OUTSIDE)
        return NAN;
    a = m->org[loc.he];
    b = mesh_dest(m, loc.he);
    c = m->org[mesh_prev(loc.he)];
    wb = orient2d(m->xy[c], m->xy[a], q);
    wc = orient2d(m->xy[a], m->xy[b], q);
    area = orient2d(m->xy[a], m->xy[b], m->xy[c]);
    return m->z[a] + ((double)wb * ((double)m->z[b] - m->z[a]) +
                      (double)wc * ((double)m->z[c] - m->z[a])) /
                         (double)area;
}

double locate_height(const struct mesh *m, struct location loc, struct ivec2 q)
{
    return height(m, loc, q);
}

void locate_heights(const struct mesh *m, const struct mesh *pts,
                    const struct location *loc, double *out)
{
    for (uint32_t v = 0; v < pts->nv; v++)
        out[v] = height(m, loc[v], pts->xy[v]);
}
