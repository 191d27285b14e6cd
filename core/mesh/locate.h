/* locate.h -- the place of a point in a triangulation, by walking towards it, and the height there.
 * Paper 1 sections 3.2 (one point, straight) and 3.3 (a whole mesh, along its spanning tree).
 * Exact: every turn of the walk is decided by orient2d on the lattice.  The straight walk ends
 * on every mesh that mesh_link() or mesh_check() accepts, Delaunay or not.  locate_mesh() goes
 * across any edge that the point lies beyond, which takes fewer tests; of contrived meshes each
 * way may be long, or a circle: its steps are counted, and beyond a multiple of the points the
 * others are located by bisection (chains.h). */
#ifndef CORE_LOCATE_H
#define CORE_LOCATE_H
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct mesh; /* mesh.h */

enum locate_where {
    LOCATE_INSIDE, /* strictly inside the triangle of half-edge he */
    LOCATE_EDGE,   /* strictly inside the edge he, whose triangle is not a ghost */
    LOCATE_VERTEX, /* on the vertex org[he]; he's triangle is not a ghost */
    LOCATE_OUTSIDE /* outside the hull; he, in a real triangle, is a hull edge that has the
                      point strictly on its outer side */
};

struct location {
    uint32_t he;
    uint32_t where; /* enum locate_where */
};

/* enter() is called for each triangle that the walk enters, in order, with the first one and
 * without ghosts.  Consecutive triangles differ and share an edge or, if the walk passes
 * through a vertex, that vertex. */
struct locate_trace {
    void (*enter)(void *arg, uint32_t triangle);
    void *arg;
};

/* locate_point(m, he, from, q, trace): Walks straight from `from` to q.
 * he     a half-edge of a real triangle that contains `from`, border included
 * trace  may be NULL
 * Handles every degenerate case: q on a vertex, on an edge or outside; a walk through a
 * vertex or along edges; `from` on a vertex or edge.
 * Cost  two orient2d for each triangle crossed: O(sqrt nv) on average over a long way, at
 * most O(nv). */
struct location locate_point(const struct mesh *m, uint32_t he, struct ivec2 from,
                             struct ivec2 q, const struct locate_trace *trace);

/* locate_mesh(in, pts, loc): Sets loc[v] to the location of vertex v of pts in `in`, for every vertex.
 * Each walk starts from the vertex's parent in pts' spanning tree (needs pts->parent,
 * not in->parent).
 * Cost  O(in->nv + pts->nv) for meshes of comparable density; at most
 * O((in->nv + pts->nv) log^2 in->nv), with memory of its own for the time.
 * Returns ST_OK, ST_ENOMEM. */
enum status locate_mesh(const struct mesh *in, const struct mesh *pts,
                        struct location *loc);

/* locate_height(m, loc, q): Returns the height of m at q, in lattice units, by barycentric interpolation
 * (paper 1 section 3.4); NAN outside the hull.  Exact at the vertices and on level triangles;
 * elsewhere the weights are exact integers and the error is below 1e-6 units.
 *   loc  q's location in m */
double locate_height(const struct mesh *m, struct location loc, struct ivec2 q);

/* locate_heights(m, pts, loc, out): Sets out[v] to the height of m at vertex v of pts, for every vertex.
 *   loc  from locate_mesh(m, pts, loc)
 * Cost: O(pts->nv). */
void locate_heights(const struct mesh *m, const struct mesh *pts,
                    const struct location *loc, double *out);

#endif
