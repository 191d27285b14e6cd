/* measure.h -- the exact disparity of two surfaces at a given pose: the paper's pipeline
 * once through.  The probe's points are moved and put back on the lattice, triangulated and
 * given their tree (paper 1, 3.1, 3.3), spikes are laid flat, each mesh is located in the other (3.3) and
 * interpolated there (3.4), the general triangulation is merged and measured (3.5). */
#ifndef CORE_MEASURE_H
#define CORE_MEASURE_H
#include <stdint.h>
#include "disparity.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "status.h"
#include "vec.h"

/* A surface as alignment and measure need it: borrowed, never written. */
struct measure_surface {
    const struct mesh *mesh; /* with its spanning tree, spikes laid flat */
    const int32_t *raw;   /* [nv] heights as scanned, by which a probe is moved: what is a
                                spike depends on the side it is seen from */
    const float *spacing; /* [nv] holes_spacing() */
    const uint8_t *bridge; /* [nt] holes_mark() */
    double measured;       /* holes_mark()'s area, square lattice units */
};

/* Reusable memory of one worker, and what the last measure_at() left in it.  All zero is
 * an empty one; after the first few calls nothing is allocated any more. */
struct measure_work {
    struct scratch scratch; /* for the builders; free for other use between calls */
    struct scratch arrays;  /* the arrays below */
    struct mesh moved;      /* the probe at the pose, triangulated, with its tree */
    struct mesh general;    /* the general triangulation; template vertices come first */
    struct ivec3 *pts;      /* [probe nv] the moved points */
    struct location *tmpl_in_moved, *moved_in_tmpl;
    double *tmpl_other, *moved_other; /* heights interpolated in the other mesh */
    float *spacing;                   /* [moved.nv] */
    uint8_t *bridge;                  /* [moved.nt] */
    uint32_t *b_vertex;               /* [moved.nv] merge_build()'s */
    struct disparity_vertex *vertex;  /* [general.nv] gap: moved minus template */
    double measured;                  /* holes_mark()'s area of moved */
    double *ground; /* [general.nv] height of the template, where it covers the vertex */
};

void measure_work_free(struct measure_work *w); /* w is empty again; NULL is allowed */

/* measure_at(tmpl, probe, transform, u, w, out): the disparity of tmpl (side a) and of
 * probe moved by transform (side b; mm, row-major 4 x 4, rigid; a reflection will do).
 * A pose that takes a point off the lattice, or turns the probe edge-on so that nothing is
 * left to triangulate, gives *out all zero: nothing in common.  When that happens, or on
 * failure, w->general.nv is 0.
 * Cost  O(n log n), about five times a triangulation.  Returns ST_OK, ST_ENOMEM. */
enum status measure_at(const struct measure_surface *tmpl,
                       const struct measure_surface *probe, const double transform[16],
                       const struct disparity_weight *u, struct measure_work *w,
                       struct disparity *out);

#endif
