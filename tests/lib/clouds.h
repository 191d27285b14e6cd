/* clouds.h -- point sets for the benchmarks: face-like scans, and inputs that are hard to
 * triangulate.  Everything depends on the seeds alone. */
#ifndef TESTS_CLOUDS_H
#define TESTS_CLOUDS_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

enum clouds_kind {
    CLOUDS_FACE,     /* a simulated scan of a generated face, frontal */
    CLOUDS_UNIFORM,  /* uniform in a square */
    CLOUDS_GRID,     /* a range sensor's: rows and columns within an oval, some missing */
    CLOUDS_TILTED,   /* a regular grid turned by a rational angle */
    CLOUDS_CIRCLE,   /* all on one circle, exactly */
    CLOUDS_LINES,    /* on two lines that cross, and one point off them */
    CLOUDS_CLUSTERS, /* tight clusters far apart */
    CLOUDS_COLUMNS,  /* two points in every column */
    CLOUDS_DUPLICATES, /* three points at each place */
    CLOUDS_PARABOLA,   /* on half a parabola: one vertex in every triangle */
    CLOUDS_KINDS
};

const char *clouds_name(enum clouds_kind kind);

/* clouds_make(kind, k, n, out): Makes the k-th point set of a kind, in random order, in lattice
 * units; out has capacity n.  Returns the number of points: about n; 3,072 at most of a circle. */
size_t clouds_make(enum clouds_kind kind, uint64_t k, size_t n, struct ivec3 *out);

/* clouds_scan(subject, scan, n, out): Makes a frontal scan of facegen_default(), in mm.  Returns the
 * number of points, n or fewer. */
size_t clouds_scan(uint64_t subject, uint64_t scan, size_t n, struct dvec3 *out);

/* clouds_move(pts, n, k, degrees, mm, transform): Turns the points by this angle about a random
 * axis, then shifts them by mm in a random direction, both drawn with seed k.  Sets transform to
 * the motion (row-major 4 x 4). */
void clouds_move(struct dvec3 *pts, size_t n, uint64_t k, double degrees, double mm,
                 double transform[16]);

#endif
