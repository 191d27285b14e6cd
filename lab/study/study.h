/* study.h -- what the studies share: where their tables go, test functions, surfaces over
 * scattered points, quantiles and fits.  A study is a program's part, not a library's: what
 * cannot be done (no memory, no disk) ends the program with a message. */
#ifndef LAB_STUDY_H
#define LAB_STUDY_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "status.h"
#include "surface.h"
#include "vec.h"

struct study {
    const char *dir; /* folder of the study's files */
    uint64_t seed;
    bool reduced; /* few draws, small sizes: for tests */
};

/* ---- the studies; what each writes stands in its .html (the part of the report), what came
 * out in docs/studies.md */
void method_run(const struct study *study); /* the disparity paper's figures 1 to 9 */
void cost_run(const struct study *study);   /* its tables 1 to 4 */
void faces_run(const struct study *study);  /* its figures 10 and 11 */
void missing_run(
    const struct study *study); /* the missing-points paper's figures, tables */

void study_must(enum status st);          /* ends the program unless ST_OK */
void *study_alloc(size_t n, size_t size); /* zeroed; free() */

/* study_open(study, name): Opens a file of the study's folder for writing. */
FILE *study_open(const struct study *study, const char *name);

/* study_close(f): Closes it; ends the program if not all could be written. */
void study_close(FILE *f);

/* ---- numbers */

/* study_real(r): uniform in [0, 1); study_int(r, lo, hi): uniform, both ends included. */
struct study_random {
    uint64_t state;
};
double study_real(struct study_random *r);
int32_t study_int(struct study_random *r, int32_t lo, int32_t hi);

struct study_spread {
    double mean, median, low, high; /* low, high: the 5 % and 95 % quantiles */
};

/* study_spread(v, n): sorts v; quantiles between neighbours in proportion.  n >= 1. */
struct study_spread study_spread(double *v, size_t n);

/* y = c x^slope, by least squares of the logarithms; half: half the 95 % confidence
 * interval of the slope (Student).  n >= 3. */
struct study_fit {
    double slope, half;
};
struct study_fit study_fit(const double *x, const double *y, size_t n);

/* ---- the six test functions of the missing-points paper, as it prints them */

#define STUDY_FUNCTIONS 6
#define STUDY_UNIT      1e7 /* lattice units to the side of the unit square */
double study_function(unsigned f, double x, double y); /* f 0 to 5 for F1 to F6 */
const char *study_function_name(unsigned f);

/* study_lattice(f, x, y): Returns the point of the function's surface over (x, y). */
struct ivec3 study_lattice(unsigned f, double x, double y);

/* ---- surfaces */

struct study_surface {
    struct surface surface; /* no spikes are looked for */
    struct scratch scratch;
    struct location last; /* place of the last point */
};

/* study_triangulate(s, pts, n): Triangulates the points.
 *   s  all zero, or a former surface, whose memory is used again
 * Returns ST_OK or ST_EDEGENERATE. */
enum status study_triangulate(struct study_surface *s, const struct ivec3 *pts, size_t n);
void study_surface_free(struct study_surface *s);

/* study_height(s, q, inside): Returns the surface's height at q, lattice units; outside the hull the height of
 * its nearest point, and *inside is false. */
double study_height(struct study_surface *s, struct ivec2 q, bool *inside);

/* ---- pictures */

/* study_edges(m, per, tag, f): lines "tag,x1,y1,x2,y2", every edge once, per lattice units. */
void study_edges(const struct mesh *m, double per, const char *tag, FILE *f);

/* study_triangles(study, name, m, per): Writes a file of the triangles for gnuplot's pm3d: each as a surface of
 * two scans of two points, with the triangle's brightness behind each point. */
void study_triangles(const struct study *study, const char *name, const struct mesh *m,
                     double per);

#endif
