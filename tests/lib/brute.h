/* brute.h -- the geometry by definition and by linear search: slow, short, and independent of
 * core's algorithms, which are compared with it.  Also the tests' point sets. */
#ifndef TESTS_BRUTE_H
#define TESTS_BRUTE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "locate.h"
#include "mesh.h"

/* A small generator (splitmix64): the same numbers on every machine. */
struct brute_rng {
    uint64_t state;
};

/* brute_seed(name): prints and returns the test's seed: SEED in the environment, else a fixed
 * one. */
uint64_t brute_seed(const char *name);
uint64_t brute_rand(struct brute_rng *r);
int32_t brute_int(struct brute_rng *r, int32_t lo,
                  int32_t hi);                         /* lo..hi, both included */
double brute_real(struct brute_rng *r);                /* [0, 1) */
double brute_within(struct brute_rng *r, double half); /* [-half, half) */

/* brute_shuffle(items, n, size, r): puts n items of size bytes (64 at most) in random order. */
void brute_shuffle(void *items, size_t n, size_t size, struct brute_rng *r);

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

/* brute_points(shape, n, r, out): at most n points; the heights are a bumpy surface plus
 * noise.  Returns the number of points.  n is 3 or more. */
size_t brute_points(enum brute_shape shape, size_t n, struct brute_rng *r,
                    struct ivec3 *out);

/* brute_delaunay(pts, n, out): the triangulation by definition: each directed edge forms a
 * triangle with the point on its left whose circle is empty, found by searching all points.
 * O(n^2). */
void brute_delaunay(const struct ivec3 *pts, size_t n, struct mesh *out);

/* brute_flip(m, h): replaces h, a diagonal of the two triangles at it, by the other diagonal,
 * if both triangles are real and the other diagonal lies within them.  The triangulation is
 * then no longer Delaunay.  Returns whether it was flipped. */
bool brute_flip(struct mesh *m, uint32_t h);

/* brute_order(m, r): m->org has the corners of triangles that form a sphere.  Links their edges
 * and puts the triangles in the order of mesh.h: each behind the first half-edge that shows
 * it, or, with r, behind one chosen at random.  O(nt^2). */
void brute_order(struct mesh *m, struct brute_rng *r);

/* brute_code(m): keep of m, whose triangles are in the order of mesh.h, what mesh_link() reads;
 * the rest is overwritten. */
void brute_code(struct mesh *m);

/* brute_same(a, b): the same points and the same set of triangles, whatever the numbers. */
bool brute_same(const struct mesh *a, const struct mesh *b);

/* brute_identical(a, b): the same points, triangles and links, number by number. */
bool brute_identical(const struct mesh *a, const struct mesh *b);

/* brute_prim(m, parent): the minimum spanning tree by Prim's rule, with edges in the order of
 * their lengths, then of their points; parent[] is indexed by vertex of m, and the root is the lexicographically
 * first point.  O(nv^2). */
void brute_prim(const struct mesh *m, uint32_t *parent);

/* brute_locate(m, q): a correct location of q by searching all triangles. */
struct location brute_locate(const struct mesh *m, struct ivec2 q);

/* brute_volume(a, b, area): the integral of |height of b - height of a| over the common area
 * of both hulls, from the exact overlay of both triangulations: each triangle of a is clipped
 * against each of b.  *area: the common area.  O(nv^2), lattice units. */
double brute_volume(const struct mesh *a, const struct mesh *b, double *area);

#endif
