/* brute.h -- geometry by definition and by linear search: slow, short, and independent of the
 * algorithms of core, which are compared with it.  Also the point sets of the tests. */
#ifndef TESTS_BRUTE_H
#define TESTS_BRUTE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "draw.h"
#include "locate.h"
#include "mesh.h"

/* brute_seed(name): Prints and returns the seed of a test: SEED in the environment, else a fixed
 * number. */
uint64_t brute_seed(const char *name);

/* brute_int(r, lo, hi): Draws an integer of lo..hi, both included. */
int32_t brute_int(struct draw *r, int32_t lo, int32_t hi);

/* brute_shuffle(items, n, size, r): Puts n items of size bytes (64 at most) in random order. */
void brute_shuffle(void *items, size_t n, size_t size, struct draw *r);

/* Shapes of point sets.  All points are distinct in (x, y) and not all on a line. */
enum brute_shape {
    BRUTE_RANDOM,    /* uniform in a large square */
    BRUTE_SMALL,     /* uniform in a square so small that alignments abound */
    BRUTE_LATTICE,   /* a regular grid: all cocircular */
    BRUTE_CIRCLE,    /* on one circle, exactly */
    BRUTE_HULL_LINE, /* many points along the sides of a rectangle */
    BRUTE_CLUSTERS,  /* tight clusters far apart */
    BRUTE_COLUMNS,   /* two points in a column */
    BRUTE_EXTREME,   /* the corners and sides of the whole lattice among others */
    BRUTE_SHAPES
};

/* brute_points(shape, n, r, out): Draws at most n points, 3 <= n; their heights are a bumpy surface
 * plus noise.  Returns the number of points. */
size_t brute_points(enum brute_shape shape, size_t n, struct draw *r, struct ivec3 *out);

/* brute_delaunay(pts, n, out): Triangulates by definition: each directed edge forms a triangle with
 * the point on its left whose circle is empty.  Cost: O(n^2), a search of all points and edges. */
void brute_delaunay(const struct ivec3 *pts, size_t n, struct mesh *out);

/* brute_flip(m, h): Replaces h, a diagonal of the two triangles at it, by the other diagonal,
 * if both triangles are real and the other diagonal lies within them.  The triangulation is
 * then no longer Delaunay.  Returns true if it was flipped. */
bool brute_flip(struct mesh *m, uint32_t h);

/* brute_order(m, r): Links the edges of the triangles in m->org, which form a sphere, and puts the
 * triangles in the order of mesh.h: each behind the first half-edge that shows it, or, with r,
 * behind a random half-edge.  Cost: O(nt^2). */
void brute_order(struct mesh *m, struct draw *r);

/* brute_code(m): Overwrites all members of m that mesh_link() does not read.  The triangles are in
 * the order of mesh.h. */
void brute_code(struct mesh *m);

/* brute_same(a, b): Returns true if both have the same points and triangles, in any order. */
bool brute_same(const struct mesh *a, const struct mesh *b);

/* brute_identical(a, b): Returns true if points, triangles and links are equal, number by number. */
bool brute_identical(const struct mesh *a, const struct mesh *b);

/* brute_prim(m, parent): Finds the minimum spanning tree by Prim's rule; edges of one length are
 * ordered by their points.
 *   parent  by vertex of m; the root is the lexicographically first point
 * Cost: O(nv^2). */
void brute_prim(const struct mesh *m, uint32_t *parent);

/* brute_locate(m, q): Returns a correct location of q, by searching all triangles. */
struct location brute_locate(const struct mesh *m, struct ivec2 q);

/* brute_volume(a, b, area): Returns the integral of |height of b - height of a| over the common area
 * of both hulls, lattice units, and sets *area to that area.  Each triangle of a is clipped
 * against each of b.  Cost: O(nv^2). */
double brute_volume(const struct mesh *a, const struct mesh *b, double *area);

#endif
