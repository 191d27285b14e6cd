#include "delaunay.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "arm.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"
#include "strips.h"

#define NONE UINT32_MAX

/* A directed edge; the other direction of e is e ^ 1.  next and prev are the neighbours in
 * the counter-clockwise ring of edges out of the same vertex. */
struct edge {
    uint32_t dst, next, prev;
};

struct builder {
    const struct ivec2 *xy;
    struct edge *edges;
    uint32_t *hull; /* [v] for v on the hull: its edge to the next vertex of the hull,
                         counter-clockwise; outdated elsewhere */
    uint32_t count; /* directed edges handed out so far */
    /* head of the list of deleted edge pairs, linked by next; or NONE */
    uint32_t deleted;
};

/* new_edge(b, from, to): an edge from -> to that is in no ring yet. */
static inline uint32_t new_edge(struct builder *b, uint32_t from, uint32_t to)
{
    uint32_t e = b->deleted;

    if (e != NONE) {
        b->deleted = b->edges[e].next;
    } else {
        e = b->count;
        b->count += 2;
    }
    b->edges[e].dst = to;
    b->edges[e ^ 1].dst = from;
    return e;
}

/* Put e into the ring right after `at`. */
static inline void ring_insert(struct edge *edges, uint32_t at, uint32_t e)
{
    const uint32_t after = edges[at].next;

    edges[e].next = after;
    edges[e].prev = at;
    edges[at].next = e;
    edges[after].prev = e;
}

static inline void ring_remove(struct edge *edges, uint32_t e)
{
    const uint32_t next = edges[e].next, prev = edges[e].prev;

    edges[prev].next = next;
    edges[next].prev = prev;
}

static inline void delete_edge(struct builder *b, uint32_t e)
{
    e &= ~UINT32_C(1);
    ring_remove(b->edges, e);
    ring_remove(b->edges, e ^ 1);
    b->edges[e].dst = b->edges[e ^ 1].dst = NONE;
    b->edges[e].next = b->deleted;
    b->deleted = e;
}

/* The triangulation of two points: one edge. */
static void build_two(struct builder *b, uint32_t v)
{
    const uint32_t e = new_edge(b, v, v + 1);

    b->edges[e].next = b->edges[e].prev = e;
    b->edges[e ^ 1].next = b->edges[e ^ 1].prev = e ^ 1;
    b->hull[v] = e;
    b->hull[v + 1] = e ^ 1;
}

/* Three points: a triangle, or two edges where they lie on one line.  The middle one of
 * three on a line needs no hull edge: merging starts at ends only. */
static void build_three(struct builder *b, uint32_t v)
{
    const int64_t turn = orient2d(b->xy[v], b->xy[v + 1], b->xy[v + 2]);
    struct edge *edges = b->edges;
    uint32_t e, f, g;

    build_two(b, v);
    e = b->hull[v];
    f = new_edge(b, v + 1, v + 2);
    ring_insert(edges, e ^ 1, f);
    edges[f ^ 1].next = edges[f ^ 1].prev = f ^ 1;
    b->hull[v + 2] = f ^ 1;
    if (turn == 0)
        return;
    g = new_edge(b, v + 2, v);
    ring_insert(edges, f ^ 1, g);
    ring_insert(edges, e, g ^ 1);
    if (turn > 0) {
        b->hull[v + 1] = f;
        b->hull[v + 2] = g;
    } else {
        b->hull[v] = g ^ 1;
        b->hull[v + 1] = e ^ 1;
    }
}

/* The lower common tangent of two triangulations separated by a line, from the left's
 * vertex *l and the right's vertex *r nearest to that line (each extreme in the direction
 * across it).  The hull edges before which they stand are found by hull[]: the previous
 * edge in the ring leads clockwise round the hull. */
static void lower_tangent(const struct builder *b, uint32_t *l, uint32_t *r,
                          uint32_t *l_cw, uint32_t *r_ccw)
{
    const struct edge *edges = b->edges;
    const struct ivec2 *xy = b->xy;
    uint32_t el = edges[b->hull[*l]].prev; /* clockwise along the left hull */
    uint32_t er = b->hull[*r];             /* counter-clockwise along the right one */

    for (;;) {
        if (orient2d(xy[*l], xy[edges[el].dst], xy[*r]) > 0) {
            *l = edges[el].dst;
            el = edges[el ^ 1].prev;
        } else if (orient2d(xy[*r], xy[edges[er].dst], xy[*l]) < 0) {
            *r = edges[er].dst;
            er = edges[er ^ 1].next;
        } else {
            break;
        }
    }
    *l_cw = el;
    *r_ccw = er;
}

/* The edge between the two sides that rises, from r to l, with r seen from l. */
struct base {
    uint32_t l, r;
    struct arm r_arm;
};

/* A vertex above the base, at the end of edge e out of l or of r, seen from l; cross is twice
 * the area of the triangle l r v. */
struct candidate {
    uint32_t e, v;
    struct arm arm;
    int64_t cross;
};

/* Does the circle through l, r and c hold d?  cd and dr are cross products of their arms. */
static inline bool circle_holds(const struct builder *b, const struct base *base,
                                const struct candidate *c, const struct candidate *d,
                                int64_t cd, int64_t dr)
{
    const int64_t det = arm_incircle(&base->r_arm, &c->arm, &d->arm, c->cross, cd, dr);
    const struct ivec2 *xy = b->xy;

    if (__builtin_expect(det == 0, 0))
        return incircle(xy[base->l], xy[base->r], xy[c->v], xy[d->v]);
    return det < 0;
}

static inline struct candidate candidate(const struct builder *b, const struct base *base,
                                         uint32_t e)
{
    struct candidate c = {.e = e, .v = b->edges[e].dst};

    c.arm = arm_to(b->xy[base->l], b->xy[c.v]);
    c.cross = arm_cross(&base->r_arm, &c.arm);
    return c;
}

/* The first candidate of a side, from edge e on, the circle of which does not hold the next:
 * the edges to the others are deleted.  Its cross is not above 0 where there is none. */
static inline struct candidate delaunay_choose(struct builder *b, const struct base *base,
                                               uint32_t e, bool left)
{
    struct candidate c = candidate(b, base, e);

    while (c.cross > 0) {
        const struct edge *ring = &b->edges[c.e];
        const struct candidate d = candidate(b, base, left ? ring->next : ring->prev);

        if (!circle_holds(b, base, &c, &d, arm_cross(&c.arm, &d.arm), -d.cross))
            break;
        delete_edge(b, c.e);
        c = d;
    }
    return c;
}

/* Merge the triangulations of two sets separated by a line, the left one seen across it
 * first; l and r as in lower_tangent().  Guibas and Stolfi's rising bubble: base is the
 * highest edge between the two sides so far, from right to left. */
static void merge(struct builder *b, uint32_t l, uint32_t r)
{
    struct edge *edges = b->edges;
    uint32_t base, el, er;

    lower_tangent(b, &l, &r, &el, &er);
    base = new_edge(b, r, l);
    /* On the left the outer face lies between el and the next edge of the ring, on the
     * right between the one before er and er: that is where the tangent goes. */
    ring_insert(edges, el, base ^ 1);
    ring_insert(edges, edges[er].prev, base);
    b->hull[l] = base ^ 1;

    for (;;) {
        const struct base now = {l, r, arm_to(b->xy[l], b->xy[r])};
        const struct candidate lc = delaunay_choose(b, &now, edges[base ^ 1].next, true);
        const struct candidate rc = delaunay_choose(b, &now, edges[base].prev, false);
        uint32_t up;

        if (lc.cross <= 0 && rc.cross <= 0)
            break;
        if (lc.cross <= 0 ||
            (rc.cross > 0 &&
             circle_holds(b, &now, &lc, &rc, arm_cross(&lc.arm, &rc.arm), -rc.cross))) {
            up = new_edge(b, rc.v, l);
            ring_insert(edges, base ^ 1, up ^ 1);
            ring_insert(edges, edges[rc.e ^ 1].prev, up);
            r = rc.v;
        } else {
            up = new_edge(b, r, lc.v);
            ring_insert(edges, edges[base].prev, up);
            ring_insert(edges, lc.e ^ 1, up ^ 1);
            l = lc.v;
        }
        base = up;
    }
    b->hull[r] = base;
}

/* Triangulate the points [first, end) of one strip, sorted by y, then x. */
static void build_rows(struct builder *b, uint32_t first, uint32_t end)
{
    const uint32_t n = end - first, mid = first + n / 2;

    if (n == 2) {
        build_two(b, first);
    } else if (n == 3) {
        build_three(b, first);
    } else {
        build_rows(b, first, mid);
        build_rows(b, mid, end);
        merge(b, mid - 1, mid);
    }
}

static void build_strips(struct builder *b, const struct strips *st, uint32_t first,
                         uint32_t end)
{
    const uint32_t mid = first + (end - first) / 2;

    if (end - first == 1) {
        build_rows(b, st->at[first].first, st->at[first + 1].first);
    } else {
        build_strips(b, st, first, mid);
        build_strips(b, st, mid, end);
        merge(b, st->at[mid - 1].hi, st->at[mid].lo);
    }
}

/* Number the triangles and write the mesh: the ghosts, round the hull clockwise, then each
 * triangle behind the first half-edge that it shares with one before it.  half[e] becomes the
 * half-edge of the directed edge e; twin[] is its inverse until the other side is known. */
static void emit(const struct builder *b, uint32_t hull_vertex, uint32_t *half,
                 struct mesh *m)
{
    const struct edge *edges = b->edges;
    const uint32_t outer = b->hull[hull_vertex] ^ 1;
    uint32_t *const org = m->org, *const twin = m->twin, *const out = m->out;
    uint32_t h = 0, e = outer, ghosts;

    memset(half, 0xff, b->count * sizeof *half);
    out[m->nv] = 2;
    do {
        const uint32_t next = edges[e ^ 1].prev;

        half[e] = h;
        org[h] = edges[e ^ 1].dst;
        org[h + 1] = edges[e].dst;
        org[h + 2] = m->nv;
        twin[h] = e;
        twin[h + 1] = next == outer ? 2 : h + 5;
        twin[h + 2] = h == 0 ? NONE : h - 2;
        e = next;
        h += 3;
    } while (e != outer);
    twin[2] = h - 2;

    ghosts = h;
    for (uint32_t i = 0; i < h; i += i < ghosts ? 3 : 1) {
        e = twin[i] ^ 1;
        if (half[e] == NONE) {
            const uint32_t f = edges[e ^ 1].prev, g = edges[f ^ 1].prev;

            half[e] = h;
            half[f] = h + 1;
            half[g] = h + 2;
            twin[h] = e;
            twin[h + 1] = f;
            twin[h + 2] = g;
            org[h] = edges[g].dst;
            org[h + 1] = edges[e].dst;
            org[h + 2] = edges[f].dst;
            out[edges[g].dst] = h;
            out[edges[e].dst] = h + 1;
            out[edges[f].dst] = h + 2;
            h += 3;
        }
        twin[i] = half[e];
    }
    m->nt = h / 3;
}

enum status delaunay_build(const struct ivec3 *pts, size_t n, struct scratch *s,
                           struct mesh *out)
{
    struct strips st;
    struct builder b = {.deleted = NONE};
    size_t edges, halves, sort;
    unsigned char *block;
    enum status status;

    out->nv = out->nt = 0;
    if (n > SURFACE_MAX_POINTS)
        return ST_ELIMIT;
    if (n < 3)
        return ST_EDEGENERATE;
    if ((status = mesh_reserve(out, (uint32_t)n)) != ST_OK)
        return status;

    /* At no time are there more than 3n - 6 edges: a deleted pair is used again. */
    edges = mem_round(6 * n * sizeof(struct edge));
    halves = mem_round(6 * n * sizeof(uint32_t));
    sort = strips_scratch(n);
    if ((block = scratch_need(s, edges + halves > sort ? edges + halves : sort)) == NULL)
        return ST_ENOMEM;
    if ((status = strips_sort(pts, n, block, &st, out->xy, out->z)) != ST_OK)
        return status;
    if (st.at[st.count].first < 3)
        return ST_EDEGENERATE;

    b.xy = out->xy;
    b.edges = (struct edge *)(void *)block;
    b.hull = out->out;
    build_strips(&b, &st, 0, st.count);
    /* A tree of edges means that all points lie on one line. */
    if (b.count == 2 * (st.at[st.count].first - 1))
        return ST_EDEGENERATE;
    out->nv = st.at[st.count].first;
    emit(&b, st.at[0].lo, (uint32_t *)(void *)(block + edges), out);
    return ST_OK;
}

/* ---- vertices numbered as the points are */

/* The points by row; in a row from left to right, in a place by number (z). */
static int by_row(const void *a, const void *b)
{
    const struct ivec3 *p = a, *q = b;

    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return (p->z > q->z) - (p->z < q->z);
}

/* Move each point to the first place right of its predecessor in the row, if it is not there
 * already. */
static void separate(struct ivec3 *pts, struct ivec3 *numbered, size_t n)
{
    qsort(numbered, n, sizeof *numbered, by_row);
    for (size_t i = 1; i < n; i++) {
        const struct ivec3 before = numbered[i - 1];
        struct ivec3 *p = &numbered[i];

        if (p->y == before.y && p->x <= before.x) {
            p->x = before.x + 1;
            pts[p->z].x = p->x;
        }
    }
}

/* The heights of m, a triangulation of n points, are their numbers. */
static void renumber(struct mesh *m, const struct ivec3 *pts)
{
    const uint32_t nv = m->nv;

    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t v = m->org[h];

        m->org[h] = v == nv ? nv : (uint32_t)m->z[v];
        m->out[m->org[h]] = h;
    }
    for (uint32_t v = 0; v < nv; v++) {
        m->xy[v] = (struct ivec2){pts[v].x, pts[v].y};
        m->z[v] = pts[v].z;
    }
}

enum status delaunay_numbered(struct ivec3 *pts, size_t n, struct scratch *s,
                              struct mesh *out)
{
    struct ivec3 *const numbered = pts + n;
    enum status st;

    /* A point that stands alone keeps its height: its number. */
    for (size_t i = 0; i < n; i++)
        numbered[i] = (struct ivec3){pts[i].x, pts[i].y, (int32_t)i};
    st = delaunay_build(numbered, n, s, out);
    if (st == ST_OK && out->nv < n) {
        separate(pts, numbered, n);
        st = delaunay_build(numbered, n, s, out);
    }
    if (st == ST_OK)
        renumber(out, pts);
    return st;
}
