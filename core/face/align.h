/* align.h -- find the pose of a probe over a template.
 * Paper 1 section 4.  The probe moves; the template's triangulation and tree are never
 * rebuilt.
 * (1) Starting poses: the one that is given, and others from the principal axes of both
 *     surfaces; over a grid, as it lies, where that is cheaper by far than all of these.
 * (2) Reweighted Gauss-Newton steps, coarse to fine, on a robust sum of the gaps at points
 *     of the probe.  Each point is located in the template's triangulation, from the
 *     triangle in which the step before found it.
 * (3) The last step separates motion from change between two scans of one person (fit.h), so
 *     that an expression does not move the nose.
 * All arithmetic is in doubles in a fixed order, + - * / and sqrt only: the same two
 * surfaces give the same digits on every machine with IEEE 754 numbers. */
#ifndef CORE_ALIGN_H
#define CORE_ALIGN_H
#include <stdint.h>
#include "mem.h"
#include "status.h"

/* Share of the probe's points over the template below which both are apart. */
#define ALIGN_APART_WITHIN 0.2

struct pose_axes;    /* pose.h */
struct align_grid;   /* align_grid.h */
struct pose;         /* pose.h */
struct align_weight; /* align_field.h */
struct fit_basis;    /* fit.h */
struct surface;      /* surface.h */

enum align_stop {
    ALIGN_CONVERGED, /* the last step was below the resolution */
    ALIGN_STEPS,     /* the step limit was reached first */
    ALIGN_APART      /* the surfaces have too little in common at every start */
};

/* Returns "converged", "steps" or "apart", for struct surface_disparity. */
const char *align_stop_name(enum align_stop stop);

struct align_result {
    double transform[16]; /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    uint32_t evaluations; /* robust sums evaluated (over subsets of points too) */
    uint32_t starts;      /* starting poses tried */
    enum align_stop stop;
    double within;   /* share of the probe's points over the template, 0..1 */
    double cost_mm;  /* mean gap (capped, L1) at the coarse pose that was refined */
    double rival_mm; /* mean gap at the best coarse pose elsewhere; INFINITY: none */
    /* standard deviations of rotation and shift, from the curvature at the end; INFINITY: unknown */
    double turn_deg, shift_mm;
};

/* How to search; every member may be NULL. */
struct align_how {
    const struct pose *start;     /* tried first: probe -> template */
    const struct align_weight *u; /* weight, large on parts that keep their shape */
    /* for (3), which is skipped without it or without u */
    const struct fit_basis *motion;
    /* A template that is a grid, and its axes; both or neither: */
    const struct align_grid *grid;
    const struct pose_axes *axes;
};

/* One worker's memory; all zero is an empty one. */
struct align_work {
    struct scratch field, fit;
};

void align_work_free(struct align_work *w);              /* resets w to the empty state */
void align_work_wipe(struct align_work *w, size_t keep); /* as measure_work_wipe() */

/* align_search(tmpl, probe, how, w, out): Finds the pose of probe over tmpl.
 * tmpl, probe  lattice units at LATTICE_PER_MM; both need their spanning-tree order; tmpl is
 *              NULL where how has a grid, and how->u and how->motion count nothing then
 * out          filled; with ALIGN_APART the transform is the best one found
 * Works from any shift, and from rotations of the one against the other of up to 30 degrees
 * of yaw and 20 of pitch and roll.
 * Cost  a few thousand points are taken, however many there are, and a fixed number of steps
 * at most; no allocation once w has grown.  Returns ST_OK (surfaces apart included), ST_ENOMEM. */
enum status align_search(const struct surface *tmpl, const struct surface *probe,
                         const struct align_how *how, struct align_work *w,
                         struct align_result *out);

#endif
