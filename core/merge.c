/* merge.c -- b's points are inserted into a copy of a's triangulation along b's spanning
 * tree, each from the triangle in which it was located, and the circles are repaired by
 * flips (Lawson).  Mestetskiy and Tsarik trace the seams between two unseparated
 * triangulations instead.  Where two scans of one face overlap, three quarters of all
 * triangles lie on a seam; insertion costs no more and has a valid triangulation after every
 * step.  Insertion alone would be quadratic on contrived input, so the work is counted, and
 * beyond a multiple of the points the union is triangulated from scratch.  The Delaunay
 * triangulation is unique (predicates.h), so both ways give the same. */
#include "merge.h"

#include <stdbool.h>
#include <string.h>

#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "numbered.h"
#include "predicates.h"
#include "tuning.h"

struct grower {
    struct mesh *m;
    uint32_t ghost; /* the ghost's number while vertices are added */
    uint64_t work;  /* steps and flips so far */
    uint64_t limit; /* of work */
};

/* Where the new point q lies: *he becomes a half-edge of the triangle that contains it (a
 * ghost triangle when q is outside the hull), the edge itself if *on_edge.  A visibility
 * walk from *he, which can go round in circles where a is not Delaunay.  False when the
 * work has reached its limit. */
static bool find(struct grower *g, uint32_t *he, struct ivec2 q, bool *on_edge)
{
    const struct mesh *m = g->m;
    const struct ivec2 *xy = m->xy;
    const uint32_t *org = m->org;
    uint32_t h = *he;
    int64_t s, sn, sp;

    /* From a ghost triangle look inwards, through its finite edge. */
    while (org[h] == g->ghost || mesh_dest(m, h) == g->ghost)
        h = mesh_next(h);
    if (org[mesh_prev(h)] == g->ghost)
        h = m->twin[h];
    s = orient2d(xy[org[h]], xy[mesh_dest(m, h)], q);
    if (s < 0)
        h = m->twin[h];
    *on_edge = true;
    while (g->work <= g->limit) {
        const uint32_t n = mesh_next(h), p = mesh_prev(h);

        if (org[p] == g->ghost) { /* strictly outside this hull edge */
            *he = h;
            *on_edge = false;
            return true;
        }
        sn = orient2d(xy[org[n]], xy[org[p]], q);
        sp = orient2d(xy[org[p]], xy[org[h]], q);
        if (sn >= 0 && sp >= 0) {
            *he = sn == 0 ? n : sp == 0 ? p : h;
            *on_edge = sn == 0 || sp == 0 || s == 0;
            return true;
        }
        h = m->twin[sn < 0 ? n : p];
        s = 1;
        g->work++;
    }
    return false;
}

static inline void link(struct mesh *m, uint32_t a, uint32_t b)
{
    m->twin[a] = b;
    m->twin[b] = a;
}

/* Cut the triangle of h in three at vertex q; h keeps its place.  Afterwards the three
 * edges that face q are h, and the next and previous edges' new places. */
static void split(struct mesh *m, uint32_t h, uint32_t q)
{
    const uint32_t n = mesh_next(h), p = mesh_prev(h);
    const uint32_t a = m->org[h], b = m->org[n], c = m->org[p];
    const uint32_t bc = 3 * m->nt, ca = bc + 3;

    m->org[bc] = b; /* triangle b c q */
    m->org[bc + 1] = c;
    m->org[bc + 2] = q;
    m->org[ca] = c; /* triangle c a q */
    m->org[ca + 1] = a;
    m->org[ca + 2] = q;
    m->org[p] = q; /* triangle a b q stays where abc was */
    link(m, bc, m->twin[n]);
    link(m, ca, m->twin[p]);
    link(m, n, bc + 2);
    link(m, bc + 1, ca + 2);
    link(m, ca + 1, p);
    m->out[a] = h;
    m->out[b] = bc;
    m->out[c] = ca;
    m->out[q] = p;
    m->nt += 2;
}

/* The triangle of h = x -> y has its third corner q; swap xy for the edge from q to w, the
 * corner across it.  h becomes x -> w and keeps q as its third corner. */
static inline void flip(struct mesh *m, uint32_t h)
{
    const uint32_t f = m->twin[h];
    const uint32_t hn = mesh_next(h), fn = mesh_next(f);
    const uint32_t xw = m->twin[fn], yq = m->twin[hn];

    m->out[m->org[h]] = h;
    m->out[m->org[f]] = f;
    m->org[hn] = m->org[mesh_prev(f)];
    m->org[fn] = m->org[mesh_prev(h)];
    link(m, h, xw);
    link(m, f, yq);
    link(m, hn, fn);
}

/* Must the edge h = x -> y, which faces the new vertex at q, be flipped? */
static inline bool must_flip(const struct grower *g, uint32_t h, struct ivec2 q)
{
    const struct mesh *m = g->m;
    const struct ivec2 *xy = m->xy;
    const uint32_t x = m->org[h], y = mesh_dest(m, h);
    const uint32_t w = m->org[mesh_prev(m->twin[h])];

    if (w == g->ghost)
        return false;
    if (x == g->ghost)
        return orient2d(xy[w], xy[y], q) > 0;
    if (y == g->ghost)
        return orient2d(xy[x], xy[w], q) > 0;
    return incircle(xy[x], xy[y], q, xy[w]);
}

static void insert(struct grower *g, uint32_t he, bool on_edge, uint32_t v,
                   struct ivec2 q)
{
    struct mesh *m = g->m;
    uint32_t h = he, stop;

    split(m, h, v);
    if (on_edge) { /* the triangle over h is flat */
        flip(m, h);
        g->work++;
    }
    /* Go round v once; `stop` ends the last of the edges that face it. */
    stop = m->org[h];
    for (;;) {
        if (must_flip(g, h, q)) {
            flip(m, h);
            g->work++;
            continue;
        }
        if (mesh_dest(m, h) == stop)
            break;
        h = mesh_next(m->twin[mesh_next(h)]);
    }
}

/* Give the ghost its final number. */
static void name_ghost(struct mesh *m, uint32_t from, uint32_t to)
{
    const uint32_t first = m->out[from];
    uint32_t h = first;

    do {
        m->org[h] = to;
        h = mesh_turn(m, h);
    } while (h != first);
    m->out[to] = first;
}

/* Insert all of b; false when it took too much work. */
static bool grow(struct mesh *m, const struct mesh *a, const struct mesh *b,
                 const struct location *b_in_a, uint32_t *b_vertex)
{
    const uint32_t ghost = a->nv + b->nv;
    struct grower g = {m, ghost, 0, (uint64_t)MERGE_WORK * ghost};

    name_ghost(m, a->nv, g.ghost);
    for (uint32_t v = 0; v < b->nv; v++) {
        const struct ivec2 q = b->xy[v];
        uint32_t he = b_in_a[v].he;
        bool on_edge;

        if (b_in_a[v].where == LOCATE_VERTEX) {
            b_vertex[v] = a->org[he];
            continue;
        }
        if (!find(&g, &he, q, &on_edge))
            return false;
        b_vertex[v] = m->nv;
        m->xy[m->nv] = q;
        m->z[m->nv] = b->z[v];
        insert(&g, he, on_edge, m->nv++, q);
    }
    if (m->nv != g.ghost)
        name_ghost(m, g.ghost, m->nv);
    return true;
}

/* Triangulate the union from scratch, with the vertex numbers that grow() would give. */
static enum status rebuild(struct mesh *m, const struct mesh *a, const struct mesh *b,
                           const struct location *b_in_a, struct scratch *s,
                           uint32_t *b_vertex)
{
    const size_t n = (size_t)a->nv + b->nv;
    struct ivec3 *pts = mem_array(2 * n, sizeof *pts);
    uint32_t k = 0;
    enum status st;

    if (pts == NULL)
        return ST_ENOMEM;
    for (; k < a->nv; k++)
        pts[k] = (struct ivec3){a->xy[k].x, a->xy[k].y, a->z[k]};
    for (uint32_t v = 0; v < b->nv; v++) {
        if (b_in_a[v].where == LOCATE_VERTEX) {
            b_vertex[v] = a->org[b_in_a[v].he];
        } else {
            b_vertex[v] = k;
            pts[k++] = (struct ivec3){b->xy[v].x, b->xy[v].y, b->z[v]};
        }
    }
    st = numbered_build(pts, k, s, m);
    mem_free(pts);
    return st;
}

enum status merge_build(const struct mesh *a, const struct mesh *b,
                        const struct location *b_in_a, struct scratch *s,
                        struct mesh *out, uint32_t *b_vertex)
{
    enum status st = mesh_copy(out, a, b->nv);

    if (st == ST_OK && !grow(out, a, b, b_in_a, b_vertex))
        st = rebuild(out, a, b, b_in_a, s, b_vertex);
    if (st != ST_OK)
        out->nv = out->nt = 0;
    return st;
}
