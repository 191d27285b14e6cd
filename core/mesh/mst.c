#include "mst.h"

#include <stdbool.h>
#include <string.h>

#include "mem.h"
#include "mesh.h"
#include "predicates.h"

#define EDGES_PER_TREE 4 /* a simple planar graph has fewer than 3 */

/* An edge of the graph whose vertices are the trees found so far. */
struct edge {
    uint64_t len;  /* squared length, exact */
    uint32_t a, b; /* the end points, vertices of the mesh */
    uint32_t u, v; /* the trees they belong to */
};

/* The shortest edge out of a tree. */
struct best {
    uint64_t len;
    uint32_t e;
};

struct link {
    uint32_t a, b;
};

struct forest {
    const struct ivec2 *xy;
    uint32_t trees, ne, nlinks;
    struct edge *edge;   /* [2 nv] the edges between different trees */
    struct edge *sorted; /* [3 nv / 2] the same, grouped by u */
    struct best *best;   /* [nv] */
    uint32_t *next;      /* [nv] the tree at the other end of best, then its number */
    uint32_t *mark;      /* [nv + 1] */
    struct link *link;   /* [nv] edges of the spanning tree */
};

/* f's arrays in block for n vertices; returns the bytes needed. */
static size_t mst_layout(struct forest *f, size_t n, unsigned char *block)
{
    size_t at = 0;

    f->edge = mem_take(block, &at, 2 * n, sizeof *f->edge);
    f->sorted = mem_take(block, &at, n + n / 2, sizeof *f->sorted);
    f->best = mem_take(block, &at, n, sizeof *f->best);
    f->next = mem_take(block, &at, n, sizeof *f->next);
    f->mark = mem_take(block, &at, n + 1, sizeof *f->mark);
    f->link = mem_take(block, &at, n, sizeof *f->link);
    return at;
}

static inline uint64_t length2(struct ivec2 a, struct ivec2 b)
{
    const int64_t dx = b.x - a.x, dy = b.y - a.y;

    return (uint64_t)(dx * dx + dy * dy);
}

/* For edges of equal length: the one whose first end point comes first, then the other's
 * (points by x, then y). */
static bool tie_less(const struct ivec2 *xy, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d)
{
    const struct ivec2 ab0 = lex_less(xy[b], xy[a]) ? xy[b] : xy[a];
    const struct ivec2 ab1 = lex_less(xy[b], xy[a]) ? xy[a] : xy[b];
    const struct ivec2 cd0 = lex_less(xy[d], xy[c]) ? xy[d] : xy[c];
    const struct ivec2 cd1 = lex_less(xy[d], xy[c]) ? xy[c] : xy[d];

    if (ab0.x != cd0.x || ab0.y != cd0.y)
        return lex_less(ab0, cd0);
    return lex_less(ab1, cd1);
}

static inline bool edge_less(const struct ivec2 *xy, const struct edge *e,
                             const struct edge *f)
{
    if (__builtin_expect(e->len == f->len, 0))
        return tie_less(xy, e->a, e->b, f->a, f->b);
    return e->len < f->len;
}

/* Which side of the triangle v[0] v[1] v[2] is the longest, when two are equally long:
 * side i runs from v[i] to v[i + 1]. */
static uint32_t longest_tie(const struct ivec2 *xy, const uint32_t v[3],
                            const uint64_t len[3])
{
    uint32_t k = 0;

    for (uint32_t i = 1; i < 3; i++)
        if (len[i] > len[k] || (len[i] == len[k] &&
                                tie_less(xy, v[k], v[(k + 1) % 3], v[i], v[(i + 1) % 3])))
            k = i;
    return k;
}

/* The first clean-up: the longest side of a triangle is in no minimum spanning tree, for
 * the other two join its ends.  Returns how many edges of the graph are left, fewer than
 * 2 nv, a half-edge of each in kept[].  dead[h]: the triangle of h drops h. */
static uint32_t thin_out(const struct mesh *m, uint8_t *dead, uint32_t *kept)
{
    const struct ivec2 *const xy = m->xy;
    uint32_t n = 0;

    memset(dead, 0, 3 * (size_t)m->nt);
    for (uint32_t h = 0; h < 3 * m->nt; h += 3) {
        const uint32_t *const v = &m->org[h], *const twin = &m->twin[h];
        uint64_t len[3];
        uint32_t k, beyond;

        if (v[0] == m->nv || v[1] == m->nv || v[2] == m->nv) {
            /* A ghost drops the two edges that are none. */
            const uint32_t i = v[0] == m->nv ? 1 : v[1] == m->nv ? 2 : 0;

            memset(&dead[h], 1, 3);
            dead[h + i] = 0;
            kept[n] = h + i;
            n += twin[i] < h && !dead[twin[i]];
            continue;
        }
        len[0] = length2(xy[v[0]], xy[v[1]]);
        len[1] = length2(xy[v[1]], xy[v[2]]);
        len[2] = length2(xy[v[2]], xy[v[0]]);
        /* Which side is longest is as good as random: no branch. */
        k = len[1] > len[0];
        beyond = (len[2] > len[0]) & (len[2] > len[1]);
        k = (k & (beyond - 1)) | beyond << 1;
        if ((len[0] == len[1]) | (len[1] == len[2]) | (len[2] == len[0]))
            k = longest_tie(xy, v, len);
        dead[h + k] = 1;
        for (uint32_t i = 0; i < 3; i++) { /* an edge is taken on its second visit */
            kept[n] = h + i;
            n += (twin[i] < h) & (i != k) & !dead[twin[i]];
        }
    }
    return n;
}

/* What is left of the Delaunay graph, each vertex a tree of its own. */
static void mst_collect(struct forest *f, const struct mesh *m)
{
    uint32_t *const kept = (uint32_t *)(void *)f->sorted; /* 14 bytes a point, of 36 */
    const uint32_t n = thin_out(m, (uint8_t *)(kept + 2 * (size_t)m->nv), kept);

    for (uint32_t e = 0; e < n; e++) {
        const uint32_t a = m->org[kept[e]], b = mesh_dest(m, kept[e]);

        f->edge[e] = (struct edge){length2(m->xy[a], m->xy[b]), a, b, a, b};
    }
    f->ne = n;
}

static inline void offer(const struct forest *f, uint32_t tree, uint32_t e)
{
    struct best *const best = &f->best[tree];
    const uint64_t len = f->edge[e].len, less = -(uint64_t)(len < best->len);

    if (__builtin_expect(len == best->len, 0)) {
        if (edge_less(f->xy, &f->edge[e], &f->edge[best->e]))
            best->e = e;
        return;
    }
    best->e ^= (best->e ^ e) & (uint32_t)less; /* less is all ones or zero: no branch */
    best->len ^= (best->len ^ len) & less;
}

/* Every tree takes its shortest outgoing edge; then next[tree] is the number of the new
 * tree that it belongs to. */
static void mst_join(struct forest *f)
{
    const uint32_t trees = f->trees;
    uint32_t *const next = f->next, *const number = f->mark;
    uint32_t n = 0;

    for (uint32_t t = 0; t < trees; t++)
        f->best[t] = (struct best){UINT64_MAX, 0};
    for (uint32_t e = 0; e < f->ne; e++) {
        offer(f, f->edge[e].u, e);
        offer(f, f->edge[e].v, e);
    }
    /* Along next[] the edges get shorter, so that the only rings are of two trees that
     * took the same edge; the first of the two is the root. */
    for (uint32_t t = 0; t < trees; t++) {
        const struct edge *const e = &f->edge[f->best[t].e];
        const uint32_t other = e->u ^ e->v ^ t;
        const bool mutual = f->best[other].e == f->best[t].e;
        const bool root = mutual & (t < other);

        next[t] = other ^ ((other ^ t) & -(uint32_t)root);
        f->link[f->nlinks] = (struct link){e->a, e->b};
        f->nlinks += !(mutual & (t > other));
    }
    for (uint32_t t = 0; t < trees; t++) /* shortens most ways to two steps */
        next[t] = next[next[t]];
    for (uint32_t t = 0; t < trees; t++) {
        uint32_t root = next[t];

        while (next[root] != root)
            root = next[root];
        for (uint32_t s = t; s != root;) {
            const uint32_t up = next[s];

            next[s] = root;
            s = up;
        }
    }
    for (uint32_t t = 0; t < trees; t++) {
        number[t] = n;
        n += next[t] == t;
    }
    for (uint32_t t = 0; t < trees; t++)
        next[t] = number[next[t]];
    f->trees = n;
}

/* Of parallel edges keep the shortest: f->edge is then simple, fewer than 3 edges a tree,
 * as the graph is planar. */
static void drop_parallels(struct forest *f)
{
    uint32_t *const mark = f->mark;
    struct edge *const edge = f->edge, *const sorted = f->sorted;
    const uint32_t n = f->ne;
    uint32_t sum = 0, first = 0;

    memset(mark, 0, f->trees * sizeof *mark);
    for (uint32_t e = 0; e < n; e++)
        mark[edge[e].u]++;
    for (uint32_t t = 0; t < f->trees; t++) {
        const uint32_t count = mark[t];

        mark[t] = sum;
        sum += count;
    }
    for (uint32_t e = 0; e < n; e++)
        sorted[mark[edge[e].u]++] = edge[e];
    /* mark[v] is now the place of the edge kept from the group's u to v. */
    memset(mark, 0xff, f->trees * sizeof *mark);
    f->ne = 0;
    for (uint32_t e = 0; e < n; e++) {
        uint32_t place;

        if (e > 0 && sorted[e].u != sorted[e - 1].u)
            first = f->ne;
        place = mark[sorted[e].v];
        if (place - first >= f->ne - first) { /* none in this group */
            mark[sorted[e].v] = f->ne;
            edge[f->ne++] = sorted[e];
        } else if (edge_less(f->xy, &sorted[e], &edge[place])) {
            edge[place] = sorted[e];
        }
    }
}

/* The clean-up: contract the trees and drop the edges inside a tree; drop parallel edges
 * as soon as there are more than a few edges to a tree, so that a stage costs no more than
 * a fixed time a tree. */
static void clean_up(struct forest *f)
{
    struct edge *const edge = f->edge;
    uint32_t n = 0;

    for (uint32_t e = 0; e < f->ne; e++) {
        const uint32_t u = f->next[edge[e].u], v = f->next[edge[e].v];

        edge[n] = edge[e];
        edge[n].u = u < v ? u : v;
        edge[n].v = u < v ? v : u;
        n += u != v;
    }
    f->ne = n;
    if (n / EDGES_PER_TREE > f->trees)
        drop_parallels(f);
}

/* The tree as lists of neighbours, and what the walk over it makes. */
struct mst_walk {
    uint32_t *first;  /* [nv + 1] where a vertex's neighbours begin in near */
    uint32_t *near;   /* [2 nv - 2] */
    uint32_t *stack;  /* [nv] vertices to visit */
    uint32_t *above;  /* [nv] the vertex before it on the walk: its parent */
    uint32_t *number; /* [nv + 1] the new number of a vertex */
    struct ivec2 *xy; /* [nv] in new order, as z, out and parent */
    int32_t *z;
    uint32_t *out, *parent;
};

/* The walk's arrays lie where the edges were: 2 nv * 24 bytes for 44 nv + 8. */
static void walk_layout(struct mst_walk *w, size_t n, unsigned char *block)
{
    w->xy = (struct ivec2 *)(void *)block;
    w->first = (uint32_t *)(void *)(w->xy + n);
    w->near = w->first + n + 1;
    w->stack = w->near + 2 * n;
    w->above = w->stack + n;
    w->number = w->above + n;
    w->z = (int32_t *)(w->number + n + 1);
    w->out = (uint32_t *)(w->z + n);
    w->parent = w->out + n;
}

static void neighbours(struct mst_walk *w, const struct forest *f, uint32_t nv)
{
    uint32_t sum = 0;

    memset(w->first, 0, (nv + 1) * sizeof *w->first);
    for (uint32_t i = 0; i + 1 < nv; i++) {
        w->first[f->link[i].a]++;
        w->first[f->link[i].b]++;
    }
    for (uint32_t v = 0; v <= nv; v++) {
        sum += w->first[v];
        w->first[v] = sum; /* the end; moves down to the beginning as near fills */
    }
    for (uint32_t i = 0; i + 1 < nv; i++) {
        w->near[--w->first[f->link[i].a]] = f->link[i].b;
        w->near[--w->first[f->link[i].b]] = f->link[i].a;
    }
}

/* Number the vertices in the order of a depth-first walk from root; the neighbours of a
 * vertex are visited in the order of their coordinates. */
static void visit(struct mst_walk *w, const struct mesh *m, uint32_t root)
{
    const struct ivec2 *const xy = m->xy;
    uint32_t top = 1, n = 0;

    w->stack[0] = root;
    w->above[root] = root;
    while (top > 0) {
        const uint32_t v = w->stack[--top], base = top, up = w->above[v], self = n++;

        w->number[v] = self;
        w->xy[self] = xy[v];
        w->z[self] = m->z[v];
        w->out[self] = m->out[v];
        w->parent[self] = w->number[up];
        for (uint32_t i = w->first[v]; i < w->first[v + 1]; i++) {
            const uint32_t c = w->near[i];
            uint32_t j = top;

            if (c == up)
                continue;
            for (; j > base && lex_less(xy[w->stack[j - 1]], xy[c]); j--)
                w->stack[j] = w->stack[j - 1];
            w->stack[j] = c;
            w->above[c] = v;
            top++;
        }
    }
}

enum status mst_build(struct mesh *m, struct scratch *s)
{
    const uint32_t nv = m->nv;
    struct forest f = {.xy = m->xy, .trees = nv};
    unsigned char *block = scratch_need(s, mst_layout(&f, nv, NULL));
    struct mst_walk w;
    uint32_t root = 0;

    if (block == NULL)
        return ST_ENOMEM;
    (void)mst_layout(&f, nv, block);
    mst_collect(&f, m);
    mst_join(&f);
    while (f.trees > 1) {
        clean_up(&f);
        mst_join(&f);
    }
    walk_layout(&w, nv, block);
    neighbours(&w, &f, nv);
    for (uint32_t v = 1; v < nv; v++)
        if (lex_less(m->xy[v], m->xy[root]))
            root = v;
    visit(&w, m, root);
    w.number[nv] = nv;
    memcpy(m->xy, w.xy, nv * sizeof *m->xy);
    memcpy(m->z, w.z, nv * sizeof *m->z);
    memcpy(m->out, w.out, nv * sizeof *m->out);
    memcpy(m->parent, w.parent, nv * sizeof *m->parent);
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        m->org[h] = w.number[m->org[h]];
    return ST_OK;
}

/* Of every edge ab of the mesh, no edge of the tree's way from a to b may come after it. */
static bool cycle_holds(const struct mesh *m, uint32_t a, uint32_t b)
{
    const uint64_t len = length2(m->xy[a], m->xy[b]);

    for (uint32_t u = a, v = b; u != v;) {
        const uint32_t low = u > v ? u : v, up = m->parent[low];
        const uint64_t step = length2(m->xy[low], m->xy[up]);

        if (step > len || (step == len && tie_less(m->xy, a, b, low, up)))
            return false;
        *(u > v ? &u : &v) = up;
    }
    return true;
}

enum status mst_check(const struct mesh *m)
{
    if (m->parent[0] != 0)
        return ST_ECORRUPT;
    for (uint32_t v = 1; v < m->nv; v++)
        if (m->parent[v] >= v)
            return ST_ECORRUPT;
    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t a = m->org[h], b = mesh_dest(m, h);

        if (a < b && b < m->nv && !cycle_holds(m, a, b))
            return ST_ECORRUPT;
    }
    return ST_OK;
}
