/* weight.h -- u(x, y) of the measure: where a face keeps its shape.
 * Paper 1 section 2, definition (1).  Mouth, jaw and cheeks move with expression and change
 * between captures; nose, orbits and forehead hardly do.  The weight is 1 on and above the
 * nose tip near the middle and falls off beneath and to the sides, to a floor that still
 * counts the rest.  Its three lengths were chosen on simulated scans (docs/decision.md). */
#ifndef CORE_WEIGHT_H
#define CORE_WEIGHT_H
#include "disparity.h"

struct measure_surface; /* measure.h */

struct weight_face {
    double nose_x, nose_y; /* the template's nose tip, lattice units */
};

/* weight_of(tmpl, w): the weight for a template; find its nose.  O(nv).  The returned
 * function borrows w.  x is taken to run to the side and y up, as in the scanner's frame. */
struct disparity_weight weight_of(const struct measure_surface *tmpl,
                                  struct weight_face *w);

/* weight_total(tmpl, u): the sum of u over what was measured of the template, mm^2.
 * O(nt). */
double weight_total(const struct measure_surface *tmpl, const struct disparity_weight *u);

#endif
