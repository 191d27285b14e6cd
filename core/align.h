/* align.h -- shifts and rotations to the smallest disparity.
 * Paper 1 section 4.  The probe moves, the template stays: its triangulation and tree are
 * never rebuilt.  Three steps:
 * (1) a pose estimate from the principal axes of both, and starts round it;
 * (2) align_search(): robust sums of gaps at probe points located in the template's
 *     triangulation, each found again from the triangle where it was last time, coarse to
 *     fine, by reweighted Gauss-Newton steps;
 * (3) align_finish(): the exact disparity over the general triangulation, so that the
 *     number reported is a minimum of that.
 * Double arithmetic in a fixed order, + - * / and sqrt only, so the same two meshes give
 * the same digits on every machine with IEEE 754 doubles. */
#ifndef CORE_ALIGN_H
#define CORE_ALIGN_H
#include <stdint.h>
#include "status.h"

struct disparity;        /* disparity.h */
struct disparity_weight; /* disparity.h */
struct measure_surface;  /* measure.h */
struct measure_work;     /* measure.h */
struct scratch;          /* mem.h */

enum align_stop {
    ALIGN_CONVERGED, /* the last step was below the resolution */
    ALIGN_STEPS,     /* the step limit was reached first */
    ALIGN_APART      /* the surfaces have too little in common at every start */
};

struct align_result {
    double transform[16]; /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    uint32_t evaluations; /* robust sums evaluated (over subsets of points too) */
    uint32_t exact;       /* evaluations of the exact measure */
    uint32_t starts;      /* starting poses tried */
    enum align_stop stop;
};

/* align_search(tmpl, probe, u, s, out): steps (1) and (2).
 * tmpl, probe  lattice units at LATTICE_PER_MM; both need their spanning-tree order
 * u            weight over the template's plane for the last steps; NULL: 1 everywhere
 * out          filled; with ALIGN_APART the transform is the best that was seen
 * Finds the pose from any shift, and from rotations of the one against the other up to
 * 30 degrees of yaw and 20 of pitch and roll.
 * Cost  O(probe->nv) a step, at most a fixed number of steps; no allocation once s has
 * grown.  Returns ST_OK (surfaces apart included), ST_ENOMEM. */
enum status align_search(const struct measure_surface *tmpl,
                         const struct measure_surface *probe,
                         const struct disparity_weight *u, struct scratch *s,
                         struct align_result *out);

/* align_finish(tmpl, probe, u, w, io, out): step (3), from io->transform downhill on
 * out->weighted_mm; io->transform, ->exact and ->stop are brought up to date and *out is
 * the exact measure at io->transform.  May be called with ALIGN_APART too: then it
 * measures once and leaves the transform.
 * Cost  at most ALIGN_MAX_EXACT exact measures.  Returns ST_OK, ST_ENOMEM. */
#define ALIGN_MAX_EXACT 4
enum status align_finish(const struct measure_surface *tmpl,
                         const struct measure_surface *probe,
                         const struct disparity_weight *u, struct measure_work *w,
                         struct align_result *io, struct disparity *out);

#endif
