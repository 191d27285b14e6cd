/* peers.h -- public libraries to compare with.  scripts/bench builds bench_peers.cpp as a
 * shared object if their Debian packages are installed. */
#ifndef TESTS_PEERS_H
#define TESTS_PEERS_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

/* Points, graphs and surfaces are converted to the peer's types first, outside the timing. */
struct peers {
    const char *name; /* libraries and versions */

    void *(*points)(const struct ivec3 *pts, size_t n);
    void (*points_free)(void *points);

    /* The points put into Hilbert order: as our spanning tree, the order is made once for a
     * cloud, and used to locate it and to merge it. */
    void *(*queries)(const struct ivec3 *pts, size_t n);
    void (*queries_free)(void *queries);

    /* CGAL::Delaunay_triangulation_2<EPICK>, by its range constructor */
    void *(*triangulate)(const void *points);
    /* copy, then insert each point from the one before; includes locating it */
    void *(*merge)(const void *triangulation, const void *queries);
    size_t (*vertices)(const void *triangulation);
    size_t (*faces)(const void *triangulation); /* without the infinite ones */
    void (*triangulation_free)(void *triangulation);

    /* Every point located, each from the one before; then interpolated where it was
     * located: height[i] at the point given as i, NAN outside the hull. */
    void *(*surface)(const struct ivec3 *pts, size_t n);
    void (*locate)(const void *surface, void *queries);
    void (*interpolate)(const void *surface, const void *queries, double *height);
    void (*surface_free)(void *surface);

    /* Boost's minimum spanning trees of a graph given by n edges */
    void *(*graph)(uint32_t nv, const uint32_t (*edges)[2], const double *length,
                   size_t n);
    void (*prim)(void *graph);
    double (*kruskal)(void *graph); /* the tree's total length */
    void (*graph_free)(void *graph);
};

#define PEERS_SYMBOL "peers_table" /* a struct peers */

#endif
