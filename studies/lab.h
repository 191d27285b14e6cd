/* lab.h -- what the studies share: where their tables go, test functions, surfaces over
 * scattered points, quantiles and fits.  A study is a program's part, not a library's: what
 * cannot be done (no memory, no disk) ends the program with a message. */
#ifndef STUDIES_LAB_H
#define STUDIES_LAB_H
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

struct lab {
    const char *dir; /* where the study's files go */
    uint64_t seed;
    const char *faces; /* a folder of scans, or NULL */
    const char *raw;   /* a folder of the same people's scans as delivered, or NULL */
    bool reduced;      /* few draws, small sizes: for tests */
};

void lab_must(enum status st);          /* ends the program unless ST_OK */
void *lab_alloc(size_t n, size_t size); /* zeroed; free() */

/* lab_open(lab, name): the file name in the study's folder, for writing; lab_close() ends
 * the program where it could not all be written. */
FILE *lab_open(const struct lab *lab, const char *name);
void lab_close(FILE *f);

/* lab_field(f, places, x): a comma and x with so many digits behind the point; NAN, where
 * nothing was there to be measured, is an empty field. */
void lab_field(FILE *f, int places, double x);

/* ---- numbers */

struct lab_spread {
    double mean, median, low, high; /* low, high: the 5 % and 95 % quantiles */
};

/* lab_spread(v, n): sorts v; quantiles between neighbours in proportion.  n >= 1. */
struct lab_spread lab_spread(double *v, size_t n);

/* lab_share(k, n, low, high): the 95 % interval of a share of which k of n were seen (Clopper
 * and Pearson); n 0: 0 to 1. */
void lab_share(size_t k, size_t n, double *low, double *high);

/* y = c x^slope, by least squares of the logarithms; half: half the 95 % confidence
 * interval of the slope (Student); r2: the share of the variance explained.  n >= 3. */
struct lab_fit {
    double slope, half, c, r2;
};
struct lab_fit lab_fit(const double *x, const double *y, size_t n);

/* ---- the six test functions of the missing-points paper, as it prints them */

#define LAB_FUNCTIONS 6
#define LAB_UNIT      1e7 /* lattice units to the side of the unit square */
double lab_function(unsigned f, double x, double y); /* f 0 to 5 for F1 to F6 */
const char *lab_function_name(unsigned f);

/* lab_lattice(f, x, y): the point of the function's surface over (x, y). */
struct ivec3 lab_lattice(unsigned f, double x, double y);

/* ---- surfaces */

struct lab_surface {
    struct surface surface; /* no spikes are looked for */
    struct scratch scratch;
    struct location last; /* where the last point was found */
};

/* lab_triangulate(s, pts, n): all zero, or a former surface whose memory is used again.
 * Returns ST_OK or ST_EDEGENERATE. */
enum status lab_triangulate(struct lab_surface *s, const struct ivec3 *pts, size_t n);
void lab_surface_free(struct lab_surface *s);

/* lab_height(s, q, inside): the surface's height at q, lattice units; outside the hull that
 * of the nearest point of the hull, and *inside is false. */
double lab_height(struct lab_surface *s, struct ivec2 q, bool *inside);

/* ---- pictures */

/* lab_edges(m, per, tag, f): lines "tag,x1,y1,x2,y2", every edge once, per lattice units. */
void lab_edges(const struct mesh *m, double per, const char *tag, FILE *f);

/* lab_triangles(m, per, f): the triangles as gnuplot's pm3d wants them: each a surface of
 * its own of two scans of two points. */
void lab_triangles(const struct mesh *m, double per, FILE *f);

#endif
