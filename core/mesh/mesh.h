/* mesh.h -- a triangulated surface over the plane: points, triangulation, spanning tree.
 *
 * Half-edges.  Triangle t owns the half-edges 3t, 3t+1, 3t+2 in counter-clockwise order;
 * half-edge h runs from vertex org[h] to org[mesh_next(h)] with its triangle on the left;
 * twin[h] is the same edge seen from the other side.
 * The ghost.  A vertex at infinity, numbered nv, closes the surface to a sphere: across each
 * hull edge a -> b lies the ghost triangle with the half-edge b -> a and the corner nv.  So
 * every half-edge has a twin, every vertex has a full ring of triangles, and there are
 * always nt = 2 nv - 2 triangles, ghosts included.
 * The order of triangles.  First come the ghosts, clockwise round the hull, each with the
 * ghost vertex as third corner.  Each other triangle has its gate: the twin of its first
 * half-edge, which belongs to a triangle before it.
 * The tree.  parent[] is the minimum spanning tree of the Delaunay graph, made by
 * mst_build(), which also numbers the vertices along a depth-first walk of it: parent[0]
 * is 0 and parent[v] < v for every other v, so 0, 1, 2, ... visits parents first.
 *
 * All arrays live in one block without inner pointers; a mesh is copied by mesh_copy().
 * Units: lattice units (lattice.h).  A built mesh is immutable and may be read by any
 * number of threads. */
#ifndef CORE_MESH_H
#define CORE_MESH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "surface_basic.h"
#include "status.h"
#include "vec.h"

struct mesh {
    uint32_t nv;      /* points, at distinct (x, y) */
    uint32_t nt;      /* triangles, ghosts included: 2 nv - 2 */
    uint32_t cap;     /* capacity, in points */
    struct ivec2 *xy; /* [nv]; there is room for the ghost's too */
    int32_t *z;       /* [nv] height over (x, y) */
    uint32_t *org;    /* [3 nt] vertex at the half-edge's start */
    uint32_t *twin;   /* [3 nt] its other side */
    uint32_t *out;    /* [nv + 1] a half-edge that leaves the vertex */
    uint32_t *parent; /* [nv] towards the root of the spanning tree */
    void *block;      /* holds all of the above */
};

/* mesh_next(h), mesh_prev(h): Return the triangle's next and previous half-edge.  Without a branch,
 * which would be mispredicted: h is at a random corner. */
static inline uint32_t mesh_next(uint32_t h)
{
    return h + 1 - 3 * (uint32_t)(h % 3 == 2);
}

static inline uint32_t mesh_prev(uint32_t h)
{
    return h - 1 + 3 * (uint32_t)(h % 3 == 0);
}

/* mesh_dest(m, h): Returns the vertex at the end of h. */
static inline uint32_t mesh_dest(const struct mesh *m, uint32_t h)
{
    return m->org[mesh_next(h)];
}

/* mesh_turn(m, h): Returns the next half-edge out of org[h], counter-clockwise. */
static inline uint32_t mesh_turn(const struct mesh *m, uint32_t h)
{
    return m->twin[mesh_prev(h)];
}

static inline bool mesh_is_ghost(const struct mesh *m, uint32_t t)
{
    return m->org[3 * t] == m->nv || m->org[3 * t + 1] == m->nv ||
           m->org[3 * t + 2] == m->nv;
}

/* mesh_real(m): Returns the number of triangles without the ghosts.  Cost: O(nt). */
uint32_t mesh_real(const struct mesh *m);

/* mesh_reserve(m, n): Gives m, which may be all zero, the capacity for n points; its content is lost.
 * Cost: 68 bytes a point.
 * Returns ST_OK; ST_ELIMIT: n > SURFACE_MAX_POINTS; ST_ENOMEM: m is unchanged. */
enum status mesh_reserve(struct mesh *m, uint32_t n);
void mesh_free(struct mesh *m); /* resets m to the empty state; NULL is allowed */

/* mesh_copy(dst, src, extra): Copies src to dst, with capacity for at least extra more points.
 * Returns ST_OK; ST_ELIMIT; ST_ENOMEM: dst is unchanged. */
enum status mesh_copy(struct mesh *dst, const struct mesh *src, uint32_t extra);

/* mesh_check(m, tree): Checks all of mesh_link()'s conditions on a mesh with twins, and the empty
 * circle across every inner edge (so: the Delaunay triangulation).  For tests and for
 * surfacectl check.
 *   tree  true: parent[] must be a spanning tree of mesh edges (its minimality: mst_check())
 * Cost: O(nv).
 * Returns ST_OK, ST_ECORRUPT. */
enum status mesh_check(const struct mesh *m, bool tree);

#endif
