/* star.h -- remove a vertex from a Delaunay triangulation.
 * Only the triangles round the vertex change: those that fill the polygon they leave have
 * their corners on that polygon.  Heller's rule, to cut off the ear with the
 * smallest circle first, does not give the Delaunay triangulation; Devillers ("On Deletion
 * in Delaunay Triangulations", Int. J. Comput. Geom. Appl. 12, 2002) orders the ears by the
 * power of the removed vertex.  Rings are short, and no such order is needed here: the
 * circles through the ends of an edge, on one side of it, lie within each other, so one pass
 * over the polygon finds the corner that belongs to an edge, and the parts on both sides of
 * that triangle are filled in the same way.  With predicates.h's rule for
 * cocircular points the result is, triangle for triangle, what delaunay_build() makes of
 * the points without that one. */
#ifndef CORE_STAR_H
#define CORE_STAR_H
#include <stdbool.h>
#include <stdint.h>

struct mesh; /* mesh.h */

#define STAR_MAX  64 /* neighbours; a vertex with more is not removed */
#define STAR_NONE UINT32_MAX

struct star {
    uint32_t v, n;           /* the vertex; its neighbours */
    uint32_t ring[STAR_MAX]; /* the neighbours, counter-clockwise */
    uint32_t edge[STAR_MAX]; /* the half-edge ring[i] -> ring[i + 1] in v's triangle */
    uint32_t ntri;           /* n - 2, that fill the polygon: */
    uint8_t corner[STAR_MAX][3]; /* places in ring, counter-clockwise */
    uint32_t mate[STAR_MAX][3];  /* across the edge from corner i to i + 1: 3 x triangle +
                                    edge, or STAR_RING + place: that edge of the ring */
};
#define STAR_RING (UINT32_C(1) << 31)

/* star_find(m, v, s): Finds the triangles that would replace v; m is not changed.
 * Cost: O(n^2), for n neighbours.
 * Returns false if v is on the hull, was removed before, or has more than STAR_MAX neighbours. */
bool star_find(const struct mesh *m, uint32_t v, struct star *s);

/* star_remove(m, s): Removes s->v: m->out of it becomes STAR_NONE.  The triangles of
 * s->edge[0 .. n-3] become those that fill the polygon, in that order; the corners of the
 * last two become STAR_NONE.  nv and nt stay, so mesh_check() would refuse m, though the
 * triangles left are a Delaunay triangulation.  Precondition: s is
 * from star_find(m, ...), and m is unchanged since.  Cost: O(n). */
void star_remove(struct mesh *m, const struct star *s);

#endif
